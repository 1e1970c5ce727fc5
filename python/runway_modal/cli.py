"""The command ``runway-modal``."""

from __future__ import annotations

import argparse
import json
import math
import sys
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from . import tables
from ._core import InputError, NumericalError
from .case import Case, read_case

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from .response import Response

_START = """\
to begin:
  runway-modal example > case.toml      a case with every key explained
  runway-modal run case.toml --figure loads.png

exit codes: 0 done, 1 numerical failure or missing extra, 2 bad input
"""


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; the exit code."""
    parsed = _parser().parse_args(arguments)
    try:
        parsed.command(parsed)
    except BrokenPipeError:
        # Whoever read has enough; the interpreter shall not flush into nothing.
        sys.stdout = None
        return 0
    except (InputError, OSError) as error:
        print(f"runway-modal: error: {error}", file=sys.stderr)
        return 2
    except (NumericalError, ImportError) as error:
        print(f"runway-modal: error: {error}", file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="runway-modal",
        description="What does this runway do to this aircraft? Exact modal response.",
        epilog=_START,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=version("runway_modal"))
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    run = commands.add_parser("run", help="simulate a case file", description=_run.__doc__)
    run.set_defaults(command=_run)
    run.add_argument("case", type=Path, metavar="CASE.toml")
    for kind, what in (
        ("csv", "time histories; - for standard output"),
        ("json", "results and time histories; - for standard output"),
        ("parquet", "time histories (extra tables)"),
        ("figure", "gear loads over the profile: .png, .pdf, .svg ... (extra plot)"),
    ):
        run.add_argument(f"--{kind}", metavar="PATH", help=what)

    example = commands.add_parser("example", help="print a commented case file")
    example.set_defaults(command=_example)

    report = commands.add_parser("report", help="the 1980 report, recomputed, as a page")
    report.set_defaults(command=_report)
    report.add_argument("--out", type=Path, required=True, metavar="DIR")
    return parser


def _example(_: argparse.Namespace) -> None:
    print((files("runway_modal") / "example.toml").read_text(encoding="utf-8"), end="")


def _report(parsed: argparse.Namespace) -> None:
    from . import report1980

    print(report1980.write_page(parsed.out))


def _run(parsed: argparse.Namespace) -> None:
    """Print modes, static loads and, for each speed, extremes; write what is asked for."""
    case = read_case(parsed.case)
    responses = case.run()
    wanted = {kind: getattr(parsed, kind) or case.output.get(kind) for kind in _WRITERS}
    to_stdout = [kind for kind in ("csv", "json") if wanted[kind] == "-"]
    if len(to_stdout) > 1:
        raise InputError("--csv - and --json -: standard output takes one of them")
    # A table that goes to another program comes alone.
    if not to_stdout:
        print("\n".join(_lines(case, responses)))
    for kind, path in wanted.items():
        if kind in to_stdout:
            _WRITERS[kind](case, responses, sys.stdout)
        elif path:
            _WRITERS[kind](case, responses, Path(path))
            if not to_stdout:
                print(f"{kind}: {path}")


def _lines(case: Case, responses: Mapping[str, Response]) -> Iterator[str]:
    units, modes = case.units, case.modes
    yield case.title
    yield f"Units: {units.length}, {units.force}, s"
    for note in case.notes:
        yield f"Inferred, not published: {note}"
    yield ""
    yield "  mode   frequency [Hz]   omega [rad/s]   damping ratio   node [" + units.length + "]"
    rows = zip(modes.frequency_hz, modes.omega, modes.damping_ratio, modes.node, strict=True)
    for i, (hertz, omega, ratio, node) in enumerate(rows, 1):
        # Roll leaves the whole centreline at rest.
        where = "-" if math.isnan(node) else f"{node:.2f}"
        yield f"  {i:<4} {hertz:16.4f} {omega:15.4f} {ratio:15.4f} {where:>12}"
    for name, response in responses.items():
        yield ""
        yield from _results(case, name, response)


def _results(case: Case, name: str, response: Response) -> Iterator[str]:
    force = case.units.force
    gears = case.modes.aircraft.gear_names
    width = max(7, *map(len, gears), *map(len, response.acceleration))
    extremes = response.extremes()
    span = f"{response.time[0]:g} to {response.time[-1]:.4g} s"
    yield f"Speed {name} = {case.speeds[name]:.6g} {case.units.length}/s, {span}"
    yield (
        f"  {'gear':<{width}} {f'static [{force}]':>15} {f'largest [{force}]':>16} {'at [s]':>8}"
        f" {f'smallest [{force}]':>17} {'at [s]':>8}"
    )
    digits = 1 if response.static_load.max() >= 1e3 else 4
    for g, gear in enumerate(gears):
        yield (
            f"  {gear:<{width}} {response.static_load[g]:15.{digits}f}"
            f" {extremes.max_load[g]:16.{digits}f} {extremes.time_of_max[g]:8.4f}"
            f" {extremes.min_load[g]:17.{digits}f} {extremes.time_of_min[g]:8.4f}"
        )
    yield f"  {'station':<{width}}   largest vertical acceleration [g]   at [s]"
    for station, value in extremes.max_acceleration.items():
        at = extremes.time_of_max_acceleration[station]
        yield f"  {station:<{width}} {value / case.units.standard_gravity:35.4f} {at:8.4f}"
    if response.unloaded.any():
        lost = ", ".join(n for n, u in zip(gears, response.unloaded, strict=True) if u)
        yield f"  WARNING: {lost} unloads: past that the linear model no longer holds."


def _summary(case: Case, name: str, response: Response) -> dict[str, Any]:
    extremes = response.extremes()

    def by_gear(values: Any) -> dict[str, Any]:
        return dict(zip(case.modes.aircraft.gear_names, values.tolist(), strict=True))

    return {
        "speed": case.speeds[name],
        "stated_speed": name,
        "static_load": by_gear(response.static_load),
        "max_load": by_gear(extremes.max_load),
        "time_of_max": by_gear(extremes.time_of_max),
        "min_load": by_gear(extremes.min_load),
        "time_of_min": by_gear(extremes.time_of_min),
        "unloaded": by_gear(response.unloaded),
        "max_acceleration": extremes.max_acceleration,
        "time_of_max_acceleration": extremes.time_of_max_acceleration,
        "history": {key: values.tolist() for key, values in tables.columns(response).items()},
    }


def _write_json(case: Case, responses: Mapping[str, Response], to: Path | TextIO) -> None:
    document = {
        "title": case.title,
        "units": {"length": case.units.length, "force": case.units.force, "time": "s"},
        "inferred": case.notes,
        "modes": {
            "omega": case.modes.omega.tolist(),
            "damping_ratio": case.modes.damping_ratio.tolist(),
            "shapes": case.modes.shapes.tolist(),
        },
        "runs": [_summary(case, name, response) for name, response in responses.items()],
    }
    text = json.dumps(document, indent=1, allow_nan=False) + "\n"
    if isinstance(to, Path):
        to.write_text(text, encoding="utf-8")
    else:
        to.write(text)


def _write_csv(case: Case, responses: Mapping[str, Response], to: Path | TextIO) -> None:
    by_speed = {case.speeds[name]: response for name, response in responses.items()}
    if isinstance(to, Path):
        with to.open("w", encoding="utf-8", newline="") as file:
            tables.write_csv(by_speed, case.units, file)
    else:
        tables.write_csv(by_speed, case.units, to)


def _write_parquet(case: Case, responses: Mapping[str, Response], to: Path) -> None:
    frames = []
    for name, response in responses.items():
        frame = tables.to_pandas(response, case.units)
        frame.insert(0, "speed", case.speeds[name])
        frame.attrs["units"]["speed"] = f"{case.units.length}/s"
        frames.append(frame)
    import pandas as pd

    pd.concat(frames, ignore_index=True).to_parquet(to)


def _write_figure(case: Case, responses: Mapping[str, Response], to: Path) -> None:
    from .plotting import loads_over_profile

    figure = loads_over_profile(
        responses,
        {name: f"{name} gear" for name in case.modes.aircraft.gear_names},
        case.title,
        units=case.units,
        against="time" if len(responses) == 1 else "distance",
    )
    try:
        figure.savefig(to, dpi=110)
    except ValueError as error:
        raise InputError(f"figure = '{to}': {error}") from None


_WRITERS: dict[str, Any] = {
    "csv": _write_csv,
    "json": _write_json,
    "parquet": _write_parquet,
    "figure": _write_figure,
}
