"""Root mean squares of single runs: against quadrature, closed forms, and ensembles."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import trapezoid

import runway_modal as rm
from runway_modal import nonlinear

RNG = np.random.default_rng(20)


def by_quadrature(response: rm.Response) -> np.ndarray:
    """Gauss's rule of ten nodes between default times: every knot, 20 a period and more."""
    node, weight = np.polynomial.legendre.leggauss(10)
    time = np.unique(response.time)
    half = np.diff(time)[:, None] / 2.0
    fine = response.at(np.clip(time[:-1, None] + half * (1.0 + node), time[0], time[-1]).ravel())
    dynamic = fine.load - fine.static_load
    values = np.column_stack((dynamic, *fine.acceleration.values()))
    return np.sqrt((half * weight).ravel() @ values**2 / (time[-1] - time[0]))


def of_run(response: rm.Response | nonlinear.Response) -> np.ndarray:
    return np.array([*response.rms_load, *response.rms_acceleration.values()])


def damped(stiffness: str = "static") -> rm.Aircraft:
    plain = rm.f4e(stiffness)
    gears = [rm.Gear(g.name, g.x, g.y, g.stiffness, damping=40.0) for g in plain.gears]
    return rm.Aircraft(
        mass=plain.mass,
        pitch_inertia=plain.pitch_inertia,
        roll_inertia=plain.roll_inertia,
        gears=gears,
        stations={"pilot": (200.0, 10.0)},
    )


@pytest.mark.parametrize("damping_input", [False, True])
@pytest.mark.parametrize("ratio", [0.0, 0.01, 0.5, 1.0, 3.0])
def test_equals_fine_quadrature(ratio: float, damping_input: bool) -> None:
    x = np.cumsum(10.0 ** RNG.uniform(-1.0, 3.0, 60))
    tracks = {
        "nose": rm.Profile(x, RNG.normal(0.0, 1.0, x.size)) + rm.Profile.spall(200.0, 2.0),
        "left": rm.Profile.full_mat(),
    }
    modes, speed = damped().modes(ratio), rm.knots(40)
    run = rm.simulate(modes, tracks, speed, duration=40.0, damping_input=damping_input)
    assert of_run(run) == pytest.approx(by_quadrature(run), rel=1e-11)
    inner = run.time[(run.time > 0.123) & (run.time < 3.21)]
    part = run.at([0.123, *inner, 3.21])
    assert of_run(run.at([0.123, 3.21])) == pytest.approx(by_quadrature(part), rel=1e-11)


def test_spans_add_up() -> None:
    run = rm.simulate(damped().modes(0.02), rm.Profile.double_spall(), rm.knots(30))
    edges = [0.0, 0.7, 0.7000001, 2.0, run.time[-1]]
    spans = np.diff(edges)
    parts = [of_run(run.at(span)) ** 2 for span in pairwise(edges)]
    assert np.sqrt(spans @ parts / edges[-1]) == pytest.approx(of_run(run), rel=1e-13)


@pytest.mark.parametrize("ratio", [0.0, 1e-7, 0.01])
def test_a_long_level_stretch_in_closed_form(ratio: float) -> None:
    """After a step down of height h: load = static + kh e^(-ζωt) (cos νt + ζω/ν sin νt)."""
    omega, height, span = 10.0, 2.0, 1e6
    modes = rm.single_dof(mass=3.0, omega=omega, damping_ratio=ratio)
    run = rm.simulate(modes, rm.Profile([0.0, 0.0], [height, 0.0]), 100.0, duration=span)
    decay, nu = ratio * omega, omega * np.sqrt(1.0 - ratio**2)
    # |e^(-λt)(cos νt + (λ/ν) sin νt)|² integrated; λ = decay.
    t, lam, b = span, decay, decay / nu

    def integral(of_cos: float, of_sin: float, level: float) -> float:
        """Of e^(-2λt) (level + of_cos cos 2νt + of_sin sin 2νt) from 0 to t."""
        fall = np.exp(-2.0 * lam * t)
        flat = t if lam == 0.0 else -np.expm1(-2.0 * lam * t) / (2.0 * lam)
        c, s, d = np.cos(2 * nu * t), np.sin(2 * nu * t), 4.0 * (lam**2 + nu**2)
        cos = (fall * (2 * nu * s - 2 * lam * c) + 2 * lam) / d
        sin = (2 * nu - fall * (2 * lam * s + 2 * nu * c)) / d
        return float(level * flat + of_cos * cos + of_sin * sin)

    mean = integral((1.0 - b * b) / 2.0, b, (1.0 + b * b) / 2.0) / span
    stiffness = 3.0 * omega**2
    # Nothing forgets the rounding of 1e7 radians.
    close = 1e-12 + omega * span * 2.0**-52
    expected = stiffness * height * np.sqrt(mean)
    assert run.at([0.0, span]).rms_load[0] == pytest.approx(expected, rel=close)


def test_gears_damped_far_beyond_critical() -> None:
    """The slow part of the motion lasts 4e10 times as long as the fast one."""
    modes = rm.single_dof(mass=1.0, omega=1.0, damping_ratio=1e5)
    run = rm.simulate(modes, rm.Profile([0.0, 0.0], [1.0, 0.0]), 1.0, duration=1e6)
    root = np.sqrt(1e10 - 1.0)
    fast, slow = 1e5 + root, 1.0 / (1e5 + root)
    # load = (fast e^(-slow t) - slow e^(-fast t)) / (fast - slow)
    square = (
        fast**2 * -np.expm1(-2e6 * slow) / (2.0 * slow)
        - 2.0 * fast * slow / (fast + slow)
        + slow**2 / (2.0 * fast)
    ) / (fast - slow) ** 2
    assert run.at([0.0, 1e6]).rms_load[0] == pytest.approx(np.sqrt(square / 1e6), rel=1e-11)


@pytest.mark.parametrize("damping_input", [False, True])
def test_ensembles_find_the_same(damping_input: bool) -> None:
    modes, spacing, speed = damped().modes(0.03), 9.0, rm.knots(75)
    elevations = RNG.normal(0.0, 0.3, (3, 3, 700)).cumsum(axis=2)
    ensemble = rm.simulate_many(modes, elevations, spacing, speed, damping_input=damping_input)
    end = (699 * spacing + 279.25) / speed
    for run, tracks in enumerate(elevations):
        profiles = {
            name: rm.Profile(spacing * np.arange(700), z)
            for name, z in zip(modes.aircraft.gear_names, tracks, strict=True)
        }
        alone = rm.simulate(modes, profiles, speed, damping_input=damping_input).at([0.0, end])
        assert alone.rms_load == pytest.approx(ensemble.rms_load[run], rel=1e-12)
        for station, rms in alone.rms_acceleration.items():
            assert rms == pytest.approx(ensemble.rms_acceleration[station][run], rel=1e-11)


def test_an_instant_has_its_magnitude_and_rest_none() -> None:
    run = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    for time in (-1.0, 0.0, 1.0, 50.0):
        now = run.at(time)
        assert now.rms_load == pytest.approx(abs(now.load[0] - now.static_load), rel=1e-10)
        assert now.rms_acceleration["cg"] == pytest.approx(abs(now.acceleration["cg"][0]))
    assert not of_run(run.at([-9.0, -1.0])).any()
    level = rm.simulate(rm.f4e().modes(0.01), rm.Profile([0.0, 900.0], [1e5, 1e5]), rm.knots(20))
    assert not of_run(level).any()
    assert not run.rms_load.flags.writeable


def test_what_overflows_is_an_error() -> None:
    steep = rm.Profile([0.0, 1.0], [0.0, 1e100])
    stiff = rm.single_dof(mass=1e60, omega=1e3, damping_ratio=0.1)
    with pytest.raises(rm.NumericalError, match="root mean square"):
        _ = rm.simulate(stiff, steep, 1.0).rms_load


def test_nonlinear_runs() -> None:
    run = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), rm.knots(20))
    for span in (run.time[[0, -1]], np.array([0.5, 3.0])):
        time = np.linspace(*span, 200_001)
        fine = run.at(time)
        values = np.column_stack((fine.load - fine.static_load, *fine.acceleration.values()))
        plain = np.sqrt(trapezoid(values**2, time, axis=0) / (span[1] - span[0]))
        assert of_run(run.at(span)) == pytest.approx(plain, rel=1e-6)
    now = run.at(1.0)
    assert now.rms_load == pytest.approx(abs(now.load[0] - now.static_load))
    assert now.rms_acceleration["cg"] == pytest.approx(abs(now.acceleration["cg"][0]))
