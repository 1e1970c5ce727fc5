"""Runs of the nonlinear aircraft against the linear model, closed forms and laws of mechanics."""

import math
import pickle
import subprocess
import sys
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import runway_modal as rm
from runway_modal import nonlinear

SPEED = rm.knots(20)
STRUT = {"nose": 1662.0, "left": 27809.0, "right": 27809.0}
#: Fast enough over this to throw the aircraft off the runway.
BUMP, FAST = rm.Profile.one_minus_cosine(400.0, 8.0), 1200.0

Make = Callable[[nonlinear.Gear, float], nonlinear.Gear]


def f4e(make: Make, **changes: object) -> nonlinear.Aircraft:
    """The F-4E with other gears in the same places."""
    report = nonlinear.f4e()
    gears = list(map(make, report.gears, report.static_load.tolist()))
    keys = ("mass", "pitch_inertia", "roll_inertia")
    values = {**{key: getattr(report, key) for key in keys}, "gears": gears, **changes}
    return nonlinear.Aircraft(**values)  # type: ignore[arg-type]


def linear(damping: float = 0.0, **changes: object) -> nonlinear.Aircraft:
    """Linear struts; dampers in one ratio to the stiffnesses, which couple no modes."""

    def make(gear: nonlinear.Gear, _: float) -> nonlinear.Gear:
        series = STRUT[gear.name] * gear.tire / (STRUT[gear.name] + gear.tire)
        spring = nonlinear.LinearSpring(STRUT[gear.name])
        return nonlinear.Gear(gear.name, gear.x, gear.y, spring, gear.tire, damping * series)

    return f4e(make, **changes)


def gas(n: float = 1.0, extension: float = math.inf, **changes: object) -> nonlinear.Aircraft:
    def make(gear: nonlinear.Gear, load: float) -> nonlinear.Gear:
        strut = nonlinear.GasSpring(load, n * load / STRUT[gear.name], n, extension)
        return nonlinear.Gear(gear.name, gear.x, gear.y, strut, gear.tire, **changes)  # type: ignore[arg-type]

    return f4e(make)


def one_gear(**changes: object) -> nonlinear.Aircraft:
    """All the mass on one gear at the centre of gravity, on a gas spring and a tire."""
    load = 60.0 * 386.0886
    values = {"strut": nonlinear.GasSpring(load, 2.0), "tire": 13530.0, **changes}
    gear = nonlinear.Gear("main", 0.0, 0.0, **values)  # type: ignore[arg-type]
    return nonlinear.Aircraft(mass=60.0, pitch_inertia=1.0, roll_inertia=1.0, gears=[gear])


LOW = rm.Profile.mat(930.0, height=0.6)
TRACKS = {
    "one profile": LOW,
    "one profile per gear": {
        "nose": LOW,
        "left": LOW.shifted(7.0) + rm.Profile.mat(50.0, 0.1, 0.0),
    },
    "from a height": rm.Profile([-500.0, 0.0, 90.0], [2.0, 2.0, 2.5]),
}


@pytest.mark.parametrize("tracks", TRACKS.values(), ids=TRACKS)
@pytest.mark.parametrize("damping", [0.0, 0.005])
def test_linear_springs_agree_with_the_linear_model(damping: float, tracks: object) -> None:
    aircraft = linear(damping, stations={"pilot": (200.0, 0.0)})
    if damping and isinstance(tracks, dict):
        # The damper's blow at a step down would pull: up only.
        tracks = {**tracks, "left": LOW.shifted(7.0) + rm.Profile([100.0, 100.0], [0.0, 0.3])}
    modes = aircraft.linearised().modes()
    assert modes.damping_coupling.max() < 1e-15
    exact = rm.simulate(modes, tracks, SPEED, damping_input=True)  # type: ignore[arg-type]
    assert not exact.unloaded.any()
    response = nonlinear.simulate(aircraft, tracks, SPEED)  # type: ignore[arg-type]
    # Found: 0.2e-8 to 0.9e-8.
    assert abs((response.load - exact.load) / exact.static_load).max() < 1e-8
    # And everything, however small against the static deflection, with a closer tolerance.
    response = nonlinear.simulate(aircraft, tracks, SPEED, rtol=1e-9)  # type: ignore[arg-type]
    np.testing.assert_array_equal(response.time, exact.time)
    np.testing.assert_array_equal(response.distance, exact.distance)
    np.testing.assert_allclose(response.elevation, exact.elevation, rtol=0, atol=1e-14)
    np.testing.assert_allclose(response.static_load, exact.static_load, rtol=1e-14)
    for name in ("cg", "cg_rate", "cg_acceleration", "gear_displacement"):
        ours, theirs = getattr(response, name), getattr(exact, name)
        largest = abs(theirs).max(axis=0)
        assert (abs(ours - theirs).max(axis=0) <= 1e-8 * largest + 1e-12).all(), name
    pilot = exact.acceleration["pilot"]
    assert abs(response.acceleration["pilot"] - pilot).max() < 1e-8 * abs(pilot).max()
    ours, theirs = response.extremes(), exact.extremes()
    for name in ("max_load", "min_load"):
        np.testing.assert_allclose(getattr(ours, name), getattr(theirs, name), rtol=1e-8)
        times = f"time_of_{name[:3]}"
        np.testing.assert_allclose(getattr(ours, times), getattr(theirs, times), atol=1e-6)
    assert ours.max_acceleration == pytest.approx(theirs.max_acceleration, rel=1e-8)
    assert ours.time_of_max_acceleration == pytest.approx(theirs.time_of_max_acceleration, abs=1e-6)
    np.testing.assert_allclose(response.stiffness / response.stiffness[0], 1.0, rtol=1e-12)


def test_error_is_in_proportion_to_the_tolerance() -> None:
    aircraft = linear()
    exact = rm.simulate(aircraft.linearised().modes(), LOW, SPEED)
    errors = []
    for rtol in (1e-4, 1e-6, 1e-8, 1e-10, 1e-11):
        response = nonlinear.simulate(aircraft, LOW, SPEED, rtol=rtol)
        errors.append(abs((response.load - exact.load) / exact.static_load).max() / rtol)
    # Found: 0.4 to 0.9 of what was asked, at every tolerance.
    assert max(errors) < 2.0, errors


@pytest.mark.parametrize(
    ("aircraft", "profile", "speed"),
    [
        (nonlinear.f4e(), rm.Profile.full_mat(), SPEED),
        (gas(1.1, 8.0, damping=20.0), BUMP, FAST),
        (
            gas(1.1, 8.0, unsprung_mass=0.6, friction=400.0, orifice=nonlinear.Orifice(3.0, 9.0)),
            rm.Profile.mat(300.0, 1.5),
            SPEED,
        ),
    ],
    ids=["full mat", "lift-off", "friction and orifice"],
)
def test_convergence_through_every_kind_of_break(
    aircraft: nonlinear.Aircraft, profile: rm.Profile, speed: float
) -> None:
    times = np.linspace(0.0, 1.0, 300)
    loads = [
        nonlinear.simulate(aircraft, profile, speed, times=times, rtol=rtol).load
        for rtol in (1e-4, 1e-6, 1e-8, 1e-10)
    ]
    errors = [abs((load - loads[-1]) / aircraft.static_load).max() for load in loads[:-1]]
    # Found: each at most 50 times its tolerance, a hundredth of the one before.
    assert errors[0] < 1e-2
    assert errors[1] < 1e-4
    assert errors[2] < 1e-6
    assert errors[0] > 10.0 * errors[1] > 100.0 * errors[2]


@pytest.mark.parametrize("changes", [{}, {"unsprung_mass": 0.7}], ids=["massless", "unsprung"])
@pytest.mark.parametrize("n", [1.0, 1.4])
def test_rest_on_the_level_and_on_uneven_ground(n: float, changes: dict[str, float]) -> None:
    aircraft = gas(n, **changes)
    for tracks in (rm.Profile([0.0], [3.0]), {"left": rm.Profile([0.0], [2.0])}):
        response = nonlinear.simulate(aircraft, tracks, SPEED)
        # Three gears carry what equilibrium gives them, however the runway lies.
        np.testing.assert_allclose(
            response.load, np.broadcast_to(aircraft.static_load, response.load.shape), rtol=1e-13
        )
        assert abs(response.cg_acceleration).max() < 1e-11
        np.testing.assert_allclose(
            response.gear_displacement, response.elevation, rtol=0, atol=1e-13
        )


def period_of(aircraft: nonlinear.Aircraft, height: float) -> tuple[float, float, float]:
    """Half a period after a sharp step up, from energy alone: time, largest, smallest load."""
    gear = aircraft.gears[0]
    chamber, tire = gear.strut[0], gear.tire  # type: ignore[index]
    load0, column, weight = chamber.load, chamber.column, 60.0 * 386.0886

    def load(s: float) -> float:
        # Isothermal: root of κF² + (ℓ - D)F - ℓF₀ = 0, D from the unloaded tire.
        gap = column - (s + load0 / tire)
        return tire / 2.0 * (-gap + math.sqrt(gap * gap + 4.0 * column * load0 / tire))

    def work(s: float) -> float:
        """Energy of gas and tire at compression s."""
        return column * load0 * math.log(load(s) / load0) + load(s) ** 2 / (2.0 * tire)

    def kinetic(s: float) -> float:
        return work(height) - work(s) - weight * (height - s)

    turn = brentq(kinetic, -20.0, 0.0, xtol=1e-14)
    middle, half = (height + turn) / 2.0, (height - turn) / 2.0

    def slowness(angle: float) -> float:
        s = middle + half * math.sin(angle)
        return half * math.cos(angle) / math.sqrt(2.0 * kinetic(s) / 60.0)

    edge = math.pi / 2.0 - 1e-5
    inner, _ = quad(slowness, -edge, edge, epsrel=1e-11)
    # The ends, where both go to zero, by the accelerations there.
    ends = sum(
        math.sqrt(2.0 * half * (1.0 - math.cos(1e-5)) * 60.0 / abs(load(s) - weight))
        for s in (height, turn)
    )
    return inner + ends, load(height), load(turn)


@pytest.mark.parametrize("height", [0.5, 2.0])
def test_period_and_turning_points_of_one_gear(height: float) -> None:
    aircraft = one_gear()
    step = rm.Profile([0.0, 0.0], [0.0, height])
    extremes = nonlinear.simulate(aircraft, step, 100.0, duration=0.6).extremes()
    half_period, largest, smallest = period_of(aircraft, height)
    assert extremes.max_load[0] == pytest.approx(largest, rel=1e-9)
    assert extremes.min_load[0] == pytest.approx(smallest, rel=1e-8)
    assert extremes.time_of_min[0] == pytest.approx(half_period, rel=1e-6)
    # Far from harmonic: the linear model's half period is another.
    omega = aircraft.linearised().modes().omega[0]
    assert abs(half_period * omega / math.pi - 1.0) > 1e-3


def energy(response: nonlinear.Response, base: float = 0.0) -> np.ndarray:
    """Of a run on massless isothermal or polytropic gears over the level at `base`."""
    aircraft = response.aircraft
    inertia = np.array([aircraft.mass, aircraft.pitch_inertia, aircraft.roll_inertia])
    total = 0.5 * response.cg_rate**2 @ inertia
    total += aircraft.mass * aircraft.gravity * response.cg[:, 0]
    for gear, load in zip(aircraft.gears, response.load.T, strict=True):
        total += load**2 / (2.0 * gear.tire)
        (chamber,) = gear.strut  # type: ignore[misc]
        # On the stop the gas keeps what it has there.
        pressed = np.maximum(load, chamber.preload) / chamber.load
        n = chamber.polytropic
        work = np.log(pressed) if n == 1 else (pressed ** (1 - 1 / n) - 1) / (n - 1)
        total += chamber.load * chamber.column * work
    return total


@pytest.mark.parametrize("n", [1.0, 1.3])
@pytest.mark.parametrize("extension", [math.inf, 6.0])
def test_undamped_gas_keeps_energy_through_lift_off_and_stops(n: float, extension: float) -> None:
    response = nonlinear.simulate(gas(n, extension), BUMP, FAST, duration=3.0, rtol=1e-10)
    # With a stop the aircraft flies; without, gas pushes however far the strut extends.
    assert response.unloaded.all() == (extension < math.inf)
    level = response.time > (400.0 + 280.0) / FAST
    kept = energy(response)[level]
    assert np.ptp(kept) < 1e-8 * abs(response.aircraft.static_load).sum()


def test_undamped_wheels_keep_energy() -> None:
    aircraft = one_gear(unsprung_mass=2.0)
    step = rm.Profile([0.0, 0.0], [0.0, 2.0])
    response = nonlinear.simulate(aircraft, step, 100.0, duration=1.5, rtol=1e-10)
    # The step compresses the tire at once: enough for the wheel to hop.
    assert response.extremes().max_load[0] > 2.0 * response.static_load[0]
    assert response.unloaded[0]
    gear, gravity = aircraft.gears[0], aircraft.gravity
    chamber, static = gear.strut[0], response.static_load[0]  # type: ignore[index]
    kept = []
    for piece in response._pieces[1:]:
        w, _, _, rate, _, _, z, wheel_rate = piece.y(np.linspace(piece.begin, piece.end, 50))
        deflection = np.maximum(0.0, static / gear.tire + 2.0 - z)
        kept.append(
            0.5 * aircraft.mass * rate**2
            + 0.5 * gear.unsprung_mass * wheel_rate**2
            + gravity * (aircraft.mass * w + gear.unsprung_mass * z)
            + 0.5 * gear.tire * deflection**2
            - chamber.load * chamber.column * np.log(chamber.column - (z - w))
        )
    spread = np.ptp(np.concatenate(kept))
    assert spread < 1e-8 * static


def test_flight_is_ballistic() -> None:
    response = nonlinear.simulate(gas(1.0, 6.0), BUMP, FAST)
    flying = (response.load == 0.0).all(axis=1)
    runs = np.flatnonzero(np.diff(np.r_[0, flying, 0])).reshape(-1, 2)
    begin, end = max(runs, key=lambda run: run[1] - run[0])
    assert end - begin > 10
    np.testing.assert_allclose(
        response.cg_acceleration[begin:end], [[-386.0886, 0.0, 0.0]] * (end - begin), atol=1e-12
    )
    t = response.time[begin:end] - response.time[begin]
    start, rate = response.cg[begin], response.cg_rate[begin]
    fall = np.outer(t, rate)
    fall[:, 0] -= 0.5 * 386.0886 * t**2
    np.testing.assert_allclose(response.cg[begin:end], start + fall, rtol=0, atol=1e-9)
    assert (response.stiffness[begin:end] == 0.0).all()
    # Off the runway: further above it than struts on their stops and unloaded tires reach.
    above = response.gear_displacement - response.elevation
    reach = [
        gear.strut[0].extension + load / gear.tire  # type: ignore[index]
        for gear, load in zip(response.aircraft.gears, response.static_load, strict=True)
    ]
    assert (above[begin:end] > reach).all()


def test_loads_are_never_negative_and_dampers_do_not_pull() -> None:
    response = nonlinear.simulate(gas(1.0, 6.0, damping=60.0), BUMP, FAST)
    assert response.load.min() == 0.0
    assert (response.extremes().min_load == 0.0).all()
    assert response.unloaded.all()


@pytest.mark.parametrize(
    "aircraft",
    [nonlinear.f4e(), gas(1.2, 5.0, unsprung_mass=0.5, orifice=nonlinear.Orifice(2.0, 6.0))],
    ids=["massless", "unsprung"],
)
def test_mirrored_tracks_give_mirrored_results(aircraft: nonlinear.Aircraft) -> None:
    mat = rm.Profile.mat(300.0)
    left, right = (
        nonlinear.simulate(aircraft, {"nose": mat, side: mat}, SPEED, duration=2.5)
        for side in ("left", "right")
    )
    assert abs(left.cg[:, 2]).max() > 1e-3
    # Static loads of left and right differ in the last digits; errors are within the tolerance.
    np.testing.assert_allclose(left.load, right.load[:, [0, 2, 1]], rtol=0, atol=1e-3)
    np.testing.assert_allclose(left.cg, right.cg * [1, 1, -1], rtol=0, atol=1e-8)


@pytest.mark.parametrize(
    "changes",
    [
        {"orifice": nonlinear.Orifice(3.0, 9.0)},
        {"friction": 600.0},
        {"damping": 90.0},
        {"friction": 300.0, "orifice": nonlinear.Orifice(1.0, 2.0)},
    ],
    ids=["orifice", "friction", "viscous", "both"],
)
def test_dampers_only_take_energy(changes: dict[str, object]) -> None:
    def run(**dampers: object) -> np.ndarray:
        aircraft = one_gear(unsprung_mass=0.5, **dampers)
        response = nonlinear.simulate(
            aircraft, rm.Profile.mat(100.0, 1.0, 0.0), 400.0, duration=2.0
        )
        return response.at(np.linspace(1.0, 2.0, 500)).cg[:, 0]

    # Found: 0.4 to 0.8 of the height of the undamped motion.
    assert np.ptp(run(**changes)) < 0.85 * np.ptp(run())


def test_orifice_and_friction_against_a_plain_integration() -> None:
    """Stick and slip exactly, against friction smoothed over 0.002 in/s in one stiff run."""
    orifice, friction = nonlinear.Orifice(3.0, 9.0), 800.0
    aircraft = one_gear(unsprung_mass=2.0, friction=friction, orifice=orifice, damping=10.0)
    chamber, mass, wheel, gravity = aircraft.gears[0].strut[0], 60.0, 2.0, 386.0886  # type: ignore[index]
    tire = aircraft.gears[0].tire
    profile = rm.Profile([0.0, 20.0, 60.0, 75.0], [0.0, 2.5, 2.5, 0.0])

    def derivative(t: float, y: np.ndarray) -> list[float]:
        w, rate, z, wheel_rate = y
        s, v = z - w, wheel_rate - rate
        strut = chamber.load * chamber.column / (chamber.column - s) + 10.0 * v
        strut += (3.0 if v > 0 else 9.0) * v * abs(v) + friction * math.tanh(v / 0.002)
        ground = np.interp(100.0 * t, profile.x, profile.z)
        load = max(0.0, (mass + wheel) * gravity + tire * (ground - z))
        return [rate, strut / mass - gravity, wheel_rate, (load - strut) / wheel - gravity]

    times = np.linspace(0.0, 2.0, 300)
    plain = solve_ivp(
        derivative, (0.0, 2.0), np.zeros(4), "Radau", times, rtol=1e-7, atol=1e-9, max_step=2e-3
    )
    response = nonlinear.simulate(aircraft, profile, 100.0, times=times)
    np.testing.assert_allclose(response.cg[:, 0], plain.y[0], rtol=0, atol=2e-3 * 2.5)
    np.testing.assert_allclose(response.cg_rate[:, 0], plain.y[1], rtol=0, atol=0.2)


def test_strut_that_friction_holds_leaves_the_tire_alone() -> None:
    aircraft = one_gear(unsprung_mass=2.0, friction=1e9)
    omega = math.sqrt(13530.0 / 62.0)
    rigid = rm.single_dof(mass=62.0, omega=omega, damping_ratio=0.0)
    profile = rm.Profile.mat(100.0, 0.5)
    exact = rm.simulate(rigid, profile, 100.0, duration=3.0)
    response = nonlinear.simulate(aircraft, profile, 100.0, times=exact.time)
    np.testing.assert_allclose(response.load, exact.load, rtol=1e-8)
    np.testing.assert_allclose(response.cg[:, 0], exact.cg[:, 0], rtol=0, atol=1e-8)


def test_strut_on_its_stop_moves_with_the_wheel() -> None:
    """Through a long drop the wheel hangs on the stop, and everything falls with g."""
    load = 60.0 * 386.0886
    strut = nonlinear.GasSpring(load, 2.0, 1.0, extension=3.0)
    aircraft = one_gear(strut=strut, unsprung_mass=2.0, damping=40.0)
    drop = rm.Profile([0.0, 0.0], [0.0, -60.0])
    response = nonlinear.simulate(aircraft, drop, 100.0, times=np.linspace(0.0, 0.5, 501))
    flying = response.load[:, 0] == 0.0
    # By momentum: whatever strut and stop do inside, the two together fall freely.
    last = np.flatnonzero(flying)[-1]
    after = response.time[last]
    assert after > 0.3
    held = flying & (response.time > 0.9 * after)
    np.testing.assert_allclose(response.cg_acceleration[held, 0], -386.0886, rtol=1e-9)
    # The strut pushed body and wheel apart before the stop took both along: momentum is kept.
    rate = response.cg_rate[held, 0]
    fallen = -386.0886 * response.time[held]
    np.testing.assert_allclose(rate, fallen, rtol=1e-8)


def test_held_struts_do_not_move_and_none_leaves_its_stop() -> None:
    aircraft = gas(1.0, 6.0, unsprung_mass=0.6, friction=700.0, orifice=nonlinear.Orifice(3.0, 9.0))
    response = nonlinear.simulate(aircraft, BUMP, FAST, duration=1.5)
    motion, seen = response._motion, set()
    for piece in response._pieces[1:]:
        times = np.linspace(piece.begin, piece.end, 12)
        travels = motion._travels(piece.stretch, times, piece.y(times))
        for state, travel in zip(piece.states, travels, strict=True):
            seen.add((state.piece, state.sense))
            assert travel.compression.min() > -6.0 - 1e-9
            if state.piece == 0:
                np.testing.assert_allclose(travel.compression, -6.0, rtol=0, atol=1e-9)
            if state.sense == 0:
                np.testing.assert_allclose(travel.rate, 0.0, atol=1e-8)
            else:
                assert (state.sense * travel.rate > -1e-8).all()
    # On the stop, stuck, compressing and extending: all of them happened.
    assert seen == {(0, 0), (1, 0), (1, 1), (1, -1)}


def test_wheel_that_leaves_the_runway_for_less_than_a_step() -> None:
    """Heavy, hardly damped wheels that hop: once their short flights were taken for none."""
    aircraft = gas(1.4, 3.0, unsprung_mass=4.4338670825717195, friction=22.040229464592045)
    bump = rm.Profile.one_minus_cosine(358.63079443, 4.129008568252717)
    response = nonlinear.simulate(aircraft, bump, 1492.1486480637723, duration=2.0, rtol=1e-6)
    off = [not state.touching for piece in response._pieces for state in piece.states]
    assert any(off)
    for piece in response._pieces[1:]:
        times = np.linspace(piece.begin, piece.end, 20)
        travels = response._motion._travels(piece.stretch, times, piece.y(times))
        for gear, state, travel, static in zip(
            aircraft.gears, piece.states, travels, response.static_load, strict=True
        ):
            # The tire touches where it is compressed, to the last digits at the ends.
            pressed = travel.deflection + static / gear.tire
            assert (pressed > -1e-9).all() if state.touching else (pressed < 1e-9).all()


def test_two_stage_strut_stiffens() -> None:
    def run(*strut: nonlinear.GasSpring) -> nonlinear.Response:
        return nonlinear.simulate(
            one_gear(strut=strut), rm.Profile.mat(200.0, 3.0), 300.0, duration=1.5
        )

    load = 60.0 * 386.0886
    first = nonlinear.GasSpring(load, 2.0)
    one = run(first)
    # Not reached: as if it were not there. Reached: a longer column, softer there.
    high = one.extremes().max_load[0] * 1.01
    np.testing.assert_array_equal(
        run(first, nonlinear.GasSpring(high, 1.0, 1.0, 0.0)).load, one.load
    )
    two = run(first, nonlinear.GasSpring(1.2 * load, 4.0, 1.0, 0.0))
    above = two.load[:, 0] > 1.2 * load
    k = 1 / (1 / first.stiffness(two.load[above, 0]) + 1 / 13530.0)
    assert (two.stiffness[above, 0] < k).all()
    below = 1 / (1 / first.stiffness(two.load[~above, 0]) + 1 / 13530.0)
    np.testing.assert_allclose(two.stiffness[~above, 0], below, rtol=1e-12)


def test_extremes_against_dense_samples() -> None:
    for aircraft, profile, speed in (
        (nonlinear.f4e(), rm.Profile.full_mat(), SPEED),
        (gas(1.0, 6.0, damping=20.0), BUMP, FAST),
    ):
        response = nonlinear.simulate(aircraft, profile, speed, duration=4.0)
        dense = response.at(np.linspace(0.0, 4.0, 100_001))
        extremes = response.extremes()
        for largest, times, load in (
            (extremes.max_load, extremes.time_of_max, dense.load.max(axis=0)),
            (-extremes.min_load, extremes.time_of_min, (-dense.load).max(axis=0)),
        ):
            assert (largest >= load).all()
            np.testing.assert_allclose(largest, load, rtol=1e-4, atol=1e-3)
            assert ((times >= 0.0) & (times <= 4.0)).all()
        peak = abs(dense.acceleration["cg"]).max()
        assert peak <= extremes.max_acceleration["cg"] <= 1.0005 * peak


def test_extremes_of_a_part_and_at_other_times() -> None:
    response = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), SPEED)
    part = response.at([0.5, 1.5]).extremes()
    assert (part.max_load <= response.extremes().max_load).all()
    assert ((part.time_of_max >= 0.5) & (part.time_of_max <= 1.5)).all()
    again = response.at(response.time)
    np.testing.assert_array_equal(again.load, response.load)
    before = response.at([-7.0, -1.0])
    np.testing.assert_allclose(before.load, [response.static_load] * 2, rtol=1e-14)
    np.testing.assert_array_equal(response.at(1.0).load, response.at([1.0]).load)


def test_four_gears_start_in_equilibrium_on_uneven_ground() -> None:
    places = {"nose": (240, 0), "left": (-40, 100), "right": (-40, -100), "aft": (-90, 0)}
    gas_strut = nonlinear.GasSpring(15e3, 3.0, extension=4.0)
    aircraft = nonlinear.Aircraft(
        mass=145.5,
        pitch_inertia=1.92e6,
        roll_inertia=6.56e5,
        gears=[nonlinear.Gear(n, x, y, gas_strut, 12e3) for n, (x, y) in places.items()],
    )
    raised = nonlinear.simulate(aircraft, {"aft": rm.Profile([0.0], [0.5])}, SPEED)
    assert raised.load[0, 3] > aircraft.static_load[3] + 500.0
    assert abs(raised.cg_acceleration).max() < 1e-9
    np.testing.assert_allclose(
        raised.load @ aircraft.geometry,
        [[145.5 * 386.0886, 0.0, 0.0]] * raised.time.size,
        atol=1e-6,
    )


def test_results_are_read_only_and_the_callers_times_are_left_alone() -> None:
    times = np.linspace(0.0, 1.0, 5)
    response = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), SPEED, times=times)
    assert times.flags.writeable
    times[:] = -1.0
    assert response.time[1] == 0.25
    for name in ("time", "load", "cg", "elevation", "stiffness", "gear_displacement", "distance"):
        assert not getattr(response, name).flags.writeable, name
    assert not response.acceleration["cg"].flags.writeable
    assert "gears nose, left, right" in repr(response)


def test_default_times_show_both_sides_where_dampers_make_loads_jump() -> None:
    """Of one side alone the largest load of the nose gear is 0.2 % too low."""
    response = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), rm.knots(60))
    found = response.extremes()
    np.testing.assert_allclose(response.load.max(axis=0), found.max_load, rtol=1e-3)
    largest = abs(response.acceleration["cg"]).max()
    assert largest == pytest.approx(found.max_acceleration["cg"], rel=3e-3)


def test_pickles_by_values() -> None:
    aircraft = gas(1.1, 6.0, unsprung_mass=0.6, friction=100.0)
    again = pickle.loads(pickle.dumps(aircraft))
    assert again == aircraft
    np.testing.assert_array_equal(again.static_load, aircraft.static_load)


def refused(expected: str, make: Callable[[], object]) -> None:
    with pytest.raises(rm.InputError) as caught:
        make()
    assert expected.lower() in str(caught.value).lower()


def test_bad_input() -> None:
    aircraft, mat = nonlinear.f4e(), rm.Profile.full_mat()

    def run(**changes: object) -> nonlinear.Response:
        values = {"aircraft": aircraft, "tracks": mat, "speed": SPEED, **changes}
        return nonlinear.simulate(**values)  # type: ignore[arg-type]

    refused("aircraft = 3", lambda: run(aircraft=3))
    refused("not a nonlinear Aircraft", lambda: run(aircraft=rm.f4e()))
    refused("tracks['tail']", lambda: run(tracks={"tail": mat}))
    refused("tracks = 5", lambda: run(tracks=5))
    for bad in (0.0, -1.0, math.nan, math.inf):
        refused(f"speed = {bad}", lambda bad=bad: run(speed=bad))
        refused(f"rtol = {bad}", lambda bad=bad: run(rtol=bad))
        refused(f"duration = {bad}", lambda bad=bad: run(duration=bad))
    refused("times[1] = 0.5", lambda: run(times=[1.0, 0.5]))
    refused("duration", lambda: run(times=[1.0], duration=1.0))
    refused("times has 0 entries", lambda: run(times=[]))
    response = run(duration=4.0)
    refused("times has 0 entries", lambda: response.at([]))
    refused("times[1] = nan", lambda: response.at([1.0, math.nan]))
    refused("times[1] = 4.5", lambda: response.at([1.0, 4.5]))
    refused("times[1] = 0.5", lambda: response.at([1.0, 0.5]))
    refused("end = 0.0", lambda: response.equivalent_stiffness(0.0, 0.0))
    refused("step = 0.0", lambda: response.equivalent_stiffness(0.0, 930.0, 0.0))
    refused("end = 5000.0", lambda: response.equivalent_stiffness(0.0, 5000.0))
    flight = nonlinear.simulate(gas(1.0, 6.0), BUMP, FAST)
    refused("leaves the runway", lambda: flight.equivalent_stiffness(0.0, 2000.0))


def test_scipy_is_loaded_for_a_run_only() -> None:
    code = "import sys, runway_modal.nonlinear; print([m for m in sys.modules if 'scipy' in m])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


def test_scipy_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy", None)
    with pytest.raises(ImportError, match=r"runway_modal\[taxi\]"):
        nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), SPEED)


@pytest.mark.parametrize("datum", [0.0, 4204.02, 6e4])
def test_rest_high_above_the_datum(datum: float) -> None:
    heights = {"nose": datum, "left": datum + 1.29, "right": datum + 0.82}
    tracks = {name: rm.Profile([0, 100], [z, z]) for name, z in heights.items()}
    aircraft = nonlinear.f4e()
    found = nonlinear.simulate(aircraft, tracks, 400.0, times=[0.0])
    expected = rm.simulate(aircraft.linearised().modes(), tracks, 400.0, times=[0.0])
    np.testing.assert_allclose(found.load, expected.load, rtol=1e-9)
    level = nonlinear.simulate(
        aircraft, {n: t + rm.Profile([0], [-datum]) for n, t in tracks.items()}, 400.0, times=[0.0]
    )
    np.testing.assert_allclose(found.cg[0] - level.cg[0], [datum, 0.0, 0.0], atol=1e-10)


def test_a_step_at_the_last_time_shows_what_follows() -> None:
    aircraft, step, last = nonlinear.f4e(), rm.Profile([0, 0], [0, 1]), 279.25 / 400.0
    short = nonlinear.simulate(aircraft, step, 400.0, times=[0.0, last])
    longer = nonlinear.simulate(aircraft, step, 400.0, times=[0.0, last, last + 1.0]).at(
        [0.0, last]
    )
    np.testing.assert_array_equal(short.elevation, longer.elevation)
    assert short.elevation[-1].tolist() == [1.0, 1.0, 1.0]
    np.testing.assert_allclose(short.load, longer.load, rtol=1e-6)
    highest = (short.extremes().max_load, longer.extremes().max_load)
    np.testing.assert_allclose(*highest, rtol=1e-6)
    sides = nonlinear.simulate(aircraft, step, 400.0, duration=last).load[-2:, 1]
    assert sides[1] - sides[0] > 9000.0
    at_once = nonlinear.simulate(aircraft, step, 400.0, times=[0.0])
    assert at_once.elevation.tolist() == [[1.0, 0.0, 0.0]]


def test_a_gear_that_carries_rounding_alone_is_refused() -> None:
    gas = nonlinear.GasSpring
    gears = [
        nonlinear.Gear("a", 150.0, 50.0, gas(2e4, 2.0, 1.1), 9800.0),
        nonlinear.Gear("b", 0.0, 50.0, gas(2e4, 2.0), 17000.0),
        nonlinear.Gear("c", 0.0, -50.0, gas(2e4, 2.0), 10000.0),
    ]
    with pytest.raises(rm.InputError, match=r"gears\[0\]: 'a' carries .* at rest"):
        nonlinear.Aircraft(mass=145.5, pitch_inertia=6.7e5, roll_inertia=3e5, gears=gears)


def test_sections_are_extremes_between_their_ends() -> None:
    response = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), rm.knots(20))
    sections = response.sections(500.0)
    begins = list(sections)
    assert begins == [500.0 * i for i in range(7)]
    ends = [*begins[1:], response.distance[-1]]
    for begin, end in zip(begins, ends, strict=True):
        span = response.at([begin / response.speed, end / response.speed])
        found, alone = sections[begin], span.extremes()
        np.testing.assert_allclose(found.max_load, alone.max_load, rtol=1e-12)
        np.testing.assert_allclose(found.min_load, alone.min_load, rtol=1e-12)
        np.testing.assert_allclose(found.rms_load, span.rms_load, rtol=1e-12)
        assert found.rms_acceleration == pytest.approx(span.rms_acceleration, rel=1e-12)
    whole = response.extremes()
    highest = np.max([section.max_load for section in sections.values()], axis=0)
    np.testing.assert_allclose(highest, whole.max_load, rtol=1e-12)
