"""Laws that hold for every run, on random runs."""

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import NDArray

import runway_modal as rm
from runway_modal._tracks import by_gear

QUANTITIES = ("load", "cg", "cg_rate", "cg_acceleration", "gear_displacement")

RATIOS = st.sampled_from([0.0, 1e-6, 0.01, 0.3, 1 - 1e-9, 1.0, 1 + 1e-9, 2.0])
SPEEDS = st.floats(40.0, 4000.0)
SEEDS = st.integers(0, 10**6)


def craft(damping: float = 0.0, gears: int = 3) -> rm.Aircraft:
    """Crooked aircraft without symmetry, of three to five gears."""
    places = [
        (210.0, 13.0, 1700.0), (-37.0, 101.0, 8800.0), (-52.0, -117.0, 7300.0),
        (5.0, 40.0, 3000.0), (-110.0, -20.0, 2500.0),
    ]  # fmt: skip
    return rm.Aircraft(
        mass=145.5,
        pitch_inertia=1.92e6,
        roll_inertia=6.56e5,
        gears=[rm.Gear("abcde"[i], *place, damping) for i, place in enumerate(places[:gears])],
    )


def rough(seed: int, points: int = 12, steps: bool = True) -> rm.Profile:
    """Random profile from 0 to 0, with vertical steps."""
    random = np.random.default_rng(seed)
    run = random.exponential(30.0, points)
    if steps:
        run[::4] = 0.0
    z = random.normal(0.0, 1.0, points)
    z[[0, -1]] = 0.0
    return rm.Profile(np.cumsum(run), z)


def dynamic(response: rm.Response, quantity: str) -> NDArray[np.float64]:
    """Part of a quantity that the runway causes."""
    values: NDArray[np.float64] = getattr(response, quantity)
    return values - response.static_load if quantity == "load" else values


def away_from_steps(response: rm.Response, knots: NDArray[np.float64]) -> NDArray[np.float64]:
    """Times within the run that no rounding carries across a knot."""
    times = np.linspace(response.time[0], response.time[-1], 301)
    gap = abs(times[:, None] - knots[None, :]).min(axis=1)
    return times[gap > 1e-9]


def assert_close(a: NDArray[np.float64], b: NDArray[np.float64], share: float) -> None:
    """Columns agree within a share of each column's peak."""
    peak = np.maximum(abs(a), abs(b)).max(axis=0)
    assert (abs(a - b) <= share * peak + 1e-300).all()


@given(seed=SEEDS, ratio=RATIOS, speed=SPEEDS, damping_input=st.booleans(), gears=st.integers(3, 5))
def test_profiles_add_up(
    seed: int, ratio: float, speed: float, damping_input: bool, gears: int
) -> None:
    modes = craft(60.0, gears).modes(ratio)
    one, two = rough(seed), rough(seed + 1).shifted(17.0)
    options: dict[str, Any] = {
        "times": np.linspace(0, 600 / speed, 200),
        "damping_input": damping_input,
    }
    a, b, both = (rm.simulate(modes, p, speed, **options) for p in (one, two, one + two))
    for quantity in QUANTITIES:
        parts = dynamic(a, quantity), dynamic(b, quantity)
        peak = max(abs(parts[0]).max(), abs(parts[1]).max())
        error = abs(sum(parts) - dynamic(both, quantity)).max()
        assert error <= 1e-12 * peak


@given(seed=SEEDS, ratio=RATIOS, speed=SPEEDS, damping_input=st.booleans(), gears=st.integers(3, 5))
def test_tracks_add_up(
    seed: int, ratio: float, speed: float, damping_input: bool, gears: int
) -> None:
    modes = craft(60.0, gears).modes(ratio)
    profile = rough(seed)
    options: dict[str, Any] = {
        "times": np.linspace(0, 600 / speed, 200),
        "damping_input": damping_input,
    }
    whole = rm.simulate(modes, profile, speed, **options)
    single = [
        rm.simulate(modes, {name: profile}, speed, **options) for name in modes.aircraft.gear_names
    ]
    for quantity in QUANTITIES:
        parts = [dynamic(part, quantity) for part in single]
        peak = max(abs(part).max() for part in parts)
        assert abs(sum(parts) - dynamic(whole, quantity)).max() <= 1e-12 * peak


@given(
    ratio=RATIOS,
    speed=SPEEDS,
    damping_input=st.booleans(),
    where=st.lists(st.integers(1, 255), min_size=1, max_size=9, unique=True),
)
def test_a_segment_split_anywhere_changes_nothing(
    ratio: float, speed: float, damping_input: bool, where: list[int]
) -> None:
    # Slopes of whole powers of two: a cut at any whole station lies exactly on the line.
    x = np.array([0.0, 64.0, 64.0, 192.0, 256.0])
    z = np.array([0.0, 2.0, 1.0, 1.0, 3.0])
    profile = rm.Profile(x, z)
    cuts = np.setdiff1d(np.array(where, dtype=float), x)
    assume(cuts.size > 0)
    order = np.argsort(np.concatenate([x, cuts]), kind="stable")
    split = rm.Profile(
        np.concatenate([x, cuts])[order], np.concatenate([z, profile.elevation(cuts)])[order]
    )
    modes = craft(60.0).modes(ratio)
    options: dict[str, Any] = {"damping_input": damping_input}
    a = rm.simulate(modes, profile, speed, times=np.linspace(0, 900 / speed, 200), **options)
    b = rm.simulate(modes, split, speed, times=a.time, **options)
    for quantity in QUANTITIES:
        assert_close(getattr(a, quantity), getattr(b, quantity), 1e-13)
    for key in ("max_load", "min_load"):
        ours, theirs = getattr(a.extremes(), key), getattr(b.extremes(), key)
        np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-13 * abs(a.load).max())


@given(ratio=RATIOS, speed=SPEEDS, damping_input=st.booleans(), height=st.floats(-3.0, 3.0))
def test_a_step_is_the_limit_of_a_steep_ramp(
    ratio: float, speed: float, damping_input: bool, height: float
) -> None:
    assume(abs(height) > 0.01)
    modes = craft(60.0).modes(ratio)
    width = 1e-7
    step, ramp = (rm.Profile([50.0, 50.0 + w], [0.0, height]) for w in (0.0, width))
    # Away from the ramps themselves, on which a damper's load is without bound.
    times = (np.array([50.0, 297.0, 312.0])[:, None] + [1.0, 2.0, 9.0]).ravel() / speed
    options: dict[str, Any] = {"times": times, "damping_input": damping_input}
    a, b = (rm.simulate(modes, profile, speed, **options) for profile in (step, ramp))
    # With a damper the blow, too: it is the height times the damping, whatever the width.
    rate = modes.omega.max() * (1 + 4 * ratio) * width / speed
    for quantity in QUANTITIES:
        assert_close(dynamic(a, quantity), dynamic(b, quantity), 20 * rate + 1e-11)


@given(seed=SEEDS, ratio=RATIOS, speed=SPEEDS, damping_input=st.booleans())
def test_mirror(seed: int, ratio: float, speed: float, damping_input: bool) -> None:
    here = craft(60.0)
    there = rm.Aircraft(
        mass=here.mass,
        pitch_inertia=here.pitch_inertia,
        roll_inertia=here.roll_inertia,
        gears=[rm.Gear(g.name, g.x, -g.y, g.stiffness, g.damping) for g in here.gears],
    )
    tracks = {"a": rough(seed), "b": rough(seed + 1), "c": rough(seed + 2)}
    options: dict[str, Any] = {
        "times": np.linspace(0, 600 / speed, 200),
        "damping_input": damping_input,
    }
    a, b = (rm.simulate(c.modes(ratio), tracks, speed, **options) for c in (here, there))
    for quantity in ("load", "gear_displacement"):
        assert_close(getattr(a, quantity), getattr(b, quantity), 1e-12)
    turned = np.array([1.0, 1.0, -1.0])
    for quantity in ("cg", "cg_rate", "cg_acceleration"):
        assert_close(getattr(a, quantity) * turned, getattr(b, quantity), 1e-12)


@given(
    height=st.sampled_from([0.0, 1.0, -7.3, 1e5, -1e5, 123456.789, 1e9]),
    ratio=RATIOS,
    speed=SPEEDS,
    gears=st.integers(3, 5),
    points=st.integers(1, 5),
    damping_input=st.booleans(),
)
def test_level_runway_gives_static_loads(
    height: float, ratio: float, speed: float, gears: int, points: int, damping_input: bool
) -> None:
    modes = craft(60.0, gears).modes(ratio)
    level = rm.Profile(np.linspace(0, 400, points), np.full(points, height))
    response = rm.simulate(modes, level, speed, duration=600 / speed, damping_input=damping_input)
    two_bits = 2 * np.spacing(response.static_load)
    assert (abs(response.load - response.static_load) <= two_bits).all()
    assert (abs(response.extremes().max_load - response.static_load) <= two_bits).all()
    assert not response.cg_rate.any()
    assert not response.cg_acceleration.any()
    np.testing.assert_allclose(
        response.gear_displacement, height, rtol=1e-12 if gears == 3 else 1e-11
    )


@given(seed=SEEDS, ratio=RATIOS, gears=st.integers(3, 5))
def test_unforced_energy_never_grows(seed: int, ratio: float, gears: int) -> None:
    modes = craft(0.0, gears).modes(ratio)
    profile = rough(seed)
    speed = 800.0
    after = (profile.x[-1] + 320.0 + 1.0) / speed
    response = rm.simulate(modes, profile, speed, times=np.linspace(after, after + 30.0, 3001))
    energy = response.modal_rate**2 + (modes.omega * response.modal) ** 2
    # Each row is marched from the last knot anew: rounding is a few ulps of the start.
    growth = np.diff(energy, axis=0).max(axis=0)
    assert (growth <= 4e-15 * np.ptp(modes.omega) * 30.0 * energy[0] + 1e-300).all()
    if ratio == 0.0:
        np.testing.assert_allclose(energy / energy[0], 1.0, rtol=0, atol=1e-12)


@given(
    slope=st.floats(-0.05, 0.05).filter(lambda s: abs(s) > 1e-6),
    ratio=st.sampled_from([0.05, 0.3, 1.0, 2.0]),
    speed=st.floats(40.0, 1000.0),
    gears=st.integers(3, 5),
    base=st.sampled_from([0.0, 1e4]),
)
def test_a_constant_slope_ends_in_its_static_limit(
    slope: float, ratio: float, speed: float, gears: int, base: float
) -> None:
    modes = craft(0.0, gears).modes(ratio)
    long = speed * 200.0
    profile = rm.Profile([0.0, long], [base, base + slope * long])
    response = rm.simulate(modes, profile, speed, times=[190.0])
    # Steadily climbing; without the dampers' input, each mode hangs back by 2ζ/ω of its rate,
    # and that stretches the springs.
    rate = modes.shapes.T @ (modes.aircraft.mass_matrix @ [slope * speed, 0.0, 0.0])
    np.testing.assert_allclose(response.modal_rate[0], rate, rtol=1e-9, atol=1e-9 * abs(rate).max())
    np.testing.assert_allclose(
        response.cg_acceleration[0], 0.0, atol=1e-8 * abs(slope) * speed * modes.omega.max()
    )
    back = modes.shapes @ (2 * ratio / modes.omega * rate)
    stiffness = np.array([gear.stiffness for gear in modes.aircraft.gears])
    load = response.static_load + stiffness * (modes.aircraft.geometry @ back)
    tolerance = 1e-8 * abs(response.static_load).max() + 1e-12 * base * stiffness.max()
    np.testing.assert_allclose(response.load[0], load, rtol=0, atol=tolerance)


@given(
    seed=SEEDS, ratio=RATIOS, speed=SPEEDS, dx=st.sampled_from([-512.0, 0.25, 64.0, 4096.0]),
    damping_input=st.booleans(),
)  # fmt: skip
def test_a_shifted_profile_comes_later(
    seed: int, ratio: float, speed: float, dx: float, damping_input: bool
) -> None:
    modes = craft(60.0).modes(ratio)
    first = rough(seed)
    # Stations that stay exact when shifted.
    profile = rm.Profile(np.round(first.x * 16) / 16, first.z)
    here = rm.simulate(modes, profile, speed, damping_input=damping_input, duration=600 / speed)
    knots = ((profile.x[:, None] + 210.0 - np.array([210.0, -37.0, -52.0])) / speed).ravel()
    times = away_from_steps(here, knots)
    a = here.at(times)
    b = rm.simulate(
        modes, profile.shifted(dx), speed, times=times + dx / speed, damping_input=damping_input
    )
    for quantity in QUANTITIES:
        values = getattr(a, quantity)
        # Times that differ by dx / speed round: the signal moves that much.
        slack = 1e-12 + 4e-16 * (abs(dx) / speed + 600 / speed) * modes.omega.max()
        assert abs(values - getattr(b, quantity)).max() <= 10 * slack * abs(values).max()


@given(
    seed=SEEDS, ratio=RATIOS, speed=SPEEDS, power=st.integers(-40, 40), damping_input=st.booleans()
)
def test_scaling_the_runway_scales_the_response(
    seed: int, ratio: float, speed: float, power: int, damping_input: bool
) -> None:
    modes = craft(60.0).modes(ratio)
    profile = rough(seed)
    scale = 2.0**power
    options: dict[str, Any] = {
        "times": np.linspace(0, 600 / speed, 100),
        "damping_input": damping_input,
    }
    a = rm.simulate(modes, profile, speed, **options)
    b = rm.simulate(modes, rm.Profile(profile.x, scale * profile.z), speed, **options)
    # A power of two scales every term without rounding.
    for quantity in ("cg", "cg_rate", "cg_acceleration", "gear_displacement"):
        np.testing.assert_array_equal(scale * getattr(a, quantity), getattr(b, quantity))


@given(
    seed=SEEDS,
    spacing=st.sampled_from([1.0, 0.5, 0.25]),
    points=st.tuples(*[st.integers(2, 700)] * 3),
    starts=st.tuples(*[st.integers(-300, 300)] * 3),
    aside=st.sampled_from([0.0, 0.5]),
    damping_input=st.booleans(),
)
def test_knots_met_together_are_as_good_as_merged(
    seed: int,
    spacing: float,
    points: tuple[int, int, int],
    starts: tuple[int, int, int],
    aside: float,
    damping_input: bool,
) -> None:
    # Every gear meets its knots where the foremost does, on one grid, or the last one halfway
    # between. One breakpoint off it, after everything, and they are merged.
    random = np.random.default_rng(seed)
    aircraft = craft(damping=30.0)
    grid = spacing * np.arange(-400, 1000)
    tracks, end = {}, -np.inf
    for gear, count, start in zip(aircraft.gears, points, starts, strict=True):
        met = grid[400 + start :][:count]
        lag = aircraft.gears[0].x - gear.x - aside * spacing * (gear.name == "c")
        tracks[gear.name] = rm.Profile(met - lag, random.normal(0.0, 1.0, met.size))
        end = max(end, met[-1])
    off = grid[-1] + 0.1
    last = tracks["b"]
    merged = tracks | {"b": rm.Profile(np.append(last.x, off), np.append(last.z, last.z[-1]))}
    speed = 400.0
    modes = aircraft.modes(0.02)
    one = rm.simulate(modes, tracks, speed, damping_input=damping_input)
    other = rm.simulate(modes, merged, speed, damping_input=damping_input)
    count = np.searchsorted(one.time, end / speed)
    assert (one.time[:count] == other.time[:count]).all()
    assert_close(one.modal[:count], other.modal[:count], 1e-13)
    assert_close(one.modal_rate[:count], other.modal_rate[:count], 1e-13)


@given(
    seed=SEEDS,
    ratio=RATIOS,
    speed=SPEEDS,
    damping_input=st.booleans(),
    picks=st.lists(st.floats(0.0, 1.0), min_size=1, max_size=30),
)
def test_a_time_has_one_answer_however_it_is_sampled(
    seed: int, ratio: float, speed: float, damping_input: bool, picks: list[float]
) -> None:
    modes = craft(60.0, 4).modes(ratio)
    response = rm.simulate(modes, rough(seed, 150), speed, damping_input=damping_input)
    last = response.time.size - 1
    rows = np.sort([round(pick * last) for pick in picks])
    some = response.at(response.time[rows])
    anew = rm.simulate(
        modes, rough(seed, 150), speed, times=response.time[rows], damping_input=damping_input
    )
    for quantity in (*QUANTITIES, "modal", "modal_rate", "elevation"):
        for other in (some, anew):
            np.testing.assert_array_equal(
                getattr(other, quantity), getattr(response, quantity)[rows]
            )


@given(seed=SEEDS, ratio=RATIOS, speed=SPEEDS, damping_input=st.booleans())
def test_rows_at_knots_are_limits_of_their_neighbourhood(
    seed: int, ratio: float, speed: float, damping_input: bool
) -> None:
    modes = craft(60.0).modes(ratio)
    profile = rough(seed)
    lag = 210.0 - np.array([gear.x for gear in modes.aircraft.gears])
    knots = np.unique((profile.x[:, None] + lag) / speed)
    knots = knots[np.concatenate([[True], np.diff(knots) > 1e-6])]
    near = 1e-11
    response = rm.simulate(modes, profile, speed, damping_input=damping_input)
    at, right, left = (response.at(knots + shift) for shift in (0.0, near, -near))
    for quantity in ("load", "cg_acceleration", "elevation"):
        values = getattr(at, quantity)
        scale = abs(getattr(response, quantity)).max(axis=0)
        rate = 2 * max(modes.omega.max(), speed) * (1 + 4 * ratio)
        assert (abs(values - getattr(right, quantity)) <= 1e3 * near * rate * scale).all()
    # What has inertia does not jump, whatever the runway does (but for a damper's blow).
    kept = ("modal",) if damping_input else ("modal", "modal_rate")
    for quantity in kept:
        scale = abs(getattr(response, quantity)).max(axis=0)
        rate = 1e3 * near * modes.omega.max() * (1 + 4 * ratio)
        assert (abs(getattr(at, quantity) - getattr(left, quantity)) <= rate * scale + 1e-300).all()


@pytest.mark.parametrize("gears", [3, 4, 5])
def test_elevation_rows_are_the_profile_under_each_gear(gears: int) -> None:
    modes = craft(0.0, gears).modes(0.01)
    profile = rough(5, 40, steps=False)
    response = rm.simulate(modes, profile, 333.0)
    for column, gear in enumerate(modes.aircraft.gears):
        expected = profile.elevation(response.distance - (210.0 - gear.x))
        np.testing.assert_allclose(response.elevation[:, column], expected, rtol=0, atol=1e-10)


def test_profiles_alike_are_one_track() -> None:
    modes, surface = craft().modes(0.02), rough(3, 200, steps=False)
    again = {gear.name: rm.Profile(surface.x, surface.z) for gear in modes.aircraft.gears}
    other = again | {"c": rm.Profile(surface.x, surface.z + np.linspace(0, 1, surface.z.size))}
    profiles = by_gear(modes.aircraft.gear_names, again)
    assert all(profile is profiles[0] for profile in profiles)
    assert by_gear(modes.aircraft.gear_names, other)[2] is other["c"]
    one, two = (rm.simulate(modes, tracks, 405.0) for tracks in (surface, again))
    assert one.modal.tobytes() == two.modal.tobytes()


def test_a_long_run_is_the_same_on_any_number_of_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    random = np.random.default_rng(5)
    stations = np.cumsum(random.uniform(0.05, 0.4, 200_000))
    profile = rm.Profile(stations, random.uniform(0.0, 1.0, stations.size))
    bits = set()
    for threads in ("1", "2"):
        monkeypatch.setenv("RAYON_NUM_THREADS", threads)
        response = rm.simulate(craft().modes(0.01), profile, 400.0, duration=stations[-1] / 400.0)
        arrays = (response.time, response.modal, response.modal_rate, response.extremes().max_load)
        bits.add(tuple(array.tobytes() for array in arrays))
    assert len(bits) == 1


@pytest.mark.parametrize(("ratio", "low"), [(0.01, 0.0912), (0.1, 0.4976)])
def test_dampers_on_steep_ramps_taken_fast(ratio: float, low: float) -> None:
    modes = rm.single_dof(mass=145.5, omega=12.016, damping_ratio=ratio)
    mat, speed = rm.Profile.full_mat(), rm.knots(100)
    most = [
        rm.simulate(modes, mat, speed, damping_input=given).extremes().max_load[0]
        for given in (False, True)
    ]
    # Up the ramp the damper pushes by c z' v at once, before the spring is compressed.
    c = 2.0 * ratio * 12.016 * 145.5
    assert most[1] >= modes.aircraft.static_load[0] + c * speed * 1.5 / 12.0
    assert 1.0 - most[0] / most[1] == pytest.approx(low, abs=1e-4)
