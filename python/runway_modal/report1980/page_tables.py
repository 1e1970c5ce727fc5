"""The tables of the page: the report's four, and one of the velocity terms."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from runway_modal.aircraft import Gear, f4e

from . import runs, velocity_term
from .markup import number, row, table, tag, typeset
from .tables import DAMPING_RATIO, TABLE_1, TABLE_2, TABLE_3, TABLE_4, TAXI_STIFFNESS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from .tables import PrintedModes


def tables() -> Iterator[str]:
    """Set Tables 1 to 4, and TAXI's stiffnesses, beside what is computed."""
    yield '<section id="tables">\n<h2>Tables 1 to 4</h2>'
    yield "<h3>Table 1. Aircraft model data</h3>"
    printed = tag("printed", "printed")
    rows = [
        row(typeset(symbol), number(f"{value:,.10g}"), unit, printed)
        for symbol, value, unit in TABLE_1
    ]
    aircraft = f4e()
    nose, main, _ = aircraft.static_load
    rows += [
        row("Weight", number(f"{aircraft.mass * aircraft.gravity:,.1f}"), "lbf", "computed"),
        row("Static load, nose gear", number(f"{nose:,.1f}"), "lbf", "computed"),
        row("Static load, each main gear", number(f"{main:,.1f}"), "lbf", "computed"),
    ]
    yield from table(("", ">Value", "Unit", "Origin"), rows)

    yield "<h3>Table 2. Equivalent spring stiffness [lbf/in]</h3>"
    rows = [
        row(
            f"{gear.name.capitalize()} gear",
            number(f"{gear.strut:,.0f}"),
            number(f"{gear.tire:,.0f}"),
            number(f"{gear.series:,.0f}"),
            number(
                f"{Gear.from_series('g', 0, 0, strut=gear.strut, tire=gear.tire).stiffness:,.2f}"
            ),
        )
        for gear in TABLE_2
    ]
    yield from table(
        ("", ">Strut, printed", ">Tire, printed", ">Series, printed", ">Series, computed"), rows
    )

    yield from _modes(TABLE_3, "Table 3. Mode shapes and frequencies")
    yield "<h3>Stiffness over TAXI's full-mat run [lbf/in] (Section IV.6)</h3>"
    rows = []
    for printed_range, gear in zip(TAXI_STIFFNESS, ("left", "nose"), strict=True):
        low, high, equivalent = runs.taxi_stiffness(gear)
        rows.append(
            row(
                f"{printed_range.name.capitalize()} gear",
                *(
                    number(f"{value:,.0f}")
                    for pair in (
                        (printed_range.low, low),
                        (printed_range.high, high),
                        (printed_range.equivalent, equivalent),
                    )
                    for value in pair
                ),
            )
        )
    yield from table(("", ">Smallest", ">here", ">Largest", ">here", ">Eq. 22", ">here"), rows)
    yield (
        '<p class="note">"Here" is the nonlinear reference, calibrated on the main gear\'s row: '
        "not a prediction.</p>"
    )
    yield from _modes(TABLE_4, "Table 4. Revised mode shapes and frequencies")
    yield "</section>"


def _modes(printed: PrintedModes, title: str) -> Iterator[str]:
    yield f"<h3>{title}</h3>"
    modes = f4e(printed.stiffness).modes(DAMPING_RATIO)
    rows = []
    for i, (omega, shape) in enumerate(zip(printed.omega, printed.shapes, strict=True)):
        # A mode's sign is free: ours is shown with the report's.
        sign = 1.0 if np.dot(shape, modes.shapes[:, i]) > 0 else -1.0
        computed = (modes.omega[i], *(sign * modes.shapes[:, i] + 0.0))
        both = (("printed", (omega, *shape), (3, 6)), ("computed", computed, (5, 8)))
        for label, (frequency, *coordinates), (few, many) in both:
            shown = [f"{frequency:.{few}f}", *(f"{value:.{many}f}" for value in coordinates)]
            name = f"Mode {i + 1}" if label == "printed" else ""
            rows.append(row(name, label, *map(number, shown)))
    yield from table(("", "", ">ω [rad/s]", ">x_g (bounce)", ">θ (pitch)", ">φ (roll)"), rows)


def velocity_terms() -> Iterator[str]:
    """Set what leaving out the velocity terms does, by profile and damping ratio."""
    yield '<section id="velocity">\n<h2>Leaving out the velocity terms</h2>'
    yield (
        "<p>Section III.4 drops 2ζω u̇<sub>M</sub> from the bounce model's excitation (Eq. 15) and "
        "2ζωM (u̇<sub>M</sub> − u̇) from its load (Eq. 16), the latter as an estimate on the safe "
        "side. The change of the largest load shows what that does: below zero is unsafe. At a "
        "sharp edge the damper's load is infinite for no time; that blow moves the mass but is not "
        "counted.</p>"
    )
    rows = []
    for name, (profile, speed) in velocity_term.CASES.items():
        for ratio in velocity_term.RATIOS:
            peaks = velocity_term.peaks(profile, speed, ratio)
            changes = (peaks.without_input, peaks.without_load, peaks.without_both)
            rows.append(
                row(
                    name if ratio == velocity_term.RATIOS[0] else "",
                    number(f"{100 * ratio:g} %"),
                    number(f"{peaks.full / 1e3:.2f}"),
                    *(number(f"{100 * (change / peaks.full - 1):+.3f} %") for change in changes),
                )
            )
    heads = (
        "Profile",
        ">ζ",
        ">Both kept [kip]",
        ">Excitation dropped",
        ">Load dropped",
        ">Both dropped (report)",
    )
    yield from table(heads, rows)
    yield f'<p class="note">1.91 Hz; {tag("inferred", "inferred")} mat edges, half mat length, '
    yield "spall depth and spacing.</p>\n</section>"
