"""``runway-modal sweep``: rolls over the tracks at many speeds, prints the worst, writes all."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from runway_modal import tables_sweep
from runway_modal._quantities import ACCELERATION_LIMIT
from runway_modal.case import read_case
from runway_modal.plotting_sweep import loads_and_accelerations
from runway_modal.sweep import sweep, worst_speed

from .notes import ignored, notes
from .output import Output, figure_writer, table_writers
from .text import heading, load_digits, loads_table, modes_table, name_width, unloading

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from runway_modal.case import Case
    from runway_modal.case.speed_range import SpeedRange
    from runway_modal.profile import Profile
    from runway_modal.sweep import Sweep


def run(path: Path, asked: Mapping[str, str | None]) -> None:
    """Sweep the speeds of a case file; `asked` names files by kind."""
    case = read_case(path)
    case.need_linear("a sweep")
    span, tracks = case.speed_range(), case.given_tracks()
    output = Output.of(case, asked)
    with span.place.located():
        found = sweep(case.modes, tracks, span.speeds(), damping_input=case.damping_input)
    output.say(_summary(case, found))
    output.write(
        table_writers(lambda: [tables_sweep.quantities(found)], case.units)
        | figure_writer(lambda: loads_and_accelerations(found, case.title, units=case.units))
    )
    # Last, line by line: it may take long or come to nothing.
    for line in _proven(case, tracks, span):
        output.say([line])


def _summary(case: Case, found: Sweep) -> Iterator[str]:
    knots = found.speed / case.units.knot
    yield from heading(case)
    yield from notes(case)
    yield from ignored(case, "sweep", "duration", "output")
    yield ""
    yield from modes_table(case)
    yield ""
    yield f"{knots.size} speeds from {knots[0]:.6g} to {knots[-1]:.6g} kt"
    yield from _loads(case, found, knots)
    yield from _accelerations(case, found, knots)
    lost = zip(case.aircraft.gear_names, found.unloaded.T, strict=True)
    yield from unloading(
        [
            f"{gear} (at {at.sum()} speeds, from {knots[at][0]:.6g} kt)"
            for gear, at in lost
            if at.any()
        ]
    )


def _loads(case: Case, found: Sweep, knots: NDArray[np.float64]) -> Iterator[str]:
    gears = range(found.static_load.size)
    high, low = found.max_load.argmax(axis=0), found.min_load.argmin(axis=0)
    yield from loads_table(
        case,
        "kt",
        (found.max_load[high, gears], knots[high], found.position_of_max[high, gears]),
        (found.min_load[low, gears], knots[low], found.position_of_min[low, gears]),
        ["UNLOADS" if lost.any() else "" for lost in found.unloaded.T],
    )


def _accelerations(case: Case, found: Sweep, knots: NDArray[np.float64]) -> Iterator[str]:
    width, over = name_width(case), f"over [{case.units.length}]"
    above = f"first above {ACCELERATION_LIMIT} g [kt]"
    heads = f"   largest vertical acceleration [g]    at [kt]{over:>14} {above:>24}"
    yield f"  {'station':<{width}}{heads}"
    for station, values in found.max_acceleration.items():
        shares = values / case.units.standard_gravity
        rough = knots[shares > ACCELERATION_LIMIT]
        first = f"{rough[0]:.4f}" if rough.size else "-"
        at = shares.argmax()
        where = found.position_of_max_acceleration[station][at]
        yield f"  {station:<{width}} {shares[at]:35.4f} {knots[at]:10.4f}{where:14.2f} {first:>24}"


def _proven(case: Case, tracks: Mapping[str, Profile], span: SpeedRange) -> Iterator[str]:
    """Tell what no speed of the range exceeds, between the steps too."""
    tolerance = span.tolerance
    if tolerance is None:
        return
    width, digits, force = name_width(case), load_digits(case), f"[{case.units.force}]"

    def worst(gear: str, quantity: Literal["max_load", "min_load"]) -> str:
        with span.place.located():
            found = worst_speed(
                case.modes,
                tracks,
                (span.low, span.high),
                quantity,
                at=gear,
                tolerance=tolerance,
                damping_input=case.damping_input,
            )
        knots = found.speed / case.units.knot
        # Rounded outwards: what is printed is proven, too.
        outwards = math.ceil if quantity == "max_load" else math.floor
        bound = outwards(found.bound * 10**digits) / 10**digits
        return f"{found.value:16.{digits}f} {knots:10.4f} {bound:17.{digits}f} {found.runs:8d}"

    yield ""
    yield "Largest and smallest load at any speed of the range, proven"
    heads = (
        f"{f'{what} {force}':>16}    at [kt] {f'none {beyond} {force}':>17}     runs"
        for what, beyond in (("largest", "above"), ("smallest", "below"))
    )
    yield f"  {'gear':<{width}}{''.join(heads)}"
    for gear in case.aircraft.gear_names:
        yield f"  {gear:<{width}}{worst(gear, 'max_load')}{worst(gear, 'min_load')}"
