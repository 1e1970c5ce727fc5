"""``runway-modal sweep``: rolls over the tracks at many speeds, prints the worst, writes all."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Literal

from runway_modal import tables_sweep
from runway_modal._quantities import ACCELERATION_LIMIT, EXTREMES_OF_GEARS, EXTREMES_OF_STATIONS
from runway_modal.case import read_case
from runway_modal.plotting_sweep import loads_and_accelerations
from runway_modal.sweep import sweep, worst_speed

from .documents import by_name, json_writer
from .notes import ignored, notes
from .output import Output, figure_writer, table_writers
from .text import heading, load_digits, loads_table, modes_table, name_width, unloading

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from runway_modal.case import Case
    from runway_modal.case.speed_range import SpeedRange
    from runway_modal.profile import Profile
    from runway_modal.sweep import Sweep, WorstSpeed


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
    # Last, gear by gear: it may take long or come to nothing.
    proven: dict[str, dict[str, WorstSpeed]] = {}
    if span.tolerance is not None:
        output.say(_heads_of_proven(case))
        for gear in case.aircraft.gear_names:
            proven[gear] = _worst_speeds(case, tracks, span, gear, span.tolerance)
            output.say([_proven(case, gear, **proven[gear])])
    output.write(json_writer(case, lambda: _document(found, proven)))


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


def _worst_speeds(
    case: Case, tracks: Mapping[str, Profile], span: SpeedRange, gear: str, tolerance: float
) -> dict[str, WorstSpeed]:
    """Find what no speed of the range exceeds at a gear, between the steps too."""
    quantities: tuple[Literal["max_load", "min_load"], ...] = ("max_load", "min_load")
    with span.place.located():
        return {
            quantity: worst_speed(
                case.modes,
                tracks,
                (span.low, span.high),
                quantity,
                at=gear,
                tolerance=tolerance,
                damping_input=case.damping_input,
            )
            for quantity in quantities
        }


def _heads_of_proven(case: Case) -> Iterator[str]:
    force = f"[{case.units.force}]"
    yield ""
    yield "Largest and smallest load at any speed of the range, proven"
    heads = (
        f"{f'{what} {force}':>16}    at [kt] {f'none {beyond} {force}':>17}     runs"
        for what, beyond in (("largest", "above"), ("smallest", "below"))
    )
    yield f"  {'gear':<{name_width(case)}}{''.join(heads)}"


def _proven(case: Case, gear: str, max_load: WorstSpeed, min_load: WorstSpeed) -> str:
    digits = load_digits(case)

    def cells(found: WorstSpeed, outwards: Callable[[float], int]) -> str:
        knots = found.speed / case.units.knot
        # Rounded outwards: what is printed is proven, too.
        bound = outwards(found.bound * 10**digits) / 10**digits
        return f"{found.value:16.{digits}f} {knots:10.4f} {bound:17.{digits}f} {found.runs:8d}"

    largest, smallest = cells(max_load, math.ceil), cells(min_load, math.floor)
    return f"  {gear:<{name_width(case)}}{largest}{smallest}"


def _document(found: Sweep, proven: Mapping[str, Mapping[str, WorstSpeed]]) -> dict[str, Any]:
    gears = found.gear_names
    return {
        "speed": found.speed.tolist(),
        "static_load": by_name(gears, found.static_load),
        **{key: by_name(gears, getattr(found, key).T) for key in EXTREMES_OF_GEARS},
        **{
            key: {station: values.tolist() for station, values in getattr(found, key).items()}
            for key in EXTREMES_OF_STATIONS
        },
        "unloaded": by_name(gears, found.unloaded.T),
        "proven": {
            gear: {quantity: asdict(worst) for quantity, worst in of_gear.items()}
            for gear, of_gear in proven.items()
        },
    }
