"""`simulate_many` against `simulate` run by run, quadrature, and itself in other batches."""

import os
import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.stats import binom

import runway_modal as rm
from ctrl_c import ctrl_c

#: Relative to the largest load or acceleration.
TOLERANCE = 1e-10

MODES = rm.f4e().modes(0.01)


def craft(random: np.random.Generator, gears: int) -> rm.Aircraft:
    """Crooked aircraft; of three gears and more two may stand side by side."""
    number = np.arange(gears)
    x = np.where(number % 2, random.uniform(0.0, 210.0, gears), -40.0)
    y = 90.0 * number if gears > 2 else np.zeros(gears)
    stiffness = random.uniform(1500.0, 9000.0, gears)
    # The centre of gravity where all are pressed in alike: none pulls at rest.
    x, y = (arm - np.average(arm, weights=stiffness) if gears > 1 else [0.0] for arm in (x, y))
    return rm.Aircraft(
        mass=145.5,
        pitch_inertia=1.92e6,
        roll_inertia=6.56e5,
        gears=[rm.Gear(f"g{i}", x[i], y[i], stiffness[i], random.uniform(0, 100)) for i in number],
        stations={"pilot": (250.0, 10.0)},
    )


def one_by_one(
    modes: rm.Modes, elevations: NDArray[np.float64], spacing: float, speed: float, damped: bool
) -> rm.Response:
    """The same run by `simulate`, from t = 0 until the last gear passes the last station."""
    gears = modes.aircraft.gears
    x = spacing * np.arange(elevations.shape[-1])
    each = [rm.Profile(x, row.astype(float)) for row in elevations]
    tracks = each * len(gears) if len(each) == 1 else each
    lag = max(g.x for g in gears) - min(g.x for g in gears)
    return rm.simulate(
        modes,
        each[0] if len(each) == 1 else dict(zip(modes.aircraft.gear_names, tracks, strict=True)),
        speed,
        times=[0.0, (x[-1] + lag) / speed],
        damping_input=damped,
    )


def mean_squares(response: rm.Response, spacing: float, stations: int, speed: float):
    """RMS of dynamic loads and accelerations by Gauss's rule between knots, at most a radian."""
    gears = response.modes.aircraft.gears
    front = max(g.x for g in gears)
    knots = np.unique([(spacing * np.arange(stations) + front - g.x) / speed for g in gears])
    knots = knots[np.concatenate(([True], np.diff(knots) > 1e-12 * knots[-1]))]
    stiffest = (response.modes.omega * np.maximum(1.0, 2.0 * response.modes.damping_ratio)).max()
    edges = [np.linspace(a, b, 2 + int((b - a) * stiffest))[:-1] for a, b in pairwise(knots)]
    edges = np.concatenate([*edges, knots[-1:]])
    nodes, weights = np.polynomial.legendre.leggauss(12)
    middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
    at = response.at((middle[:, None] + half[:, None] * nodes).ravel())
    weights = (half[:, None] * weights).ravel() / knots[-1]
    loads = np.sqrt(weights @ (at.load - response.static_load) ** 2)
    return loads, {name: np.sqrt(weights @ a**2) for name, a in at.acceleration.items()}


@given(
    seed=st.integers(0, 2**32 - 1),
    gears=st.integers(1, 5),
    single=st.booleans(),
    stations=st.sampled_from([1, 2, 3, 31, 64, 150, 400]),
    spacing=st.sampled_from([2.0, 10.0, 37.3, 400.0]),
    speed=st.sampled_from([90.0, 405.0744, 3000.0]),
    ratio=st.sampled_from([0.0, 0.01, 1.0, 3.0]),
    damped=st.booleans(),
    kind=st.sampled_from(["own", "own", "measured", "few", "corrected"]),
)
def test_is_simulate(seed, gears, single, stations, spacing, speed, ratio, damped, kind):
    random = np.random.default_rng(seed)
    aircraft = craft(random, gears)
    modes = aircraft.modes(ratio)
    if kind == "measured":
        modes = rm.Modes(aircraft, 1.1 * modes.omega, modes.damping_ratio, modes.shapes)
    elif kind in ("few", "corrected"):
        first = (modes.omega[:1], modes.damping_ratio[:1], modes.shapes[:, :1])
        modes = rm.Modes(aircraft, *first, static_correction=kind == "corrected")
    runs = int(random.integers(1, 11))
    elevations = random.normal(size=(runs, 1 if single else gears, stations)) + 40.0
    found = rm.simulate_many(modes, elevations, spacing, speed, damping_input=damped)
    for run in range(runs):
        expected = one_by_one(modes, elevations[run], spacing, speed, damped).extremes()
        scale = max(abs(expected.max_load).max(), abs(expected.min_load).max())
        assert abs(found.max_load[run] - expected.max_load).max() <= TOLERANCE * scale
        assert abs(found.min_load[run] - expected.min_load).max() <= TOLERANCE * scale
        for name, size in expected.max_acceleration.items():
            assert abs(found.max_acceleration[name][run] - size) <= TOLERANCE * max(
                expected.max_acceleration.values()
            )
    if stations > 1:
        response = one_by_one(modes, elevations[0], spacing, speed, damped)
        loads, accelerations = mean_squares(response, spacing, stations, speed)
        assert abs(found.rms_load[0] - loads).max() <= TOLERANCE * loads.max()
        for name, rms in accelerations.items():
            assert abs(found.rms_acceleration[name][0] - rms) <= TOLERANCE * max(
                accelerations.values()
            )


def runways(runs: int, tracks: int = 3, stations: int = 400) -> NDArray[np.float64]:
    return np.cumsum(np.random.default_rng(7).normal(0.0, 0.3, (runs, tracks, stations)), axis=2)


def bits(ensemble: rm.Ensemble) -> NDArray[np.float64]:
    parts = (ensemble.max_load, ensemble.min_load, ensemble.rms_load)
    accelerations = (ensemble.max_acceleration, ensemble.rms_acceleration)
    return np.column_stack([*parts, *(row for each in accelerations for row in each.values())])


@pytest.mark.parametrize("damped", [False, True])
def test_alone_as_in_any_batch(damped):
    elevations, speeds = runways(21), np.linspace(300.0, 900.0, 21)
    modes = [rm.f4e().modes(ratio) for ratio in np.linspace(0.0, 0.1, 21)]
    # Another wheelbase among them: its stations fall elsewhere.
    gears = [rm.Gear(g.name, g.x * 1.01, g.y, g.stiffness) for g in rm.f4e().gears]
    modes[4] = rm.Aircraft(
        mass=145.5, pitch_inertia=1.92e6, roll_inertia=6.56e5, gears=gears
    ).modes(0.02)
    together = bits(rm.simulate_many(modes, elevations, 10.0, speeds, damping_input=damped))
    for run in range(21):
        alone = rm.simulate_many(
            modes[run], elevations[run : run + 1], 10.0, speeds[run], damping_input=damped
        )
        assert (bits(alone) == together[run]).all()
    alike = rm.simulate_many(modes[0], elevations, 10.0, 500.0, damping_input=damped)
    some = rm.simulate_many(modes[0], elevations[3:16], 10.0, 500.0, damping_input=damped)
    assert (bits(some) == bits(alike)[3:16]).all()


@pytest.mark.parametrize(
    ("ratios", "spacing", "speed"),
    [
        # Billions of cycles a segment, of which all but the first hundreds are over.
        (0.01, 12.0, 1e-7),
        # Thousands of legs on which the load creeps to its record.
        ([1e3, 0.3, 0.3], 0.0107, 3.63),
    ],
)
def test_of_long_stretches_only_what_can_tell_is_searched(ratios, spacing, speed):
    modes = rm.f4e().modes(ratios)
    elevations = np.random.default_rng(1).normal(size=(1, 1, 8))
    found = rm.simulate_many(modes, elevations, spacing, speed)
    expected = one_by_one(modes, elevations[0], spacing, speed, False).extremes()
    np.testing.assert_allclose(found.max_load[0], expected.max_load, rtol=TOLERANCE)
    np.testing.assert_allclose(found.min_load[0], expected.min_load, rtol=TOLERANCE)


def test_every_wave_brings_the_record_once_more():
    # In resonance, sixteen stations per wave: all waves peak alike between stations, but for a
    # decrease that bounds do not tell. The record stands early, in what is gone over long before
    # the end.
    modes, x = rm.f4e().modes(0.02), 10.0 * np.arange(20_000)
    speed = modes.omega[1] * 160.0 / (2.0 * np.pi)
    wave = np.sin(2.0 * np.pi / 160.0 * x) * (1.0 - 2.5e-9 * x)
    elevations = np.stack([np.stack([wave] * 3), *runways(3, stations=x.size)])
    found = rm.simulate_many(modes, elevations, 10.0, speed)
    alone = rm.simulate_many(modes, elevations[:1], 10.0, speed)
    assert (bits(alone) == bits(found)[:1]).all()
    expected = one_by_one(modes, elevations[0], 10.0, speed, False).extremes()
    assert expected.time_of_max[1:].max() < 0.4 * x[-1] / speed  # of the main gears
    scale = expected.max_load.max()
    assert abs(found.max_load[0] - expected.max_load).max() <= TOLERANCE * scale
    assert abs(found.min_load[0] - expected.min_load).max() <= TOLERANCE * scale


def test_any_number_of_threads():
    program = (
        "import sys; sys.path.insert(0, 'tests')\n"
        "from test_ensemble import *\n"
        "print(bits(rm.simulate_many(MODES, runways(100), 10.0, 500.0)).tobytes().hex())"
    )
    outputs = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "RAYON_NUM_THREADS": threads},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for threads in ("1", "2", "3")
    }
    assert len(outputs) == 1


def test_single_precision_is_read_as_it_is():
    single = runways(9).astype(np.float32)
    found = rm.simulate_many(MODES, single, 10.0, 500.0)
    assert (bits(found) == bits(rm.simulate_many(MODES, single.astype(float), 10.0, 500.0))).all()


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_elevations_anywhere_in_memory(kind):
    given = runways(3).astype(kind)
    crooked = np.frombuffer(b"." + given.tobytes(), kind, offset=1).reshape(given.shape)
    assert not crooked.flags.aligned
    found = [rm.simulate_many(MODES, each, 10.0, 500.0) for each in (given, crooked)]
    assert (bits(found[0]) == bits(found[1])).all()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("station", [0, 12, 99])
def test_bad_elevations_are_named_and_masked(bad, station):
    elevations = runways(20, 1)
    good = bits(rm.simulate_many(MODES, elevations, 10.0, 500.0))
    elevations[13, 0, station] = bad
    before = elevations.copy()
    with pytest.raises(rm.InputError, match=rf"^elevations\[13, 0, {station}\] = (NaN|-?inf) is"):
        rm.simulate_many(MODES, elevations, 10.0, 500.0)
    masked = rm.simulate_many(MODES, elevations, 10.0, 500.0, on_error="mask", first_run=100)
    assert list(masked.failures) == [113]
    assert f"elevations[13, 0, {station}]" in masked.failures[113]
    assert masked.valid.sum() == 19
    assert not masked.valid[13]
    assert np.isnan(bits(masked)[13]).all()
    assert (bits(masked)[masked.valid] == good[masked.valid]).all()
    assert 113 not in masked.worst("nose", 20)
    np.testing.assert_array_equal(elevations, before)


def test_runs_that_overflow_are_named_and_masked():
    """Forces whose squares are at the end of double precision."""
    modes = rm.single_dof(mass=1e99, omega=9500.0, damping_ratio=0.01)
    elevations = 1e47 * runways(20, 1)
    with pytest.raises(rm.NumericalError, match=r"^elevations\[\d+\]: a result left the range"):
        rm.simulate_many(modes, elevations, 10.0, 475_000.0)
    masked = rm.simulate_many(modes, elevations, 10.0, 475_000.0, on_error="mask", first_run=100)
    assert 0 < len(masked.failures) < 20
    assert list(masked.failures) == masked.run[~masked.valid].tolist()
    assert np.isnan(bits(masked)[~masked.valid]).all()
    assert np.isfinite(bits(masked)[masked.valid]).all()


def test_one_bad_station_is_found():
    elevations = runways(3, 3, 1)
    elevations[1, 2, 0] = np.nan
    with pytest.raises(rm.InputError, match=r"^elevations\[1, 2, 0\] = NaN"):
        rm.simulate_many(MODES, elevations, 10.0, 500.0)


def test_lag_beyond_the_runway():
    """The mains are still to come when the nose has left."""
    elevations = runways(3, 1, 5)
    found = rm.simulate_many(MODES, elevations, 0.5, 40.0)
    for run in range(3):
        expected = one_by_one(MODES, elevations[run], 0.5, 40.0, False).extremes()
        np.testing.assert_allclose(found.max_load[run], expected.max_load, rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"elevations": np.zeros((2, 2, 5))}, "one for all gears, or one per gear"),
        ({"elevations": np.zeros((2, 5))}, r"elevations has shape \(2, 5\)"),
        ({"elevations": np.zeros((0, 1, 5))}, r"elevations has shape \(0, 1, 5\)"),
        ({"elevations": [[["a"]]]}, "elevations holds"),
        ({"spacing": 0.0}, "spacing = 0.0 is not positive"),
        ({"spacing": np.nan}, "spacing = NaN"),
        ({"speed": [1.0, -2.0]}, r"speed\[1\] = -2.0 is not positive"),
        ({"speed": [1.0, 1e-12], "on_error": "mask"}, r"speed\[1\] = 1e-12 is out of range"),
        ({"speed": [1.0, 2.0, 3.0]}, "speed has 3 entries, 2 expected"),
        ({"modes": [MODES]}, "modes has 1 entry, 2 expected"),
        ({"modes": [MODES, 3]}, r"modes\[1\] = 3 is not a Modes"),
        ({"modes": [MODES, rm.single_dof(mass=1, omega=1, damping_ratio=0)]}, r"modes\[1\]: gear"),
        ({"on_error": "ignore"}, "on_error = 'ignore'"),
        ({"first_run": -1}, "first_run = -1 must be at least 0"),
        ({"first_run": 2**63 - 1}, "first_run = 9223372036854775807 must be at least 0 and below"),
        ({"first_run": "7"}, "first_run = '7' is not a whole number"),
        ({"damping_input": 1}, "damping_input = 1"),
        ({"elevations": np.eye(5)[None, :1] * 1e200}, r"elevations\[0, 0, 0\] = 1e200 is out of"),
    ],
)
def test_input_is_checked(change, message):
    arguments = {"modes": MODES, "elevations": np.zeros((2, 1, 5)), "spacing": 1.0, "speed": 1.0}
    with pytest.raises(rm.InputError, match=message):
        rm.simulate_many(**(arguments | change))


def test_merge():
    elevations = runways(30)
    whole = rm.simulate_many(MODES, elevations, 10.0, 500.0)
    first = rm.simulate_many(MODES, elevations[:11], 10.0, 500.0)
    second = rm.simulate_many(MODES, elevations[11:], 10.0, 500.0, first_run=11)
    merged = second.merge(first)
    assert (merged.run == whole.run).all()
    assert (bits(merged) == bits(whole)).all()
    assert not merged.max_load.flags.writeable
    with pytest.raises(rm.InputError, match="run 0 is in both"):
        first.merge(whole)
    with pytest.raises(rm.InputError, match=r"spacing is 10.0 here and 11.0 there"):
        first.merge(rm.simulate_many(MODES, elevations[11:], 11.0, 500.0, first_run=11))
    other = rm.f4e().modes(0.02)
    with pytest.raises(rm.InputError, match=r"damping_ratio\[0\] is"):
        second.merge(rm.simulate_many(other, elevations[:11], 10.0, 500.0))


@pytest.mark.parametrize(("runs", "probability"), [(10, 0.5), (500, 0.9), (500, 0.999), (80, 0.02)])
def test_quantile_intervals_are_the_binomial_ones(runs, probability):
    found = rm.simulate_many(MODES, runways(runs, 1, 20), 10.0, 500.0)
    estimate = found.quantile("max_load", probability, confidence=0.9)
    ordered = np.concatenate(([-np.inf], np.sort(found.max_load[:, 0]), [np.inf]))
    lower = int(np.flatnonzero(ordered == estimate.low[0, 0])[-1])
    upper = int(np.flatnonzero(ordered == estimate.high[0, 0])[0])
    # Rank r covers if P(B < r) ≤ 5 %, and the next one would not.
    assert binom.cdf(lower - 1, runs, probability) <= 0.05 < binom.cdf(lower, runs, probability)
    assert binom.sf(upper - 1, runs, probability) <= 0.05 < binom.sf(upper - 2, runs, probability)
    np.testing.assert_allclose(
        estimate.value[0], np.quantile(found.max_load, probability, axis=0), rtol=1e-14
    )


def test_exceedance_interval_is_the_binomial_one():
    found = rm.simulate_many(MODES, runways(200, 1, 20), 10.0, 500.0)
    level = np.sort(found.max_load[:, 1])[189]
    estimate = found.exceedance("max_load", [level, 1e9])
    assert estimate.value[0, 1] == 10 / 200
    # At the ends 10 runs or more, and 10 or fewer, have a probability of 2.5 %.
    assert binom.sf(9, 200, estimate.low[0, 1]) == pytest.approx(0.025, rel=1e-9)
    assert binom.cdf(10, 200, estimate.high[0, 1]) == pytest.approx(0.025, rel=1e-9)
    assert (estimate.value[1] == 0.0).all()
    assert (estimate.low[1] == 0.0).all()
    assert (1.0 - estimate.high[1]) ** 200 == pytest.approx(0.025, rel=1e-9)


def test_a_quantile_beyond_the_largest_run_is_that_run():
    """Of few runs the interval begins there; an interpolation would lie below it."""
    found = rm.simulate_many(MODES, runways(20, 1, 20), 10.0, 500.0)
    estimate = found.quantile("max_load", 0.999)
    assert (estimate.low == found.max_load.max(axis=0)).all()
    assert (estimate.value == estimate.low).all()
    downward = found.quantile("min_load", 0.001)
    assert (downward.value == downward.high).all()


def test_worst_and_unloaded_and_table():
    found = rm.simulate_many(MODES, 20.0 * runways(40, 1, 60), 10.0, 500.0, first_run=7)
    worst = found.worst("left", 3)
    order = np.sort(found.max_load[:, 1])[::-1]
    np.testing.assert_array_equal(found.max_load[worst - 7, 1], order[:3])
    assert (found.unloaded == (found.min_load <= 0)).all()
    assert found.unloaded.any()
    table = found.to_pandas()
    np.testing.assert_array_equal(table.loc[worst[0], "max_load_left"], order[0])
    assert table.index[0] == 7
    with pytest.raises(rm.InputError, match="no such gear"):
        found.worst("tail")
    with pytest.raises(rm.InputError, match=r"at = 'nose': no such station.*; 'nose' is a gear"):
        found.worst("nose", quantity="max_acceleration")
    lowest = found.worst("left", 2, quantity="min_load")
    assert found.min_load[lowest[0] - 7, 1] == found.min_load[:, 1].min()
    loudest = found.worst("cg", 1, quantity="rms_acceleration")
    assert found.rms_acceleration["cg"].argmax() == loudest[0] - 7
    with pytest.raises(rm.InputError, match="is none of"):
        found.quantile("load", 0.5)
    with pytest.raises(rm.InputError, match=r"probability\[1\] = 1.0"):
        found.quantile("max_load", [0.5, 1.0])


def test_ctrl_c_in_a_search_without_end() -> None:
    # A segment of billions of undamped cycles: every one may hold the largest load.
    modes = rm.single_dof(mass=1.0, omega=1e3, damping_ratio=0.0)
    with ctrl_c(after=0.3):
        rm.simulate_many(modes, runways(1, 1, 40), 5.0, 1e-5)


def test_beyond_is_below_for_smallest_loads():
    found = rm.simulate_many(MODES, runways(200, 1, 20), 10.0, 500.0)
    level = np.sort(found.min_load[:, 1])[9]
    below, above = (found.exceedance(q, level) for q in ("min_load", "max_load"))
    assert below.value[0, 1] == pytest.approx(10 / 200, rel=1e-12)
    assert below.low[0, 1] < 10 / 200 < below.high[0, 1]
    assert above.value[0, 1] == 1.0


def test_nothing_asked_and_too_much():
    found = rm.simulate_many(MODES, runways(20, 1, 20), 10.0, 500.0)
    for estimate in (found.quantile("max_load", []), found.exceedance("max_load", [])):
        assert estimate.value.shape == estimate.low.shape == estimate.high.shape == (0, 3)
    with pytest.raises(rm.InputError, match=r"probability has shape \(1, 1\)"):
        found.quantile("max_load", [[0.5]])
    with pytest.raises(rm.InputError, match="count = -1 must be at least 0"):
        found.worst("nose", -1)


def test_without_dampers_their_input_changes_nothing():
    modes, elevations = rm.f4e().modes(0.02), runways(9)
    plain, asked = (
        rm.simulate_many(modes, elevations, 10.0, 500.0, damping_input=flag)
        for flag in (False, True)
    )
    np.testing.assert_array_equal(bits(plain), bits(asked))


def test_a_search_that_overflows_ends():
    """Elevations whose loads are in range, but not the squares of what bounds them."""
    gears = [rm.Gear("front", 1.7, 0.0, 1.3e5, 8e3), rm.Gear("rear", -0.3, 0.0, 2.7e5, 1e4)]
    aircraft = rm.Aircraft(
        mass=1.5e4, pitch_inertia=5.7e5, roll_inertia=1.9e6, gravity=9.8, gears=gears
    )
    for size in (1e149, 1e150, 1e151, 1e153):
        elevations = np.zeros((2, 2, 129))
        elevations[1, 1, 72] = size
        found = rm.simulate_many(
            aircraft.modes(0.3), elevations, 0.035, 1.0, damping_input=True, on_error="mask"
        )
        assert found.valid[0]
        assert np.isfinite(found.max_load[found.valid]).all()


def test_a_level_runway_has_no_rms():
    """The root of a sum's rounding would be 1e-8 of what was added up."""
    modes = rm.f4e().modes(0.01)
    own = rm.Modes(modes.aircraft, 1.1 * modes.omega[:2], 0.01, modes.shapes[:, :2])
    for heights in np.random.default_rng(3).normal(scale=3.0, size=(20, 3)):
        found = rm.simulate_many(own, heights[None, :, None], 10.0, 500.0)
        assert (found.rms_load <= abs(found.max_load - found.static_load)).all()


def test_what_the_caller_changes_later_changes_nothing() -> None:
    speed = np.full(3, rm.knots(60))
    surface = rm.Roughness.iso8608("B", unit="in")
    modes, elevations = rm.f4e().modes(0.01), np.random.default_rng(1).normal(size=(3, 1, 50))
    runway = {"length": 2400.0, "spacing": 12.0, "seed": 1, "runs": 3}
    found = [
        rm.simulate_many(modes, elevations, 12.0, speed),
        rm.monte_carlo(modes, surface, speed=speed, **runway),
    ]
    speed[:] = 1.0
    for ensemble in found:
        assert (ensemble.speed == rm.knots(60)).all()
