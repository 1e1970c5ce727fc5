"""Case files: every unit system says the same, and faults are named with their place."""

import inspect
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

import runway_modal as rm
from runway_modal import nonlinear
from runway_modal.case import Case, read_case
from runway_modal.case.tracks import _SHAPES
from runway_modal.units import FREQUENCY, LENGTH, MASS, SPEED, STIFFNESS, Units

F4E = '[aircraft]\npreset = "f4e"\ndamping_ratio = 0.01\n'
RUN = '[run]\nspeeds = ["20 kt"]\n'
MAT = '[[track]]\nshape = "full_mat"\n'
INCHES = '[units]\nlength = "in"\nforce = "lbf"\n'
METRES = '[units]\nlength = "m"\nforce = "N"\n'

#: Table 1 and Table 2 of the report, each number with a unit of its own.
FULL = """
[aircraft]
mass = "145.5 lbf*s2/in"
pitch_inertia = "1.92e6 lbf*s2*in"
roll_inertia = "6.56e5 lbf s² in"
gravity = "386.0886 in/s2"
damping_ratio = 0.01
[[aircraft.gears]]
name = "nose"
x = "19.575 ft"
y = 0
stiffness = "18.024 kip/ft"
[[aircraft.gears]]
name = "left"
x = "-1126.49 mm"
y = "2.77495 m"
stiffness = "9102 lbf/in"
[[aircraft.gears]]
name = "right"
x = "-44.35 in"
y = "-109.25 in"
stiffness = "9.102 kip/in"
"""


def read(folder: Path, text: str) -> Case:
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return read_case(path)


@pytest.mark.parametrize("aircraft", [F4E, FULL], ids=["preset", "data"])
@pytest.mark.parametrize(
    ("length", "force"), [("in", "lbf"), ("m", "N"), ("ft", "kip"), ("mm", "kN")]
)
def test_any_units_give_the_same_loads(
    tmp_path: Path, aircraft: str, length: str, force: str
) -> None:
    case = read(tmp_path, f'[units]\nlength="{length}"\nforce="{force}"\n{aircraft}{MAT}{RUN}')
    expected = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20)).extremes()
    found = case.run()["20 kt"].extremes()
    # Newtons in a pound-force, exact by definition.
    newtons = {"lbf": 4.4482216152605, "kip": 4448.2216152605, "N": 1.0, "kN": 1000.0}[force]
    np.testing.assert_allclose(
        found.max_load * newtons / 4.4482216152605, expected.max_load, rtol=1e-9
    )
    np.testing.assert_allclose(found.time_of_max, expected.time_of_max, rtol=1e-7)


@pytest.mark.parametrize(
    ("units", "text", "dimension", "value"),
    [
        (("m", "N"), "20 kt", SPEED, 10.288888888888889),
        (("m", "N"), "72 km/h", SPEED, 20.0),
        (("in", "lbf"), "100 ft/s", SPEED, 1200.0),
        (("m", "N"), "1 slug", MASS, 14.593902937206365),
        (("m", "N"), "1 lbf/in", STIFFNESS, 175.12683524647637),
        (("in", "lbf"), "1 m", LENGTH, 39.37007874015748),
        (("in", "lbf"), "2.5 1/s", FREQUENCY, 2.5),
    ],
)
def test_quantities(
    units: tuple[str, str], text: str, dimension: tuple[int, int, int], value: float
) -> None:
    assert Units(*units).quantity("q", text, dimension) == pytest.approx(value, rel=1e-15)


def test_tracks_add_up_follow_each_other_and_come_from_files(tmp_path: Path) -> None:
    (tmp_path / "survey.csv").write_text("s [m],z [mm]\n0,0\n2.54,25.4\n5.08,0\n")
    text = (
        '[[track]]\nshape = "mat"\nlength = "10 ft"\nramp = 0\n'
        '[[track]]\nshape = "spall"\nlength = 24\ndepth = 1\ngap = "5 ft"\n'
        '[[track]]\ngears = ["nose"]\nfile = "survey.csv"\nstart = 1000\n'
    )
    tracks = read(tmp_path, INCHES + F4E + text + RUN).tracks
    assert tracks["left"].x.tolist() == [0, 0, 120, 120, 180, 180, 204, 204]
    assert tracks["left"].z.tolist() == [0, 1.5, 1.5, 0, 0, -1, -1, 0]
    np.testing.assert_allclose(tracks["nose"].elevation([1100.0]), [1.0], rtol=1e-14)


def test_one_degree_of_freedom_and_measured_modes(tmp_path: Path) -> None:
    single = '[single_dof]\nmass = 145.5\nomega = "1.91 Hz"\ndamping_ratio = 0.01\n'
    assert read(tmp_path, INCHES + single + MAT + RUN).modes.frequency_hz[0] == pytest.approx(1.91)
    measured = (
        '[aircraft]\npreset = "f4e"\n[[aircraft.modes]]\nomega = 12.016\ndamping_ratio = 0.02\n'
        "shape = [0.078743, -0.000226, 0]\n"
    )
    modes = read(tmp_path, INCHES + measured + MAT + RUN).modes
    assert modes.omega.tolist() == [12.016]
    assert modes.damping_ratio.tolist() == [0.02]
    assert not modes.static_correction
    corrected = measured.replace("[[", "static_correction = true\n[[")
    assert read(tmp_path, INCHES + corrected + MAT + RUN).modes.static_correction
    of_own = '[aircraft]\npreset = "f4e"\nstatic_correction = true\n'
    with pytest.raises(
        rm.InputError, match=r":6: aircraft: static_correction applies only to measured"
    ):
        read(tmp_path, INCHES + of_own + MAT + RUN)


def test_a_survey_may_be_an_erd_file(tmp_path: Path) -> None:
    survey = rm.Profile(0.5 * np.arange(4), [0.0, 0.01, -0.02, 0.0])
    rm.write_erd(tmp_path / "survey.erd", survey, "m")
    track = '[[track]]\nfile = "survey.erd"\nelevation = 0\nstart = 100\n'
    found = read(tmp_path, INCHES + F4E + track + RUN).tracks["left"]
    np.testing.assert_allclose((found.x - 100) * 0.0254, survey.x, atol=1e-12)
    np.testing.assert_allclose(found.z * 0.0254, survey.z, atol=1e-12)


def test_crater_repair(tmp_path: Path) -> None:
    text = (
        '[[track]]\nshape = "crater_repair"\nlength = "930 in"\nupheaval = 0.0508\n'
        'settlement = "1 in"\nupheaval_length = "10 ft"\n'
    )
    case = read(tmp_path, METRES + F4E + text + RUN)
    expected = rm.Profile.crater_repair(930.0, upheaval=2.0, settlement=1.0, upheaval_length=120.0)
    np.testing.assert_allclose(case.tracks["left"].x / 0.0254, expected.x, rtol=1e-14)
    np.testing.assert_allclose(case.tracks["left"].z / 0.0254, expected.z, rtol=1e-14)
    assert case.notes == (
        "track[0]: ramp = 12 in, the default",
        "track[0]: the arrangement of its slopes",
    )


def test_footprint_is_of_the_sum_of_tracks_under_its_gear(tmp_path: Path) -> None:
    gap = '[[track]]\nshape = "spall"\nlength = 24\ndepth = 1\ngap = "5 ft"\n'
    text = INCHES + F4E + MAT + gap + '[footprint]\nnose = "0.75 ft"\n' + RUN
    tracks = read(tmp_path, text).tracks
    bare = rm.Profile.full_mat() + rm.Profile.spall(24, 1, start=990)
    assert tracks["left"] == bare
    assert tracks["nose"].x.tolist() == bare.footprint(9.0).x.tolist()
    np.testing.assert_allclose(tracks["nose"].z, bare.footprint(9.0).z, atol=1e-15)


def test_nonlinear_aircraft_is_the_same_in_any_units(tmp_path: Path) -> None:
    aircraft = F4E + "nonlinear = true\n[aircraft.stations]\npilot = ['200 in', 0]\n"
    case = read(tmp_path, METRES + aircraft + MAT + RUN)
    expected = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), rm.knots(20)).extremes()
    found = case.run()["20 kt"].extremes()
    np.testing.assert_allclose(found.max_load / 4.4482216152605, expected.max_load, rtol=1e-6)
    np.testing.assert_allclose(found.min_load / 4.4482216152605, expected.min_load, rtol=1e-6)
    np.testing.assert_allclose(case.modes.omega, nonlinear.f4e().linearised().modes(0.01).omega)
    # What the dampers of the run give each mode (Eq. 11), not the ratio they were sized by.
    np.testing.assert_allclose(case.modes.damping_ratio, [0.00907, 0.01005, 0.01517], rtol=1e-3)
    assert found.max_acceleration.keys() == {"cg", "pilot"}
    assert any("gas law" in note for note in case.notes)


def test_inferred_defaults_are_said(tmp_path: Path) -> None:
    shape = '[[track]]\nshape = "two_foot_spall"\nramp = 2\n'
    assert read(tmp_path, INCHES + F4E + shape + RUN).notes == (
        "track[0]: depth = 1.5 in, the default",
    )


def test_lengths_in_inches_reach_the_reports_shapes_unrounded(tmp_path: Path) -> None:
    shape = '[[track]]\nshape = "double_spall"\nspacing = "24 in"\nramp = "1 ft"\n'
    found = read(tmp_path, METRES + F4E + shape + RUN).tracks["left"]
    expected = rm.Profile.double_spall(ramp=12.0, spacing=24.0)
    np.testing.assert_allclose(found.x, expected.x * 0.0254, rtol=1e-15)


def test_every_shape_is_in_the_example() -> None:
    example = (files("runway_modal.case") / "example.toml").read_text(encoding="utf-8")
    # What a shell makes of it on any system is still TOML.
    assert example.isascii()
    for name, shape in _SHAPES.items():
        assert name in example
        for parameter in inspect.signature(shape).parameters:
            assert parameter in example


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (INCHES + F4E + MAT + 'lenght = "3 ft"\n' + RUN, "9: track[0]: unknown key 'lenght'"),
        (INCHES + F4E + '[[track]]\nshape = "ful_mat"\n' + RUN, "8: .*did you mean 'full_mat'"),
        (INCHES + F4E + MAT + '[run]\nspeeds = ["20 N"]\n', "10: run: .*wrong kind of unit"),
        (INCHES + F4E + MAT + "[run]\nspeeds = [-1]\n", "10: run: speeds.0. = -1 is not positive"),
        (INCHES + F4E + MAT, "run is missing"),
        (F4E + MAT + RUN, "units is missing"),
        (INCHES + FULL.replace('"18.024 kip/ft"', "-1") + MAT + RUN, "15: .*gears.0.: stiff"),
        (
            INCHES + FULL.replace('"left"', '"nose"') + MAT + RUN,
            "17: aircraft.gears.1.: gears.1..name = 'nose' repeats",
        ),
        (INCHES + F4E + MAT + 'gears = ["noze"]\n' + RUN, "did you mean 'nose'"),
        (INCHES + F4E + MAT + RUN + "damping_input = 1\n", "11: run: damping_input = 1 is not"),
        (INCHES + MAT + RUN, "exactly one of .aircraft. and .single_dof."),
        ("a = \n", "line 1"),
        (
            METRES + F4E + '[[track]]\nshape = "mat"\nlength = "3 ft"\nramp = -1\n' + RUN,
            "10: track.0.: ramp = -1.0 is not between 0 and 0.457",
        ),
        (
            METRES + F4E + '[[track]]\nshape = "two_foot_spall"\nramp = 0.5\n' + RUN,
            r"9: .* 12.0, half the length .in.; the file says ramp = 0\.5$",
        ),
        (
            METRES + F4E + MAT + '[footprint]\nnose = "-10 in"\n' + RUN,
            "10: footprint: nose = -0.254 is not positive; the file says nose = '-10 in'",
        ),
        (
            INCHES + F4E + MAT + '[[track]]\nshape = "full_mat"\ngap = -2\n' + RUN,
            "11: track.1.: gap = -2.0 is negative",
        ),
        (
            INCHES + F4E + MAT + '[[track]]\nshape = "full_mat"\nstart = 0\ngap = 2\n' + RUN,
            "12: track.1.: give either gap or start, not both",
        ),
        (
            INCHES + FULL.replace("stiffness = ", "tire = 1\nstiffness = ", 1) + MAT + RUN,
            "gears.0.: give either stiffness or strut and tire, not both",
        ),
        ("title = 3\n" + INCHES + F4E + MAT + RUN, "1: title = 3 is not a string"),
        ("title = ''\n" + INCHES + F4E + MAT + RUN, "1: title = '' is empty"),
        (INCHES + F4E + MAT + '[footprint]\nnoze = 1\n' + RUN, "10: footprint: unknown key"),
        (INCHES + F4E + MAT + RUN + '[output]\ncsv = "-"\n', "12: output: csv = '-': standard"),
        (INCHES + F4E + MAT + RUN + "duration = -1\n", "11: run: duration = -1.0 is not positive"),
        (INCHES + F4E + MAT + '[run]\nspeeds = ["20 kt", "20 kt"]\n', "10: .*is given twice"),
        (INCHES + F4E + MAT + "[run]\nspeeds = [true]\n", "speeds.0. = True is not a number"),
        (INCHES + F4E + MAT + '[run]\nspeeds = ["20"]\n', "'20' is not a number with a unit"),
        (INCHES + F4E + MAT + 'gears = ["nose", "nose"]\n' + RUN, "9: .*'nose' is listed twice"),
        (INCHES + F4E + '[[track]]\nfile = "no.csv"\n' + RUN, "8: .*cannot read .*no.csv: No such"),
        (
            INCHES + F4E + '[[track]]\nfile = "a.csv"\nelevation = {nose = 1}\n' + RUN,
            "9: track.0.: elevation is neither a heading nor a number",
        ),
        (
            INCHES + F4E.replace("damping_ratio = 0.01", "[[aircraft.modes]]\nomega = 1\n"
            "damping_ratio = 0\nshape = ['a', 0, 0]") + MAT + RUN,
            "9: aircraft.modes.0.: shape.0. = 'a' is not a real number",
        ),
        (INCHES + F4E + MAT + 'file = "a.csv"\n' + RUN, "9: track.0.: exactly one of shape and"),
        (INCHES + F4E + '[[track]]\nlength = 3\n' + RUN, "7: track.0.: exactly one of shape and"),
        (
            INCHES + F4E + MAT + '[run]\nspeeds = ["20,5 kt"]\n',
            "10: run: speeds.0. = '20,5 kt': numbers have a decimal point",
        ),
        (
            INCHES + F4E.replace("0.01", '"1 %"') + MAT + RUN,
            "6: aircraft: damping_ratio = '1 %' is not a real number",
        ),
        (
            INCHES + F4E + MAT.replace("[[track]]", "[track]") + MAT + RUN,
            r"Cannot overwrite a value .*; a list of tables has \[\[...\]\] at each",
        ),
        (INCHES + F4E + 'nonlinear = true\nstiffness = "static"\n' + MAT + RUN, "8: .*'stiffness'"),
        (
            INCHES + F4E + "nonlinear = true\n" + MAT + RUN + "damping_input = false\n",
            "12: run: damping_input: a nonlinear run always includes it",
        ),
    ],
)  # fmt: skip
def test_faults_are_named_with_their_place(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(rm.InputError, match=said.replace("[0]", r"\[0\]")):
        read(tmp_path, text).run()
