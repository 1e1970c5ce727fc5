"""Profiles: builders, sums, steps, footprints, and that nothing of the caller's is touched."""

import pickle
from fractions import Fraction
from itertools import pairwise
from time import perf_counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import quad, trapezoid

import runway_modal as rm

STEP_UP = rm.Profile([10, 10], [0, 2])
DROP = rm.Profile([10, 10], [1, -3])


def around(stations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Stations with a point just before each and points between them."""
    between = 0.5 * (stations[1:] + stations[:-1])
    return np.sort(np.concatenate([stations, np.nextafter(stations, -np.inf), between]))


@pytest.mark.parametrize(
    ("profile", "x", "z"),
    [
        (rm.Profile.mat(100.0), [0, 12, 88, 100], [0, 1.5, 1.5, 0]),
        (rm.Profile.mat(24.0, 2.0, 12.0, 5.0), [5, 17, 17, 29], [0, 2, 2, 0]),
        (rm.Profile.mat(24.0, 2.0, 0.0, -5.0), [-5, -5, 19, 19], [0, 2, 2, 0]),
        (rm.Profile.spall(24.0, 1.5, 3.0, 1.0), [1, 4, 22, 25], [0, -1.5, -1.5, 0]),
        (rm.Profile.full_mat(), [0, 12, 918, 930], [0, 1.5, 1.5, 0]),
        (rm.Profile.half_mat(), [0, 0, 540, 540], [0, 1.5, 1.5, 0]),
        (rm.Profile.half_mat(465.0), [0, 0, 465, 465], [0, 1.5, 1.5, 0]),
        (rm.Profile.two_foot_spall(2.0, 6.0), [0, 6, 18, 24], [0, -2, -2, 0]),
        (
            rm.Profile.double_spall(1.0, 2.0, 30.0),
            [0, 2, 22, 24, 30, 32, 52, 54],
            [0, -1, -1, 0, 0, -1, -1, 0],
        ),
    ],
)
def test_builders(profile: rm.Profile, x: list[float], z: list[float]) -> None:
    np.testing.assert_array_equal(profile.x, x)
    np.testing.assert_array_equal(profile.z, z)


@pytest.mark.parametrize(("slope", "ramp"), [(120.0, 12.0), (0.0, 12.0), (60.0, 0.0), (0.0, 0.0)])
def test_crater_repair_is_upheaval_and_mat_and_settlement(slope: float, ramp: float) -> None:
    repair = rm.Profile.crater_repair(930.0, 2.0, 1.0, slope, height=1.5, ramp=ramp, start=-50.0)
    edge = slope - 50.0
    parts = [
        rm.Profile.mat(930.0 + 2 * slope, 2.0, slope, -50.0),
        rm.Profile.mat(930.0, 1.5, ramp, edge),
        rm.Profile([edge + ramp, edge + 465.0, edge + 930.0 - ramp], [0.0, -1.0, 0.0]),
    ]
    stations = around(repair.x)
    total = sum((part.elevation(stations) for part in parts), np.zeros(stations.size))
    np.testing.assert_allclose(repair.elevation(stations), total, rtol=0, atol=1e-12)
    assert repair.x[0] == -50.0
    assert repair.x[-1] == 880.0 + 2 * slope
    assert repair.z[0] == repair.z[-1] == 0.0


def test_crater_repair_without_upheaval_and_settlement_is_the_mat() -> None:
    stations = np.linspace(-10.0, 950.0, 1921)
    flush = rm.Profile.crater_repair(930.0, 0.0, 0.0, 0.0)
    mat = rm.Profile.full_mat()
    np.testing.assert_array_equal(flush.elevation(stations), mat.elevation(stations))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"upheaval_length": -1.0}, "upheaval_length = -1.0 is negative"),
        ({"length": 24.0}, "ramp = 12.0 is half the length 24.0: no mat to settle"),
        ({"length": 20.0}, "ramp = 12.0 is not between 0 and 10.0, half the length"),
        ({"length": -1.0}, "length = -1.0 is not positive"),
        ({"settlement": np.inf}, "settlement = inf is not finite"),
    ],
)
def test_crater_repair_refuses(changes: dict[str, float], message: str) -> None:
    values = {
        "length": 930.0,
        "upheaval": 2.0,
        "settlement": 1.0,
        "upheaval_length": 60.0,
        **changes,
    }
    with pytest.raises(rm.InputError, match=message):
        rm.Profile.crater_repair(**values)


def test_detrended_is_the_profile_above_the_line_through_its_ends() -> None:
    x, z = [-50.0, 0.0, 0.0, 70.0, 150.0], [3.0, 8.0, 9.0, -2.0, 13.0]
    found = rm.Profile(x, z).detrended()
    np.testing.assert_array_equal(found.x, x)
    line = 3.0 + 0.05 * (np.array(x) + 50.0)
    np.testing.assert_allclose(found.z, z - line, rtol=0, atol=1e-14)
    assert found.z[0] == found.z[-1] == 0.0
    assert rm.Profile([5.0], [7.0]).detrended() == rm.Profile([5.0], [0.0])


def test_a_grade_loads_gears_by_its_kinks_alone() -> None:
    grade = rm.simulate(rm.f4e().modes(0.01), rm.Profile([0, 60_000], [0, 600]), rm.knots(100))
    # Found: 1.63 times its static load, at the first kink.
    assert grade.extremes().max_load[1] == pytest.approx(1.629 * grade.static_load[1], rel=1e-3)
    modes = rm.f4e().modes(0.05)
    bump = rm.Profile.one_minus_cosine(300.0, 2.0, start=30_000.0)
    climb = rm.Profile([0.0, 60_000.0], [0.0, 600.0])
    times = np.linspace(34.0, 36.0, 200)
    both, alone = (
        rm.simulate(modes, track, 900.0, times=times).load for track in (climb + bump, bump)
    )
    # In the report's model a damped mode lags behind a steady climb.
    lag = both - alone
    np.testing.assert_allclose(lag, np.broadcast_to(lag[0], lag.shape), rtol=1e-3)
    detrended = rm.simulate(modes, (climb + bump).detrended(), 900.0, times=times).load
    np.testing.assert_allclose(detrended, alone, rtol=1e-9)


def test_sequence_is_a_sum_at_stations() -> None:
    mat, spall = rm.Profile.full_mat(), rm.Profile.two_foot_spall().shifted(-7.0)
    bump = rm.Profile.one_minus_cosine(100.0, 2.0)
    row = rm.Profile.sequence([mat, spall, bump, mat], [600.0, 0.0, 30.5])
    starts = [0.0, 1530.0 + 7.0, 1554.0, 1684.5]
    parts = [p.shifted(dx) for p, dx in zip([mat, spall, bump, mat], starts, strict=True)]
    total = parts[0] + parts[1] + parts[2] + parts[3]
    np.testing.assert_array_equal(np.unique(row.x), np.unique(total.x))
    stations = around(row.x)
    np.testing.assert_array_equal(row.elevation(stations), total.elevation(stations))
    # The double spall is two spalls with a gap.
    two = rm.Profile.sequence([rm.Profile.two_foot_spall()] * 2, gap=24.0)
    assert two == rm.Profile.double_spall()


def test_sequence_goes_on_from_where_the_last_ended() -> None:
    up, level = rm.Profile([5, 10], [1, 3]), rm.Profile([7], [4])
    row = rm.Profile.sequence([up, level, up], gap=2.0)
    assert row == rm.Profile([5, 10, 12, 14, 19], [1, 3, 3, 3, 5])
    assert rm.Profile.sequence([up, level, up], gap=0) == rm.Profile([5, 10, 15], [1, 3, 5])
    assert rm.Profile.sequence([up], gap=[]) == rm.Profile.sequence([up], gap=1.0) == up


@pytest.mark.parametrize(
    ("profiles", "gap", "message"),
    [
        ([], 0.0, "profiles is empty"),
        ([STEP_UP, None], 0.0, r"profiles\[1\] = None is not a Profile"),
        ([STEP_UP] * 2, -1.0, r"gap\[0\] = -1.0 is negative or not finite"),
        ([STEP_UP] * 3, [1.0, np.nan], r"gap\[1\] = nan is negative or not finite"),
        ([STEP_UP] * 3, [1.0], "gap has 1 entry, 2 expected"),
        ([STEP_UP] * 3, [[1.0, 2.0]], r"gap has shape \(1, 2\)"),
    ],
)
def test_sequence_refuses(profiles: list[rm.Profile], gap: float, message: str) -> None:
    with pytest.raises(rm.InputError, match=message):
        rm.Profile.sequence(profiles, gap)


def test_spalls_that_touch() -> None:
    touching = rm.Profile.double_spall(spacing=24.0)
    # One wide spall: at the shared edge up and down again cancel.
    stations = np.linspace(-5.0, 60.0, 1301)
    wide = rm.Profile.spall(48.0, 1.5)
    np.testing.assert_array_equal(touching.elevation(stations), wide.elevation(stations))


@pytest.mark.parametrize(
    ("segments", "why"),
    [
        (1, "must be at least 2"),
        (10**7, "must be at least 2 and below 10000000"),
        (4.0, "is not a whole number"),
        ("64", "is not a whole number"),
    ],
)
def test_segments_are_counted(segments: int, why: str) -> None:
    with pytest.raises(rm.InputError, match=f"segments = {segments!r} {why}"):
        rm.Profile.one_minus_cosine(80.0, 3.0, segments=segments)


@pytest.mark.parametrize("segments", [2, 3, 64, 1001])
def test_one_minus_cosine(segments: int) -> None:
    profile = rm.Profile.one_minus_cosine(80.0, 3.0, segments=segments, start=7.0)
    assert profile.x.size == segments + 1
    np.testing.assert_allclose(np.diff(profile.x), 80.0 / segments, rtol=1e-12)
    curve = 1.5 * (1 - np.cos(2 * np.pi * (profile.x - 7.0) / 80.0))
    np.testing.assert_allclose(profile.z, curve, rtol=0, atol=1e-14)
    np.testing.assert_array_equal(profile.z, profile.z[::-1])
    assert profile.z[0] == profile.z[-1] == 0.0
    stations = np.linspace(7.0, 87.0, 5001)
    exact = 1.5 * (1 - np.cos(2 * np.pi * (stations - 7.0) / 80.0))
    departure = abs(profile.elevation(stations) - exact).max()
    assert departure <= 3.0 * np.pi**2 / 4 / segments**2 + 1e-14


def test_elevation_between_before_and_after() -> None:
    profile = rm.Profile([0, 10, 10, 20], [1, 3, 5, 4])
    stations = [-1e9, 0.0, 5.0, np.nextafter(10, 0), 10.0, 15.0, 20.0, 1e9, -np.inf, np.inf]
    expected = [1, 1, 2, 3, 5, 4.5, 4, 4, 1, 4]
    np.testing.assert_allclose(profile.elevation(stations), expected, rtol=1e-14)
    assert profile.elevation([]).shape == (0,)


def test_elevation_refuses_nan() -> None:
    with pytest.raises(rm.InputError, match=r"stations\[1\] = nan"):
        rm.Profile.full_mat().elevation([0.0, np.nan])


@pytest.mark.parametrize(
    "pair",
    [
        (STEP_UP, DROP),
        (STEP_UP, rm.Profile([0, 20], [0, 5])),
        (rm.Profile([10, 20], [1, 2]), STEP_UP),
        (rm.Profile([0, 10], [1, 2]), STEP_UP),
        (rm.Profile([0, 10, 10, 30], [0, 1, 2, 3]), rm.Profile([10, 30, 30], [4, 5, 6])),
        (rm.Profile([3], [7]), STEP_UP),
        (rm.Profile.full_mat(), rm.Profile.double_spall()),
    ],
)
def test_sum_on_both_sides_of_steps(pair: tuple[rm.Profile, rm.Profile]) -> None:
    a, b = pair
    stations = around(np.union1d(a.x, b.x))
    for total in (a + b, b + a):
        np.testing.assert_allclose(
            total.elevation(stations), a.elevation(stations) + b.elevation(stations), atol=1e-14
        )
        np.testing.assert_array_equal(np.unique(total.x), np.union1d(a.x, b.x))
    assert a + b == b + a


def test_sum_with_something_else() -> None:
    with pytest.raises(TypeError):
        STEP_UP + 1.0  # type: ignore[operator]


def test_shifted() -> None:
    moved = rm.Profile.double_spall(ramp=2.0).shifted(-7.5)
    np.testing.assert_array_equal(moved.x, rm.Profile.double_spall(ramp=2.0).x - 7.5)
    np.testing.assert_array_equal(moved.z, rm.Profile.double_spall(ramp=2.0).z)


def exact_mean(profile: rm.Profile, length: float, station: float) -> float:
    """Mean elevation over the contact length, by quadrature between breakpoints."""
    low, high = station - length / 2, station + length / 2
    inside = [float(x) for x in np.unique(profile.x) if low < x < high]
    edges = [low, *inside, high]
    parts = [
        quad(lambda s: profile.elevation([s])[0], a, b, epsabs=1e-13, epsrel=1e-13)[0]
        for a, b in pairwise(edges)
        if b > a
    ]
    return float(sum(parts)) / length


@pytest.mark.parametrize("tolerance", [None, 1e-3, 1e-6])
@pytest.mark.parametrize(
    ("profile", "length"),
    [
        (rm.Profile([5, 5], [0, 2]), 10.0),
        (rm.Profile.two_foot_spall(), 11.0),
        (rm.Profile.two_foot_spall(), 24.0),
        (rm.Profile.spall(4.0, 1.5), 11.0),
        (rm.Profile.full_mat(), 12.0),
        (rm.Profile([0, 7, 7, 11, 30], [100, 103, 99, 98, 101]), 9.5),
    ],
    ids=["step", "spall", "spall as long", "spall shorter", "mat", "high"],
)
def test_footprint_against_quadrature(
    profile: rm.Profile, length: float, tolerance: float | None
) -> None:
    felt = profile.footprint(length, tolerance)
    allowed = 1e-4 * np.ptp(profile.z) if tolerance is None else tolerance
    stations = np.linspace(profile.x[0] - length, profile.x[-1] + length, 201)
    exact = [exact_mean(profile, length, s) for s in stations]
    error = abs(felt.elevation(stations) - exact)
    assert error.max() <= allowed * (1 + 1e-9) + 1e-12
    # Breakpoints lie on the exact curve.
    on = felt.x[:: max(1, felt.x.size // 50)]
    exact_on = [exact_mean(profile, length, s) for s in on]
    np.testing.assert_allclose(
        felt.elevation(on), exact_on, rtol=0, atol=1e-12 * abs(profile.z).max()
    )


def area(profile: rm.Profile) -> float:
    return float(trapezoid(profile.z, profile.x))


def test_footprint_keeps_the_mean() -> None:
    spall = rm.Profile.spall(4.0, 1.5)
    for length in (1.0, 4.0, 11.0, 100.0):
        felt = spall.footprint(length, 1e-7)
        assert area(felt) == pytest.approx(area(spall), rel=1e-5)
        # A spall shorter than the contact is felt with the share of it that it takes.
        assert felt.z.min() == pytest.approx(-1.5 * min(1.0, 4.0 / length), rel=1e-12)


def test_footprint_of_a_long_rough_profile_does_not_drift() -> None:
    random = np.random.default_rng(3)
    x = np.cumsum(random.exponential(30.0, 5000))
    profile = rm.Profile(x, 1e5 + random.normal(0.0, 0.5, x.size))
    felt = profile.footprint(11.0)
    assert felt.z[0] == profile.z[0]
    assert felt.z[-1] == pytest.approx(profile.z[-1], abs=1e-8)


@pytest.mark.parametrize("length", [1e-300, 1e-12])
def test_footprint_too_short_for_the_stations(length: float) -> None:
    # The ends of the contact would round together and the mean would be anything.
    with pytest.raises(rm.InputError, match=r"length = .* is out of range"):
        rm.Profile.full_mat().footprint(length)


def fraction_mean(profile: rm.Profile, length: float, station: float) -> Fraction:
    """Mean elevation over the contact length, in exact arithmetic, from the breakpoints in it."""
    x, z = profile.x, profile.z
    half = Fraction(length) / 2
    low, high = Fraction(station) - half, Fraction(station) + half
    first = max(int(np.searchsorted(x, float(low))) - 2, 0)
    last = min(int(np.searchsorted(x, float(high))) + 2, x.size)
    points = [(Fraction(a), Fraction(b)) for a, b in zip(x[first:last], z[first:last], strict=True)]
    points = [
        (min(low, points[0][0]), points[0][1]),
        *points,
        (max(high, points[-1][0]), points[-1][1]),
    ]
    total = Fraction(0)
    for (a, za), (b, zb) in pairwise(points):
        left, right = max(a, low), min(b, high)
        if right > left:
            middle = za + (zb - za) * ((left + right) / 2 - a) / (b - a)
            total += middle * (right - left)
    return total / Fraction(length)


def rough(points: int, base: float = 0.0, steps: bool = True) -> rm.Profile:
    """Random breakpoints, every seventh a vertical step."""
    random = np.random.default_rng(points)
    runs = random.exponential(30.0, points)
    runs[::7] *= not steps
    return rm.Profile(np.cumsum(runs), base + np.cumsum(random.normal(0.0, 0.1, points)))


def departures(profile: rm.Profile, felt: rm.Profile, length: float, most: int) -> list[float]:
    """How far chords lie from the exact mean at their middles, where they are furthest."""
    middles = 0.5 * (felt.x[1:] + felt.x[:-1])
    chosen = np.random.default_rng(0).permutation(middles.size)[:most]
    found = felt.elevation(middles)
    return [
        abs(float(Fraction(found[i]) - fraction_mean(profile, length, middles[i]))) for i in chosen
    ]


def rounding(profile: rm.Profile, length: float) -> float:
    """A last digit of the largest station in the contact length, and one of elevation."""
    share = np.spacing(abs(profile.x).max()) / length
    return float(np.ptp(profile.z) * share + 2 * np.spacing(abs(profile.z).max()))


@pytest.mark.parametrize("length", [1e-3, 0.7, 11.0, 24.0, 300.0, 1e5])
def test_footprint_keeps_within_its_tolerance(length: float) -> None:
    profile = rough(300)
    for tolerance in (1e-2, 1e-4, 1e-6):
        felt = profile.footprint(length, tolerance)
        allowed = rounding(profile, length)
        most = 400 if length < 1e4 else 10
        assert max(departures(profile, felt, length, most)) <= tolerance + allowed
        chosen = np.linspace(0, felt.x.size - 1, most // 10).astype(int)
        on = [float(fraction_mean(profile, length, x)) for x in felt.x[chosen]]
        np.testing.assert_allclose(felt.z[chosen], on, rtol=0, atol=allowed)


def test_footprint_error_and_chords_follow_the_tolerance() -> None:
    profile, found = rough(40, steps=False), []
    for tolerance in 4.0 ** -np.arange(5, 12):
        felt = profile.footprint(11.0, tolerance)
        worst = max(departures(profile, felt, 11.0, felt.x.size))
        # The bound is no vanity: it is nearly reached.
        assert 0.6 * tolerance < worst <= tolerance * (1 + 1e-6)
        found.append(felt.x.size)
    # A quarter of the tolerance is twice the chords, in the limit of many.
    growth = np.diff(np.log2(found))
    assert np.all(np.diff(growth) > -0.02)
    assert growth[-1] == pytest.approx(1.0, abs=0.15)


def test_footprint_of_a_step_of_any_length_is_a_ramp() -> None:
    for length in (1e-7, 1.0, 1e7):
        felt = STEP_UP.footprint(length, 1e-12)
        np.testing.assert_allclose(felt.x, 10.0 + np.array([-0.5, 0.5]) * length, rtol=1e-15)
        np.testing.assert_array_equal(felt.z, STEP_UP.z)


def test_a_short_footprint_leaves_the_profile_and_a_long_one_its_mean() -> None:
    mat, stations = rm.Profile.full_mat(), np.linspace(-50.0, 1000.0, 2101)
    felt = mat.footprint(1e-4)
    # A ramp of 1/8 is rounded over half a footprint either side.
    assert abs(felt.elevation(stations) - mat.elevation(stations)).max() < 1e-4 / 8
    assert mat.footprint(1e6, 1e-12).elevation([465.0])[0] == pytest.approx(1.5 * 918 / 1e6)


@pytest.mark.parametrize("base", [0.0, 1e5])
@pytest.mark.parametrize("length", [0.7, 11.0])
def test_footprint_of_many_breakpoints_does_not_drift(base: float, length: float) -> None:
    profile = rough(100_000, base)
    felt = profile.footprint(length)
    chosen = np.linspace(0, felt.x.size - 1, 100).astype(int)
    exact = [fraction_mean(profile, length, felt.x[i]) for i in chosen]
    errors = [abs(float(Fraction(felt.z[i]) - e)) for i, e in zip(chosen, exact, strict=True)]
    assert max(errors) <= rounding(profile, length)


def test_footprint_of_many_breakpoints_is_fast() -> None:
    profile = rough(100_000)
    times = []
    for _ in range(3):
        start = perf_counter()
        profile.footprint(11.0)
        times.append(perf_counter() - start)
    assert min(times) < 1.0


def test_footprint_refuses_more_chords_than_memory() -> None:
    with pytest.raises(rm.InputError, match=r"tolerance = 1e-17 is out of range.*more than 1e7"):
        rough(2000).footprint(11.0, 1e-17)


def test_footprint_of_a_level_runway() -> None:
    for level in (rm.Profile([3], [5]), rm.Profile([0, 9], [5, 5])):
        np.testing.assert_array_equal(level.footprint(2.0).z, 5.0)


def test_repr() -> None:
    assert repr(rm.Profile([0, 1], [0, 2])) == "Profile(x=[0.0, 1.0], z=[0.0, 2.0])"
    assert eval(repr(STEP_UP), {"Profile": rm.Profile}) == STEP_UP
    text = repr(rm.Profile.one_minus_cosine(100.0, 2.0))
    assert text == "<Profile: 65 breakpoints, x 0 to 100, z 0 to 2>"


def test_sum_of_many() -> None:
    parts = [rm.Profile.mat(120.0, start=start) for start in (0.0, 500.0, 2000.0)]
    assert sum(parts) == parts[0] + parts[1] + parts[2]
    with pytest.raises(TypeError, match="unsupported operand"):
        sum(parts, 1.0)
    with pytest.raises(rm.InputError, match=r"profiles = .* is not a sequence"):
        rm.Profile.sequence(parts[0], 5.0)


def test_equality_hash_and_pickle() -> None:
    a, b = rm.Profile([0, 1], [0, 2]), rm.Profile([0.0, 1.0], (0.0, 2.0))
    assert a == b
    assert hash(a) == hash(b)
    assert a != rm.Profile([0, 1], [0, 3])
    assert a != rm.Profile([0, 2], [0, 2])
    assert a != "profile"
    assert len({a, b}) == 1
    # As -0 is 0.
    level = rm.Profile([-0.0, 1.0], [0.0, -0.0])
    assert level == rm.Profile([0, 1], [0, 0])
    assert hash(level) == hash(rm.Profile([0, 1], [0, 0]))
    assert pickle.loads(pickle.dumps(a)) == a


def test_views_are_read_only_and_stay_alive() -> None:
    x = rm.Profile(np.arange(1000.0), np.zeros(1000)).x
    np.testing.assert_array_equal(x, np.arange(1000.0))
    for view in (x, STEP_UP.x, STEP_UP.z):
        assert not view.flags.writeable
        with pytest.raises(ValueError, match="read-only"):
            view[0] = 1.0
        with pytest.raises(ValueError, match="WRITEABLE"):
            view.flags.writeable = True


def test_the_callers_arrays_are_copied_and_left_alone() -> None:
    x, z = np.array([0.0, 1.0, 2.0]), np.array([0.0, 3.0, 1.0])
    kept = x.copy(), z.copy()
    profile = rm.Profile(x, z)
    profile.footprint(0.5), profile.shifted(1.0), profile + profile, profile.elevation(x)
    np.testing.assert_array_equal((x, z), kept)
    assert x.flags.writeable
    x[:], z[:] = 9.0, 9.0
    np.testing.assert_array_equal((profile.x, profile.z), kept)


# Stations that are one but for rounding

#: The same tenths, as they come about.
TENTHS = {
    "products": lambda n: 0.1 * np.arange(n),
    "rounded": lambda n: np.round(0.1 * np.arange(n), 1),
    "sums": lambda n: np.cumsum(np.full(n, 0.1)) - 0.1,
    "divided": lambda n: np.arange(n) / 10.0,
}


def slopes(profile: rm.Profile) -> NDArray[np.float64]:
    runs = np.diff(profile.x)
    return np.diff(profile.z)[runs > 0] / runs[runs > 0]


@given(
    seed=st.integers(0, 10**6),
    grids=st.tuples(*2 * [st.sampled_from(sorted(TENTHS))]),
    base=st.sampled_from([0.0, 10.0, 1e4]),
    start=st.sampled_from([0.0, 1000.0]),
)
def test_a_sum_is_no_steeper_than_its_parts(
    seed: int, grids: tuple[str, str], base: float, start: float
) -> None:
    random = np.random.default_rng(seed)
    one, two = (
        rm.Profile(start + TENTHS[grid](200), height + np.cumsum(random.normal(0.0, 1e-3, 200)))
        for grid, height in zip(grids, (base, 0.0), strict=True)
    )
    total = one + two
    most = sum(abs(slopes(part)).max() for part in (one, two))
    assert abs(slopes(total)).max() <= most * (1.0 + 1.0 / 128.0)
    at = np.concatenate([total.x, 0.5 * (total.x[1:] + total.x[:-1])])
    allowed = 1e3 * np.spacing(abs(total.z).max()) + most * np.spacing(abs(total.x).max())
    np.testing.assert_allclose(
        total.elevation(at), one.elevation(at) + two.elevation(at), rtol=0, atol=allowed
    )


@pytest.mark.parametrize("grid", TENTHS)
@pytest.mark.parametrize("start", [0.0, 1000.0])
def test_dampers_feel_no_rounding_under_a_footprint(grid: str, start: float) -> None:
    """A contact of three spacings: its ends pass two breakpoints at once, but for rounding."""
    aircraft = rm.Aircraft(
        mass=64e3,
        pitch_inertia=3.1e6,
        roll_inertia=1.6e6,
        gravity=9.80665,
        gears=[
            rm.Gear("nose", 11.5, 0.0, 0.6e6, 20e3),
            rm.Gear("left", -1.2, 3.8, 2.4e6, 90e3),
            rm.Gear("right", -1.2, -3.8, 2.4e6, 90e3),
        ],
    )
    z = np.cumsum(np.random.default_rng(1).normal(0.0, 5e-4, 60))

    def extremes(base: float, length: float) -> rm.Extremes:
        # Many chords: between long ones slopes are those of their middles.
        felt = rm.Profile(start + TENTHS[grid](60), base + z).footprint(length, 1e-9)
        return rm.simulate(aircraft.modes(), felt, 60.0, damping_input=True).extremes()

    expected = extremes(0.0, 0.3 * (1.0 + 1e-8))
    for base in (0.0, 10.0, 1e3, 1e5):
        for length in (0.3, 0.3 + 1e-13, 0.3 + 1e-11):
            found = extremes(base, length)
            for name in ("max_load", "min_load"):
                actual, desired = getattr(found, name), getattr(expected, name)
                np.testing.assert_allclose(actual, desired, rtol=3e-4, err_msg=f"{base} {length}")


@given(seed=st.integers(0, 10**6), points=st.integers(1, 12), length=st.floats(0.5, 60.0))
def test_footprint_stays_in_range_and_ends_level(seed: int, points: int, length: float) -> None:
    random = np.random.default_rng(seed)
    x = np.cumsum(random.choice([0.0, 1.0, 7.3], points))
    profile = rm.Profile(x, random.normal(size=points))
    felt = profile.footprint(length)
    assert felt.z.min() >= profile.z.min() - 1e-12
    assert felt.z.max() <= profile.z.max() + 1e-12
    # The same area under both once the level ends are cut off alike.
    low, high = x[0] - length, x[-1] + length
    ends = rm.Profile([low, high], [0, 0])
    assert area(felt + ends) == pytest.approx(area(profile + ends), abs=2e-4 * (high - low) * 4)
