"""``runway-modal sweep``: rolls over the tracks at many speeds, prints the worst, writes all."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from runway_modal import tables, tables_sweep
from runway_modal._axes import ACCELERATION_LIMIT
from runway_modal.case import read_case
from runway_modal.sweep import sweep, worst_speed
from runway_modal.units import SPEED

from .notes import notes
from .output import (
    STANDARD,
    check_files,
    opened,
    save_figure,
    say,
    summary_stream,
)
from .text import load_digits, loads_table, modes_table, name_width

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from numpy.typing import NDArray

    from runway_modal.case import Case
    from runway_modal.case.speed_range import SpeedRange
    from runway_modal.profile import Profile
    from runway_modal.sweep import Sweep


def run(path: Path, asked: Mapping[str, str | None]) -> None:
    """Sweep the speeds of a case file; `asked` names files by kind."""
    case = read_case(path)
    span, tracks = case.speed_range(), case.given_tracks()
    if case.reference is not None:
        table = case.root.table("aircraft")
        raise table.fault("nonlinear: a sweep needs the linear model", "nonlinear")
    wanted = {kind: to or "" for kind, to in asked.items()}
    stream = summary_stream(case, wanted)
    check_files(wanted)
    with span.place.located():
        found = sweep(case.modes, tracks, span.speeds(), damping_input=case.damping_input)
    say("\n".join(_summary(case, found)), stream)
    if span.tolerance is not None:
        say("\n".join(_proven(case, tracks, span, span.tolerance)), stream)
    # Files first: the reader of standard output may stop early.
    for kind, to in sorted(wanted.items(), key=lambda item: item[1] == STANDARD):
        if to:
            _WRITERS[kind](case, found, to)
            if to != STANDARD:
                say(f"{kind}: {to}", stream)


def _knots(case: Case, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    return speeds / case.units.quantity("speed", "1 kt", SPEED)


def _summary(case: Case, found: Sweep) -> Iterator[str]:
    units, knots = case.units, _knots(case, found.speed)
    yield case.title
    yield f"Units: {units.length}, {units.force}, s"
    yield from notes(case)
    yield ""
    yield from modes_table(case)
    yield ""
    yield f"{knots.size} speeds from {knots[0]:.6g} to {knots[-1]:.6g} kt"
    yield from _loads(case, found, knots)
    yield from _accelerations(case, found, knots)
    lost = {
        gear: knots[found.unloaded[:, i]] for i, gear in enumerate(found.modes.aircraft.gear_names)
    }
    if found.unloaded.any():
        where = ", ".join(
            f"{gear} (at {at.size} speeds, from {at[0]:.6g} kt)"
            for gear, at in lost.items()
            if at.size
        )
        yield f"  WARNING: load reaches zero on {where}; the linear model does not hold beyond that"


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
    width = name_width(case)
    above = f"first above {ACCELERATION_LIMIT} g [kt]"
    yield f"  {'station':<{width}}   largest vertical acceleration [g]    at [kt] {above:>24}"
    for station, values in found.max_acceleration.items():
        shares = values / case.units.standard_gravity
        rough = knots[shares > ACCELERATION_LIMIT]
        first = f"{rough[0]:.4f}" if rough.size else "-"
        at = shares.argmax()
        yield f"  {station:<{width}} {shares[at]:35.4f} {knots[at]:10.4f} {first:>24}"


def _proven(
    case: Case, tracks: Mapping[str, Profile], span: SpeedRange, tolerance: float
) -> Iterator[str]:
    """Tell what no speed of the range exceeds, between the steps too."""
    width, digits, force = name_width(case), load_digits(case), case.units.force
    yield ""
    yield "Largest load at any speed of the range, proven"
    bound = f"none above [{force}]"
    yield f"  {'gear':<{width}} {f'found [{force}]':>15}    at [kt] {bound:>20}       runs"
    for gear in case.aircraft.gear_names:
        with span.place.located():
            worst = worst_speed(
                case.modes,
                tracks,
                (span.low, span.high),
                at=gear,
                tolerance=tolerance,
                damping_input=case.damping_input,
            )
        (knots,) = _knots(case, np.array([worst.speed]))
        yield (
            f"  {gear:<{width}} {worst.value:15.{digits}f} {knots:10.4f}"
            f" {worst.bound:20.{digits}f} {worst.runs:10d}"
        )


def _write_csv(case: Case, found: Sweep, to: str) -> None:
    with opened(to) as file:
        tables.write_csv([tables_sweep.quantities(found)], case.units, file)


def _write_parquet(case: Case, found: Sweep, to: str) -> None:
    tables.write_parquet([tables_sweep.quantities(found)], case.units, Path(to))


def _write_figure(case: Case, found: Sweep, to: str) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 7.5), layout="constrained")
    loads, accelerations = figure.subplots(2, 1, sharex=True)
    found.plot(ax=loads, units=case.units)
    found.plot_acceleration(ax=accelerations, units=case.units)
    loads.set_xlabel("")
    figure.suptitle(case.title)
    save_figure(figure, to)


_WRITERS: dict[str, Callable[[Case, Sweep, str], None]] = {
    "csv": _write_csv,
    "parquet": _write_parquet,
    "figure": _write_figure,
}

#: Kinds of files.
KINDS = tuple(_WRITERS)
