"""The command as its users run it."""

import csv
import dataclasses
import json
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import runway_modal as rm
from runway_modal.cli import main


@pytest.fixture
def case(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    assert main(["example"]) == 0
    path = tmp_path / "case.toml"
    path.write_text(capsys.readouterr().out, encoding="utf-8")
    return path


def test_example_prints_the_demo_numbers(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(case)]) == 0
    printed = capsys.readouterr().out
    # The README's, from report1980.
    for number in ("12.0163", "8921.8", "12939.7", "43685.9", "3.2662", "3516.1"):
        assert number in printed
    assert "WARNING" not in printed
    assert "Inferred, not published: track[0]: ramps of 12 in" in printed


def test_unloading_is_said(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = case.read_text(encoding="utf-8")
    case.write_text(text.replace('"full_mat"', '"mat"\nlength = 930\nheight = 4', 1), "utf-8")
    assert main(["run", str(case)]) == 0
    printed = capsys.readouterr().out
    assert "WARNING: load reaches zero on nose, left, right; the linear model" in printed
    assert [line.split()[0] for line in printed.splitlines() if line.endswith("UNLOADS")] == [
        "nose",
        "left",
        "right",
    ]


@pytest.mark.parametrize(("shape", "struck"), [("half_mat", True), ("full_mat", False)])
def test_blows_that_are_left_out_are_said(
    case: Path, capsys: pytest.CaptureFixture[str], shape: str, struck: bool
) -> None:
    case.write_text(
        '[units]\nlength = "in"\nforce = "lbf"\n[single_dof]\nmass = 145.5\nomega = 12\n'
        f'damping_ratio = 0.1\n[[track]]\nshape = "{shape}"\n'
        '[run]\nspeeds = ["20 kt"]\ndamping_input = true\n',
        "utf-8",
    )
    assert main(["run", str(case)]) == 0
    assert ("strike the dampers of gear" in capsys.readouterr().out) == struck


@pytest.mark.parametrize(
    ("ratio", "given", "said"),
    [
        (0.1, "", "may be far too low"),
        # On the mat's ramps the dampers would push by 6 % of the static load.
        (0.02, "", "and slopes worth 6 % of static loads, but"),
        (0.01, "", None),
        (0.1, "true", None),
    ],
)
def test_dampers_that_do_not_feel_the_ground_are_said(
    case: Path, capsys: pytest.CaptureFixture[str], ratio: float, given: str, said: str | None
) -> None:
    case.write_text(
        '[units]\nlength = "in"\nforce = "lbf"\n[single_dof]\nmass = 145.5\nomega = 12\n'
        f'damping_ratio = {ratio}\n[[track]]\nshape = "full_mat"\n[run]\nspeeds = ["20 kt"]\n'
        + (f"damping_input = {given}\n" if given else ""),
        "utf-8",
    )
    assert main(["run", str(case)]) == 0
    printed = capsys.readouterr().out
    assert ("do not feel the ground's" in printed) == bool(said)
    assert (said or "") in printed


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("mass = 145.5", "mass = 0.01", "NOTE: modes of 225 to 2"),
        (
            "damping_ratio = 0.1",
            "damping_ratio = 5",
            "a damping ratio of 5 is beyond critical",
        ),
        ("damping_input = true", "damping_input = false", "NOTE: damping ratios up to 0.1 act on"),
        ("", "", "NOTE: damping_input has no effect: no gear has a damping of its own"),
        ("damping_ratio = 0.1", "damping_ratio = 0.01", "has no effect"),
    ],
)
def test_slips_are_said(
    case: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, said: str
) -> None:
    text = (
        '[units]\nlength = "in"\nforce = "lbf"\n[aircraft]\nmass = 145.5\npitch_inertia = 1.92e6\n'
        "roll_inertia = 6.56e5\ndamping_ratio = 0.1\n[[aircraft.gears]]\nname = 'leg'\n"
        "x = 0\ny = 0\nstiffness = 2e4\n[[track]]\nshape = 'full_mat'\n[run]\nspeeds = ['20 kt']\n"
        "damping_input = true\n"
    )
    case.write_text(text.replace(old, new), "utf-8")
    assert main(["run", str(case)]) == 0
    assert said in capsys.readouterr().out


def test_dampers_that_a_noisy_survey_shakes_are_said(
    case: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    x, noise = 0.25 * np.arange(400), np.random.default_rng(5).normal(scale=1e-3, size=400)
    rm.write_csv(case.with_name("survey.csv"), rm.Profile(x, noise), "m")
    text = (
        '[units]\nlength = "m"\nforce = "N"\n[aircraft]\nmass = 3e4\npitch_inertia = 1e6\n'
        "roll_inertia = 1e6\n[[aircraft.gears]]\nname = 'leg'\nx = 0\ny = 0\nstiffness = 1e6\n"
        "damping = 45e3\n[[track]]\nfile = 'survey.csv'\n[run]\nspeeds = ['{}']\n"
        "damping_input = true\n"
    )
    for speed, said in (("70 m/s", True), ("7 m/s", False)):
        case.write_text(text.format(speed), "utf-8")
        assert main(["run", str(case)]) == 0
        assert ("the dampers of leg push by" in capsys.readouterr().out) == said


def test_a_grade_is_said_and_taken_out(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case.with_name("survey.csv").write_text("x [m],z [m]\n0,10\n500,16\n1500,25\n", "utf-8")
    text = (
        '[units]\nlength = "m"\nforce = "N"\n[aircraft]\npreset = "f4e"\ndamping_ratio = 0.01\n'
        '[[track]]\nfile = "survey.csv"\n{}[run]\nspeeds = ["100 kt"]\n'
    )
    case.write_text(text.format(""), "utf-8")
    assert main(["run", str(case)]) == 0
    said = capsys.readouterr().out
    assert "the track under nose, left, right rises by +15 m." in said
    case.write_text(text.format("detrend = true\n"), "utf-8")
    assert main(["run", str(case)]) == 0
    assert "rises by" not in capsys.readouterr().out


def test_tables_are_aligned_at_the_right(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(case)]) == 0
    lines = capsys.readouterr().out.splitlines()
    for head, rows in (("  mode", 3), ("  gear", 3), ("  station", 2)):
        (at,) = (i for i, line in enumerate(lines) if line.startswith(head))
        widths = {len(line) for line in lines[at : at + rows + 1]}
        assert len(widths) == 1, lines[at : at + rows + 1]


def test_nonlinear_run(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = case.read_text(encoding="utf-8").replace("# nonlinear", "nonlinear")
    case.write_text(re.sub("(?m)^stiffness.*$", "", text), encoding="utf-8")
    paths = {kind: str(case.with_name(f"a.{kind}")) for kind in ("csv", "parquet")}
    figure = str(case.with_name("a.svg"))
    options = (a for kind, path in paths.items() for a in (f"--{kind}", path))
    assert main(["run", str(case), *options, "--figure", figure, "--sections", "50 ft"]) == 0
    printed = capsys.readouterr().out
    # The largest of all, 40.4 kip again, leads the list.
    assert re.search(r"Worst 6 of 6 sections.*\n.*\n +1200\.00 +\d\.\d+ +1\.71", printed)
    # What `nonlinear.simulate` says of the main gears: 40.4 kip.
    assert re.search(r"left +23627\.1 +40[34]\d\d\.\d", printed)
    assert "Inferred, not published: aircraft: gas law and dampers" in printed
    frame = pd.read_parquet(paths["parquet"])
    assert frame.attrs["units"]["stiffness_left"] == "lbf/in"
    assert pd.read_csv(paths["csv"])["stiffness_left [lbf/in]"].max() > 11000.0


def test_root_mean_squares_of_acceleration(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(case)]) == 0
    line = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("  cg "))
    response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    assert float(line.split()[-1]) == pytest.approx(
        response.rms_acceleration["cg"] / 386.0886, abs=6e-5
    )


def test_the_worst_sections(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(case), "--sections", "25 ft"]) == 0
    printed = capsys.readouterr().out
    title, heads, *lines = printed[printed.index("Worst 10 of 11") :].splitlines()
    assert "sections of 300 in: largest load ÷ static" in title
    assert heads.split() == ["from", "[in]", "nose", "left", "right", "cg", "RMS", "pilot", "RMS"]
    aircraft = dataclasses.replace(rm.f4e(), stations={"pilot": (200.0, 0.0)})
    response = rm.simulate(aircraft.modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    sections = response.sections(300.0)
    shares = []
    for line in lines:
        begin, *numbers = (float(number) for number in line.split())
        found = sections[begin]
        np.testing.assert_allclose(numbers[:3], found.max_load / found.static_load, atol=6e-4)
        assert numbers[3] == pytest.approx(found.max_acceleration["cg"] / 386.0886, abs=6e-5)
        assert numbers[6] == pytest.approx(found.rms_acceleration["pilot"] / 386.0886, abs=6e-5)
        shares.append(max(numbers[:3]))
    assert shares == sorted(shares, reverse=True)
    assert len(lines) == 10
    assert len(sections) == 11
    # A number alone is in the case's units.
    assert main(["run", str(case), "--sections", "300"]) == 0
    assert capsys.readouterr().out == printed
    to = case.with_suffix(".json")
    assert main(["run", str(case), "--sections", "300", "--json", str(to)]) == 0
    written = json.loads(to.read_text())["runs"][0]["sections"]
    assert [section["begin"] for section in written] == list(sections)
    for section, found in zip(written, sections.values(), strict=True):
        assert list(section["max_load"].values()) == pytest.approx(found.max_load.tolist())
        assert section["max_acceleration"] == pytest.approx(found.max_acceleration)
        assert list(section["rms_load"].values()) == pytest.approx(found.rms_load.tolist())
        assert section["rms_acceleration"] == pytest.approx(found.rms_acceleration)


@pytest.mark.parametrize(
    ("length", "said"),
    [
        ("-5 ft", "--sections = -60.0 is not positive"),
        ("100 lb", "--sections = '100 lb' has the wrong kind of unit"),
        ("long", "--sections = 'long' is not a number with a unit"),
        ("1e-6", "length = 1e-06 makes"),
    ],
)
def test_sections_that_are_none(
    case: Path, capsys: pytest.CaptureFixture[str], length: str, said: str
) -> None:
    assert main(["run", str(case), "--sections", length]) == 2
    assert said in capsys.readouterr().err


def test_files_hold_the_response(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = case.parent
    text = case.read_text(encoding="utf-8").replace('["20 kt"]', '["10 kt", "20 kt"]')
    case.write_text(text + '\n[output]\nfigure = "loads.png"\n', encoding="utf-8")
    paths = {kind: str(out / f"a.{kind}") for kind in ("csv", "json", "parquet")}
    assert main(["run", str(case), *(a for k, p in paths.items() for a in (f"--{k}", p))]) == 0
    response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    frame = pd.read_parquet(paths["parquet"])
    assert frame.attrs["units"]["load_left"] == "lbf"
    last = frame[np.isclose(frame["speed"], rm.knots(20))]
    np.testing.assert_allclose(last["load_left"], response.load[:, 1], rtol=1e-12)
    table = pd.read_csv(paths["csv"])
    np.testing.assert_allclose(table["load_left [lbf]"], frame["load_left"], rtol=1e-15)
    document = json.loads(Path(paths["json"]).read_text())
    assert document["runway_modal"] == rm.__version__
    left = document["aircraft"]["gears"][1]
    assert (left["name"], left["stiffness"]) == ("left", rm.f4e().gears[1].stiffness)
    assert document["aircraft"]["pitch_inertia"] == rm.f4e().pitch_inertia
    runs = document["runs"]
    assert [run["stated_speed"] for run in runs] == ["10 kt", "20 kt"]
    assert runs[1]["max_load"]["left"] == pytest.approx(43685.9, abs=0.05)
    assert runs[1]["rms_load"]["left"] == pytest.approx(response.rms_load[1])
    assert runs[1]["rms_acceleration"]["cg"] == pytest.approx(response.rms_acceleration["cg"])
    assert (out / "loads.png").read_bytes().startswith(b"\x89PNG")


def test_standard_output_is_the_table_alone(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(case), "--csv", "-"]) == 0
    rows = list(csv.reader(capsys.readouterr().out.splitlines()))
    assert rows[0][:3] == ["speed [in/s]", "time [s]", "distance [in]"]
    assert {len(row) for row in rows} == {14}
    assert main(["run", str(case), "--json", "-"]) == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out)["runs"][0]["unloaded"] == dict.fromkeys(
        ("nose", "left", "right"), False
    )
    # What is said of the run is not lost.
    assert "Inferred, not published" in captured.err


def test_one_speed_spelled_twice_is_two_runs(case: Path) -> None:
    text = case.read_text(encoding="utf-8").replace('["20 kt"]', '["20 kt", "20.0 kt"]')
    case.write_text(text, encoding="utf-8")
    for kind, read in (("csv", pd.read_csv), ("parquet", pd.read_parquet)):
        path = case.with_suffix(f".{kind}")
        assert main(["run", str(case), f"--{kind}", str(path)]) == 0
        times = read(path).iloc[:, 1]
        assert (times == 0.0).sum() == 2


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--csv", "-", "--json", "-"], "only one of them can go to standard output"),
        (["--figure", "-"], "--figure -: only csv or json can go to standard output"),
        (["--figure", "a.xyz"], "figure a.xyz: "),
        (["--csv", "./case.toml"], "csv ./case.toml: that is the case file"),
        (["--csv", "a.b", "--json", "./a.b"], "json ./a.b: already taken by csv"),
        (["--csv", "none/a.csv"], "csv none/a.csv: no such directory"),
        (["--csv", "a.xlsx"], "csv a.xlsx: what is written is csv, not xlsx"),
        (["--parquet", "a.csv"], "parquet a.csv: what is written is parquet, not csv"),
    ],
)
def test_refused_files(
    case: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    options: list[str],
    said: str,
) -> None:
    monkeypatch.chdir(case.parent)
    before = case.read_bytes()
    assert main(["run", "case.toml", *options]) == 2
    assert said in capsys.readouterr().err
    assert case.read_bytes() == before


def test_a_survey_is_not_written_over(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    survey, table = case.with_name("survey.csv"), "0,0\n1,0.1\n2,0\n"
    survey.write_text(table, encoding="utf-8")
    text = case.read_text(encoding="utf-8")
    case.write_text(text.replace('shape = "full_mat"', 'file = "survey.csv"\nunit = "in"'), "utf-8")
    assert main(["run", str(case), "--csv", str(survey)]) == 2
    assert f"csv {survey}: that is a track of the case" in capsys.readouterr().err
    assert survey.read_text(encoding="utf-8") == table
    assert main(["run", str(case), "--csv", str(case.with_name("other.csv"))]) == 0


def test_bad_input_exits_with_2(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(case.with_name("none.toml"))]) == 2
    case.write_text("speed = 3\n", encoding="utf-8")
    assert main(["run", str(case)]) == 2
    error = capsys.readouterr().err
    assert "none.toml" in error
    assert "case.toml:1: unknown key 'speed'" in error


@pytest.mark.parametrize(
    ("raised", "code", "said"),
    [
        (KeyboardInterrupt(), 130, ""),
        (MemoryError("8 EiB"), 1, "runway-modal: error: out of memory: 8 EiB\n"),
        (rm.NumericalError("inf"), 1, "runway-modal: error: inf\n"),
        (ImportError("pip install it"), 1, "runway-modal: error: pip install it\n"),
    ],
)
def test_what_stops_a_run_is_an_exit_code(
    case: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    raised: BaseException,
    code: int,
    said: str,
) -> None:
    def stop(_: object) -> None:
        raise raised

    monkeypatch.setattr("runway_modal.case.Case.run", stop)
    assert main(["run", str(case)]) == code
    assert capsys.readouterr().err == said


def test_a_reader_that_leaves_is_no_fault(case: Path) -> None:
    written = [case.with_name("run.csv"), case.with_name("run.json")]
    files = ["--csv", str(written[0]), "--json", str(written[1])]
    for arguments in (
        ["example"],
        ["run", str(case), "--csv", "-"],
        ["run", str(case), *files],
    ):
        code = "import sys; from runway_modal.cli import main; sys.exit(main(sys.argv[1:]))"
        with subprocess.Popen(
            [sys.executable, "-c", code, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE
        ) as process:
            process.stdout.close()
            error = process.stderr.read().decode()
        assert process.returncode == 0
        assert "Traceback" not in error
        assert "BrokenPipe" not in error
    # Nobody reads what is said; what is to be written is written.
    assert all(file.stat().st_size > 1000 for file in written)


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_interrupted(case: Path) -> None:
    text = case.read_text(encoding="utf-8").replace("# duration = 8", "duration = 1e4")
    case.write_text(text, encoding="utf-8")
    code = "import sys; from runway_modal.cli import main; print(0, flush=True); sys.exit(main())"
    with subprocess.Popen(
        [sys.executable, "-c", code, "run", str(case), "--csv", str(case.with_suffix(".csv"))],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:
        process.stdout.read(1)
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(0.5)
        process.send_signal(signal.SIGINT)
        error = process.stderr.read().decode()
    assert process.returncode == 130
    assert error == ""


def test_letters_that_a_terminal_lacks(case: Path) -> None:
    text = case.read_text(encoding="utf-8").replace('"F-4E', '"Ü滑 F-4E')
    case.write_text(text, encoding="utf-8")
    code = "import sys; from runway_modal.cli import main; sys.exit(main(sys.argv[1:]))"
    for options, said in (((), b"\\u6ed1 F-4E"), (("--csv", "-"), "[in/s²]".encode())):
        done = subprocess.run(
            [sys.executable, "-c", code, "run", str(case), *options],
            env={"PYTHONIOENCODING": "ascii"},
            capture_output=True,
            check=True,
        )
        assert said in done.stdout
