"""Bad and extreme input: it works, or `InputError` names argument, index and value."""

import os
import pickle
import re
import subprocess
import sys
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import numpy as np
import pytest

import runway_modal as rm
from runway_modal import nonlinear

SHAPES = np.array([[0.025931, -0.078743, 0.0], [0.000685, 0.000226, 0.0], [0.0, 0.0, 0.001235]])
MODES = rm.f4e().modes(0.01)
MAT = rm.Profile.full_mat()


def gear(**changes: Any) -> rm.Gear:
    return rm.Gear(**{"name": "a", "x": 1.0, "y": 2.0, "stiffness": 3.0, "damping": 4.0, **changes})


def aircraft(**changes: Any) -> rm.Aircraft:
    values = {
        "mass": 145.5,
        "pitch_inertia": 1.92e6,
        "roll_inertia": 6.56e5,
        "gears": rm.f4e().gears,
    }
    return rm.Aircraft(**{**values, **changes})


def measured(**changes: Any) -> rm.Modes:
    values = {"omega": [7.0, 12.0, 18.0], "damping_ratio": [0.01] * 3, "shapes": SHAPES}
    return rm.Modes(**{"aircraft": rm.f4e(), **values, **changes})


def simulate(**changes: Any) -> rm.Response:
    return rm.simulate(**{"modes": MODES, "tracks": MAT, "speed": 400.0, **changes})


def single_dof(**changes: Any) -> rm.Modes:
    return rm.single_dof(**{"mass": 1.0, "omega": 1.0, "damping_ratio": 0.1, **changes})


def put(values: list[Any], index: int, value: Any) -> list[Any]:
    return [*values[:index], value, *values[index + 1 :]]


Make = Callable[[Any], Any]

RUN = simulate(duration=1.0)

#: Every numeric argument that is one number: name in messages, how to pass it, what is allowed.
SCALARS: list[tuple[str, Make, str]] = [
    ("x", lambda v: gear(x=v), "any"),
    ("y", lambda v: gear(y=v), "any"),
    ("stiffness", lambda v: gear(stiffness=v), "positive"),
    ("damping", lambda v: gear(damping=v), "not negative"),
    ("strut", lambda v: rm.Gear.from_series("a", 0, 0, strut=v, tire=1.0), "positive"),
    ("tire", lambda v: rm.Gear.from_series("a", 0, 0, strut=1.0, tire=v), "positive"),
    ("mass", lambda v: aircraft(mass=v), "positive"),
    ("pitch_inertia", lambda v: aircraft(pitch_inertia=v), "positive"),
    ("roll_inertia", lambda v: aircraft(roll_inertia=v), "positive"),
    ("gravity", lambda v: aircraft(gravity=v), "not negative"),
    ("stiffness['nose']", lambda v: rm.f4e().with_stiffness({"nose": v}), "positive"),
    ("mass", lambda v: single_dof(mass=v), "positive"),
    ("omega", lambda v: single_dof(omega=v), "positive"),
    ("damping_ratio", lambda v: single_dof(damping_ratio=v), "not negative"),
    ("damping_ratio", lambda v: rm.f4e().modes(v), "not negative"),
    ("damping_ratio", lambda v: measured(damping_ratio=v), "not negative"),
    ("length", lambda v: rm.Profile.mat(v), "positive"),
    ("height", lambda v: rm.Profile.mat(100.0, v), "any"),
    ("ramp", lambda v: rm.Profile.mat(100.0, ramp=v), "not negative"),
    ("start", lambda v: rm.Profile.mat(100.0, start=v), "any"),
    ("depth", lambda v: rm.Profile.spall(100.0, v), "any"),
    ("length", lambda v: rm.Profile.spall(v, 1.0), "positive"),
    ("length", lambda v: rm.Profile.half_mat(v), "positive"),
    ("spacing", lambda v: rm.Profile.double_spall(spacing=v), "positive"),
    ("length", lambda v: rm.Profile.one_minus_cosine(v, 1.0), "positive"),
    ("height", lambda v: rm.Profile.one_minus_cosine(9.0, v), "any"),
    ("start", lambda v: rm.Profile.one_minus_cosine(9.0, 1.0, start=v), "any"),
    ("length", lambda v: rm.Profile.crater_repair(v, 2.0, 1.0, 60.0), "positive"),
    ("upheaval", lambda v: rm.Profile.crater_repair(930.0, v, 1.0, 60.0), "any"),
    ("settlement", lambda v: rm.Profile.crater_repair(930.0, 2.0, v, 60.0), "any"),
    ("upheaval_length", lambda v: rm.Profile.crater_repair(930.0, 2.0, 1.0, v), "not negative"),
    ("start", lambda v: rm.Profile.crater_repair(930.0, 2.0, 1.0, 60.0, start=v), "any"),
    ("gap", lambda v: rm.Profile.sequence([MAT, MAT], v), "not negative"),
    ("dx", lambda v: MAT.shifted(v), "any"),
    ("length", lambda v: MAT.footprint(v), "positive"),
    ("tolerance", lambda v: MAT.footprint(9.0, v), "positive"),
    ("speed", lambda v: simulate(speed=v), "positive"),
    ("duration", lambda v: simulate(duration=v), "positive"),
    ("length", lambda v: [e.max_load for e in RUN.sections(v).values()], "positive"),
    ("v", rm.knots, "any"),
]  # fmt: skip

#: Every array argument: name in messages, a good value, how to pass it, what is allowed.
ARRAYS: list[tuple[str, list[float], Make, str]] = [
    ("x", [0.0, 1.0, 2.0], lambda v: rm.Profile(v, [0.0, 1.0, 2.0]), "rising"),
    ("z", [0.0, 1.0, 2.0], lambda v: rm.Profile([0.0, 1.0, 2.0], v), "any"),
    ("stations", [0.0, 1.0, 2.0], MAT.elevation, "stations"),
    ("omega", [7.0, 12.0, 18.0], lambda v: measured(omega=v), "positive"),
    ("damping_ratio", [0.1, 0.1, 0.1], lambda v: measured(damping_ratio=v), "not negative"),
    ("damping_ratio", [0.1, 0.1, 0.1], lambda v: rm.f4e().modes(v), "not negative"),
    ("k", [1.0, 2.0, 3.0], rm.equivalent_stiffness, "positive"),
    ("times", [0.0, 1.0, 2.0], lambda v: simulate(times=v), "rising"),
    ("times", [0.0, 1.0, 2.0], simulate(duration=1.0).at, "rising"),
]

SCALAR_IDS = [f"{name}-{i}" for i, (name, _, _) in enumerate(SCALARS)]
ARRAY_IDS = [f"{name}-{i}" for i, (name, _, _, _) in enumerate(ARRAYS)]


def assert_refused(make: Callable[[], Any], *parts: str) -> None:
    """InputError, and its message holds every part."""
    with pytest.raises(rm.InputError) as raised:
        make()
    message = str(raised.value)
    for part in parts:
        assert part.lower() in message.lower(), message


def finite(result: Any) -> bool:
    """Whether nothing in a result is NaN or infinite."""
    if isinstance(result, rm.Response):
        extremes = result.extremes()
        parts: list[Any] = [
            result.time, result.distance, result.modal, result.modal_rate, result.cg,
            result.cg_rate, result.cg_acceleration, result.gear_displacement, result.elevation,
            result.load, *result.acceleration.values(), extremes.max_load, extremes.min_load,
            extremes.time_of_max, extremes.time_of_min, list(extremes.max_acceleration.values()),
        ]  # fmt: skip
    elif isinstance(result, rm.Modes):
        parts = [result.omega, result.damping_ratio, result.shapes, result.damping_coupling]
    elif isinstance(result, rm.Aircraft):
        parts = [result.stiffness_matrix, result.damping_matrix, result.static_load]
    elif isinstance(result, rm.Profile):
        parts = [result.x, result.z, result.elevation(result.x)]
    elif isinstance(result, rm.Gear):
        parts = [[result.x, result.y, result.stiffness, result.damping]]
    else:
        parts = [result]
    return all(np.isfinite(part).all() for part in parts)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize(("name", "make", "_allowed"), SCALARS, ids=SCALAR_IDS)
def test_a_number_that_is_not_finite(name: str, make: Make, _allowed: str, value: float) -> None:
    assert_refused(lambda: make(value), name, str(value))


@pytest.mark.parametrize("value", [0.0, -1.0])
@pytest.mark.parametrize(("name", "make", "allowed"), SCALARS, ids=SCALAR_IDS)
def test_a_number_that_must_be_positive(name: str, make: Make, allowed: str, value: float) -> None:
    if allowed == "any" or (allowed == "not negative" and value == 0.0):
        assert finite(make(value))
    else:
        assert_refused(lambda: make(value), name, str(value))


@pytest.mark.parametrize("value", [1e-300, 1e300, 5e-324, np.finfo(float).max])
@pytest.mark.parametrize(("name", "make", "_allowed"), SCALARS, ids=SCALAR_IDS)
def test_a_tiny_or_huge_number(name: str, make: Make, _allowed: str, value: float) -> None:
    try:
        result = make(value)
    except rm.InputError as error:
        # Named itself, or the quantity derived from it that is out of range.
        related = {
            "damping_ratio": "damping",
            "length": "ramp",
            "ramp": "z[1]",
            "dx": "x",
            "upheaval_length": "x[",
        }
        heights = {"height", "depth", "upheaval", "upheaval_length", "settlement"}
        names = [name.split("[")[0], related.get(name, name), *(["z["] if name in heights else [])]
        if name in ("length", "start"):
            names.append("z[")
        assert any(part in str(error) for part in names), str(error)
    else:
        assert finite(result)


@pytest.mark.parametrize(
    "value",
    [
        "1.0",
        b"1",
        None,
        1j,
        np.complex128(1 + 0j),
        np.array("3"),
        object,
        [1.0, 2.0],
        {},
        np.ma.masked,
    ],
    ids=repr,
)
@pytest.mark.parametrize(("name", "make", "_allowed"), SCALARS, ids=SCALAR_IDS)
def test_something_that_is_not_a_number(
    name: str, make: Make, _allowed: str, value: object
) -> None:
    if value is None and name in ("tolerance", "duration", "damping_ratio"):
        pytest.skip("None asks for the default, where there is one")
    if isinstance(value, list) and name in ("damping_ratio", "v"):
        pytest.skip("an array is allowed")
    assert_refused(lambda: make(value), name)


@pytest.mark.parametrize("value", [np.float32(3.0), np.int8(3), 3, np.array(3.0), True])
@pytest.mark.parametrize(("name", "make", "_allowed"), SCALARS, ids=SCALAR_IDS)
def test_any_kind_of_real_number(name: str, make: Make, _allowed: str, value: Any) -> None:
    if name in ("spacing", "ramp") or (name == "length" and value is True):
        value = type(value)(25) if not isinstance(value, bool | np.ndarray) else 25
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            assert finite(make(value))
        except rm.InputError as error:
            # A mat of three inches has no room for its ramps of twelve.
            assert name == "length"
            assert "ramp" in str(error)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("index", [0, 1, 2])
@pytest.mark.parametrize(("name", "good", "make", "allowed"), ARRAYS, ids=ARRAY_IDS)
def test_an_entry_that_is_not_finite(
    name: str, good: list[float], make: Make, allowed: str, index: int, value: float
) -> None:
    if allowed == "stations" and not np.isnan(value):
        assert finite(make(put(good, index, value)))  # the level ends reach for ever
    else:
        assert_refused(lambda: make(put(good, index, value)), f"{name}[{index}] = {value}")


@pytest.mark.parametrize("index", [0, 1, 2])
@pytest.mark.parametrize(("name", "good", "make", "allowed"), ARRAYS, ids=ARRAY_IDS)
def test_an_entry_out_of_range(
    name: str, good: list[float], make: Make, allowed: str, index: int
) -> None:
    bad = put(good, index, -1.0)
    if allowed in ("positive", "not negative"):
        assert_refused(lambda: make(bad), f"{name}[{index}] = -1.0")
    elif allowed == "rising" and index > 0:
        assert_refused(lambda: make(bad), f"{name}[{index}] = -1.0", str(good[index - 1]))
    else:
        assert finite(make(bad))
    if allowed == "positive":
        assert_refused(lambda: make(put(good, index, 0.0)), f"{name}[{index}] = 0.0")


@pytest.mark.parametrize("value", [1e-300, 1e300])
@pytest.mark.parametrize("index", [0, 1, 2])
@pytest.mark.parametrize(("name", "good", "make", "_allowed"), ARRAYS, ids=ARRAY_IDS)
def test_a_tiny_or_huge_entry(
    name: str, good: list[float], make: Make, _allowed: str, index: int, value: float
) -> None:
    try:
        assert finite(make(put(good, index, value)))
    except rm.InputError as error:
        # Stations next to each other make a slope out of range, told of the elevation.
        assert re.search(rf"[{name[0]}z]\w*\[\d\] = ", str(error)), str(error)


def variants(good: list[float]) -> dict[str, Any]:
    """The same whole numbers in every form an array may take."""
    base = np.array(good)
    wide = np.zeros((len(good), 2))
    wide[:, 0] = good
    frozen = base.copy()
    frozen.flags.writeable = False
    # As views into files and messages may be.
    crooked = np.frombuffer(b"." + base.tobytes(), offset=1)
    return {
        "list": list(good),
        "tuple": tuple(good),
        "float32": base.astype(np.float32),
        "float16": base.astype(np.float16),
        "long double": base.astype(np.longdouble),
        "swapped bytes": base.astype(base.dtype.newbyteorder()),
        "strided": wide[:, 0],
        "reversed": base[::-1].copy()[::-1],
        "read-only": frozen,
        "misaligned": crooked,
        "objects": base.astype(object),
        "masked, nothing hidden": np.ma.array(base, mask=False),
    }


@pytest.mark.parametrize("form", variants([0.0]))
@pytest.mark.parametrize(
    ("good", "read"),
    [
        ([0.0, 1.0, 2.0], lambda v: rm.Profile(v, [0, 1, 5]).x),
        ([0.0, 1.0, 2.0], lambda v: rm.Profile([0, 1, 5], v).z),
        ([0.0, 6.0, 99.0], MAT.elevation),
        ([7.0, 12.0, 18.0], lambda v: measured(omega=v).omega),
        ([0.25, 0.0, 3.0], lambda v: measured(damping_ratio=v).damping_ratio),
        ([0.25, 0.0, 3.0], lambda v: rm.f4e().modes(v).damping_ratio),
        ([1.0, 2.0, 3.0], lambda v: np.array(rm.equivalent_stiffness(v))),
        ([0.0, 0.5, 2.0], lambda v: simulate(times=v).load),
        ([0.0, 0.5, 2.0], lambda v: simulate(duration=1.0).at(v).load),
    ],
)
def test_every_form_of_array(good: list[float], read: Make, form: str) -> None:
    given = variants(good)[form]
    np.testing.assert_array_equal(read(given), read(np.array(good)))
    np.testing.assert_array_equal(given, good)


def test_wrong_kinds_are_refused_by_name() -> None:
    ensemble = rm.simulate_many(MODES, np.zeros((3, 1, 9)), 12.0, 400.0)
    surface = rm.Roughness.iso8608("A", unit="in")
    runway: dict[str, Any] = {
        "length": 500.0,
        "spacing": 10.0,
        "speed": 400.0,
        "seed": 1,
        "runs": 1,
    }
    strange = np.array([1, 2])
    for make, said in (
        (lambda: rm.simulate_many(rm.f4e(), np.zeros((3, 1, 9)), 12.0, 400.0), "Aircraft.modes"),
        (lambda: rm.Profile.sequence(None, 1.0), "profiles = None is not a sequence"),
        (lambda: rm.Profile.sequence([MAT, MAT], [[1, 2], [3]]), "gap is not a rectangular"),
        (lambda: ensemble.mean("max_load", confidence=[0.9, 0.95]), "confidence = [0.9"),
        (lambda: ensemble.mean(["max_load"]), "quantity = ['max_load'] is none of"),
        (lambda: ensemble.worst(["left"]), "at = ['left']: no such gear"),
        (lambda: rm.monte_carlo(MODES, surface, **runway, on_error=strange), "on_error = array"),
        (lambda: rm.monte_carlo(MODES, surface, **runway, tracks=strange), "tracks = array"),
        (lambda: simulate(speed=np.ma.array(3.0, mask=True)), "speed is masked"),
        (lambda: gear(name="\udc80"), "name = '\\udc80'"),
        (lambda: aircraft(stations={1: (0.0, 0.0)}), "stations[1]: 1 is not a name"),
        (lambda: rm.sweep(MODES, MAT, [400.0, 1e-90]), "speeds[1] = 1e-90 is out of range"),
    ):
        assert_refused(make, said)


def test_more_runs_than_memory_holds() -> None:
    surface = rm.Roughness.iso8608("A", unit="in")
    runway: dict[str, Any] = {"length": 500.0, "spacing": 10.0, "speed": 400.0, "seed": 1}
    for runs in (10**13, 2**62):
        with pytest.raises(MemoryError, match=f"runs = {runs}"):
            rm.monte_carlo(MODES, surface, **runway, runs=runs)
    with pytest.raises(MemoryError, match="runs = "):
        surface.elevations(length=500.0, spacing=10.0, seed=1, runs=2**62)
    assert_refused(lambda: rm.monte_carlo(MODES, surface, **runway, runs=2**63), "runs = 9223")


def test_modes_cannot_be_changed() -> None:
    modes = rm.f4e().modes(0.01)
    with pytest.raises(AttributeError, match="cannot be changed"):
        modes.omega = np.ones(3)
    assert modes == rm.f4e().modes(0.01)


@pytest.mark.parametrize("simulate", [rm.simulate, nonlinear.simulate])
def test_responses_cannot_be_changed(simulate) -> None:
    aircraft = nonlinear.f4e() if simulate is nonlinear.simulate else rm.f4e().modes(0.01)
    response = simulate(aircraft, rm.Profile.full_mat(), rm.knots(20))
    again = pickle.loads(pickle.dumps(response))
    for name in ("time", "load", "aircraft", "note"):
        with pytest.raises(AttributeError, match=f"cannot be changed: {name} = 1"):
            setattr(response, name, 1)
    for name in ("time", "_run", "_pieces"):
        with pytest.raises(AttributeError, match=f"cannot be changed: del {name}"):
            delattr(response, name)
    np.testing.assert_array_equal(again.load, response.load)
    for name in ("time", "load", "cg", "rms_load", "distance"):
        assert not getattr(again, name).flags.writeable
    with pytest.raises(AttributeError, match="cannot be changed: del omega"):
        del MODES.omega


def test_integers() -> None:
    for kind in (int, np.int8, np.uint64, bool):
        values = np.array([0, 1, 1]).astype(kind)
        profile = rm.Profile(values, values)
        assert profile.x.dtype == np.float64
        np.testing.assert_array_equal(profile.x, [0, 1, 1])


def test_shapes_in_any_memory_order() -> None:
    wide = np.zeros((6, 6))
    wide[::2, ::2] = SHAPES
    for shapes in (np.asfortranarray(SHAPES), wide[::2, ::2], SHAPES.T.copy().T, SHAPES.tolist()):
        np.testing.assert_array_equal(measured(shapes=shapes).shapes, SHAPES)


@pytest.mark.parametrize(
    "bad",
    [
        ["0", "1", "2"], [None, 1.0, 2.0], [0.0, 1j, 2.0], [object] * 3, [[0.0], [1.0, 2.0], 3.0],
        np.zeros((3, 1)), 5.0, None, "012", np.array(["a"] * 3), {1.0, 2.0}, {0.0: 1.0},
        np.array([1, 2, 3], dtype="datetime64[s]"), [0.0, 1.0, 10**400],
    ],
    ids=repr,
)  # fmt: skip
@pytest.mark.parametrize(("name", "_good", "make", "_allowed"), ARRAYS, ids=ARRAY_IDS)
def test_something_that_is_not_an_array_of_numbers(
    name: str, _good: list[float], make: Make, _allowed: str, bad: object
) -> None:
    if isinstance(bad, float) and name in ("times", "damping_ratio", "stations"):
        pytest.skip("one number is allowed")
    if getattr(bad, "shape", ()) == (3, 1) and name == "stations":
        pytest.skip("any shape is allowed")
    if bad is None and name in ("times", "damping_ratio"):
        pytest.skip("None asks for the default, where there is one")
    # Where one entry is wrong, which.
    assert_refused(
        lambda: make(bad),
        f"{name}[0] = None" if isinstance(bad, list) and bad[:1] == [None] else name,
    )


@pytest.mark.parametrize(("name", "good", "make", "_allowed"), ARRAYS, ids=ARRAY_IDS)
def test_masked_entry(name: str, good: list[float], make: Make, _allowed: str) -> None:
    assert_refused(
        lambda: make(np.ma.array(np.array(good), mask=[False, True, False])), f"{name}[1] is masked"
    )


def test_profile_of_no_points_and_of_uneven_length() -> None:
    assert_refused(lambda: rm.Profile([], []), "x has 0 entries")
    assert_refused(lambda: rm.Profile([0, 1], [0]), "z has 1 entry", "2 expected")


def test_one_point_profile_is_level() -> None:
    response = simulate(tracks=rm.Profile([7.0], [3.0]))
    assert finite(response)
    np.testing.assert_allclose(response.load / response.static_load, 1.0, rtol=5e-16)
    np.testing.assert_array_equal(response.elevation, 3.0)


def test_stations_that_decrease() -> None:
    assert_refused(lambda: rm.Profile([0, 5, 4], [0, 0, 0]), "x[2] = 4.0", "5.0")


def test_gears() -> None:
    nose, left, right = rm.f4e().gears
    assert_refused(lambda: aircraft(gears=[]), "gears has 0 entries")
    assert_refused(
        lambda: aircraft(gears=[nose, left, right, left]), "gears[3]", "gears[1]", "'left'"
    )
    assert_refused(lambda: aircraft(gears=[nose, "left", right]), "gears[1]", "'left'")
    for bad in (None, 3.0, nose, np.array(3.0)):
        assert_refused(partial(aircraft, gears=bad), "gears")
    for name in ("", None, 3):
        assert_refused(partial(gear, name=name), "name", repr(name))
    assert aircraft(gears=iter([nose, left, right])) == rm.f4e()


def test_unknown_names() -> None:
    assert_refused(lambda: simulate(tracks={"tail": MAT}), "tracks['tail']", "nose")
    assert_refused(lambda: rm.f4e().with_stiffness({"tail": 1.0}), "stiffness['tail']", "nose")
    assert_refused(lambda: rm.f4e("soft"), "stiffness", "'soft'")  # type: ignore[arg-type]
    assert_refused(lambda: rm.knots(1.0, "mile"), "length", "'mile'")  # type: ignore[arg-type]


@pytest.mark.parametrize("bad", [None, 3.0, "nose", [("nose", 1.0)], object], ids=repr)
def test_wrong_kind_of_object(bad: Any) -> None:
    assert_refused(lambda: simulate(modes=bad), "modes")
    assert_refused(lambda: simulate(tracks=bad), "tracks")
    assert_refused(lambda: simulate(tracks={"nose": bad}), "tracks['nose']")
    assert_refused(lambda: simulate(damping_input=bad), "damping_input")
    assert_refused(lambda: measured(aircraft=bad), "aircraft")
    assert_refused(lambda: rm.f4e().with_stiffness(bad), "stiffness")
    assert_refused(lambda: aircraft(stations=bad), "stations")
    assert_refused(lambda: rm.f4e(bad), "stiffness")
    assert_refused(lambda: rm.knots(1.0, bad), "length")


def test_stations() -> None:
    assert aircraft(stations={"pilot": (1, 2)}).stations["pilot"] == (1.0, 2.0)
    assert aircraft(stations={"cg": (0, 0)}).stations == {"cg": (0.0, 0.0)}
    for point in ((np.nan, 0.0), (0.0, np.inf), (1.0,), (1.0, 2.0, 3.0), "ab", None, (1e300, 0.0)):
        assert_refused(partial(aircraft, stations={"pilot": point}), "stations['pilot']")
    assert_refused(lambda: aircraft(stations={"cg": (1.0, 0.0)}), "stations['cg']")


def test_measured_modes_of_wrong_shape() -> None:
    assert_refused(lambda: measured(shapes=SHAPES[:, :2]), "shapes", "(3, 2)", "(3, 3)")
    assert_refused(lambda: measured(shapes=SHAPES[:2]), "shapes", "(2, 3)")
    assert_refused(lambda: measured(shapes=SHAPES[0]), "shapes", "(3,)")
    assert_refused(lambda: measured(damping_ratio=[0.1, 0.1]), "damping_ratio has 2 entries")
    assert_refused(lambda: measured(omega=[], shapes=np.zeros((3, 0)), damping_ratio=[]), "omega")
    assert_refused(lambda: rm.f4e().modes([0.1, 0.1]), "damping_ratio has 2 entries")
    assert_refused(lambda: rm.f4e().modes([0.1]), "damping_ratio has 1 entry")
    assert_refused(lambda: rm.f4e().modes([]), "damping_ratio has 0 entries, 3 expected")
    for value in (np.nan, np.inf, 1e300):
        shapes = SHAPES.copy()
        shapes[1, 2] = value
        assert_refused(partial(measured, shapes=shapes), "shapes")


def test_equivalent_stiffness_of_nothing() -> None:
    assert_refused(lambda: rm.equivalent_stiffness([]), "k has 0 entries")


def test_times() -> None:
    response = simulate(duration=1.0)
    for at in (response.at, lambda t: simulate(times=t)):
        assert_refused(partial(at, []), "times has 0 entries")
        assert_refused(partial(at, [1.0, 0.5]), "times[1] = 0.5", "1.0")
        assert_refused(partial(at, [0.0, np.nan]), "times[1] = nan")
        assert_refused(partial(at, [0.0, 1e20]), "times[1] = 1e20")
        assert_refused(partial(at, [-1e20, 0.0]), "times[0] = -1e20")
        assert finite(at([-1e6, 0.0, 0.0, 1e6]))
        assert finite(at(1.0))
    assert_refused(lambda: simulate(times=[0.0], duration=1.0), "duration", "times")
    assert_refused(lambda: simulate(duration=1e9), "duration = 1000000000.0")


def test_times_on_a_level_runway_may_be_huge() -> None:
    response = simulate(tracks=rm.Profile([0.0], [1.0]), times=[-1e100, 0.0, 1e100])
    assert finite(response)
    assert_refused(lambda: response.at([0.0, 1e300]), "times[1] = 1e300")


@pytest.mark.parametrize("damping_input", [False, True])
@pytest.mark.parametrize(
    "profile",
    [
        ([0, 1], [0, 1e-300]), ([0, 0], [0, 1e-300]), ([0, 1], [1e90, 1e90]), ([0, 1], [0, 1e90]),
        ([0, 1e-12], [0, 1]), ([0, 1e9], [0, 1]), ([-1e9, -1e8], [0, 1]), ([1e300], [1]),
        ([0, 0, 0, 0], [0, 1, 2, 3]), ([0, 5e-324], [0, 0]),
    ],
    ids=repr,
)  # fmt: skip
def test_extreme_profiles_work(
    profile: tuple[list[float], list[float]], damping_input: bool
) -> None:
    modes = aircraft(gears=[rm.Gear(g.name, g.x, g.y, g.stiffness, 50.0) for g in rm.f4e().gears])
    times = [-1.0, 0.0, 1e-300, 0.5, 7.0]
    assert finite(
        simulate(
            modes=modes.modes(),
            tracks=rm.Profile(*profile),
            times=times,
            damping_input=damping_input,
        )
    )


@pytest.mark.parametrize(
    "profile",
    [
        ([0, 1], [0, 1e300]),
        ([0, 1e-300], [0, 1]),
        ([0, 1], [-1e308, 1e308]),
        ([-1e308, 1e308], [0, 1]),
    ],
    ids=repr,
)
def test_slopes_out_of_range(profile: tuple[list[float], list[float]]) -> None:
    # Each of these once gave a run whose extremes were searched for without end.
    assert_refused(lambda: rm.Profile(*profile), "[", "] = ")


@pytest.mark.parametrize("speed", [1e-99, 1e-30, 1e30, 1e99])
def test_extreme_speeds(speed: float) -> None:
    try:
        assert finite(simulate(speed=speed))
    except rm.InputError as error:
        # So slow that a phase has no digits left when the last gear leaves the mat.
        assert speed < 1.0
        assert "reaches 1e12" in str(error)


def test_the_callers_arrays_are_left_alone() -> None:
    omega, ratio, shapes = np.array([7.0, 12.0, 18.0]), np.full(3, 0.01), SHAPES.copy()
    times, k = np.linspace(0.0, 3.0, 50), np.array([1.0, 2.0])
    kept = [a.copy() for a in (omega, ratio, shapes, times, k)]
    modes = rm.Modes(rm.f4e(), omega, ratio, shapes)
    rm.f4e().modes(ratio)
    response = rm.simulate(modes, MAT, 400.0, times=times)
    response.at(times).extremes()
    rm.equivalent_stiffness(k)
    for array, copy in zip((omega, ratio, shapes, times, k), kept, strict=True):
        np.testing.assert_array_equal(array, copy)
        assert array.flags.writeable
    # And what they do afterwards is no concern of the results.
    for array in (omega, ratio, shapes, times):
        array[...] = -1.0
    np.testing.assert_array_equal(response.time, kept[3])
    np.testing.assert_array_equal(modes.omega, kept[0])


def test_threads_give_equal_bits() -> None:
    random = np.random.default_rng(5)
    profile = rm.Profile(np.cumsum(random.exponential(9.0, 20_000)), random.normal(size=20_000))
    times = np.linspace(0.0, 400.0, 5000)

    def run(_: int) -> bytes:
        response = rm.simulate(MODES, profile, 400.0, times=times)
        extremes = response.extremes()
        parts = (response.load, response.cg, extremes.max_load, extremes.time_of_min)
        return b"".join(part.tobytes() for part in parts)

    with ThreadPoolExecutor(8) as pool:
        assert len(set(pool.map(run, range(16)))) == 1


def test_threads_sharing_one_response() -> None:
    response = simulate()
    with ThreadPoolExecutor(8) as pool:
        loads = list(pool.map(lambda t: response.at(t).load.tobytes(), [response.time] * 16))
    assert set(loads) == {response.load.tobytes()}


def test_a_short_look_at_a_long_profile_needs_little_room() -> None:
    # Terabytes, if room were made for all of the profile.
    response = rm.simulate(rm.f4e().modes(0.01), rm.Profile([0, 2e12], [0, 1]), 405.0, duration=1.0)
    assert response.time.size < 100


@pytest.mark.skipif(sys.platform != "linux", reason="limits of the address space")
def test_no_room_for_the_results_is_a_memory_error() -> None:
    code = """
import resource, runway_modal as rm
resource.setrlimit(resource.RLIMIT_AS, (2 << 30, 2 << 30))
try:
    rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), 405.0, duration=1e6)
except MemoryError:
    print("no room")
"""
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment
    )
    assert done.stdout == "no room\n"
