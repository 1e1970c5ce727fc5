"""What the 1980 report says its figures show, as far as its linear models go.

The figures are lost; dimensions that had to be inferred are the defaults of the profile builders.
Each test states the number it found.
"""

import numpy as np
import pytest

import runway_modal as rm
from runway_modal import report1980

#: Wheelbase of the F-4E (Table 1) and overall length of the full mat [in].
WHEELBASE, FULL_MAT = 234.9 + 44.35, 930.0
SPEED = rm.knots(20)
#: Ramps of the full mat [in]: what is on the mat lies between them.
RAMP = 12.0


def ranges(response: rm.Response, lag: float) -> tuple[np.ndarray, np.ndarray]:
    """Load ranges of all gears on the level of the full mat and after it, `lag` inches behind."""
    start, end = np.array([lag, lag + FULL_MAT]) / response.speed
    ramp = RAMP / response.speed
    on = response.at([start + ramp, end - ramp]).extremes()
    after = response.at([end, end + 5.0]).extremes()
    return on.max_load - on.min_load, after.max_load - after.min_load


@pytest.mark.parametrize(
    ("stiffness", "ratio"), [("static", 1.527), ("equivalent", 0.526)], ids=["Table 3", "Table 4"]
)
def test_full_mat_is_amplified_with_table_3_and_cancelled_with_table_4(
    stiffness: str, ratio: float
) -> None:
    modes = rm.f4e(stiffness).modes(0.01)  # type: ignore[arg-type]
    response = rm.simulate(modes, rm.Profile.full_mat(), SPEED)
    on, after = ranges(response, WHEELBASE)
    # Found: 1.527 and 0.526, the same for both mains.
    np.testing.assert_allclose((after / on)[1:], ratio, rtol=0, atol=5e-4)


def test_after_over_on_is_of_the_run_s_own_speed() -> None:
    mat = rm.Profile.full_mat()
    for knots in (20.0, 40.0):
        response = rm.simulate(rm.f4e().modes(0.01), mat, rm.knots(knots))
        on, after = ranges(response, WHEELBASE)
        # Found: 1.527 and 0.943.
        found = report1980.after_over_on(response, mat)[1:]
        np.testing.assert_allclose(found, (after / on)[1:], rtol=1e-4)


@pytest.mark.parametrize(
    ("hertz", "ratio"), [(1.91, 1.522), (1.80, 0.487)], ids=["amplified", "cancelled"]
)
def test_full_mat_with_one_degree_of_freedom(hertz: float, ratio: float) -> None:
    modes = rm.single_dof(mass=145.5, omega=2 * np.pi * hertz, damping_ratio=0.01)
    on, after = ranges(rm.simulate(modes, rm.Profile.full_mat(), SPEED), lag=0.0)
    # Found: 1.522 at 1.91 Hz, 0.487 at 1.80 Hz.
    np.testing.assert_allclose(after / on, ratio, rtol=0, atol=5e-4)


def test_printed_bounce_frequencies() -> None:
    hertz = [rm.f4e(k).modes(0.01).frequency_hz[1] for k in ("static", "equivalent")]
    np.testing.assert_allclose(hertz, [1.91, 1.80], rtol=0, atol=0.005)


def test_mains_leave_the_full_mat_three_seconds_after_the_nose_meets_it() -> None:
    response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), SPEED)
    leave = response.time[np.flatnonzero(response.elevation[:, 1] > 0)[-1] + 1]
    assert leave == pytest.approx((FULL_MAT + WHEELBASE) / SPEED, rel=1e-15)
    assert leave == pytest.approx(2.985, abs=5e-4)
    # The nose meets it at time 0.
    before, after = response.at([0.0, 1e-6]).elevation[:, 0]
    assert before == 0.0 < after


def test_half_mat_unloads_at_the_fourth_minimum() -> None:
    modes = rm.single_dof(mass=145.5, omega=2 * np.pi * 1.91, damping_ratio=0.01)
    profile = rm.Profile.half_mat()
    response = rm.simulate(modes, profile, SPEED)
    # Both sides of each sharp edge are samples, so a minimum at an edge is one of them.
    edge = profile.x[-1] / SPEED
    times = np.union1d(np.linspace(0.0, 3.0, 30_001), [np.nextafter(edge, 0.0), edge])
    load = response.at(times).load[:, 0]
    dips = np.flatnonzero((load[1:-1] < load[:-2]) & (load[1:-1] < load[2:])) + 1
    minima = [response.at(times[i - 1 : i + 2]).extremes().min_load[0] for i in dips[:4]]
    # Found: 25.7, 27.6, 29.3 and -1.0 kip; the fourth where the load drops at the trailing edge.
    assert (np.array(minima[:3]) > 0.0).all()
    assert minima[3] < 0.0
    np.testing.assert_allclose(minima, [25.7e3, 27.6e3, 29.3e3, -1.0e3], rtol=0, atol=50.0)
    assert response.unloaded[0]


@pytest.mark.parametrize(
    ("profile", "asymmetric", "symmetric"),
    [
        (rm.Profile.two_foot_spall(), 43.2e3, 41.1e3),
        (rm.Profile.double_spall(), 43.4e3, 41.2e3),
    ],
    ids=["two-foot spall", "double spall"],
)
def test_spall_under_nose_and_left_loads_left_more_than_under_all(
    profile: rm.Profile, asymmetric: float, symmetric: float
) -> None:
    modes = rm.f4e().modes(0.01)
    left = [
        rm.simulate(modes, dict.fromkeys(gears, profile), rm.knots(10)).extremes().max_load[1]
        for gears in (("nose", "left"), ("nose", "left", "right"))
    ]
    # Found: 43.2 against 41.1 kip with one spall, 43.4 against 41.2 kip with two.
    assert left[0] > left[1]
    np.testing.assert_allclose(left, [asymmetric, symmetric], rtol=0, atol=50.0)


@pytest.mark.parametrize(
    ("ratio", "kt", "low"), [(0.01, 20, 0.018), (0.1, 20, 14.15), (0.1, 60, 36.85)]
)
def test_what_leaving_out_the_dampers_costs(ratio: float, kt: float, low: float) -> None:
    # As `simulate` tells of `damping_input`.
    bounce = rm.single_dof(mass=145.5, omega=12.016, damping_ratio=ratio)
    without, kept = (
        rm.simulate(bounce, rm.Profile.full_mat(), rm.knots(kt), damping_input=kept).extremes()
        for kept in (False, True)
    )
    found = 100 * (1 - without.max_load[0] / kept.max_load[0])
    assert found == pytest.approx(low, rel=0.01)
