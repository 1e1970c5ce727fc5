"""Where the results of a case go: standard output and files."""

from __future__ import annotations

import io
import os
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from runway_modal import stored
from runway_modal._axes import require
from runway_modal._core import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from matplotlib.figure import Figure

    from runway_modal.case import Case

#: Stands for standard output.
STANDARD = "-"

#: Kinds of files that can be written there.
_STREAMS = ("csv", "json")


def summary_stream(case: Case, wanted: Mapping[str, str]) -> TextIO:
    """Check the paths wanted, by kind; choose the stream that no table is written to."""
    for kind, to in wanted.items():
        if to == STANDARD and kind not in _STREAMS:
            there = " or ".join(kind for kind in _STREAMS if kind in wanted)
            raise InputError(f"--{kind} -: only {there} can go to standard output")
    taken = {source.resolve(): "that is a track of the case" for source in case.sources}
    taken[case.sources[0].resolve()] = "that is the case file"
    for kind, to in wanted.items():
        if to and to != STANDARD:
            path = Path(to).resolve()
            if path in taken:
                raise InputError(f"{kind} {to}: {taken[path]}")
            taken[path] = f"already taken by {kind}"
    if list(wanted.values()).count(STANDARD) > 1:
        raise InputError("--csv - and --json -: only one of them can go to standard output")
    return sys.stderr if STANDARD in wanted.values() else sys.stdout


#: Suffixes of formats, by kind; "" for one that no command writes.
_SUFFIXES = {
    "csv": (".csv",),
    "json": (".json",),
    "parquet": (".parquet", ".pq"),
    "": (".xlsx", ".xls", ".ods"),
}


def check_files(wanted: Mapping[str, str]) -> None:
    """Refuse files that cannot be written, before the computation and not after it."""
    for kind, to in wanted.items():
        if not to or to == STANDARD:
            continue
        path = Path(to)
        if not path.parent.is_dir():
            raise InputError(f"{kind} {to}: no such directory")
        for other, suffixes in _SUFFIXES.items():
            if kind not in ("figure", other) and path.suffix.lower() in suffixes:
                raise InputError(f"{kind} {to}: what is written is {kind}, not {path.suffix[1:]}")
    if wanted.get("parquet"):
        stored.require()
    if wanted.get("figure"):
        require()
        from matplotlib.figure import Figure

        kinds = Figure().canvas.get_supported_filetypes()
        if Path(wanted["figure"]).suffix.removeprefix(".").lower() not in kinds:
            raise InputError(f"figure {wanted['figure']}: the suffix is none of {', '.join(kinds)}")


def say(text: str, stream: TextIO) -> None:
    """Print; if the reader has gone, drop the rest, so that files are still written."""
    try:
        print(text, file=stream, flush=True)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def stated_speed(case: Case, name: str) -> str:
    """Give a speed as written in the file, and in the case's units."""
    exact = f"{case.speeds[name]:.6g} {case.units.length}/s"
    return name if name == exact else f"{name} = {exact}"


@contextmanager
def opened(to: str) -> Iterator[TextIO]:
    """Open a file, or standard output, for UTF-8 text with the same bytes on every system."""
    if to != STANDARD:
        with Path(to).open("w", encoding="utf-8", newline="") as file:
            yield file
        return
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8", newline="")
    yield sys.stdout


def save_figure(figure: Figure, to: str) -> None:
    """Write a figure; the suffix of the file name selects the format."""
    figure.savefig(to, dpi=110)
