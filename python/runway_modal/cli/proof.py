"""What no speed of a range exceeds, between the steps of a sweep too."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from runway_modal._core import InputError
from runway_modal._quantities import LABELS
from runway_modal.sweep import worst_speed

from .text import load_digits, name_width

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from typing import TypeAlias

    from runway_modal.case import Case
    from runway_modal.case.speed_range import SpeedRange
    from runway_modal.profile import Profile
    from runway_modal.sweep import WorstSpeed

    _Quantity: TypeAlias = Literal["max_load", "min_load", "max_acceleration"]
    #: Worst speeds by quantity, then by gear or station.
    Proven: TypeAlias = dict[str, dict[str, WorstSpeed]]


def proof(
    case: Case, tracks: Mapping[str, Profile], span: SpeedRange, proven: Proven
) -> Iterator[str]:
    """Tell it line by line, as it is found, and add it to `proven`: a line may take long."""

    def find(quantity: _Quantity, at: str, key: str, tolerance: float) -> WorstSpeed:
        with span.place.located(key):
            try:
                found = worst_speed(
                    case.modes,
                    tracks,
                    (span.low, span.high),
                    quantity,
                    at=at,
                    tolerance=tolerance,
                    damping_input=case.damping_input,
                )
            except InputError as error:
                raise InputError(f"{error} ({at}: {LABELS[quantity]})") from None
        proven.setdefault(quantity, {})[at] = found
        return found

    def cells(
        found: WorstSpeed, scale: float, digits: int, outwards: Callable[[float], int]
    ) -> str:
        knots = found.speed / case.units.knot
        # Rounded outwards: what is printed is proven, too.
        bound = outwards(found.bound / scale * 10**digits) / 10**digits
        value = f"{found.value / scale:16.{digits}f} {knots:10.4f}"
        return f"{value} {bound:17.{digits}f} {found.runs:8d}"

    width = name_width(case)
    if span.tolerance is not None:
        unit, digits = f"[{case.units.force}]", load_digits(case)
        yield ""
        yield "Largest and smallest load at any speed of the range, proven"
        heads = _heads("largest", "above", unit) + _heads("smallest", "below", unit)
        yield f"  {'gear':<{width}}{heads}"
        for gear in case.aircraft.gear_names:
            largest = find("max_load", gear, "tolerance", span.tolerance)
            smallest = find("min_load", gear, "tolerance", span.tolerance)
            ends = cells(largest, 1.0, digits, math.ceil), cells(smallest, 1.0, digits, math.floor)
            yield f"  {gear:<{width}}{''.join(ends)}"
    if span.acceleration_tolerance is not None:
        yield ""
        yield "Largest vertical acceleration at any speed of the range, proven"
        yield f"  {'station':<{width}}{_heads('largest', 'above', '[g]')}"
        for station in case.aircraft.stations:
            key = "acceleration_tolerance"
            found = find("max_acceleration", station, key, span.acceleration_tolerance)
            yield f"  {station:<{width}}{cells(found, case.units.standard_gravity, 4, math.ceil)}"


def _heads(what: str, beyond: str, unit: str) -> str:
    return f"{f'{what} {unit}':>16}    at [kt] {f'none {beyond} {unit}':>17}     runs"
