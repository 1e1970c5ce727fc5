"""The command ``runway-modal``: its arguments, its exit codes, its subcommands."""

from __future__ import annotations

import argparse
import io
import os
import sys
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from runway_modal._core import InputError, NumericalError, __version__

from . import monte_carlo, run, sweep

if TYPE_CHECKING:
    from collections.abc import Callable

_BEGIN = """\
getting started:
  runway-modal example > case.toml      a case file with every key explained
  runway-modal run case.toml --figure loads.png
  runway-modal sweep case.toml --figure speeds.png
  runway-modal mc case.toml --figure exceedance.png

exit codes: 0 success, 1 numerical failure, missing extra or out of memory,
2 bad input or a file that cannot be read or written, 130 interrupted
"""

_RUN = """\
Print modes, static loads and, for each speed, the true extremes of gear loads
and accelerations; write the files named here or under [output] in the case.
With --csv - or --json - the summary goes to standard error.
"""

_SWEEP = """\
Roll over the tracks of the case at each speed of [sweep]. Print each gear's largest and smallest
load, each station's largest acceleration, and the speeds at which they occur; with a tolerance in
[sweep], also what no speed in between exceeds. With --csv - or --json - the summary goes to
standard error.
"""

_MC = """\
Roll over the random runways of [roughness] and [monte_carlo] in the case, at each speed of [run].
Print means, quantiles and probabilities of exceedance with their confidence intervals, and the
worst runs by number; `runway-modal run CASE.toml --runway NUMBER` shows any run in full.
A terminal shows a progress bar (extra cli). With --csv - or --json - the summary goes to
standard error.
"""


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; return the exit code."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A character that the terminal cannot show is printed as its code.
            stream.reconfigure(errors="backslashreplace")
    parsed = _parser().parse_args(arguments)
    try:
        parsed.command(parsed)
        sys.stdout.flush()
    except BrokenPipeError:
        # The reader has gone: drop the rest of the output.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        return 130
    except OSError as error:
        named = error.filename is not None and error.strerror
        return _failed(f"{error.filename}: {error.strerror}" if named else str(error), 2)
    except InputError as error:
        return _failed(str(error), 2)
    except (NumericalError, ImportError) as error:
        return _failed(str(error), 1)
    except MemoryError as error:
        return _failed(f"out of memory: {error}", 1)
    return 0


def _failed(why: str, code: int) -> int:
    print(f"runway-modal: error: {why}", file=sys.stderr)
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="runway-modal",
        description="What does this runway do to this aircraft? Exact modal response.",
        epilog=_BEGIN,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=__version__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(
        name: str, run: Callable[[argparse.Namespace], None], does: str, more: str = ""
    ) -> argparse.ArgumentParser:
        command = commands.add_parser(
            name,
            help=does,
            description=more or f"{does[0].upper()}{does[1:]}.",
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        command.set_defaults(command=run)
        return command

    def takes_case(command: argparse.ArgumentParser) -> argparse.ArgumentParser:
        command.add_argument(
            "case", type=Path, metavar="CASE.toml", help="case file; see runway-modal example"
        )
        return command

    of_run = takes_case(add("run", _run, "simulate a case file", _RUN))
    of_run.add_argument("--csv", metavar="PATH", help="time histories; - for standard output")
    of_run.add_argument("--json", metavar="PATH", help="results and time histories; - as for --csv")
    of_run.add_argument("--parquet", metavar="PATH", help="time histories (extra tables)")
    of_run.add_argument(
        "--figure",
        metavar="PATH",
        help="gear loads and accelerations at the case's stations over the profile, "
        ".png .pdf .svg (extra plot)",
    )
    of_run.add_argument(
        "--runway",
        type=int,
        metavar="NUMBER",
        help="simulate random runway NUMBER of 'runway-modal mc' instead of the tracks; "
        "[output] is ignored",
    )
    of_run.add_argument(
        "--sections",
        metavar="LENGTH",
        help="list the sections of this length with the largest loads; '100 m', or a number in the "
        "case's units; --json writes all of them",
    )
    of_sweep = takes_case(add("sweep", _sweep, "roll over the tracks at many speeds", _SWEEP))
    of_sweep.add_argument("--csv", metavar="PATH", help="one row per speed; - for standard output")
    of_sweep.add_argument(
        "--json", metavar="PATH", help="extremes and proven bounds by speed; - as for --csv"
    )
    of_sweep.add_argument("--parquet", metavar="PATH", help="one row per speed (extra tables)")
    of_sweep.add_argument(
        "--figure",
        metavar="PATH",
        help="loads and accelerations against speed, .png .pdf .svg (extra plot)",
    )
    of_mc = takes_case(
        add("mc", _mc, "roll over random runways: the Monte Carlo of a case file", _MC)
    )
    of_mc.add_argument(
        "--runs", type=int, metavar="N", help="number of runs (overrides the case file)"
    )
    of_mc.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="keep finished runs, one directory per speed; the same command resumes from them "
        "(extra tables)",
    )
    of_mc.add_argument("--csv", metavar="PATH", help="one row per run; - for standard output")
    of_mc.add_argument(
        "--json", metavar="PATH", help="statistics with their intervals; - as for --csv"
    )
    of_mc.add_argument("--parquet", metavar="PATH", help="one row per run (extra tables)")
    of_mc.add_argument(
        "--figure",
        metavar="PATH",
        help="histogram and exceedance of the largest loads, and of accelerations at the case's "
        "stations, .png .pdf .svg (extra plot)",
    )
    of_mc.add_argument("--quiet", action="store_true", help="no progress bar")
    add("example", _example, "print a case file with every key explained")
    report = add(
        "report", _report, "recompute the 1980 report and write it as a page (extras plot, taxi)"
    )
    report.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="DIR",
        help="directory for the page, created if missing",
    )
    return parser


def _files(parsed: argparse.Namespace) -> dict[str, str | None]:
    """Files asked for, by kind."""
    kinds = ("csv", "json", "parquet", "figure")
    return {kind: getattr(parsed, kind) for kind in kinds if hasattr(parsed, kind)}


def _run(parsed: argparse.Namespace) -> None:
    run.run(parsed.case, _files(parsed), parsed.runway, parsed.sections)


def _sweep(parsed: argparse.Namespace) -> None:
    sweep.run(parsed.case, _files(parsed))


def _mc(parsed: argparse.Namespace) -> None:
    monte_carlo.run(
        parsed.case, _files(parsed), runs=parsed.runs, out=parsed.out, quiet=parsed.quiet
    )


def _example(_: argparse.Namespace) -> None:
    print((files("runway_modal.case") / "example.toml").read_text(encoding="utf-8"), end="")


def _report(parsed: argparse.Namespace) -> None:
    from runway_modal import report1980

    print(report1980.write_page(parsed.out))
