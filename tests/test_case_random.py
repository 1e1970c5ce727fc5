"""Random runways of case files: any units say the same, and faults are named with their place."""

import re
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

import runway_modal as rm
from runway_modal.case import Case, read_case
from runway_modal.cli import main
from runway_modal.units import Units

UNITS = '[units]\nlength = "{}"\nforce = "N"\n'
F4E = '[aircraft]\npreset = "f4e"\ndamping_ratio = 0.01\n'
RUN = '[run]\nspeeds = ["20 kt"]\n'
CLASS_A = '[roughness]\niso8608 = "A"\n'
POWER = (
    '[roughness]\ncoefficient = "16e-6 m3"\nreference = "0.1 cycles/m"\n'
    'band = ["0.005 cycles/m", "0.5 cycles/m"]\n'
)
POINTS = (
    '[roughness]\nn = ["0.005 cycles/m", "0.05 cycle/m", "0.5 cycles/m"]\n'
    'psd = ["6.4e-3 m3", "6.4e-5 m3", "0.64 mm*mm*m"]\n'
)
RUNS = '[monte_carlo]\nlength = "100 m"\nspacing = "50 cm"\nruns = 10\nseed = 1\n'


def read(folder: Path, text: str) -> Case:
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return read_case(path)


@pytest.mark.parametrize("length", ["m", "in", "ft", "mm"])
@pytest.mark.parametrize("roughness", [CLASS_A, POWER, POINTS], ids=["class", "law", "points"])
def test_any_units_and_forms_give_the_same_loads(
    tmp_path: Path, length: str, roughness: str
) -> None:
    case = read(tmp_path, UNITS.format(length) + F4E + roughness + RUNS + RUN)
    random = case.random_runways()
    metres = Units("m", "N").factor(Units(length, "N"), (1, 0, 0))
    n = np.array([0.01, 0.1, 0.3])
    expected = 16e-6 * (n / 0.1) ** -2
    np.testing.assert_allclose(random.roughness.psd(n / metres), expected * metres**3, rtol=1e-12)
    (speed,) = case.speeds.values()
    found = rm.monte_carlo(
        case.modes, random.roughness, **random.options(speed, damping_input=False)
    )
    in_inches = rm.monte_carlo(
        rm.f4e().modes(0.01),
        rm.Roughness.iso8608("A", "in"),
        length=100 / 0.0254,
        spacing=0.5 / 0.0254,
        speed=rm.knots(20),
        runs=10,
        seed=1,
    )
    # Waves between the band's ends are cut up at other roundings, not at other places.
    np.testing.assert_allclose(found.max_load / 4.4482216152605, in_inches.max_load, rtol=1e-7)


def test_numbers_alone_are_in_cycles_per_unit_of_length(tmp_path: Path) -> None:
    text = (
        "[roughness]\ncoefficient = 16e-6\nwaviness = 2.5\nreference = 0.1\nband = [0.005, 0.5]\n"
    )
    random = read(tmp_path, UNITS.format("m") + F4E + text + RUNS + RUN).random_runways()
    assert random.roughness.psd(0.2) == pytest.approx(16e-6 * 2**-2.5, rel=1e-12)
    assert random.spectrum == "power law of waviness 2.5"


def test_levels_by_the_text_that_names_them(tmp_path: Path) -> None:
    levels = '[monte_carlo.levels]\nmax_load = [200e3, "40 kip"]\nrms_acceleration = ["0.1 g"]\n'
    random = read(tmp_path, UNITS.format("m") + F4E + CLASS_A + RUNS + levels + RUN).random
    assert random.levels == {
        "max_load": {"200000.0 N": 200e3, "40 kip": pytest.approx(177928.8646)},
        "rms_acceleration": {"0.1 g": pytest.approx(0.980665)},
    }


def test_tracks_and_random_runways_in_one_file_or_alone(tmp_path: Path) -> None:
    head = UNITS.format("in") + F4E
    track = '[[track]]\nshape = "full_mat"\n'
    both = read(tmp_path, head + track + CLASS_A + RUNS + RUN)
    assert both.run()["20 kt"].extremes().max_load[1] / 4.4482216152605 == pytest.approx(
        43685.9, abs=0.05
    )
    assert both.notes == ("track[0]: ramps of 12 in",)
    replay = both.over_random_runway(3)
    assert replay.notes == ()
    assert replay.tracks["nose"] == replay.tracks["left"]
    alone = read(tmp_path, head + track + RUN)
    with pytest.raises(rm.InputError, match=r"case\.toml: \[monte_carlo\] is missing"):
        alone.over_random_runway(3)
    random = read(tmp_path, head + CLASS_A + RUNS + RUN)
    with pytest.raises(rm.InputError, match=r"case\.toml: \[\[track\]\] is missing"):
        random.run()


def test_a_nonlinear_aircraft_runs_over_one_but_not_over_all(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = UNITS.format("in") + F4E + "nonlinear = true\n" + CLASS_A + RUNS + RUN
    case = read(tmp_path, text)
    replay = case.over_random_runway(3)
    assert replay.notes == case.aircraft_notes != ()
    (response,) = replay.run().values()
    assert response.stiffness.shape[1] == 3
    assert main(["mc", str(tmp_path / "case.toml")]) == 2
    said = "case.toml:7: aircraft: nonlinear: a Monte Carlo needs the linear model"
    assert said in capsys.readouterr().err


def test_every_key_is_in_the_example() -> None:
    example = (files("runway_modal.case") / "example.toml").read_text(encoding="utf-8")
    for key in ("iso8608", "band", "coefficient", "waviness", "reference", "n", "psd"):
        assert f"{key} = " in example
    for key in ("length", "spacing", "runs", "seed", "first_run", "tracks"):
        assert f"{key} = " in example.partition("[monte_carlo]")[2]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (CLASS_A.replace("A", "I") + RUNS, "8: roughness: iso8608 = 'I' is unknown"),
        (CLASS_A + "waviness = 2\n" + RUNS, "9: roughness: unknown key 'waviness'"),
        (
            POWER.replace("cycles", "rad", 1) + RUNS,
            "9: roughness: reference = '0.1 rad/m' is not a number of cycles/in, cycles/ft",
        ),
        (POWER.replace("16e-6 m3", "16e-6 m2") + RUNS, "8: roughness: coefficient = .*like 'm3'"),
        (POWER.replace("0.5 cyc", "0.001 cyc") + RUNS, "10: roughness: band"),
        (POINTS.replace("0.05 ", "0.5 ") + RUNS, "8: roughness: n.2. = 0.5"),
        (
            "[roughness]\nwaviness = 2\n" + RUNS,
            "7: roughness: one of iso8608, coefficient and n is needed",
        ),
        (RUNS, "roughness is missing"),
        (CLASS_A, "monte_carlo is missing"),
        (CLASS_A + RUNS + "chunks = 3\n", "14: monte_carlo: unknown key 'chunks'"),
        (CLASS_A + RUNS.replace("runs = 10", "runs = 1.5"), "12: monte_carlo: runs = 1.5 is not a"),
        (CLASS_A + RUNS.replace("runs = 10", "runs = true"), "12: monte_carlo: runs = True is not"),
        (CLASS_A + RUNS.replace("runs = 10", "runs = 0"), "12: .*runs = 0 must be at least 1"),
        (CLASS_A + RUNS.replace("seed = 1", "seed = -1"), "13: monte_carlo: seed = -1 must be"),
        (
            CLASS_A + RUNS.replace("50 cm", "50 m"),
            "11: monte_carlo: spacing = 50.*; the file says spacing = '50 m'",
        ),
        (CLASS_A + RUNS.replace("100 m", "-1 m"), "10: monte_carlo: length = -1"),
        (CLASS_A + RUNS + 'tracks = "two"\n', "14: monte_carlo: tracks = 'two' is unknown"),
        (
            CLASS_A + RUNS + "[monte_carlo.levels]\nload = [1]\n",
            "15: monte_carlo.levels: unknown key 'load'; did you mean 'rms_load'",
        ),
        (
            CLASS_A + RUNS + '[monte_carlo.levels]\nmax_load = ["1 g"]\n',
            "15: monte_carlo.levels: max_load.0. = '1 g' has the wrong kind of unit",
        ),
        (
            CLASS_A + RUNS + "[monte_carlo.levels]\nmax_load = 3\n",
            "15: monte_carlo.levels: max_load = 3 is not a list",
        ),
        (
            POINTS + RUNS + 'tracks = "isotropic"\n',
            "monte_carlo: tracks",
        ),
    ],
)
@pytest.mark.parametrize("out", [False, True])
def test_faults_are_named_with_their_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, said: str, out: bool
) -> None:
    path = tmp_path / "case.toml"
    path.write_text(UNITS.format("m") + F4E + text + RUN, encoding="utf-8")
    kept = tmp_path / "out"
    assert main(["mc", str(path), *(["--out", str(kept)] if out else [])]) == 2
    error = capsys.readouterr().err
    assert re.search(said, error), error
    # Nothing that would be held against the corrected case.
    assert not kept.exists()
