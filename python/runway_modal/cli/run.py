"""``runway-modal run``: simulates a case, prints a summary, writes the files asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

from runway_modal import tables, tables_response
from runway_modal._files import is_number
from runway_modal._input import integer, positive
from runway_modal._quantities import EXTREMES_OF_GEARS, EXTREMES_OF_STATIONS
from runway_modal.case import Case, read_case
from runway_modal.units import LENGTH

from .documents import by_name, json_writer
from .notes import ignored, notes
from .output import Output, figure_writer, table_writers
from .text import heading, loads_table, modes_table, name_width, stated_speed, unloading

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from runway_modal import nonlinear
    from runway_modal.extremes import Extremes, Section
    from runway_modal.response import Response

    #: One run by the text of its speed.
    Runs: TypeAlias = Mapping[str, Response | nonlinear.Response]
    #: The sections of each, if they are wanted.
    Sections: TypeAlias = Mapping[str, Mapping[float, Section]]


#: Sections that are listed.
_WORST = 10


def run(
    path: Path,
    asked: Mapping[str, str | None],
    runway: int | None = None,
    sections: str | None = None,
) -> None:
    """
    Run a case file; `asked` names files by kind and overrides those of the case.

    `runway` is the number of a random runway that replaces the tracks; the files of the case are
    then ignored. `sections` asks for the worst sections of this length.
    """
    case = read_case(path)
    length = None
    if sections is not None:
        given = float(sections) if is_number(sections) else sections
        length = positive("--sections", case.units.quantity("--sections", given, LENGTH))
    if runway is not None:
        case = case.over_random_runway(integer("--runway", runway, 0))
    files = {kind: to or case.output.get(kind) for kind, to in asked.items()}
    output = Output.of(case, files)
    runs = case.run()
    found = {} if length is None else {name: runs[name].sections(length) for name in runs}
    output.say(_summary(case, runs, found, length, random=runway is not None))
    output.write(
        table_writers(lambda: _tables(case, runs), case.units)
        | figure_writer(lambda: _figure(case, runs))
        | json_writer(
            case,
            lambda: {"runs": [_results(case, name, runs[name], found.get(name)) for name in runs]},
        )
    )


def _summary(
    case: Case, runs: Runs, sections: Sections, length: float | None, *, random: bool
) -> Iterator[str]:
    yield from heading(case)
    yield from notes(case)
    if random:
        yield from ignored(case, "run --runway", "track", "footprint", "duration", "output")
    yield ""
    if case.reference is not None:
        yield "Nonlinear aircraft; its modes near rest:"
    yield from modes_table(case)
    for name, response in runs.items():
        yield ""
        yield from _of_speed(case, name, response)
        if length is not None:
            yield from _worst_sections(case, sections[name], length)


def _of_speed(case: Case, name: str, response: Response | nonlinear.Response) -> Iterator[str]:
    units, gears, width = case.units, response.gear_names, name_width(case)
    extremes, unloaded = response.extremes(), response.unloaded
    yield f"Speed {stated_speed(case, name)}, {response.time[0]:.4g} to {response.time[-1]:.4g} s"
    yield from loads_table(
        case,
        "s",
        (extremes.max_load, extremes.time_of_max, extremes.position_of_max),
        (extremes.min_load, extremes.time_of_min, extremes.position_of_min),
        ["UNLOADS" if lost else "" for lost in unloaded],
    )
    over = f"over [{units.length}]"
    heads = f"   largest vertical acceleration [g]     at [s]{over:>14}   RMS [g]"
    yield f"  {'station':<{width}}{heads}"
    for station, value in extremes.max_acceleration.items():
        at = extremes.time_of_max_acceleration[station]
        where = extremes.position_of_max_acceleration[station]
        share, mean = (
            acceleration / units.standard_gravity
            for acceleration in (value, response.rms_acceleration[station])
        )
        yield f"  {station:<{width}} {share:35.4f} {at:10.4f}{where:14.2f}{mean:10.4f}"
    if case.reference is None:
        yield from unloading([name for name, lost in zip(gears, unloaded, strict=True) if lost])


def _worst_sections(case: Case, sections: Mapping[float, Section], length: float) -> Iterator[str]:
    """Tabulate the sections with the largest loads, in shares of the static ones, and how rough."""
    static, unit = case.aircraft.static_load, case.units.length
    gears, stations = case.aircraft.gear_names, case.aircraft.stations

    def loads(begin: float) -> NDArray[np.float64]:
        largest = sections[begin].max_load
        return largest / static if static.all() else largest

    worst = sorted(sections, key=lambda begin: -loads(begin).max())[:_WORST]
    what = "÷ static" if static.all() else f"[{case.units.force}]"
    yield (
        f"  Worst {len(worst)} of {len(sections)} sections of {length:.6g} {unit}: "
        f"largest load {what}, largest vertical acceleration and its RMS [g]"
    )
    heads = [f"from [{unit}]", *gears, *(head for name in stations for head in (name, "RMS"))]
    widths = [max(10, len(head) + 2) for head in heads]
    yield "  " + "".join(map(str.rjust, heads, widths))
    for begin in worst:
        found = sections[begin]
        rough = zip(found.max_acceleration.values(), found.rms_acceleration.values(), strict=True)
        shares = [f"{load:.3f}" for load in loads(begin)]
        shaken = [f"{value / case.units.standard_gravity:.4f}" for pair in rough for value in pair]
        yield "  " + "".join(map(str.rjust, [f"{begin:.2f}", *shares, *shaken], widths))


def _results(
    case: Case,
    name: str,
    response: Response | nonlinear.Response,
    sections: Mapping[float, Section] | None,
) -> dict[str, Any]:
    history = tables.columns(tables_response.quantities(response))
    results: dict[str, Any] = {
        "speed": case.speeds[name],
        "stated_speed": name,
        "static_load": by_name(response.gear_names, response.static_load),
        **_extremes(response.extremes()),
        "unloaded": by_name(response.gear_names, response.unloaded),
        **_rms(response),
        "history": {name: values.tolist() for name, values in history.items()},
    }
    if sections is not None:
        results["sections"] = [
            {"begin": begin, **_extremes(found), **_rms(found)} for begin, found in sections.items()
        ]
    return results


def _extremes(extremes: Extremes) -> dict[str, Any]:
    names = extremes.gear_names
    gears = {key: by_name(names, getattr(extremes, key)) for key in EXTREMES_OF_GEARS}
    return gears | {key: getattr(extremes, key) for key in EXTREMES_OF_STATIONS}


def _rms(of: Response | nonlinear.Response | Section) -> dict[str, Any]:
    return {
        "rms_load": by_name(of.gear_names, of.rms_load),
        "rms_acceleration": of.rms_acceleration,
    }


def _figure(case: Case, runs: Runs) -> Figure:
    from runway_modal.plotting import loads_over_profile

    gears = case.modes.aircraft.gear_names
    return loads_over_profile(
        runs,
        # The model of one degree of freedom has one gear, named "gear".
        {name: name if name.endswith("gear") else f"{name} gear" for name in gears},
        case.title,
        units=case.units,
        against="time" if len(runs) == 1 else "distance",
        stations=[name for name in case.aircraft.stations if name != "cg"],
    )


def _tables(case: Case, runs: Runs) -> Iterator[list[tables.Quantity]]:
    return (
        tables_response.with_speed(case.speeds[name], response) for name, response in runs.items()
    )
