"""``runway-modal sweep`` as its users run it."""

import dataclasses
import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import runway_modal as rm
from runway_modal.case import read_case
from runway_modal.cli import main
from runway_modal.plotting_sweep import loads_and_accelerations

CASE = """
title = "F-4E"
[units]
length = "in"
force = "lbf"
[aircraft]
preset = "f4e"
damping_ratio = 0.01
[[track]]
shape = "full_mat"
[sweep]
from = "20 kt"
to = "60 kt"
step = "2.5 kt"
tolerance = "1 kip"
[run]
speeds = ["20 kt"]
"""


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "case.toml"
    path.write_text(CASE, encoding="utf-8")
    return path


def numbers(printed: str, head: str) -> list[list[float]]:
    """Numbers of the three gears below a heading."""
    lines = printed.splitlines()
    (at,) = (i for i, line in enumerate(lines) if re.match(head, line))
    return [
        [float(text) for text in re.findall(r"-?\d[\d.]*", line)] for line in lines[at + 1 :][:3]
    ]


def test_prints_what_the_library_says(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", str(case)]) == 0
    printed = capsys.readouterr().out
    assert "\n17 speeds from 20 to 60 kt\n" in printed
    modes, mat = rm.f4e().modes(0.01), rm.Profile.full_mat()
    knots = np.arange(20.0, 60.1, 2.5)
    found = rm.sweep(modes, mat, rm.knots(knots))
    for g, row in enumerate(numbers(printed, "  gear +static")):
        high, low = found.max_load[:, g].argmax(), found.min_load[:, g].argmin()
        expected = [
            (found.static_load[g], 1), (found.max_load[high, g], 1),
            (found.max_load[high, g] / found.static_load[g], 3), (knots[high], 4),
            (found.position_of_max[high, g], 2), (found.min_load[low, g], 1),
            (knots[low], 4), (found.position_of_min[low, g], 2),
        ]  # fmt: skip
        assert row == [float(f"{value:.{digits}f}") for value, digits in expected]
    shares = found.max_acceleration["cg"] / rm.f4e().gravity
    above = knots[shares > 0.4][0]
    (station,) = (line.split() for line in printed.splitlines() if line.startswith("  cg "))
    over = found.position_of_max_acceleration["cg"][shares.argmax()]
    told = [shares.max(), knots[shares.argmax()], round(over, 2), above]
    assert [float(text) for text in station[1:]] == pytest.approx(told, abs=1e-4)
    lost = knots[found.unloaded[:, 1]]
    assert f"left (at {lost.size} speeds, from {lost[0]:g} kt)" in printed
    limits = rm.knots(20), rm.knots(60)
    for gear, row in zip(
        modes.aircraft.gear_names,
        numbers(printed, r"  gear +largest \[lbf\] +at \[kt\] +none"),
        strict=True,
    ):
        for quantity, told, beyond in (("max_load", row[:4], 1), ("min_load", row[4:], -1)):
            worst = rm.worst_speed(modes, mat, limits, quantity, at=gear, tolerance=1000.0)
            expected = [worst.value, worst.speed / rm.knots(1), worst.bound, worst.runs]
            assert told == pytest.approx(expected, abs=0.1)
            # What is printed is proven: rounded outwards.
            assert 0.0 <= beyond * (told[2] - worst.bound) < 0.1


def test_a_sweep_needs_no_other_speeds(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case.write_text(CASE[: CASE.index("[run]")], "utf-8")
    assert main(["sweep", str(case)]) == 0
    assert "17 speeds" in capsys.readouterr().out
    assert main(["run", str(case)]) == 2
    assert "run is missing" in capsys.readouterr().err


def test_without_a_tolerance_nothing_is_proven(
    case: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case.write_text(CASE.replace('tolerance = "1 kip"', ""), "utf-8")
    assert main(["sweep", str(case)]) == 0
    assert "proven" not in capsys.readouterr().out


def test_g_is_that_of_the_limit_in_tables_and_figures(
    case: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """On the Moon, too, 0.4 g are 0.4 times standard gravity."""
    moon = CASE.replace(
        'preset = "f4e"',
        'mass = 145.5\npitch_inertia = 1.92e6\nroll_inertia = 6.56e5\ngravity = "0.165 g"',
    )
    gears = "".join(
        f'[[aircraft.gears]]\nname = "{g.name}"\nx = {g.x}\ny = {g.y}\nstiffness = {g.stiffness}\n'
        for g in rm.f4e().gears
    )
    case.write_text(moon.replace("[[track]]", gears + "[[track]]"), "utf-8")
    assert main(["sweep", str(case)]) == 0
    (line,) = (each for each in capsys.readouterr().out.splitlines() if each.startswith("  cg "))
    read = read_case(case)
    found = rm.sweep(read.modes, read.tracks, read.speed_range().speeds())
    figure = loads_and_accelerations(found, units=read.units)
    curve = figure.axes[1].get_lines()[0].get_ydata()
    assert float(line.split()[1]) == pytest.approx(curve.max(), abs=1e-4)
    assert curve.max() == found.max_acceleration["cg"].max() / read.units.standard_gravity


def test_keys_that_are_not_used_are_said(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", str(case)]) == 0
    assert "Not used" not in capsys.readouterr().out
    more = 'duration = 1\n[output]\ncsv = "a.csv"\n[roughness]\niso8608 = "A"\n[monte_carlo]\n'
    runs = 'length = "200 ft"\nspacing = "1 ft"\nruns = 3\nseed = 1\n'
    case.write_text(CASE + more + runs, "utf-8")
    for command, said in (
        (["sweep"], "`runway-modal sweep`: duration, [output]"),
        (["mc"], "`runway-modal mc`: [[track]], duration, [output]"),
        (["run", "--runway", "2"], "`runway-modal run --runway`: [[track]], duration, [output]"),
    ):
        assert main([command[0], str(case), *command[1:]]) == 0
        assert f"Not used by {said}\n" in capsys.readouterr().out
    assert not case.with_name("a.csv").exists()


def test_a_tolerance_that_is_not_reached(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case.write_text(CASE.replace('"1 kip"', "1e-8"), "utf-8")
    files = ["--csv", str(case.with_name("a.csv")), "--json", str(case.with_name("a.json"))]
    assert main(["sweep", str(case), *files]) == 2
    captured = capsys.readouterr()
    assert "case.toml:15: sweep: tolerance = 1e-8 takes more runs than" in captured.err
    assert captured.err.endswith("(nose: largest load)\n")
    # All that could be found is there.
    assert "17 speeds" in captured.out
    assert len(pd.read_csv(case.with_name("a.csv"))) == 17
    document = json.loads(case.with_name("a.json").read_text("utf-8"))
    assert len(document["speed"]) == 17
    assert document["proven"] == {}


def test_files_hold_every_speed(case: Path) -> None:
    paths = {kind: case.with_suffix(f".{kind}") for kind in ("csv", "parquet")}
    figure = case.with_suffix(".png")
    options = [text for kind, path in paths.items() for text in (f"--{kind}", str(path))]
    assert main(["sweep", str(case), *options, "--figure", str(figure)]) == 0
    frame, table = pd.read_parquet(paths["parquet"]), pd.read_csv(paths["csv"])
    np.testing.assert_allclose(frame["speed"] / rm.knots(1), np.arange(20.0, 60.1, 2.5))
    assert frame.attrs["units"]["position_of_max_left"] == "in"
    # Older pandas read the last digit by a faster way.
    left = table["max_load_left [lbf]"], frame["max_load_left"]
    np.testing.assert_allclose(*left, rtol=5e-16)
    assert figure.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("tolerance", [True, False])
def test_results_for_other_programs(
    case: Path, capsys: pytest.CaptureFixture[str], tolerance: bool
) -> None:
    if not tolerance:
        case.write_text(CASE.replace('tolerance = "1 kip"', ""), "utf-8")
    assert main(["sweep", str(case), "--json", "-"]) == 0
    captured = capsys.readouterr()
    assert "17 speeds" in captured.err
    document = json.loads(captured.out)
    assert document["inferred"] == ["track[0]: ramps of 12 in"]
    modes, mat = rm.f4e().modes(0.01), rm.Profile.full_mat()
    found = rm.sweep(modes, mat, document["speed"])
    assert len(document["speed"]) == 17
    for g, gear in enumerate(found.gear_names):
        assert document["static_load"][gear] == found.static_load[g]
        for quantity in ("max_load", "time_of_min", "position_of_max", "unloaded"):
            assert document[quantity][gear] == getattr(found, quantity)[:, g].tolist()
    assert document["max_acceleration"]["cg"] == found.max_acceleration["cg"].tolist()
    if not tolerance:
        assert document["proven"] == {}
        return
    limits = rm.knots(20), rm.knots(60)
    worst = rm.worst_speed(modes, mat, limits, "min_load", at="left", tolerance=1000.0)
    assert document["proven"]["min_load"]["left"] == pytest.approx(dataclasses.asdict(worst))
    assert set(document["proven"]) == {"max_load", "min_load"}
    assert set(document["proven"]["max_load"]) == set(found.gear_names)
    assert (document["tolerance"], document["acceleration_tolerance"]) == (1000.0, None)


def test_accelerations_are_proven_too(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = CASE.replace('tolerance = "1 kip"', 'acceleration_tolerance = "0.05 g"')
    stations = "damping_ratio = 0.01\n[aircraft.stations]\npilot = [200, 0]"
    case.write_text(text.replace("damping_ratio = 0.01", stations), "utf-8")
    to = case.with_suffix(".json")
    assert main(["sweep", str(case), "--json", str(to)]) == 0
    printed = capsys.readouterr().out
    assert "Largest and smallest load at any speed" not in printed
    aircraft = dataclasses.replace(rm.f4e(), stations={"pilot": (200.0, 0.0)})
    modes, mat, g = aircraft.modes(0.01), rm.Profile.full_mat(), 386.0885827
    limits = rm.knots(20), rm.knots(60)
    proven = json.loads(to.read_text("utf-8"))["proven"]["max_acceleration"]
    rows = printed.split("Largest vertical acceleration at any speed of the range, proven")[1]
    for at in ("cg", "pilot"):
        worst = rm.worst_speed(modes, mat, limits, "max_acceleration", at=at, tolerance=0.05 * g)
        assert proven[at] == pytest.approx(dataclasses.asdict(worst))
        (row,) = re.findall(rf"\n  {at} +(.+)", rows)
        value, knots, bound, runs = (float(text) for text in row.split())
        assert value == pytest.approx(worst.value / g, abs=5.1e-5)
        assert 0.0 <= bound - worst.bound / g < 1.01e-4
        assert (knots, runs) == (pytest.approx(worst.speed / rm.knots(1), abs=5e-5), worst.runs)


def test_standard_output_is_the_table_alone(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", str(case), "--csv", "-"]) == 0
    captured = capsys.readouterr()
    assert captured.out.startswith("speed [in/s],max_load_nose [lbf],")
    assert len(captured.out.splitlines()) == 1 + 17
    assert "17 speeds" in captured.err


@pytest.mark.parametrize(
    ("high", "step", "expected"),
    [
        ("21 kt", "0.1 kt", np.linspace(20.0, 21.0, 11)),
        ("20.25 kt", "0.1 kt", [20.0, 20.1, 20.2, 20.25]),
        ("20 kt", "0.1 kt", [20.0]),
    ],
)
def test_both_ends_are_among_the_speeds(
    case: Path, high: str, step: str, expected: list[float]
) -> None:
    case.write_text(CASE.replace("60 kt", high).replace("2.5 kt", step), "utf-8")
    span = read_case(case).speed_range()
    speeds = span.speeds()
    np.testing.assert_allclose(speeds, rm.knots(np.array(expected)), rtol=1e-12)
    assert (speeds[0], speeds[-1]) == (span.low, span.high)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('from = "20 kt"\n', "", "case.toml:11: sweep: from is missing"),
        ('"20 kt"\nto', '"0 kt"\nto', "case.toml:12: sweep: from = '0 kt' is not positive"),
        ('"60 kt"', '"10 kt"', "case.toml:13: sweep: to = '10 kt' is less than from = '20 kt'"),
        ('"2.5 kt"', '"1e-9 kt"', "step = '1e-9 kt' makes more than 1,000,000 speeds"),
        ('"2.5 kt"', '"2.5 in"', "case.toml:14: sweep: step"),
        ('"1 kip"', '"-1 kip"', "case.toml:15: sweep: tolerance"),
        ("step =", "steps =", "case.toml:14: sweep: unknown key 'steps'; did you mean 'step'?"),
        (
            "damping_ratio = 0.01",
            "damping_ratio = 0.01\nnonlinear = true",
            "a sweep needs the linear model",
        ),
        ('[[track]]\nshape = "full_mat"\n', "", "[[track]] is missing"),
        (CASE[CASE.index("[sweep]") : CASE.index("[run]")], "", "[sweep] is missing"),
    ],
)
def test_faults_name_their_place(
    case: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, said: str
) -> None:
    assert CASE.count(old) == 1
    case.write_text(CASE.replace(old, new), "utf-8")
    assert main(["sweep", str(case)]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--figure", "a.xyz"], "figure a.xyz: the suffix is none of"),
        (["--parquet", "a.json"], "parquet a.json: what is written is parquet, not json"),
        (["--csv", "none/a.csv"], "csv none/a.csv: no such directory"),
        (["--csv", "."], "csv .: that is a directory"),
        (["--csv", "case.toml"], "csv case.toml: that is the case file"),
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
    assert main(["sweep", "case.toml", *options]) == 2
    captured = capsys.readouterr()
    assert said in captured.err
    assert captured.out == ""
