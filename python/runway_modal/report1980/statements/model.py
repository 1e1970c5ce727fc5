"""Sections IV.2 to IV.4, and Table 4: stiffnesses, frequencies, shapes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from runway_modal.aircraft import Gear, f4e
from runway_modal.report1980.tables import DAMPING_RATIO, NODES, TABLE_2, TABLE_3, TABLE_4

from .statement import Finding, Statements, at_most

if TYPE_CHECKING:
    from runway_modal.report1980.tables import PrintedModes

MODEL = Statements()

#: A unit and a half of the last printed digit of ω: ours and the report's may round apart by one.
_OMEGA_DIGIT, _SHAPE_DIGIT = 1.5e-3, 1.5e-6


@MODEL.add("IV.2", "Strut and tire in series give 9102 (main) and 1502 lbf/in (nose).")
def _series_stiffness() -> Finding:
    main, nose = (
        Gear.from_series(g.name, 0.0, 0.0, strut=g.strut, tire=g.tire).stiffness for g in TABLE_2
    )
    close = [abs(k - g.series) < 0.5 for k, g in zip((main, nose), TABLE_2, strict=True)]
    return Finding(
        all(close), "{main:.1f} and {nose:.1f} lbf/in from Table 2.", main=main, nose=nose
    )


def _modes(printed: PrintedModes) -> Finding:
    modes = f4e(printed.stiffness).modes(DAMPING_RATIO)
    omega = np.abs(modes.omega - printed.omega).max()
    # A mode's sign is free.
    shape = np.abs(np.abs(modes.shapes.T) - np.abs(printed.shapes)).max()
    w1, w2, w3 = modes.omega
    return Finding(
        omega < _OMEGA_DIGIT and shape < _SHAPE_DIGIT,
        "{w1:.4f}, {w2:.4f} and {w3:.4f} rad/s; frequencies within {omega:.4f} rad/s of the print, "
        "shapes within {shape:.1e} (asked: a unit of the last digit).",
        w1=w1,
        w2=w2,
        w3=w3,
        omega=omega,
        shape=shape,
    )


@MODEL.add("IV.3", "Table 3: frequencies 7.271, 12.016 and 18.198 rad/s, and shapes.")
def _table_3() -> Finding:
    return _modes(TABLE_3)


@MODEL.add("IV.3", "The mode shapes are orthonormal with respect to mass (Eq. 7).")
def _printed_shapes_are_orthonormal() -> Finding:
    shapes = np.transpose(TABLE_3.shapes)
    off = np.abs(shapes.T @ f4e().mass_matrix @ shapes - np.eye(3)).max()
    ours = f4e().modes(DAMPING_RATIO).shapes
    exact = np.abs(ours.T @ f4e().mass_matrix @ ours - np.eye(3)).max()
    return Finding(
        off < 5e-3,
        "Table 3 as printed: ΦᵀMΦ is within {off:.1e} of the unit matrix (three digits of pitch "
        "are printed); recomputed within at most {exact:.0e}.",
        off=off,
        exact=at_most(exact),
    )


def _node(mode: int) -> Finding:
    """Compare with the quotient of printed numbers, whose rounding it inherits."""
    bounce, pitch, _ = TABLE_3.shapes[mode]
    printed = -bounce / pitch
    computed = float(f4e().modes(DAMPING_RATIO).node[mode])
    rounding = abs(printed) * (5e-7 / abs(bounce) + 5e-7 / abs(pitch))
    return Finding(
        abs(computed - NODES[mode]) < rounding + 0.05,
        "x = {computed:.2f} in, forward of the CG positive; {printed:.2f} in from Table 3's "
        "rounded shape, which leaves ±{rounding:.2f} in open.",
        computed=computed,
        printed=printed,
        rounding=rounding,
    )


@MODEL.add("IV.3", "The first mode's node lies 37.9 in aft of the CG.")
def _node_of_mode_1() -> Finding:
    return _node(0)


@MODEL.add("IV.3", "The second mode's node lies 348.4 in forward of the CG.")
def _node_of_mode_2() -> Finding:
    return _node(1)


def _energy(mode: int) -> np.ndarray:
    """Shares of bounce, pitch and roll in a mode's kinetic energy."""
    shape = f4e().modes(DAMPING_RATIO).shapes[:, mode]
    return np.asarray(np.diag(f4e().mass_matrix) * shape**2)


@MODEL.add("IV.3", "The first mode is primarily pitching at the nose gear.")
def _mode_1_pitches_at_the_nose() -> Finding:
    pitch = _energy(0)[1]
    nose, left, _ = f4e().geometry @ f4e().modes(DAMPING_RATIO).shapes[:, 0]
    return Finding(
        pitch > 0.5 and abs(nose) > abs(left),
        "{pitch:.0f} % of its kinetic energy is pitch; the nose gear moves {times:.0f} times as "
        "far as a main gear.",
        pitch=100 * pitch,
        times=abs(nose / left),
    )


@MODEL.add("IV.3", "The second mode is primarily bouncing.")
def _mode_2_bounces() -> Finding:
    bounce = _energy(1)[0]
    return Finding(
        bounce > 0.5, "{bounce:.0f} % of its kinetic energy is bounce.", bounce=100 * bounce
    )


@MODEL.add("IV.3", "The third mode is roll, decoupled from bounce and pitch by symmetry.")
def _mode_3_is_roll() -> Finding:
    bounce, pitch, roll = _energy(2)
    return Finding(
        bounce == pitch == 0.0,
        "Shares of bounce, pitch and roll: {bounce:g}, {pitch:g} and {roll:g}.",
        bounce=bounce,
        pitch=pitch,
        roll=roll,
    )


def _bounce_hertz(printed: PrintedModes, hertz: float) -> Finding:
    found = float(f4e(printed.stiffness).modes(DAMPING_RATIO).frequency_hz[1])
    return Finding(abs(found - hertz) < 0.005, "{found:.3f} Hz.", found=found)


@MODEL.add("IV.5", "The bounce mode of Table 3 has 1.91 Hz.")
def _bounce_of_table_3() -> Finding:
    return _bounce_hertz(TABLE_3, 1.91)


@MODEL.add("IV.6", "A period goes with one over the square root of stiffness.")
def _period_goes_with_root_of_stiffness() -> Finding:
    omega = [f4e(k).modes(DAMPING_RATIO).omega[1] for k in ("static", "equivalent")]
    stiffness = [f4e(k).gears[1].stiffness for k in ("static", "equivalent")]
    period, root = omega[0] / omega[1], np.sqrt(stiffness[0] / stiffness[1])
    return Finding(
        abs(period / root - 1) < 0.005,
        "From Table 3 to Table 4 the bounce period grows by a factor {period:.4f}, the root of the "
        "main gears' stiffness falls by {root:.4f}.",
        period=period,
        root=root,
    )


@MODEL.add("IV.6", "Table 4: frequencies 7.282, 11.328 and 17.148 rad/s, and shapes.")
def _table_4() -> Finding:
    return _modes(TABLE_4)


@MODEL.add("IV.6", "The bounce mode of Table 4 has 1.80 Hz.")
def _bounce_of_table_4() -> Finding:
    return _bounce_hertz(TABLE_4, 1.80)
