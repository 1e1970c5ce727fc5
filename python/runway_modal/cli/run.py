"""``runway-modal run``: simulates a case, prints a summary, writes the files asked for."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from runway_modal import tables, tables_response
from runway_modal._input import integer
from runway_modal.case import Case, read_case

from .notes import notes
from .output import (
    STANDARD,
    check_files,
    opened,
    save_figure,
    say,
    stated_speed,
    summary_stream,
)
from .text import loads_table, modes_table, name_width

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from runway_modal import nonlinear
    from runway_modal.response import Response

    #: One run by the text of its speed.
    Runs: TypeAlias = Mapping[str, Response | nonlinear.Response]


def run(path: Path, asked: Mapping[str, str | None], runway: int | None = None) -> None:
    """
    Run a case file; `asked` names files by kind and overrides those of the case.

    `runway` is the number of a random runway that replaces the tracks; the files of the case are
    then ignored.
    """
    case = read_case(path)
    if runway is not None:
        case = case.over_random_runway(integer("--runway", runway, 0))
    wanted = {kind: str(asked[kind] or case.output.get(kind) or "") for kind in KINDS}
    stream = summary_stream(case, wanted)
    check_files(wanted)
    runs = case.run()
    say("\n".join(_summary(case, runs)), stream)
    # Files first: the reader of standard output may stop early.
    for kind, to in sorted(wanted.items(), key=lambda item: item[1] == STANDARD):
        if to:
            _WRITERS[kind](case, runs, to)
            if to != STANDARD:
                say(f"{kind}: {to}", stream)


def _summary(case: Case, runs: Runs) -> Iterator[str]:
    units = case.units
    yield case.title
    yield f"Units: {units.length}, {units.force}, s"
    yield from notes(case)
    yield ""
    if case.reference is not None:
        yield "Nonlinear aircraft; its modes near rest:"
    yield from modes_table(case)
    for name, response in runs.items():
        yield ""
        yield from _of_speed(case, name, response)


def _of_speed(case: Case, name: str, response: Response | nonlinear.Response) -> Iterator[str]:
    units, gears, width = case.units, response.aircraft.gear_names, name_width(case)
    extremes, unloaded = response.extremes(), response.unloaded
    yield f"Speed {stated_speed(case, name)}, {response.time[0]:.4g} to {response.time[-1]:.4g} s"
    yield from loads_table(
        case,
        "s",
        (extremes.max_load, extremes.time_of_max, extremes.position_of_max),
        (extremes.min_load, extremes.time_of_min, extremes.position_of_min),
        ["UNLOADS" if lost else "" for lost in unloaded],
    )
    yield f"  {'station':<{width}}   largest vertical acceleration [g]     at [s]"
    for station, value in extremes.max_acceleration.items():
        at = extremes.time_of_max_acceleration[station]
        yield f"  {station:<{width}} {value / units.standard_gravity:35.4f} {at:10.4f}"
    if unloaded.any() and case.reference is None:
        lost = ", ".join(n for n, u in zip(gears, unloaded, strict=True) if u)
        yield f"  WARNING: load reaches zero on {lost}; the linear model does not hold beyond that"


def _write_csv(case: Case, runs: Runs, to: str) -> None:
    with opened(to) as file:
        tables.write_csv(_tables(case, runs), case.units, file)


def _write_json(case: Case, runs: Runs, to: str) -> None:
    document = {
        "title": case.title,
        "units": {"length": case.units.length, "force": case.units.force, "time": "s"},
        "nonlinear": case.reference is not None,
        "inferred": case.notes,
        "modes": {
            "omega": case.modes.omega.tolist(),
            "damping_ratio": case.modes.damping_ratio.tolist(),
            "shapes": case.modes.shapes.tolist(),
            "static_correction": case.modes.static_correction,
        },
        "runs": [_results(case, name, response) for name, response in runs.items()],
    }
    with opened(to) as file:
        json.dump(document, file, indent=1, allow_nan=False)
        file.write("\n")


def _results(case: Case, name: str, response: Response | nonlinear.Response) -> dict[str, Any]:
    extremes = response.extremes()
    history = tables.columns(tables_response.quantities(response))

    def by_gear(values: Any) -> dict[str, Any]:
        return dict(zip(response.aircraft.gear_names, values.tolist(), strict=True))

    return {
        "speed": case.speeds[name],
        "stated_speed": name,
        "static_load": by_gear(response.static_load),
        "max_load": by_gear(extremes.max_load),
        "time_of_max": by_gear(extremes.time_of_max),
        "position_of_max": by_gear(extremes.position_of_max),
        "min_load": by_gear(extremes.min_load),
        "time_of_min": by_gear(extremes.time_of_min),
        "position_of_min": by_gear(extremes.position_of_min),
        "unloaded": by_gear(response.unloaded),
        "max_acceleration": extremes.max_acceleration,
        "time_of_max_acceleration": extremes.time_of_max_acceleration,
        "history": {name: values.tolist() for name, values in history.items()},
    }


def _write_parquet(case: Case, runs: Runs, to: str) -> None:
    tables.write_parquet(_tables(case, runs), case.units, Path(to))


def _write_figure(case: Case, runs: Runs, to: str) -> None:
    from runway_modal.plotting import loads_over_profile

    gears = case.modes.aircraft.gear_names
    figure = loads_over_profile(
        runs,
        # The model of one degree of freedom has one gear, named "gear".
        {name: name if name == "gear" else f"{name} gear" for name in gears},
        case.title,
        units=case.units,
        against="time" if len(runs) == 1 else "distance",
    )
    save_figure(figure, to)


def _tables(case: Case, runs: Runs) -> Iterator[list[tables.Quantity]]:
    return (
        tables_response.with_speed(case.speeds[name], response) for name, response in runs.items()
    )


_WRITERS: dict[str, Callable[[Case, Runs, str], None]] = {
    "csv": _write_csv,
    "json": _write_json,
    "parquet": _write_parquet,
    "figure": _write_figure,
}

#: Kinds of files.
KINDS = tuple(_WRITERS)
