"""`sweep` against `simulate` speed by speed, `worst_speed` against dense sweeps."""

import hashlib
import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import runway_modal as rm
from ctrl_c import ctrl_c
from runway_modal.units import Units

KNOT = rm.knots(1.0)

LOADS = (
    "max_load", "time_of_max", "position_of_max", "min_load", "time_of_min", "position_of_min",
)  # fmt: skip


def craft() -> rm.Aircraft:
    """Crooked aircraft with dampers and a pilot."""
    return rm.Aircraft(
        mass=145.5,
        pitch_inertia=1.92e6,
        roll_inertia=6.56e5,
        gears=[
            rm.Gear("nose", 210.0, 13.0, 1700.0, 20.0),
            rm.Gear("left", -37.0, 101.0, 8800.0, 70.0),
            rm.Gear("right", -52.0, -117.0, 7300.0, 60.0),
        ],
        stations={"pilot": (250.0, 10.0)},
    )


def rough(seed: int, points: int, spacing: float = 12.0) -> rm.Profile:
    heights = np.cumsum(np.random.default_rng(seed).normal(0.0, 0.05, points))
    return rm.Profile(spacing * np.arange(points), heights)


PROFILES = {
    "full mat": rm.Profile.full_mat(),
    "half mat": rm.Profile.half_mat(),
    "double spall": rm.Profile.double_spall(),
    "one minus cosine": rm.Profile.one_minus_cosine(600.0, 3.0),
    "two bumps": rm.Profile.sequence([rm.Profile.mat(120.0)] * 2, 360.0),
    "rough": rough(1, 400),
    "level": rm.Profile([0.0], [3.0]),
    "behind the start": rm.Profile.mat(200.0, start=-2000.0),
}


@pytest.mark.parametrize("damping_input", [False, True])
@pytest.mark.parametrize("profile", PROFILES)
def test_every_speed_is_a_run_of_its_own(profile: str, damping_input: bool) -> None:
    modes = craft().modes(0.02)
    # One profile for all gears; another under the left.
    for tracks in (PROFILES[profile], {"nose": PROFILES[profile], "left": PROFILES["full mat"]}):
        speeds = KNOT * np.array([60.0, 7.3, 140.0, 7.3, 33.0])
        sweep = rm.sweep(modes, tracks, speeds, damping_input=damping_input)
        assert (sweep.speed == speeds).all()
        for i, speed in enumerate(speeds):
            alone = rm.simulate(modes, tracks, speed, damping_input=damping_input).extremes()
            for name in LOADS:
                assert (getattr(sweep, name)[i] == getattr(alone, name)).all()
            for name in (
                "max_acceleration", "time_of_max_acceleration", "position_of_max_acceleration",
            ):  # fmt: skip
                assert list(getattr(sweep, name)) == ["cg", "pilot"]
                at_speed = {station: each[i] for station, each in getattr(sweep, name).items()}
                assert at_speed == getattr(alone, name)
        assert (sweep.unloaded == (sweep.min_load <= 0)).all()


def test_shapes_and_no_speeds() -> None:
    sweep = rm.sweep(craft().modes(0.02), PROFILES["full mat"], [])
    assert sweep.max_load.shape == sweep.time_of_min.shape == (0, 3)
    assert sweep.max_acceleration["pilot"].shape == (0,)
    assert (sweep.static_load == craft().static_load).all()
    assert "no speeds" in repr(sweep)


def test_arguments_are_kept_and_results_read_only() -> None:
    speeds = np.array([500.0, 300.0])
    sweep = rm.sweep(craft().modes(0.02), PROFILES["full mat"], speeds)
    speeds[0] = 1.0
    assert sweep.speed[0] == 500.0
    each = (sweep.speed, sweep.max_load, sweep.time_of_min, sweep.max_acceleration["cg"])
    assert not any(values.flags.writeable for values in each)


DIGEST = """
import hashlib, sys
import numpy as np
import runway_modal as rm
modes, mat = rm.f4e().modes(0.01), rm.Profile.full_mat()
sweep = rm.sweep(modes, mat, np.linspace(50.0, 2000.0, 77))
worst = rm.worst_speed(modes, mat, (100.0, 2000.0), at="left", tolerance=100.0)
print(hashlib.sha256(sweep.max_load.tobytes() + sweep.time_of_min.tobytes()).hexdigest(), worst)
"""


def test_any_number_of_threads_gives_the_same_bits() -> None:
    found = set()
    for threads in ("1", "2", "5"):
        environment = {**os.environ, "RAYON_NUM_THREADS": threads}
        run = [sys.executable, "-c", DIGEST]
        found.add(subprocess.run(run, env=environment, check=True, capture_output=True).stdout)
    assert len(found) == 1
    sweep = rm.sweep(rm.f4e().modes(0.01), PROFILES["full mat"], np.linspace(50.0, 2000.0, 77))
    alone = hashlib.sha256(sweep.max_load.tobytes() + sweep.time_of_min.tobytes()).hexdigest()
    assert found.pop().decode().split()[0] == alone


FORK = """
import os
import runway_modal as rm
modes, mat = rm.f4e().modes(0.01), rm.Profile.full_mat()
before = rm.sweep(modes, mat, [300.0, 400.0]).max_load
child = os.fork()
after = rm.sweep(modes, mat, [300.0, 400.0]).max_load
if not child:
    os._exit(int(not (before == after).all()))
assert os.waitpid(child, 0)[1] == 0
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_forked_process_has_threads_of_its_own() -> None:
    subprocess.run([sys.executable, "-c", FORK], check=True, timeout=60)


LONG = {
    "sweep": lambda *case: rm.sweep(*case, np.linspace(100.0, 2000.0, 5000)),
    "worst_speed": lambda *case: rm.worst_speed(*case, (1e2, 2e3), at="left", tolerance=1e-3),
}


@pytest.mark.parametrize("call", LONG)
def test_ctrl_c_within_a_second(call: str) -> None:
    modes, long = craft().modes(0.02), rough(3, 300_000, 6.0)
    with ctrl_c(after=0.3):
        LONG[call](modes, long)


CASES = [
    ("max_load", "nose"),
    ("max_load", "left"),
    ("min_load", "right"),
    ("max_acceleration", "pilot"),
]


@pytest.mark.parametrize("damping_input", [False, True])
@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize(("quantity", "at"), CASES)
def test_worst_speed_against_a_dense_sweep(
    profile: str, quantity: str, at: str, damping_input: bool
) -> None:
    modes, tracks, limits = craft().modes(0.01), PROFILES[profile], (5 * KNOT, 100 * KNOT)
    tolerance = 1.0 if quantity == "max_acceleration" else 30.0
    damped = {"damping_input": damping_input}
    worst = rm.worst_speed(modes, tracks, limits, quantity, at=at, tolerance=tolerance, **damped)
    # Denser at low speed, where extremes change fastest.
    sweep = rm.sweep(modes, tracks, np.geomspace(*limits, 8_001), **damped)
    alone = rm.sweep(modes, tracks, [worst.speed], **damped)
    sign = -1.0 if quantity == "min_load" else 1.0
    if quantity == "max_acceleration":
        dense, value = sweep.max_acceleration[at], alone.max_acceleration[at][0]
    else:
        gear = modes.aircraft.gear_names.index(at)
        dense, value = getattr(sweep, quantity)[:, gear], getattr(alone, quantity)[0, gear]
    peak = (sign * dense).max()
    assert worst.value == value
    assert limits[0] <= worst.speed <= limits[1]
    assert peak <= sign * worst.bound + 1e-9 * abs(peak)
    assert sign * worst.value <= sign * worst.bound <= sign * worst.value + tolerance
    assert peak <= sign * worst.value + tolerance


@settings(max_examples=15)
@given(
    seed=st.integers(0, 2**32),
    zeta=st.sampled_from([0.0, 0.003, 0.05, 0.5, 1.0, 1.7]),
    low=st.floats(3.0, 60.0),
    width=st.floats(0.0, 40.0),
    damping_input=st.booleans(),
)
def test_no_speed_exceeds_the_bound(
    seed: int, zeta: float, low: float, width: float, damping_input: bool
) -> None:
    random = np.random.default_rng(seed)
    run = random.exponential(60.0, 12)
    run[random.random(12) < 0.2] = 0.0
    profile = rm.Profile(np.cumsum(run) - 100.0, random.normal(0.0, 1.0, 12))
    modes, limits = craft().modes(zeta), (low * KNOT, (low + width) * KNOT)
    speeds = np.sort(random.uniform(*limits, 2000))
    for quantity, gear, sign in (("max_load", 1, 1.0), ("min_load", 0, -1.0)):
        at = modes.aircraft.gear_names[gear]
        damped = {"damping_input": damping_input}
        worst = rm.worst_speed(modes, profile, limits, quantity, at=at, tolerance=200.0, **damped)
        dense = sign * getattr(rm.sweep(modes, profile, speeds, **damped), quantity)[:, gear]
        assert dense.max() <= sign * worst.bound + 1e-6
        assert sign * (worst.bound - worst.value) <= 200.0


def test_worst_speed_of_one_degree_of_freedom() -> None:
    """
    Sharp-edged mat of length L under one undamped spring: known in closed form.

    Each edge sets the body swinging with the height h, the second after the phase ωL/V. Behind
    the mat it swings with 2h |sin(ωL/2V)|, on it with h: the smallest load is least, 2kh below the
    static one, wherever ωL/2V is an odd multiple of π/2.
    """
    omega, height, length = 12.0, 1.5, 540.0
    modes = rm.single_dof(mass=145.5, omega=omega, damping_ratio=0.0)
    stiffness = modes.aircraft.gears[0].stiffness
    static = modes.aircraft.static_load[0]
    mat = rm.Profile.mat(length, height, ramp=0.0)
    at = modes.aircraft.gear_names[0]
    for count in (0, 1, 2, 5):
        resonant = omega * length / (np.pi * (2 * count + 1))
        limits = (0.97 * resonant, 1.05 * resonant)
        worst = rm.worst_speed(modes, mat, limits, "min_load", at=at, tolerance=0.1)
        assert abs(worst.value - (static - 2 * stiffness * height)) <= 0.1
        assert abs(worst.speed / resonant - 1) < 1e-3


def test_a_range_of_one_speed() -> None:
    modes = craft().modes(0.02)
    worst = rm.worst_speed(modes, PROFILES["full mat"], (400.0, 400.0), at="left", tolerance=1e-9)
    assert worst.speed == 400.0
    assert worst.value == worst.bound
    assert worst.value == rm.sweep(modes, PROFILES["full mat"], [400.0]).max_load[0, 1]


@pytest.mark.parametrize(
    ("speeds", "message"),
    [
        ([100.0, np.nan], r"speeds\[1\] = NaN is not finite"),
        ([100.0, 200.0, -3.0], r"speeds\[2\] = -3.0 is not positive"),
        ([1e-200], r"speeds\[0\] = 1e-200 is out of range"),
        ([[1.0]], r"speeds has shape \(1, 1\)"),
        (["fast"], "speeds holds"),
        (-400.0, r"speeds\[0\] = -400.0 is not positive"),
    ],
)
def test_bad_speeds(speeds: object, message: str) -> None:
    with pytest.raises(rm.InputError, match=message):
        rm.sweep(craft().modes(0.02), PROFILES["full mat"], speeds)  # type: ignore[arg-type]


def test_other_bad_input() -> None:
    modes, mat = craft().modes(0.02), PROFILES["full mat"]
    with pytest.raises(rm.InputError, match="modes = "):
        rm.sweep(craft(), mat, [1.0])  # type: ignore[arg-type]
    with pytest.raises(rm.InputError, match=r"tracks\['tail'\]"):
        rm.sweep(modes, {"tail": mat}, [1.0])
    with pytest.raises(rm.InputError, match="damping_input = 1 "):
        rm.sweep(modes, mat, [1.0], damping_input=1)  # type: ignore[arg-type]
    with pytest.raises(rm.InputError, match="damping_input = 1 "):
        rm.worst_speed(modes, mat, (1.0, 2.0), at="nose", tolerance=1.0, damping_input=1)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"speeds": (300.0,)}, r"speeds has shape \(1,\)"),
        ({"speeds": (300.0, 200.0)}, r"speeds = \(300.0, 200.0\): the lowest comes first"),
        ({"speeds": (0.0, 200.0)}, r"speeds\[0\] = 0.0 is not positive"),
        ({"speeds": (300.0, np.inf)}, r"speeds\[1\] = inf is not finite"),
        ({"quantity": "load"}, "quantity = 'load' is none of 'max_load'"),
        ({"at": "pilot"}, r"at = 'pilot': no such gear; there are \('nose', 'left', 'right'\)"),
        ({"quantity": "max_acceleration"}, "at = 'left': no such station"),
        ({"tolerance": 0.0}, "tolerance = 0.0 is not positive"),
        ({"tolerance": np.nan}, "tolerance = NaN is not finite"),
        ({"max_runs": 10}, "max_runs = 10 must be at least 100"),
        ({"max_runs": 200.5}, "max_runs = 200.5 is not a whole number"),
        (
            {"max_runs": 200, "tolerance": 1.0},
            "tolerance = 1.0 takes more runs than max_runs = 200 allows",
        ),
    ],
)
def test_bad_ranges(change: dict[str, object], message: str) -> None:
    given = {"speeds": (100.0, 2000.0), "at": "left", "tolerance": 10.0, **change}
    with pytest.raises(rm.InputError, match=message):
        rm.worst_speed(craft().modes(0.02), PROFILES["full mat"], **given)  # type: ignore[arg-type]


def test_figures() -> None:
    figure = pytest.importorskip("matplotlib.figure").Figure()
    top, bottom = figure.subplots(2, 1)
    knots = np.arange(5.0, 100.0)
    # Drawn in the order of speed, whatever the order of the sweep.
    sweep = rm.sweep(craft().modes(0.02), PROFILES["full mat"], KNOT * knots[::-1])
    units = Units("in", "lbf")
    assert sweep.plot(["left"], ax=top, units=units) is top
    assert sweep.plot_acceleration(["pilot"], ax=bottom, units=units) is bottom
    high, low, static = (line.get_ydata() for line in top.lines[:3])
    assert (high == sweep.max_load[::-1, 1] / 1e3).all()
    assert (low == sweep.min_load[::-1, 1] / 1e3).all()
    assert static[0] == sweep.static_load[1] / 1e3
    assert top.get_ylabel() == "largest and smallest load [kip]"
    curve, limit = bottom.lines[:2]
    assert np.allclose(curve.get_xdata(), knots)
    assert (
        curve.get_ydata() == sweep.max_acceleration["pilot"][::-1] / units.standard_gravity
    ).all()
    assert limit.get_ydata()[0] == 0.4
    assert bottom.get_ylim()[0] == 0.0
    assert bottom.get_ylim()[1] >= 0.4
    with pytest.raises(rm.InputError, match=r"gears\[1\] = 'tail'"):
        sweep.plot(["left", "tail"], ax=top)
    with pytest.raises(rm.InputError, match=r"stations\[0\] = 'tail'"):
        sweep.plot_acceleration(["tail"], ax=bottom)
