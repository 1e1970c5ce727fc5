"""`Response.extremes` against dense evaluation and root finding on `Response.at`."""

import dataclasses
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

import runway_modal as rm
from runway_modal import nonlinear

#: Relative to the larger of |maximum| and |minimum|.
TOLERANCE = 1e-10

Signal = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def signal(response: rm.Response, of: int | str, sign: float = 1.0) -> Signal:
    """Load of a gear, or acceleration of a station, as a function of time."""

    def evaluate(times: NDArray[np.float64]) -> NDArray[np.float64]:
        at = response.at(times)
        return sign * (at.load[:, of] if isinstance(of, int) else at.acceleration[of])

    return evaluate


def grid_times(response: rm.Response, per_period: int) -> NDArray[np.float64]:
    """Equidistant times, so many a period of the fastest mode."""
    first, last = response.time[0], response.time[-1]
    periods = (last - first) * response.modes.omega.max() / (2 * np.pi)
    return np.linspace(first, last, int(min(4e5, periods * per_period)) + 3)


def true_maximum(times: NDArray[np.float64], of: Signal) -> float:
    """Largest value of a signal: the tallest summits of a grid refined by Brent's method."""
    values = of(times)
    best = float(values.max())
    f0, f1, f2 = values[:-2], values[1:-1], values[2:]
    # Ranked by the parabola through three samples: a grid misses most of a tall summit.
    with np.errstate(invalid="ignore", divide="ignore"):
        bulge = np.where(f1 > np.minimum(f0, f2), (f2 - f0) ** 2 / (8 * (2 * f1 - f0 - f2)), 0.0)
    summit = np.where((f1 >= f0) & (f1 >= f2), f1 + bulge, -np.inf)
    for peak in np.argsort(-summit)[:8]:
        found = minimize_scalar(
            lambda t: -of(np.array([t]))[0],
            bounds=(times[peak], times[peak + 2]),
            method="bounded",
            options={"xatol": 1e-12 * max(1.0, times[peak])},
        )
        best = max(best, -float(found.fun))
    return best


def check(
    response: rm.Response, per_period: int = 64, knots: NDArray[np.float64] | None = None
) -> None:
    """Compare every extreme of a response, and the times given, with the search above."""
    extremes = response.extremes()
    times = grid_times(response, per_period)
    # Both sides of every sample: knots and vertical steps are among them.
    at = response.time if knots is None else np.union1d(response.time, knots)
    sides = np.sort(np.concatenate([np.nextafter(at, -np.inf), at]))
    sampled = response.at(sides[(sides >= response.time[0]) & (sides <= response.time[-1])])
    for gear in range(response.load.shape[1]):
        load = sampled.load[:, gear]
        high = max(load.max(), true_maximum(times, signal(response, gear)))
        low = min(load.min(), -true_maximum(times, signal(response, gear, -1.0)))
        scale = max(abs(high), abs(low))
        assert abs(extremes.max_load[gear] - high) <= TOLERANCE * scale
        assert abs(extremes.min_load[gear] - low) <= TOLERANCE * scale
        for value, when in (
            (extremes.max_load[gear], extremes.time_of_max[gear]),
            (extremes.min_load[gear], extremes.time_of_min[gear]),
        ):
            assert response.time[0] <= when <= response.time[-1]
            # At a vertical step the extreme may be the side before it, and times round.
            near = np.sort(when + np.spacing(when) * np.arange(-4, 5))
            assert abs(response.at(near).load[:, gear] - value).min() <= 1e-9 * scale
    for name, size in extremes.max_acceleration.items():
        high, low = (true_maximum(times, signal(response, name, sign)) for sign in (1.0, -1.0))
        peak = max(high, low, abs(sampled.acceleration[name]).max())
        assert abs(size - peak) <= TOLERANCE * peak


def craft(*damping: float) -> rm.Aircraft:
    """Crooked aircraft, no symmetry, with a pilot; three gears and a fourth if given a damper."""
    places = [
        (210.0, 13.0, 1700.0),
        (-37.0, 101.0, 8800.0),
        (-52.0, -117.0, 7300.0),
        (5.0, 40.0, 3e3),
    ]
    count = max(3, len(damping))
    dampers = (*damping, *[0.0] * (count - len(damping)))
    return rm.Aircraft(
        mass=145.5,
        pitch_inertia=1.92e6,
        roll_inertia=6.56e5,
        gears=[
            rm.Gear(name, *place, damper)
            for name, place, damper in zip("abcd", places[:count], dampers, strict=False)
        ],
        stations={"pilot": (250.0, 10.0)},
    )


def rough(seed: int, points: int, steps: bool) -> rm.Profile:
    """Random profile with uneven segments, a few of them vertical."""
    random = np.random.default_rng(seed)
    run = random.exponential(20.0, points)
    if steps:
        run[random.random(points) < 0.2] = 0.0
    return rm.Profile(np.cumsum(run), random.normal(0.0, 1.0, points))


PROFILES = {
    "mat": rm.Profile.full_mat(),
    "sharp mat": rm.Profile.half_mat(),
    "spall": rm.Profile.two_foot_spall(),
    "double spall": rm.Profile.double_spall(ramp=3.0),
    "bump": rm.Profile.one_minus_cosine(300.0, 2.0),
    "rough": rough(1, 60, steps=False),
    "rough with steps": rough(2, 60, steps=True),
}


@pytest.mark.parametrize("name", PROFILES)
@pytest.mark.parametrize("ratio", [0.0, 0.01, 1.0, 3.0])
def test_profiles_in_every_damping_regime(name: str, ratio: float) -> None:
    check(rm.simulate(craft().modes(ratio), PROFILES[name], rm.knots(20)))


@pytest.mark.parametrize("ratio", [1.2, 1.3, 50.0, 1000.0])
@pytest.mark.parametrize("name", ["mat", "sharp mat", "bump"])
def test_overdamped_far_beyond_critical(name: str, ratio: float) -> None:
    # Also a matter of time: with bounds that mix a mode's slow and fast exponentials the search
    # takes hours here.
    check(rm.simulate(craft().modes(ratio), PROFILES[name], rm.knots(20)))


@pytest.mark.parametrize("ratio", [1e4, 3e4, 1e5])
@pytest.mark.parametrize("name", ["mat", "bump", "rough"])
def test_damped_so_strongly_that_nothing_moves(name: str, ratio: float) -> None:
    # Accelerations are then small differences of large terms, and bend as their rounding does.
    response = rm.simulate(craft().modes(ratio), PROFILES[name], rm.knots(20))
    extremes = response.extremes()
    np.testing.assert_allclose(extremes.max_load, response.load.max(axis=0), rtol=1e-6)
    np.testing.assert_allclose(extremes.min_load, response.load.min(axis=0), rtol=1e-6)
    for station, size in extremes.max_acceleration.items():
        sampled = abs(response.acceleration[station]).max()
        assert sampled * (1 - 1e-9) <= size <= sampled * 1.01


@pytest.mark.parametrize("name", ["mat", "bump", "rough"])
def test_damping_input(name: str) -> None:
    modes = craft(40.0, 160.0, 150.0).modes()
    check(rm.simulate(modes, PROFILES[name], rm.knots(20), damping_input=True))


def test_inside_of_a_step_does_not_count() -> None:
    # Three points at one station: a step from 0 to 1; the spike has no width and is never met.
    modes = craft().modes(0.01)
    spike, step = rm.Profile([9, 9, 9], [0, 50, 1]), rm.Profile([9, 9], [0, 1])
    a, b = (rm.simulate(modes, p, 400.0).extremes() for p in (spike, step))
    np.testing.assert_allclose(a.max_load, b.max_load, rtol=1e-12)
    np.testing.assert_allclose(a.min_load, b.min_load, rtol=1e-12)


def test_damping_input_over_a_step() -> None:
    # The step gives the aircraft a blow; both sides of it count, the infinite instant does not.
    modes = craft(40.0, 160.0, 150.0).modes()
    check(rm.simulate(modes, PROFILES["sharp mat"], rm.knots(20), damping_input=True))


@pytest.mark.parametrize("name", ["mat", "rough with steps"])
def test_four_gears(name: str) -> None:
    check(rm.simulate(craft(1.0, 2.0, 3.0, 4.0).modes(0.02), PROFILES[name], rm.knots(20)))


def test_a_profile_under_each_gear() -> None:
    tracks = {"a": PROFILES["rough"], "b": PROFILES["bump"], "c": PROFILES["spall"].shifted(55.5)}
    check(rm.simulate(craft().modes(0.01), tracks, rm.knots(35)))


@pytest.mark.parametrize("correction", [False, True])
def test_measured_modes_whose_loads_carry_elevations(correction: bool) -> None:
    own = craft().modes(0.01)
    given = (own.aircraft, own.omega[:2] * 1.03, 0.01, own.shapes[:, :2])
    few = rm.Modes(*given, static_correction=correction)
    check(rm.simulate(few, PROFILES["mat"], rm.knots(20)))


@pytest.mark.parametrize("ratio", [0.0, 1e-6, 0.01])
def test_flat_segment_with_a_hundred_cycles(ratio: float) -> None:
    modes = craft().modes(ratio)
    duration = 110 * 2 * np.pi / modes.omega[0]
    check(rm.simulate(modes, PROFILES["mat"], 4000.0, duration=duration), per_period=32)


def test_window_inside_a_flat_segment_deep_in_the_decay() -> None:
    response = rm.simulate(craft().modes(0.003), PROFILES["mat"], 4000.0, duration=40.0)
    # No knot lies in the window, and its extremes are not those of the run.
    window = response.at(np.linspace(17.123, 23.777, 50))
    assert (window.extremes().max_load < response.extremes().max_load).all()
    check(window)


def test_window_covers_first_to_last_time_only() -> None:
    response = rm.simulate(craft().modes(0.01), PROFILES["mat"], rm.knots(20))
    when = response.extremes().time_of_max[1]
    sides = [
        response.at([0.0, when - 1e-3]),
        response.at([when - 1e-3, when + 1e-3]),
        response.at([when + 1e-3, 8.0]),
    ]
    highest = [window.extremes().max_load[1] for window in sides]
    assert highest[1] == pytest.approx(response.extremes().max_load[1], rel=1e-14)
    assert max(highest[0], highest[2]) < highest[1]
    for window in sides:
        check(window, knots=response.time)


UPHILL = rm.Profile([0, 400, 410, 420, 4000], [0.0, 1.0, 3.0, 3.5, 5.0])


@pytest.mark.parametrize(
    "response",
    [
        rm.simulate(craft().modes(0.01), UPHILL, rm.knots(100)),
        nonlinear.simulate(nonlinear.f4e(), UPHILL, rm.knots(100)),
    ],
    ids=["linear", "nonlinear"],
)
def test_where_loads_are_largest_and_smallest(
    response: rm.Response | nonlinear.Response,
) -> None:
    extremes = response.extremes()
    for where, when in (
        (extremes.position_of_max, extremes.time_of_max),
        (extremes.position_of_min, extremes.time_of_min),
    ):
        # Every elevation occurs once: that under the gear tells where it is.
        under = [response.at(time).elevation[0, gear] for gear, time in enumerate(when)]
        np.testing.assert_allclose(UPHILL.elevation(where), under, rtol=1e-12)


@pytest.mark.parametrize(
    ("module", "aircraft"),
    [(rm, rm.f4e()), (nonlinear, nonlinear.f4e())],
    ids=["linear", "nonlinear"],
)
def test_where_accelerations_are_largest(module: Any, aircraft: Any) -> None:
    nose, left, _ = aircraft.gears
    points = {"nose": (nose.x, 3.0), "left": (left.x, 0.0), "tail": (left.x - 300.0, 0.0)}
    aircraft = dataclasses.replace(aircraft, stations=points)
    rolling = aircraft.modes(0.01) if module is rm else aircraft
    response = module.simulate(rolling, UPHILL, rm.knots(100))
    extremes = response.extremes()
    when, where = extremes.time_of_max_acceleration, extremes.position_of_max_acceleration
    assert list(where) == list(response.extremes().max_acceleration)
    for gear, name in enumerate(("nose", "left")):
        under = response.at(when[name]).elevation[0, gear]
        assert UPHILL.elevation(where[name]) == pytest.approx(under, rel=1e-12)
    behind = where["tail"] - when["tail"] * rm.knots(100)
    assert behind == pytest.approx(where["left"] - when["left"] * rm.knots(100) - 300.0, abs=1e-9)


def test_one_time_is_its_own_extreme() -> None:
    one = rm.simulate(craft().modes(0.01), PROFILES["mat"], rm.knots(20)).at(1.2345)
    extremes = one.extremes()
    np.testing.assert_allclose(extremes.max_load, one.load[0], rtol=1e-14)
    np.testing.assert_allclose(extremes.min_load, one.load[0], rtol=1e-14)
    np.testing.assert_array_equal(extremes.time_of_max, 1.2345)


def test_both_sides_of_a_step_count() -> None:
    # A light damper and a slow roll up: the highest load is that just before the drop, which
    # no sample at the step's own time shows.
    modes = rm.single_dof(mass=1.0, omega=10.0, damping_ratio=5.0)
    drop = rm.simulate(modes, rm.Profile([0, 100, 100], [0, 5, 0]), 100.0, times=[0.0, 1.0, 2.0])
    extremes = drop.extremes()
    before = drop.at(np.nextafter(1.0, 0.0)).load[0, 0]
    after = drop.at(1.0).load[0, 0]
    assert before - after == pytest.approx(500.0)
    assert extremes.max_load[0] == pytest.approx(before, rel=1e-12)
    assert extremes.time_of_max[0] == pytest.approx(1.0, abs=1e-15)
    # The body goes on rising for a moment after the drop.
    assert after - 5.0 < extremes.min_load[0] < after


@pytest.mark.parametrize("height", [0.0, -3.0, 1e5])
def test_level_runway(height: float) -> None:
    response = rm.simulate(craft().modes(0.01), rm.Profile([0.0], [height]), 100.0)
    extremes = response.extremes()
    np.testing.assert_array_equal(extremes.max_load, response.static_load)
    np.testing.assert_array_equal(extremes.min_load, response.static_load)
    assert extremes.max_acceleration == {"cg": 0.0, "pilot": 0.0}
    assert not response.unloaded.any()
    assert not response.extremes().unloaded.any()


def test_acceleration_is_the_larger_of_up_and_down() -> None:
    modes = rm.single_dof(mass=1.0, omega=10.0, damping_ratio=0.3)
    for sign in (1.0, -1.0):
        response = rm.simulate(modes, rm.Profile([0, 0], [0, sign]), 100.0, times=[0.0, 3.0])
        extremes = response.extremes()
        # The blow of a unit step: ω² at once, and no more later.
        assert extremes.max_acceleration["cg"] == pytest.approx(100.0, rel=1e-12)
        assert extremes.time_of_max_acceleration["cg"] == 0.0


def test_first_of_equal_peaks() -> None:
    modes = rm.single_dof(mass=1.0, omega=2 * np.pi, damping_ratio=0.0)
    response = rm.simulate(modes, rm.Profile([0, 0], [0, 1]), 1.0, duration=20.0)
    extremes = response.extremes()
    # A step without damping: the load swings by k about the static one for ever.
    k = 4 * np.pi**2
    np.testing.assert_allclose(extremes.max_load, response.static_load + k, rtol=1e-12)
    np.testing.assert_allclose(extremes.min_load, response.static_load - k, rtol=1e-12)
    assert extremes.time_of_max[0] == 0.0
    assert extremes.time_of_min[0] == pytest.approx(0.5, abs=1e-6)


@given(
    seed=st.integers(0, 10**6),
    points=st.integers(1, 25),
    steps=st.booleans(),
    ratios=st.lists(st.sampled_from([0.0, 1e-3, 0.05, 0.7, 1.0, 2.0]), min_size=3, max_size=3),
    speed=st.floats(50.0, 3000.0),
    damping_input=st.booleans(),
)
def test_random_runs(
    seed: int, points: int, steps: bool, ratios: list[float], speed: float, damping_input: bool
) -> None:
    modes = craft(40.0, 160.0, 150.0).modes(ratios)
    profile = rough(seed, points, steps)
    end = (profile.x[-1] + 262.0) / speed + 1.0
    check(rm.simulate(modes, profile, speed, duration=end, damping_input=damping_input), 48)


@pytest.mark.parametrize("speed", [20.0, 60.0])
@pytest.mark.parametrize("ratio", [0.1, 0.7])
def test_default_times_show_both_sides_where_dampers_make_loads_jump(speed, ratio) -> None:
    """On a ramp's ends: of one side alone the largest load would be a fifth too low."""
    modes, mat = rm.single_dof(mass=145.5, omega=12.016, damping_ratio=ratio), rm.Profile.full_mat()
    response = rm.simulate(modes, mat, rm.knots(speed), damping_input=True)
    found = response.extremes()
    assert response.load.max() == pytest.approx(found.max_load[0], rel=2e-3)
    assert response.load.min() == pytest.approx(found.min_load[0], rel=2e-3, abs=50.0)
    largest = abs(response.acceleration["cg"]).max()
    assert largest == pytest.approx(found.max_acceleration["cg"], rel=2e-3)
    at = np.searchsorted(response.time, mat.x / rm.knots(speed))
    assert (response.time[at[1:] - 1] == np.nextafter(response.time[at[1:]], 0.0)).all()
    jumps = response.load[at[1:], 0] - response.load[at[1:] - 1, 0]
    damping, slopes = modes.aircraft.gears[0].damping, np.array([1.5 / 12, 0.0, -1.5 / 12, 0.0])
    expected = damping * np.diff(slopes) * rm.knots(speed)
    np.testing.assert_allclose(jumps, expected, rtol=1e-9)
    # Without dampers nothing jumps; the first instant has no other side.
    plain = rm.simulate(modes, mat, rm.knots(speed)).time
    assert plain.size == response.time.size - 3


def test_extremes_show_names_and_numbers() -> None:
    response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    found = response.extremes()
    lines = [line.split() for line in repr(found).splitlines()]
    assert [line[0] for line in lines] == ["gear", "nose", "left", "right", "station", "cg"]
    for row, name in enumerate(found.gear_names):
        numbers = [float(text) for text in lines[1 + row][1:]]
        expected = [
            found.static_load, found.max_load, (found.max_load / found.static_load).round(3),
            found.time_of_max, found.position_of_max,
            found.min_load, found.time_of_min, found.position_of_min,
        ]  # fmt: skip
        np.testing.assert_allclose(numbers, [each[row] for each in expected], rtol=1e-5)
        assert lines[1 + row][0] == name
    of_cg = (
        found.max_acceleration, found.time_of_max_acceleration, found.position_of_max_acceleration,
    )  # fmt: skip
    shown = [float(number) for number in lines[5][1:]]
    np.testing.assert_allclose(shown, [each["cg"] for each in of_cg], rtol=1e-5)
    # Without gravity there is no static load to compare with.
    weightless = dataclasses.replace(rm.f4e(), gravity=0.0).modes(0.01)
    floating = rm.simulate(weightless, rm.Profile.full_mat(), rm.knots(20)).extremes()
    assert repr(floating).splitlines()[1].split()[1:4:2] == ["0", "-"]


@given(
    seed=st.integers(0, 2**32),
    length=st.floats(5.0, 3e3),
    start=st.floats(-400.0, 800.0),
    damping_input=st.booleans(),
)
def test_sections_are_extremes_between_their_ends(seed, length, start, damping_input):
    draw = np.random.default_rng(seed)
    x = start + np.cumsum(draw.uniform(1.0, 60.0, 40))
    runway = rm.Profile(x, draw.normal(scale=0.3, size=40))
    speed = rm.knots(60)
    response = rm.simulate(rm.f4e().modes(0.02), runway, speed, damping_input=damping_input)
    sections = response.sections(length)
    begins = np.array(list(sections))
    # A response begins at 0 or where the runway does, and sections at multiples of the length.
    assert begins[0] == response.distance[0]
    np.testing.assert_array_equal(begins[1:], length * np.round(begins[1:] / length))
    ends = np.append(begins[1:], response.distance[-1])
    assert (ends > begins).all()
    assert (ends - begins <= length * (1 + 1e-12)).all()
    for begin, end, found in zip(begins / speed, ends / speed, sections.values(), strict=True):
        alone = response.at([begin, end]).extremes()
        scale = abs(alone.max_load).max()
        np.testing.assert_allclose(found.max_load, alone.max_load, atol=TOLERANCE * scale)
        np.testing.assert_allclose(found.min_load, alone.min_load, atol=TOLERANCE * scale)
        rms = response.at([begin, end])
        np.testing.assert_allclose(found.rms_load, rms.rms_load, atol=TOLERANCE * scale)
        assert found.rms_acceleration == pytest.approx(rms.rms_acceleration, rel=TOLERANCE)
        within = (begin - 1e-9, end + 1e-9)
        for times in (found.time_of_max, found.time_of_min, found.time_of_max_acceleration["cg"]):
            assert (np.array(times) >= within[0]).all()
            assert (np.array(times) <= within[1]).all()
    whole = response.extremes()
    for most, each in ((np.max, "max_load"), (np.min, "min_load")):
        found = most([getattr(section, each) for section in sections.values()], axis=0)
        np.testing.assert_allclose(found, getattr(whole, each), rtol=1e-12)
    cg = max(section.max_acceleration["cg"] for section in sections.values())
    assert cg == pytest.approx(whole.max_acceleration["cg"], rel=1e-12)


def test_sections_show_themselves_and_stay_read_only():
    response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    section = pickle.loads(pickle.dumps(response.sections(1000.0)[1000.0]))
    lines = repr(section).splitlines()
    assert lines[0].split()[:3] == ["gear", "static", "max_load"]
    assert lines[-6:][1].split() == ["nose", f"{section.rms_load[0]:g}"]
    assert lines[-1].split() == ["cg", f"{section.rms_acceleration['cg']:g}"]
    assert not section.rms_load.flags.writeable


def test_sections_at_a_jump_have_their_own_side():
    # Where the ramp begins the damper's force jumps: that belongs to what follows.
    gears = [dataclasses.replace(gear, damping=20.0) for gear in rm.f4e().gears]
    modes = dataclasses.replace(rm.f4e(), gears=gears).modes()
    ramp = rm.Profile([0.0, 400.0, 500.0], [0.0, 0.0, 1.0])
    response = rm.simulate(modes, ramp, 400.0, damping_input=True)
    before, after = list(response.sections(400.0).values())[:2]
    assert before.max_load[0] == response.static_load[0]
    jump = 20.0 * 400.0 / 100.0
    assert after.min_load[0] <= response.static_load[0] + jump <= after.max_load[0]


def test_too_many_sections_are_refused():
    response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    with pytest.raises(rm.InputError, match=r"length = 0.001 makes 3\.\d+e\+06 sections"):
        response.sections(1e-3)
    assert list(response.sections(1e9)) == [response.distance[0]]


def test_a_search_that_overflows_ends():
    gears = [rm.Gear("front", 1.7, 0.0, 1.3e5, 1e59), rm.Gear("rear", -0.3, 0.0, 2.7e5, 1e59)]
    aircraft = rm.Aircraft(
        mass=1.5e4, pitch_inertia=5.7e5, roll_inertia=1.9e6, gravity=9.8, gears=gears
    )
    elevations = np.zeros(129)
    elevations[72] = 1e97
    profile = rm.Profile(0.035 * np.arange(129), elevations)
    response = rm.simulate(aircraft.modes(0.3), {"rear": profile}, 1.0, damping_input=True)
    with pytest.raises(rm.NumericalError, match="an extreme left the range"):
        response.extremes()


def test_gears_that_would_pull_are_said() -> None:
    bump, modes = rm.Profile.one_minus_cosine(200.0, 12.0), rm.f4e().modes(0.01)
    said = repr(rm.simulate(modes, bump, rm.knots(60)).extremes()).splitlines()[-1]
    assert said == "nose, left, right would pull on the runway: the linear model does not hold"
    calm = repr(rm.simulate(modes, rm.Profile.full_mat(), rm.knots(20)).extremes())
    assert "would pull" not in calm
