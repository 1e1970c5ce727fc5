"""Sections II and III: equations, methods of integration, velocity terms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from runway_modal.aircraft import Aircraft, f4e
from runway_modal.report1980 import direct, runs, velocity_term
from runway_modal.report1980.tables import DAMPING_RATIO

from .statement import Finding, Statements, at_most

THEORY = Statements()


def _damped() -> Aircraft:
    """Give the gears dampers of about 1 %: c = 2ζk/ω, ω near pitch and near bounce."""
    aircraft = f4e()
    omega = {"nose": 8.0, "left": 12.0, "right": 12.0}
    gears = [
        replace(g, damping=2 * DAMPING_RATIO * g.stiffness / omega[g.name]) for g in aircraft.gears
    ]
    return replace(aircraft, gears=tuple(gears))


#: Step of what is integrated directly here [s].
_STEP = 2e-3


def _forces(aircraft: Aircraft) -> np.ndarray:
    """Ground input K₁u_P of the full mat, shape (n, 3), sampled every `_STEP`."""
    times = np.arange(0.0, 6.0, _STEP)
    elevation = runs.full_mat("static").at(times).elevation
    stiffness = np.array([g.stiffness for g in aircraft.gears])
    return np.asarray(elevation * stiffness @ aircraft.geometry)


def _matrices(aircraft: Aircraft) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass, damping of 1 % in every mode and stiffness, in CG coordinates."""
    modes = aircraft.modes(DAMPING_RATIO)
    weighted = aircraft.mass_matrix @ modes.shapes
    rates = 2 * modes.damping_ratio * modes.omega
    return aircraft.mass_matrix, weighted * rates @ weighted.T, aircraft.stiffness_matrix


@THEORY.add("II.3", "The mode shapes do not in general diagonalize the damping matrix.")
def _damping_matrix_stays_coupled() -> Finding:
    coupling = _damped().modes().damping_coupling.max()
    return Finding(
        coupling > 0,
        "With gear dampers of about 1 % the largest neglected term is {coupling:.3f} of the "
        "diagonal ones, |C_ij|/√(C_ii C_jj).",
        coupling=coupling,
    )


@THEORY.add("II.3", "With light damping the coupling of modes by damping may be neglected.")
def _damping_coupling_is_negligible() -> Finding:
    aircraft = _damped()
    modes = aircraft.modes()
    mass, stiffness = aircraft.mass_matrix, aircraft.stiffness_matrix
    diagonal = np.diag(2 * modes.damping_ratio * modes.omega)
    uncoupled = mass @ modes.shapes @ diagonal @ modes.shapes.T @ mass
    motion = [
        direct.march(direct.AVERAGE, mass, damping, stiffness, _forces(aircraft), _STEP)
        for damping in (aircraft.damping_matrix, uncoupled)
    ]
    full, without = (u @ aircraft.geometry[1] for u in motion)
    change = np.abs(without - full).max() / np.abs(full).max()
    return Finding(
        change < 0.01,
        "Over the full mat the left gear moves differently by {percent:.2f} % of its largest "
        "displacement (asked: under 1 %).",
        percent=100 * change,
    )


@THEORY.add("III.1", "Some methods of direct integration are only conditionally stable.")
def _some_methods_are_conditionally_stable() -> Finding:
    phase = 3.5
    average, linear, wilson = (direct.spectral_radius(m, phase) for m in direct.METHODS)
    return Finding(
        linear > 1 + 1e-9 and max(average, wilson) < 1 + 1e-9,
        "At ωΔt = {phase:g} a step multiplies the state by {linear:.2f} with linear acceleration "
        "(limit ωΔt = 2√3), by {average:.2f} with average acceleration and {wilson:.2f} with "
        "Wilson's θ = 1.4.",
        phase=phase,
        linear=linear,
        average=average,
        wilson=wilson,
    )


@THEORY.add(
    "III.1",
    "Each method of direct integration needs a small step to keep periods from lengthening and "
    "amplitudes from decaying.",
)
def _direct_integration_needs_small_steps() -> Finding:
    steps = 20
    found = {m: direct.period_and_decay(m, 2 * np.pi / steps) for m in direct.METHODS}
    (average, none), (linear, nor), (wilson, decay) = found.values()
    return Finding(
        min(average, linear, wilson) > 0 and max(none, nor) < 1e-9 < decay,
        "At {steps:.0f} steps a period it is longer by {average:.2f} % (Newmark, average), "
        "{linear:.2f} % (linear) and {wilson:.2f} % (Wilson); the amplitude falls by {none:.2f}, "
        "{nor:.2f} and {decay:.2f} % a cycle: decay is Wilson's alone.",
        steps=steps,
        average=100 * average,
        linear=100 * linear,
        wilson=100 * wilson,
        none=100 * abs(none),
        nor=100 * abs(nor),
        decay=100 * decay,
    )


@THEORY.add(
    "III.2",
    "Integrating each mode by Wilson's method with one step gives the same as integrating the "
    "matrix equations by it.",
)
def _modal_wilson_equals_direct_wilson() -> Finding:
    aircraft = f4e()
    modes = aircraft.modes(DAMPING_RATIO)
    shapes, force = modes.shapes, _forces(aircraft)
    matrix = direct.march(direct.WILSON, *_matrices(aircraft), force, _STEP)
    rates = np.diag(2 * modes.damping_ratio * modes.omega)
    squares = np.diag(modes.omega**2)
    modal = direct.march(direct.WILSON, np.eye(3), rates, squares, force @ shapes, _STEP)
    change = np.abs(modal @ shapes.T - matrix)[:, 0].max() / np.abs(matrix[:, 0]).max()
    return Finding(
        change < 1e-10,
        "Over the full mat, steps of {step:g} ms: bounce differs by at most {change:.0e} of its "
        "largest, rounding alone.",
        step=1e3 * _STEP,
        change=at_most(change),
    )


@THEORY.add("III.3", "Time on the axis is runway distance times ground speed (as scanned).")
def _time_is_distance_times_speed() -> Finding:
    distance = runs.FULL_MAT.x[-1] + runs.WHEELBASE
    product, quotient = distance * runs.MAT_SPEED, distance / runs.MAT_SPEED
    return Finding(
        abs(product - 3.0) < 0.05,
        "For the mains at the mat's end the product is {product:,.0f} in²/s, the quotient "
        "{quotient:.3f} s; the report's own figure shows them there at 3 s.",
        product=product,
        quotient=quotient,
    )


@THEORY.add("III.3", "Eq. 14, as scanned, solves Eq. 13 exactly.")
def _eq_14_solves_eq_13() -> Finding:
    omega, zeta, a, b = 12.016, 0.01, 3.0, -7.0
    t = np.linspace(0.0, 2.0, 201)

    def residual(slope_term: float, damping: float) -> float:
        """Of ẍ + damping·ẋ + ω²x = A + Bt, with A₁ times t (1) or alone (0)."""
        wd = omega * np.sqrt(1 - zeta**2)
        a0, a1 = a / omega**2 - 2 * zeta * b / omega**3, b / omega**2
        a2 = 0.1 - a0
        a3 = (0.5 + zeta * omega * a2 - a1) / wd
        # e^(λt) with complex λ holds both terms and their derivatives.
        rate = complex(-zeta * omega, wd)
        wave = (a2 - 1j * a3) * np.exp(rate * t)
        x = a0 + a1 * t**slope_term + wave.real
        v = slope_term * a1 + (rate * wave).real
        left = (rate**2 * wave).real + damping * v + omega**2 * x
        return float(np.abs(left - a - b * t).max() / np.abs(a + b * t).max())

    printed = residual(0.0, 2 * zeta)
    corrected = residual(1.0, 2 * zeta * omega)
    return Finding(
        printed < 1e-12,
        "Put into Eq. 13 it leaves {printed:.2f} of the largest force. With the time factor on A₁ "
        "and ω in the damping term, both lost in print or scan, at most {corrected:.0e}.",
        printed=printed,
        corrected=at_most(corrected),
    )


@THEORY.add("III.3", "The solution is exact: accuracy asks for no small step.")
def _no_small_step_is_needed() -> Finding:
    run = runs.full_mat("static")
    fine, every = _STEP * np.arange(3001), 500
    exact = run.at(fine)
    change = np.abs(run.at(fine[::every]).load - exact.load[::every]).max()
    aircraft = f4e()
    matrices = _matrices(aircraft)
    coarse = 5
    force = _forces(aircraft)[::coarse]
    u = direct.march(direct.AVERAGE, *matrices, force, coarse * _STEP)
    left = aircraft.geometry[1]
    body = exact.gear_displacement[::coarse, 1][: len(u)]
    newmark = np.abs(u @ left - body).max() / np.abs(body).max()
    return Finding(
        change == 0.0 and newmark > 0.01,
        "Full mat: loads at every second computed alone and among steps of {step:g} ms differ by "
        "{change:g} lbf. Newmark's average acceleration with steps of {coarse:g} ms moves the left "
        "gear wrong by {newmark:.1f} % of its largest displacement.",
        step=1e3 * _STEP,
        change=change,
        coarse=1e3 * coarse * _STEP,
        newmark=100 * newmark,
    )


@THEORY.add(
    "III.4",
    "In the bounce model the velocity term of the excitation, 2ζω u̇_M, may be left out because "
    "damping is small.",
    rests_on="mat edges, half mat length, spall depth and spacing",
)
def _velocity_term_of_the_excitation_is_negligible() -> Finding:
    changes = {
        name: found.without_input / found.full - 1.0
        for name, found in _velocity(DAMPING_RATIO).items()
    }
    return Finding(
        max(map(abs, changes.values())) < 0.01,
        "At 1 % damping the largest load changes by {low:+.3f} to {high:+.3f} % over the four "
        "profiles; at 10 % by {heavy_low:+.1f} to {heavy_high:+.1f} % (asked, at 1 % damping: "
        "under 1 %).",
        low=100 * min(changes.values()),
        high=100 * max(changes.values()),
        heavy_low=min(_heavy("without_input")),
        heavy_high=max(_heavy("without_input")),
    )


@THEORY.add(
    "III.4",
    "Leaving the velocity term out of the bounce model's load (Eq. 16) errs on the safe side.",
    rests_on="mat edges, half mat length, spall depth and spacing",
)
def _load_without_velocity_term_is_conservative() -> Finding:
    changes = {
        name: found.without_both / found.without_input - 1.0
        for name, found in _velocity(DAMPING_RATIO).items()
    }
    return Finding(
        min(changes.values()) >= 0,
        "At 1 % damping it lowers the largest load on every profile, by {low:.3f} to {high:.3f} % "
        "(as ζ²: at a smooth peak of the spring's load the damper's passes through zero while "
        "rising or falling, so their sum peaks higher). At 10 % the report's load, both terms "
        "left out, is off the full one by {half:+.1f} % on the half mat, {full:+.1f} % on the full "
        "mat, {two_foot:+.1f} and {double:+.1f} % on the spalls.",
        low=-100 * max(changes.values()),
        high=-100 * min(changes.values()),
        **dict(zip(("half", "full", "two_foot", "double"), _heavy("without_both"), strict=True)),
    )


def _velocity(damping_ratio: float) -> dict[str, velocity_term.Peaks]:
    return {
        name: velocity_term.peaks(profile, speed, damping_ratio)
        for name, (profile, speed) in velocity_term.CASES.items()
    }


def _heavy(left_out: str) -> list[float]:
    """Change of the largest load at 10 % damping [%], by profile."""
    return [100 * (getattr(p, left_out) / p.full - 1.0) for p in _velocity(0.1).values()]


@THEORY.add(
    "III.5",
    "Three modes and three tracks take up to nine integrations, the results of which are added.",
)
def _up_to_nine_integrations_add_up() -> Finding:
    aircraft = f4e()
    modes = aircraft.modes(DAMPING_RATIO)
    stiffness = np.array([g.stiffness for g in aircraft.gears])
    needed = np.count_nonzero(modes.shapes.T @ aircraft.geometry.T * stiffness)
    times = np.linspace(0.0, 8.0, 801)
    whole = runs.spall("static", runs.DOUBLE_SPALL, ("nose", "left", "right")).at(times)
    parts = [
        runs.spall("static", runs.DOUBLE_SPALL, (gear,)).at(times).load - whole.static_load
        for gear in aircraft.gear_names
    ]
    dynamic = whole.load - whole.static_load
    change = np.abs(sum(parts) - dynamic).max() / np.abs(dynamic).max()
    return Finding(
        needed <= 9 and change < 1e-12,
        "{needed:.0f} are needed, the nose gear not exciting roll. Gear by gear and added, loads "
        "over the double spall differ from all at once by at most {change:.0e} of the "
        "largest.",
        needed=needed,
        change=at_most(change),
    )
