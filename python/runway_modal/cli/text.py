"""Tables that the commands print of a case."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from runway_modal.extremes import share

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from typing import TypeAlias

    import numpy as np
    from numpy.typing import NDArray

    from runway_modal.case import Case

    #: Loads by gear, when each occurs (or at which speed), and where.
    Peaks: TypeAlias = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


def heading(case: Case) -> Iterator[str]:
    """Begin a summary."""
    yield case.title
    yield f"Units: {case.units.length}, {case.units.force}, s"


def stated_speed(case: Case, name: str) -> str:
    """Give a speed as written in the file, and in the case's units."""
    exact = f"{case.speeds[name]:.6g} {case.units.length}/s"
    return name if name == exact else f"{name} = {exact}"


def modes_table(case: Case) -> Iterator[str]:
    """Tabulate the modes."""
    modes = case.modes
    node = f"node at x [{case.units.length}]"
    yield f"  mode   frequency [Hz]   omega [rad/s]   damping ratio {node:>14}"
    rows = zip(modes.frequency_hz, modes.omega, modes.damping_ratio, modes.node, strict=True)
    for i, (hertz, omega, ratio, node) in enumerate(rows, 1):
        # Roll leaves the whole centreline at rest, and pure bounce no point of it.
        where = f"{node:.2f}" if math.isfinite(node) else "-"
        yield f"  {i:>4} {hertz:16.4f} {omega:15.4f} {ratio:15.4f} {where:>14}"


def name_width(case: Case) -> int:
    """Width of a column with the names of gears or stations."""
    aircraft = case.aircraft
    return max(7, *map(len, aircraft.gear_names), *map(len, aircraft.stations))


def load_digits(case: Case) -> int:
    """Digits of loads after the point."""
    return 1 if case.aircraft.static_load.max() >= 1e3 else 4


def loads_table(
    case: Case, when: str, largest: Peaks, smallest: Peaks, remarks: Iterable[str]
) -> Iterator[str]:
    """Tabulate largest and smallest loads, one line per gear; `when` is in this unit."""
    aircraft, width, digits = case.aircraft, name_width(case), load_digits(case)
    force, where = (
        f"[{case.units.force}]",
        f"{f'at [{when}]':>11} {f'gear at [{case.units.length}]':>13}",
    )
    heads = f"{f'static {force}':>15} {f'largest {force}':>16}  ÷ static{where}"
    yield f"  {'gear':<{width}} {heads} {f'smallest {force}':>17}{where}"
    rows = zip(aircraft.gear_names, aircraft.static_load, *largest, *smallest, remarks, strict=True)
    for gear, static, high, high_at, high_where, low, low_at, low_where, remark in rows:
        yield (
            f"  {gear:<{width}} {static:15.{digits}f} {high:16.{digits}f} {share(high, static):>9}"
            f" {high_at:10.4f} {high_where:13.2f} {low:17.{digits}f} {low_at:10.4f}"
            f" {low_where:13.2f}  {remark}".rstrip()
        )


def unloading(gears: Sequence[str]) -> Iterator[str]:
    """Warn of gears whose load reaches zero in a linear run."""
    if gears:
        names = ", ".join(gears)
        yield f"  WARNING: load reaches zero on {names}; the linear model does not hold beyond that"
