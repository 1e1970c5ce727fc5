"""``runway-modal sweep``: rolls over the tracks at many speeds, prints the worst, writes all."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from runway_modal import tables_sweep
from runway_modal._quantities import ACCELERATION_LIMIT, EXTREMES_OF_GEARS, EXTREMES_OF_STATIONS
from runway_modal.case import read_case
from runway_modal.plotting_sweep import loads_and_accelerations
from runway_modal.sweep import sweep

from .documents import by_name, json_writer
from .notes import ignored, notes
from .output import Output, figure_writer, table_writers
from .proof import proof
from .text import heading, loads_table, modes_table, name_width, unloading

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from runway_modal.case import Case
    from runway_modal.case.speed_range import SpeedRange
    from runway_modal.sweep import Sweep

    from .proof import Proven


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
    proven: Proven = {}
    try:
        # Last: it may take long or come to nothing.
        for line in proof(case, tracks, span, proven):
            output.say([line])
    finally:
        output.write(json_writer(case, lambda: _document(found, span, proven)))


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
    above = f"first of these above {ACCELERATION_LIMIT} g [kt]"
    heads = f"   largest vertical acceleration [g]    at [kt]{over:>14} {above:>33}"
    yield f"  {'station':<{width}}{heads}"
    for station, values in found.max_acceleration.items():
        shares = values / case.units.standard_gravity
        rough = knots[shares > ACCELERATION_LIMIT]
        first = f"{rough[0]:.4f}" if rough.size else "-"
        at = shares.argmax()
        where = found.position_of_max_acceleration[station][at]
        yield f"  {station:<{width}} {shares[at]:35.4f} {knots[at]:10.4f}{where:14.2f} {first:>33}"


def _document(found: Sweep, span: SpeedRange, proven: Proven) -> dict[str, Any]:
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
        "tolerance": span.tolerance,
        "acceleration_tolerance": span.acceleration_tolerance,
        "proven": {
            quantity: {at: asdict(worst) for at, worst in found.items()}
            for quantity, found in proven.items()
        },
    }
