"""``runway-modal mc`` as its users run it."""

import csv
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import runway_modal as rm
from runway_modal import stored
from runway_modal.case import read_case
from runway_modal.cli import main

CODE = "import sys; from runway_modal.cli import main; sys.exit(main(sys.argv[1:]))"

CASE = """
title = "F-4E"
[units]
length = "in"
force = "lbf"
[aircraft]
preset = "f4e"
damping_ratio = 0.01
[aircraft.stations]
pilot = [200, 0]
[roughness]
iso8608 = "B"
[monte_carlo]
length = "200 m"
spacing = "25 cm"
runs = 600
seed = 1980
tracks = "isotropic"
[monte_carlo.levels]
max_load = ["35 kip", 30000]
max_acceleration = ["0.4 g"]
min_load = ["2 kip"]
[run]
speeds = ["60 kt"]
"""


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "case.toml"
    path.write_text(CASE, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def ensemble() -> rm.Ensemble:
    """The case's runs, asked of the library."""
    bare = rm.f4e()
    aircraft = rm.Aircraft(
        mass=bare.mass,
        pitch_inertia=bare.pitch_inertia,
        roll_inertia=bare.roll_inertia,
        gears=bare.gears,
        stations={"pilot": (200.0, 0.0)},
    )
    return rm.monte_carlo(
        aircraft.modes(0.01),
        rm.Roughness.iso8608("B", "in"),
        length=200 / 0.0254,
        spacing=0.25 / 0.0254,
        speed=rm.knots(60),
        runs=600,
        seed=1980,
        tracks="isotropic",
    )


def numbers(line: str) -> list[float]:
    return [float(text) for text in re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?(?![\w.])", line)]


def block(lines: list[str], head: str) -> dict[str, list[float]]:
    """Numbers of a table by the first word of their lines, its intervals by `gear from`."""
    (at,) = (i for i, line in enumerate(lines) if line.startswith(f"  {head}"))
    found: dict[str, list[float]] = {}
    for line in lines[at + 2 :]:
        if not line or "too few" in line:
            break
        word = line.split()[0]
        name = word if word not in ("from", "to") else f"{name.split()[0]} {word}"  # noqa: F821
        found[name] = numbers(line[10:])
    return found


def test_prints_what_the_library_says(
    case: Path, ensemble: rm.Ensemble, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["mc", str(case)]) == 0
    captured = capsys.readouterr()
    # No terminal, no bar.
    assert captured.err == ""
    lines = captured.out.splitlines()
    assert lines[0] == "F-4E: random runways, ISO 8608 class B"
    assert "Speed 60 kt = 1215.22 in/s: 600 runs, 0 to 599" in lines

    loads = block(lines, "Largest load [lbf]")
    mean, quantile = ensemble.mean("max_load"), ensemble.quantile("max_load", [0.5, 0.95, 0.99])
    for g, gear in enumerate(ensemble.gear_names):
        worst = int(ensemble.max_load[:, g].argmax())
        for line, part in ((gear, "value"), (f"{gear} from", "low"), (f"{gear} to", "high")):
            expected = [getattr(mean, part)[0, g], *getattr(quantile, part)[:, g]]
            np.testing.assert_allclose(loads[line][:4], expected, atol=0.0501)
        assert loads[gear][4:] == [pytest.approx(ensemble.max_load[worst, g], abs=0.0501), worst]
    assert "  99.9 %: too few runs for an interval" in lines

    smallest = block(lines, "Smallest load [lbf]")
    quantile = ensemble.quantile("min_load", [0.5, 0.05, 0.01])
    np.testing.assert_allclose(smallest["left"][1:4], quantile.value[:, 1], atol=0.0501)
    assert smallest["left"][5] == ensemble.min_load[:, 1].argmin()

    largest = block(lines, "Largest |vertical acceleration| [g]")
    share = ensemble.max_acceleration["pilot"] / 386.088583
    assert largest["pilot"][0] == pytest.approx(share.mean(), abs=5.1e-5)
    assert largest["pilot"][-1] == share.argmax()


def test_shares_and_worst_runs(
    case: Path, ensemble: rm.Ensemble, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["mc", str(case)]) == 0
    lines = capsys.readouterr().out.splitlines()
    rows = {line.rsplit(None, 3)[0].strip(): line.rsplit(None, 3)[1:] for line in lines if line}

    def said(row: str) -> list[float]:
        return [float(text) for text in rows[row]]

    above = ensemble.exceedance("max_load", 35_000.0)
    assert 0.01 < above.value[0, 1] < 0.99
    expected = [100 * part[0, 1] for part in (above.value, above.low, above.high)]
    assert said("left: largest load above 35 kip") == pytest.approx(expected, abs=5.1e-5)
    share = 100 * (ensemble.max_load[:, 2] > 30_000.0).mean()
    assert said("right: largest load above 30000 lbf")[0] == pytest.approx(share, abs=5.1e-5)
    for level, row in (
        (0.0, "left: smallest load at or below 0 (unloads)"),
        (2000.0, "left: smallest load at or below 2 kip"),
    ):
        below = 100 * (ensemble.min_load[:, 1] <= level).mean()
        value, low, high = said(row)
        assert value == pytest.approx(below, abs=5.1e-5)
        assert low < value < high
    share = 100 * (ensemble.max_acceleration["cg"] > 0.4 * 386.088583).mean()
    value = said("cg: largest |vertical acceleration| above 0.4 g")[0]
    assert value == pytest.approx(share, abs=5.1e-5)
    zero = "load reaches zero on left, right"
    assert f"  WARNING: {zero}; the linear model does not hold beyond that" in lines
    (line,) = (line for line in lines if re.match(r"  left +\d+, ", line))
    assert numbers(line.replace(",", " ")) == ensemble.worst("left", 5).tolist()


def test_any_run_can_be_shown_in_full(
    case: Path, ensemble: rm.Ensemble, capsys: pytest.CaptureFixture[str]
) -> None:
    """By the command that the summary ends with."""
    assert main(["mc", str(case)]) == 0
    command = capsys.readouterr().out.splitlines()[-1].partition("runway-modal ")[2].split()
    run = int(command[-1])
    assert run == ensemble.worst("nose", 1)[0]
    table = case.with_name("run.csv")
    assert main([*command, "--csv", str(table)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"F-4E: random runway {run}"
    for g, gear in enumerate(ensemble.gear_names):
        (line,) = (line for line in lines if line.startswith(f"  {gear} "))
        _, largest, _, _, _, smallest, *_ = numbers(line)
        assert largest == pytest.approx(ensemble.max_load[run, g], abs=0.0501)
        assert smallest == pytest.approx(ensemble.min_load[run, g], abs=0.0501)
    # To all digits, by what the command is made of.
    (response,) = read_case(case).over_random_runway(run).run().values()
    extremes = response.extremes()
    np.testing.assert_allclose(extremes.max_load, ensemble.max_load[run], rtol=1e-10)
    np.testing.assert_allclose(extremes.min_load, ensemble.min_load[run], rtol=1e-10, atol=1e-6)
    at_pilot = ensemble.max_acceleration["pilot"][run]
    assert extremes.max_acceleration["pilot"] == pytest.approx(at_pilot, rel=1e-10)
    # As long as the last gear is on the runway, and it is: 200 m are 787.4 stations.
    end = (801 - 1) * 0.25 / 0.0254 + 234.9 + 44.35
    assert pd.read_csv(table)["distance [in]"].iloc[-1] == pytest.approx(end, rel=1e-12)


def test_a_random_runway_leaves_the_files_of_the_tracks_alone(case: Path, capsys) -> None:
    case.write_text(CASE + '[output]\ncsv = "loads.csv"\n', "utf-8")
    assert main(["run", str(case), "--runway", "3"]) == 0
    assert not case.with_name("loads.csv").exists()
    assert main(["run", str(case), "--runway", "-3"]) == 2
    assert "--runway = -3 must be at least 0" in capsys.readouterr().err


def test_tables_hold_every_run(case: Path, ensemble: rm.Ensemble, capsys) -> None:
    figure, parquet = case.with_name("a.png"), case.with_name("a.parquet")
    text = case.read_text("utf-8").replace('["60 kt"]', '["60 kt", "10 m/s"]')
    case.write_text(text, "utf-8")
    assert main(["mc", str(case), "--csv", "-", "--parquet", str(parquet)]) == 0
    captured = capsys.readouterr()
    rows = list(csv.reader(captured.out.splitlines()))
    assert len(rows) == 1 + 2 * 600
    assert rows[0][:3] == ["run", "speed [in/s]", "static_load_nose [lbf]"]
    assert rows[0][5] == "max_load_nose [lbf]"
    found = np.array([row[5:8] for row in rows[1:601]], float)
    # 60 kt and 200 m have been converted by other roundings.
    np.testing.assert_allclose(found, ensemble.max_load, rtol=1e-12)
    assert "Speed 10 m/s = 393.701 in/s: 600 runs" in captured.err
    frame = pd.read_parquet(parquet)
    np.testing.assert_array_equal(frame["max_load_left"][:600], found[:, 1])
    np.testing.assert_allclose(frame["rms_load_left"][:600], ensemble.rms_load[:, 1], rtol=1e-12)
    assert frame.attrs["units"]["rms_load_left"] == "lbf"
    assert main(["mc", str(case), "--runs", "50", "--figure", str(figure)]) == 0
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert f"figure: {figure}" in capsys.readouterr().out


def test_statistics_for_other_programs(
    case: Path, ensemble: rm.Ensemble, capsys: pytest.CaptureFixture[str]
) -> None:
    tracks = '[[track]]\nshape = "full_mat"\n[run]'
    case.write_text(CASE.replace("[run]", tracks), "utf-8")
    assert main(["mc", str(case), "--json", "-"]) == 0
    captured = capsys.readouterr()
    assert "Speed 60 kt" in captured.err
    document = json.loads(captured.out)
    assert document["title"] == "F-4E: random runways, ISO 8608 class B"
    assert document["units"] == {"length": "in", "force": "lbf", "time": "s"}
    # The ramps of the mat are, but no run rolls over it.
    assert document["inferred"] == []
    assert document["runways"]["seed"] == 1980
    assert document["runways"]["tracks"] == "isotropic"
    (found,) = document["speeds"]
    assert (found["stated_speed"], found["runs"], found["first_run"]) == ("60 kt", 600, 0)
    assert found["static_load"]["left"] == pytest.approx(ensemble.static_load[0, 1])

    def estimate(of: dict[str, float]) -> list[float]:
        return [of["value"], of["low"], of["high"]]

    def row(of: rm.Estimate, i: int, at: int) -> list[float]:
        return [part[i, at] for part in (of.value, of.low, of.high)]

    left = found["min_load"]["left"]
    mean = ensemble.mean("min_load")
    assert estimate(left["mean"]) == pytest.approx(row(mean, 0, 1))
    probabilities = [quantile["probability"] for quantile in left["quantiles"]]
    assert probabilities == pytest.approx([0.5, 0.05, 0.01, 0.001])
    quantiles = ensemble.quantile("min_load", probabilities)
    for i, quantile in enumerate(left["quantiles"][:3]):
        assert estimate(quantile) == pytest.approx(row(quantiles, i, 1))
    # Of 600 runs none bounds the 0.1 % quantile from below.
    assert left["quantiles"][3]["low"] is None
    assert left["quantiles"][3]["high"] == pytest.approx(quantiles.high[3, 1])
    worst = int(ensemble.min_load[:, 1].argmin())
    assert left["worst"] == {"value": pytest.approx(ensemble.min_load[worst, 1]), "run": worst}
    pilot = found["max_acceleration"]["pilot"]["worst"]
    assert pilot["value"] == pytest.approx(ensemble.max_acceleration["pilot"].max())

    shares = {(one["quantity"], one["at"], one["stated_level"]): one for one in found["exceedance"]}
    assert len(shares) == 3 + 3 + 2 * 3 + 2
    above = ensemble.exceedance("max_load", 35_000.0)
    left = shares["max_load", "left", "35 kip"]
    assert (left["side"], left["level"]) == ("above", pytest.approx(35_000.0))
    assert estimate(left) == pytest.approx(row(above, 0, 1))
    assert shares["min_load", "nose", "0 (unloads)"]["side"] == "at or below"
    assert found["worst_runs"]["right"] == ensemble.worst("right", 5).tolist()


def test_one_run_has_no_intervals(case: Path) -> None:
    to = case.with_suffix(".json")
    assert main(["mc", str(case), "--runs", "1", "--json", str(to)]) == 0
    (found,) = json.loads(to.read_text("utf-8"))["speeds"]
    mean = found["max_load"]["left"]["mean"]
    assert mean == {"value": found["max_load"]["left"]["worst"]["value"], "low": None, "high": None}


def test_a_killed_run_goes_on(case: Path) -> None:
    out = case.with_name("out")
    text = case.read_text("utf-8").replace('["60 kt"]', '["10 m/s", "60 kt"]')
    case.write_text(text.replace("runs = 600", "runs = 12_000"), "utf-8")
    command = [sys.executable, "-c", CODE, "mc", str(case), "--out", str(out)]
    first = out / "10 m_s"
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        while len(list(first.glob("runs-*.parquet"))) < 1:
            assert process.poll() is None
            time.sleep(0.001)
        process.kill()
    assert process.returncode == -signal.SIGKILL
    kept = {file: file.stat().st_mtime_ns for file in first.glob("runs-*.parquet")}
    assert 1 <= len(kept) < 3
    assert not (out / "60 kt").exists()
    done = subprocess.run(command, capture_output=True, check=True, text=True)
    assert f"runs kept in: {out}" in done.stdout
    # What was there is still what it was.
    assert all(file.stat().st_mtime_ns == then for file, then in kept.items())
    read = read_case(case)
    random = read.random_runways()
    for folder, speed in ((first, "10 m/s"), (out / "60 kt", "60 kt")):
        options = random.options(read.speeds[speed], damping_input=False)
        whole = rm.monte_carlo(read.modes, random.roughness, **options)
        np.testing.assert_array_equal(stored.read(folder).max_load, whole.max_load)
        np.testing.assert_array_equal(stored.read(folder).rms_load, whole.rms_load)


def test_more_runs_are_added_and_another_case_is_refused(
    case: Path, ensemble: rm.Ensemble, capsys: pytest.CaptureFixture[str]
) -> None:
    out = case.with_name("out")
    assert main(["mc", str(case), "--out", str(out), "--runs", "100"]) == 0
    assert "100 runs, 0 to 99" in capsys.readouterr().out
    assert main(["mc", str(case), "--out", str(out)]) == 0
    assert "600 runs, 0 to 599" in capsys.readouterr().out
    np.testing.assert_allclose(stored.read(out / "60 kt").max_load, ensemble.max_load, rtol=1e-12)
    # What is kept already is more than what is asked for.
    assert main(["mc", str(case), "--out", str(out), "--runs", "70"]) == 0
    assert "70 runs, 0 to 69" in capsys.readouterr().out
    case.write_text(CASE.replace("seed = 1980", "seed = 1981"), "utf-8")
    assert main(["mc", str(case), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert "seed = 1980 there, 1981 here" in said
    # Nor does the name of a directory pass for a key.
    (out / "60 kt").rename(out.with_name("seed"))
    line = 1 + CASE.splitlines().index("[monte_carlo]")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(case.parent)
        out.rmdir()
        case.with_name("runs").mkdir()
        out.with_name("seed").rename(case.parent / "runs" / "60 kt")
        assert main(["mc", case.name, "--out", "runs"]) == 2
    assert f"{case.name}:{line}: monte_carlo: runs/60 kt/_setup.json" in capsys.readouterr().err


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("keep", [True, False])
def test_interrupted(case: Path, keep: bool) -> None:
    out = case.with_name("out")
    case.write_text(CASE.replace("runs = 600", "runs = 4_000_000"), "utf-8")
    options = ["--out", str(out)] if keep else []
    code = CODE.replace("main;", "main; print(0, flush=True);")
    with subprocess.Popen(
        [sys.executable, "-c", code, "mc", str(case), *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as process:
        process.stdout.read(1)
        if keep:
            while len(list(out.glob("60 kt/runs-*.parquet"))) < 2:
                assert process.poll() is None
                time.sleep(0.01)
        else:
            time.sleep(1.0)
        process.send_signal(signal.SIGINT)
        asked = time.monotonic()
        error = process.stderr.read().decode()
    # Within a second, but this machine may be busy.
    assert time.monotonic() - asked < 5.0
    assert process.returncode == 130
    if not keep:
        said = "runway-modal: interrupted: no runs are kept; --out DIR keeps finished ones\n"
        assert error == said
        return
    said = re.search(r"interrupted: (\d+) of 4000000 runs are kept in (.*); the same", error)
    assert said[2] == str(out)
    # It may come between a file's last byte and its being counted.
    assert len(stored.read(out / "60 kt")) - int(said[1]) in (0, 4096)


def on_a_terminal(command: list[str], **options) -> str:
    """What a program writes to standard error if that is a terminal."""
    import pty
    import termios

    here, there = pty.openpty()
    termios.tcsetwinsize(there, (24, 80))
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=there, **options) as process:
        os.close(there)
        written = b""
        while True:
            try:
                some = os.read(here, 4096)
            except OSError:  # the other end is closed
                break
            if not some:
                break
            written += some
    os.close(here)
    assert process.returncode == 0
    return written.decode()


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo terminals")
def test_progress_is_shown_on_a_terminal_alone(case: Path) -> None:
    command = [sys.executable, "-c", CODE, "mc", str(case), "--runs", "9000"]
    shown = on_a_terminal(command)
    assert "0.00/9.00k" in shown
    # It leaves no trace above the summary.
    assert shown.endswith(" \r")
    assert on_a_terminal([*command, "--quiet"]) == ""
    without = CODE.replace("import sys;", "import sys; sys.modules['tqdm'] = None;")
    hint = on_a_terminal([sys.executable, "-c", without, *command[3:]])
    assert hint == "no progress bar: pip install 'runway_modal[cli]'\r\n"


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--figure", "-"], "--figure -: only csv or json can go to standard output"),
        (["--figure", "a.xyz"], "figure a.xyz: the suffix is none of"),
        (["--csv", "./case.toml"], "csv ./case.toml: that is the case file"),
        (["--csv", "none/a.csv"], "csv none/a.csv: no such directory"),
        (["--runs", "0"], "--runs = 0 must be at least 1"),
        (["--out", "case.toml"], "case.toml"),
    ],
)
def test_refused(
    case: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    options: list[str],
    said: str,
) -> None:
    monkeypatch.chdir(case.parent)
    assert main(["mc", "case.toml", *options]) == 2
    assert said in capsys.readouterr().err
    assert case.read_text("utf-8") == CASE


@pytest.mark.parametrize("module", ["pandas", "pyarrow", "matplotlib"])
def test_missing_extras_are_said_before_the_computing(
    case: Path, monkeypatch: pytest.MonkeyPatch, capsys, module: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.setattr("runway_modal.cli.monte_carlo.monte_carlo", None)
    wanted = ["--figure", "a.png"] if module == "matplotlib" else ["--parquet", "a.parquet"]
    assert main(["mc", str(case), *wanted]) == 1
    assert "pip install" in capsys.readouterr().err
