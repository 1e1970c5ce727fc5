"""Every statement of the report: its verdict and the numbers behind it."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import runway_modal as rm
from runway_modal.report1980 import direct, runs, velocity_term
from runway_modal.report1980.statements import STATEMENTS, Finding
from runway_modal.report1980.tables import TABLE_1

#: Verdict and values, as found; what is rounding alone is held in the statement itself.
FOUND: dict[str, tuple[bool | None, dict[str, float]]] = {
    "damping_matrix_stays_coupled": (True, {"coupling": 0.0337254}),
    "damping_coupling_is_negligible": (True, {"percent": 0.0322288}),
    "some_methods_are_conditionally_stable": (
        True,
        {"phase": 3.5, "linear": 1.17979, "average": 1, "wilson": 0.725467},
    ),
    "direct_integration_needs_small_steps": (
        True,
        {"steps": 20, "average": 0.817124, "linear": 0.408379, "wilson": 1.71063, "decay": 1.44494},
    ),
    "modal_wilson_equals_direct_wilson": (True, {"step": 2}),
    "time_is_distance_times_speed": (False, {"product": 489836, "quotient": 2.98525}),
    "eq_14_solves_eq_13": (False, {"printed": 0.64629}),
    "no_small_step_is_needed": (
        True,
        {"step": 2, "change": 0, "coarse": 10, "newmark": 3.00295},
    ),
    "velocity_term_of_the_excitation_is_negligible": (
        True,
        {"low": -0.0099826, "high": -0.00838444, "heavy_low": -0.79125, "heavy_high": 2.24416},
    ),
    "load_without_velocity_term_is_conservative": (
        False,
        {
            "low": 0.00838346,
            "high": 0.0099816,
            "half": 1.45842,
            "full": -14.15,
            "two_foot": -1.56673,
            "double": -1.56673,
        },
    ),
    "bounce_mode_dominates": (True, {"pitch": 2.66356, "bounce": 97.3364, "roll": 0}),
    "bounce_model_estimates_main_loads": (True, {"half": 0.982356, "full": 0.986727}),
    "up_to_nine_integrations_add_up": (True, {"needed": 8}),
    "series_stiffness": (True, {"main": 9101.71, "nose": 1501.98}),
    "table_3": (True, {"w1": 7.27039, "w2": 12.0163, "w3": 18.1992, "omega": 0.00122689}),
    "printed_shapes_are_orthonormal": (True, {"off": 0.00125136}),
    "node_of_mode_1": (True, {"computed": -37.8298, "printed": -37.8555, "rounding": 0.0283617}),
    "node_of_mode_2": (True, {"computed": 348.822, "printed": 348.42, "rounding": 0.773054}),
    "mode_1_pitches_at_the_nose": (True, {"pitch": 90.2161, "times": 41.8284}),
    "mode_2_bounces": (True, {"bounce": 90.2161}),
    "mode_3_is_roll": (True, {"bounce": 0, "pitch": 0, "roll": 1}),
    "bounce_of_table_3": (True, {"found": 1.91246}),
    "taxi_frequency_after_half_mat": (True, {"hertz": 1.83653}),
    "taxi_damping_after_half_mat": (True, {"percent": 1.09979}),
    "half_mat_sdof_maximum": (
        True,
        {"sdof": 56.069, "taxi": 48.7034, "sdof_static": 1.99619, "taxi_static": 2.06134},
    ),
    "half_mat_sdof_minimum": (True, {"sdof": -0.494398, "taxi": 7.74302}),
    "half_mat_unloads_at_the_fourth_minimum": (
        True,
        {"first": 25.6387, "second": 27.4985, "third": 29.2451, "fourth": -0.988796},
    ),
    "half_mat_3dof_maximum": (True, {"three": 48.0113, "sdof": 56.069, "taxi": 48.7034}),
    "half_mat_3dof_minimum": (
        False,
        {"three": -0.618186, "sdof": -0.494398, "taxi": 7.74302, "gap": 0.123789},
    ),
    "half_mat_nose": (True, {"share": 49.381, "asked": 50, "high": 0.928823, "low": 0.798846}),
    "half_mat_nose_lacks_the_highest_frequency": (None, {}),
    "period_goes_with_root_of_stiffness": (True, {"period": 1.06078, "root": 1.06129}),
    "table_4": (True, {"w1": 7.28136, "w2": 11.3278, "w3": 17.1481, "omega": 0.000641569}),
    "bounce_of_table_4": (True, {"found": 1.80288}),
    "mains_leave_at_three_seconds": (True, {"time": 2.98525}),
    "full_mat_taxi_cancels": (False, {"ratio": 1.11079}),
    "taxi_reinforces_or_cancels": (False, {"half": 1.52165, "full": 1.11079}),
    "full_mat_sdof_begins_like_taxi": (
        True,
        {"share": 18.5823, "asked": 50, "high": 0.934161, "low": 0.895687},
    ),
    "full_mat_sdof_amplifies": (True, {"ratio": 1.53696}),
    "full_mat_3dof_amplifies": (True, {"ratio": 1.52652}),
    "full_mat_3dof_is_like_sdof": (
        True,
        {"share": 3.91294, "asked": 25, "high": 1.01345, "low": 0.997036},
    ),
    "full_mat_nose": (False, {"share": 34.0299, "asked": 25, "high": 0.946739, "low": 0.84311}),
    "the_period_decides": (
        True,
        {
            "hertz": 1.86724,
            "taxi": 1.11079,
            "ratio": 1.18239,
            "table_3": 1.52652,
            "table_4": 0.525594,
        },
    ),
    "main_stiffness_range": (
        True,
        {"low": 4749.34, "high": 11428.3, "low_off": 0.34531, "high_off": 0.583174},
    ),
    "nose_stiffness_range": (
        False,
        {"low": 866.438, "high": 2478.81, "low_off": -10.2136, "high_off": -6.88163},
    ),
    "main_equivalent_stiffness": (True, {"equivalent": 8079.38, "off": -0.0201081}),
    "nose_equivalent_stiffness": (False, {"equivalent": 1404.3, "off": -6.8769}),
    "equivalent_stiffness_gives_the_period": (
        False,
        {"taxi": 1.86724, "linear": 1.80216, "off": -3.48526},
    ),
    "full_mat_sdof_cancels": (True, {"ratio": 0.518694}),
    "full_mat_3dof_cancels": (True, {"ratio": 0.525594}),
    "revised_models_agree_better": (
        False,
        {"sdof": 100.938, "revised_sdof": 73.5802, "three": 103.44, "revised_three": 72.4289},
    ),
    "spall_loads_are_like_mat_loads": (
        True,
        {"low": 41.1438, "high": 43.3012, "full": 43.6859, "half": 48.0113},
    ),
    "two_foot_spall_loads_more_asymmetrically": (
        True,
        {"two": 43.2162, "three": 41.1438, "two_4": 40.3163, "three_4": 38.3089},
    ),
    "plunge_softens_with_a_footprint": (
        True,
        {"low": 9.87068, "drop": 13.7564, "step": 13.653, "eased": 11.0291, "contact": 12},
    ),
    "double_spall_loads_more_asymmetrically": (
        True,
        {"two": 43.3836, "three": 41.2484, "two_4": 40.5989, "three_4": 38.6342},
    ),
    "linear_models_reproduce_the_nonlinear": (
        True,
        {
            "hertz": 1.86724,
            "high": 0.954812,
            "low": 0.779948,
            "share": 21.2995,
            "asked": 50,
            "revised": 72.4289,
        },
    ),
}


def test_every_statement_is_held() -> None:
    keys = [statement.key for statement in STATEMENTS]
    assert len(set(keys)) == len(keys)
    assert set(keys) == set(FOUND)


@pytest.mark.parametrize("statement", STATEMENTS, ids=lambda each: each.key)
def test_verdict_and_numbers(statement) -> None:
    holds, values = FOUND[statement.key]
    finding = statement.check()
    assert finding.holds is holds
    # The nonlinear runs are integrated to 1e-8; six digits are written above.
    for name, value in values.items():
        assert finding.values[name] == pytest.approx(value, rel=2e-5, abs=1e-12), name
    for name in finding.values.keys() - values.keys():
        assert abs(finding.values[name]) < 1e-10 or name == "shape", name


def test_statements_come_in_the_order_of_the_report() -> None:
    order = ["II.3", "III.1", "III.2", "III.3", "III.4", "III.5", "IV.2", "IV.3"]
    order += ["IV.5", "IV.6", "IV.7", "V"]
    assert list(dict.fromkeys(statement.section for statement in STATEMENTS)) == order


def test_a_verdict_follows_its_numbers() -> None:
    assert Finding(np.bool_(True), "{x:.1f}", x=1.25).verdict == "holds"
    assert Finding(False, "").verdict == "does not hold"
    assert Finding(None, "").verdict == "cannot be tested"
    assert Finding(True, "{x:+.1f}", x=-0.0).text == "+0.0"


# Velocity terms (Eqs. 15, 16): the same by scipy, from the equations as they stand.


@pytest.mark.parametrize("ratio", [0.01, 0.1])
@pytest.mark.parametrize(
    ("kept", "excited", "damped"),
    [
        ("full", True, True),
        ("without_input", False, True),
        ("without_load", True, False),
        ("without_both", False, False),
    ],
)
def test_peaks_without_velocity_terms(kept: str, excited: bool, damped: bool, ratio: float) -> None:
    mass, omega, speed = 145.5, 12.016, rm.knots(20)
    knots = np.array([0.0, 12.0, 918.0, 930.0]) / speed
    slopes = (1.5 / 12.0 * speed, 0.0, -1.5 / 12.0 * speed, 0.0)
    ends = (*knots[1:], knots[-1] + 5.0)
    heights, state, peak = (0.0, 1.5, 1.5, 0.0), np.zeros(2), -np.inf
    for begin, end, height, slope in zip(knots, ends, heights, slopes, strict=True):

        def ground(t, begin=begin, height=height, slope=slope):
            return height + slope * (t - begin)

        def rate(t, y, ground=ground, slope=slope):
            push = omega**2 * (ground(t) - y[0]) - 2 * ratio * omega * y[1]
            return [y[1], push + 2 * ratio * omega * slope * excited]

        times = np.linspace(begin, end, int(2e4 * (end - begin)) + 2)
        found = solve_ivp(rate, (begin, end), state, "DOP853", times, rtol=1e-12, atol=1e-12)
        u, v = found.y
        load = mass * (omega**2 * (ground(times) - u) + 2 * ratio * omega * (slope - v) * damped)
        peak, state = max(peak, load.max()), found.y[:, -1]
    peaks = velocity_term.peaks(rm.Profile.full_mat(), speed, ratio)
    weight = mass * 386.0886
    assert getattr(peaks, kept) - weight == pytest.approx(peak, rel=2e-7)


@pytest.mark.parametrize("name", velocity_term.CASES)
@pytest.mark.parametrize("ratio", velocity_term.RATIOS)
def test_peaks_are_those_of_the_simulation(name: str, ratio: float) -> None:
    profile, speed = velocity_term.CASES[name]
    modes = rm.single_dof(mass=145.5, omega=12.016, damping_ratio=ratio)
    found = velocity_term.peaks(profile, speed, ratio)
    for damping_input, peak in ((True, found.full), (False, found.without_both)):
        run = rm.simulate(modes, profile, speed, damping_input=damping_input)
        # A breakpoint is looked at from 1e-9 s beside it.
        assert peak == pytest.approx(run.extremes().max_load[0], rel=2e-8)


@pytest.mark.parametrize("ratio", [0.005, 0.01, 0.02])
def test_load_without_damper_is_low_by_the_square_of_damping(ratio: float) -> None:
    # A smooth peak of k d + c v against the one of k d: greater by 2ζ² of the dynamic load.
    weight = TABLE_1[0][1] * 386.0886
    for profile, speed in velocity_term.CASES.values():
        found = velocity_term.peaks(profile, speed, ratio)
        gain = (found.full - weight) / (found.without_load - weight) - 1.0
        assert gain == pytest.approx(2 * ratio**2, rel=0.05)


def test_whether_leaving_the_damper_out_is_conservative() -> None:
    change = {
        (name, ratio): found.without_both / found.full - 1.0
        for name, (profile, speed) in velocity_term.CASES.items()
        for ratio in velocity_term.RATIOS
        for found in [velocity_term.peaks(profile, speed, ratio)]
    }
    # Only on the half mat at 10 % and more, where the largest load is that of its sharp edge.
    safe = {case for case, each in change.items() if each >= 0}
    assert safe == {("half mat, 20 kt", 0.1), ("half mat, 20 kt", 0.2)}
    assert change["full mat, 20 kt", 0.01] == pytest.approx(-1.8e-4, rel=0.05)
    assert change["full mat, 20 kt", 0.1] == pytest.approx(-0.1415, rel=1e-3)
    assert change["full mat, 20 kt", 0.2] == pytest.approx(-0.2339, rel=1e-3)


# Direct integration: textbook results that the code does not use.


@pytest.mark.parametrize("phase", [0.1, 0.5, 2 * np.pi / 20])
def test_newmark_lengthens_periods_as_known(phase: float) -> None:
    # An undamped step turns by 2 atan(ωΔt/2) (average) and acos(1 − x/2/(1 + x/6)), x = (ωΔt)².
    x = phase**2
    turns = {
        direct.AVERAGE: 2 * np.arctan(phase / 2),
        direct.LINEAR: np.arccos(1 - x / 2 / (1 + x / 6)),
    }
    for method, turn in turns.items():
        elongation, decay = direct.period_and_decay(method, phase)
        assert elongation == pytest.approx(phase / turn - 1, rel=1e-9)
        assert decay == pytest.approx(0.0, abs=1e-11)


def test_linear_acceleration_is_stable_up_to_its_limit() -> None:
    limit = 2 * np.sqrt(3)
    assert direct.spectral_radius(direct.LINEAR, 0.999 * limit) == pytest.approx(1.0, abs=1e-9)
    assert direct.spectral_radius(direct.LINEAR, 1.001 * limit) > 1.01
    for phase in (0.1, 1.0, 10.0, 1000.0):
        assert direct.spectral_radius(direct.AVERAGE, phase) < 1 + 1e-9
        assert direct.spectral_radius(direct.WILSON, phase) < 1 + 1e-9
    # Wilson's method is stable without condition from θ = 1.37 on.
    assert direct.spectral_radius(direct.Method("", 1 / 6, 1.3), 100.0) > 1


def test_wilson_decays_as_it_does_when_marched() -> None:
    steps = 20
    dt = 1 / steps
    one = np.eye(1)
    # Released from 1: forced for no time at all, then free.
    force = np.zeros((10 * steps + 1, 1))
    force[0] = (2 * np.pi) ** 2
    u = direct.march(direct.WILSON, one, 0 * one, (2 * np.pi) ** 2 * one, force, dt)[:, 0]
    # Two samples a cycle apart, at any phase, once the start is forgotten.
    wave = np.array([[u[i], u[i + 1]] for i in range(100, 180)])
    step = np.linalg.lstsq(wave[:-1], wave[1:], rcond=None)[0]
    root = np.linalg.eigvals(step)[0]
    elongation, decay = direct.period_and_decay(direct.WILSON, 2 * np.pi / steps)
    assert 2 * np.pi / steps / abs(np.angle(root)) - 1 == pytest.approx(elongation, rel=1e-6)
    cycle = 2 * np.pi / abs(np.angle(root))
    assert 1 - abs(root) ** cycle == pytest.approx(decay, rel=1e-6)


@pytest.mark.parametrize("method", direct.METHODS, ids=lambda each: each.name)
def test_direct_integration_converges_to_the_exact_march(method: direct.Method) -> None:
    run = runs.full_mat("static")
    modes, aircraft = run.modes, run.modes.aircraft
    mass, shapes = aircraft.mass_matrix, modes.shapes
    rates = np.diag(2 * modes.damping_ratio * modes.omega)
    spring = np.array([gear.stiffness for gear in aircraft.gears])
    errors = []
    # The wheelbase is a whole number of quarter inches: breakpoints of all gears are samples.
    for dt in (0.25 / runs.MAT_SPEED, 0.125 / runs.MAT_SPEED):
        exact = run.at(dt * np.arange(int(4.0 / dt)))
        force = exact.elevation * spring @ aircraft.geometry
        damping = mass @ shapes @ rates @ shapes.T @ mass
        u = direct.march(method, mass, damping, aircraft.stiffness_matrix, force, dt)
        errors.append(np.abs(u - exact.cg)[:, 0].max())
    # Second order: a quarter of the error at half the step.
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.01)
    assert errors[1] < 2e-4


@pytest.mark.parametrize(
    ("dt", "found"), [(1e-2, (4.8e-2, 2.4e-2, 1.0e-1)), (1e-3, (4.7e-4, 2.3e-4, 1.0e-3))]
)
def test_errors_of_direct_integration(dt: float, found: tuple[float, ...]) -> None:
    # As benches/direct_integration.py prints and docs/report1980.md quotes them.
    run = runs.full_mat("static")
    modes, aircraft = run.modes, run.modes.aircraft
    weighted = aircraft.mass_matrix @ modes.shapes
    damping = weighted * (2 * modes.damping_ratio * modes.omega) @ weighted.T
    spring = np.array([gear.stiffness for gear in aircraft.gears])
    exact = run.at(dt * np.arange(int(run.time[-1] / dt) + 1))
    force = exact.elevation * spring @ aircraft.geometry
    dynamic = exact.load - exact.static_load
    for method, error in zip(direct.METHODS, found, strict=True):
        u = direct.march(
            method, aircraft.mass_matrix, damping, aircraft.stiffness_matrix, force, dt
        )
        off = spring * (exact.elevation - u @ aircraft.geometry.T) - dynamic
        worst = (np.abs(off).max(axis=0) / np.abs(dynamic).max(axis=0)).max()
        assert worst == pytest.approx(error, rel=0.03)
