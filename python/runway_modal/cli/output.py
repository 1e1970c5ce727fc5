"""Where the results of a case go: standard output and files."""

from __future__ import annotations

import io
import os
import sys
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from runway_modal import tables
from runway_modal._core import InputError
from runway_modal._extras import need

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from matplotlib.figure import Figure

    from runway_modal.case import Case
    from runway_modal.units import Units

#: Stands for standard output.
_STANDARD = "-"

#: Kinds of files that can be written there.
_STREAMS = ("csv", "json")

#: Suffixes of formats, by kind; "" for those that no command writes.
_SUFFIXES = {
    "csv": (".csv",),
    "json": (".json",),
    "parquet": (".parquet", ".pq"),
    "": (".xlsx", ".xls", ".ods"),
}


@dataclass(frozen=True, slots=True)
class Output:
    """Files that a command writes, by kind, and the stream for what it says."""

    paths: Mapping[str, str]
    stream: TextIO

    @classmethod
    def of(cls, case: Case, asked: Mapping[str, object]) -> Output:
        """Take the files asked for; refuse what cannot be written, before anything is computed."""
        paths = {kind: str(to) for kind, to in asked.items() if to}
        taken = {source.resolve(): "that is a track of the case" for source in case.sources}
        taken[case.sources[0].resolve()] = "that is the case file"
        for kind, to in paths.items():
            if to == _STANDARD:
                if kind not in _STREAMS:
                    there = " or ".join(kind for kind in _STREAMS if kind in asked)
                    raise InputError(f"--{kind} -: only {there} can go to standard output")
                continue
            path = Path(to)
            if path.resolve() in taken:
                raise InputError(f"{kind} {to}: {taken[path.resolve()]}")
            taken[path.resolve()] = f"already taken by {kind}"
            _check_file(kind, to)
        if list(paths.values()).count(_STANDARD) > 1:
            raise InputError("--csv - and --json -: only one of them can go to standard output")
        if "parquet" in paths:
            need("Parquet files", "tables", "pandas", "pyarrow")
        return cls(paths, sys.stderr if _STANDARD in paths.values() else sys.stdout)

    def say(self, lines: Iterable[str]) -> None:
        """Print; if the reader has gone, drop the rest, so that files are still written."""
        try:
            print("\n".join(lines), file=self.stream, flush=True)
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self.stream.fileno())

    def write(self, writers: Mapping[str, Callable[[str], None]]) -> None:
        """Write the files of these kinds that are wanted."""
        wanted = {kind: self.paths[kind] for kind in writers if kind in self.paths}
        # Files first: the reader of standard output may stop early.
        for kind, to in sorted(wanted.items(), key=lambda item: item[1] == _STANDARD):
            writers[kind](to)
            if to != _STANDARD:
                self.say([f"{kind}: {to}"])


def _check_file(kind: str, to: str) -> None:
    path = Path(to)
    if path.is_dir():
        raise InputError(f"{kind} {to}: that is a directory")
    if not path.parent.is_dir():
        raise InputError(f"{kind} {to}: no such directory")
    if kind == "figure":
        need("figures", "plot", "matplotlib")
        from matplotlib.figure import Figure

        known = Figure().canvas.get_supported_filetypes()
        if path.suffix.removeprefix(".").lower() not in known:
            raise InputError(f"figure {to}: the suffix is none of {', '.join(known)}")
        return
    for other, suffixes in _SUFFIXES.items():
        if kind != other and path.suffix.lower() in suffixes:
            raise InputError(f"{kind} {to}: what is written is {kind}, not {path.suffix[1:]}")


def table_writers(
    found: Callable[[], Iterable[Sequence[tables.Quantity]]], units: Units, index: str | None = None
) -> dict[str, Callable[[str], None]]:
    """Make the writers of tables: CSV and, with `index` as its index, Parquet."""

    def write_csv(to: str) -> None:
        with opened(to) as file:
            tables.write_csv(found(), units, file)

    return {
        "csv": write_csv,
        "parquet": lambda to: tables.write_parquet(found(), units, Path(to), index),
    }


def figure_writer(draw: Callable[[], Figure]) -> dict[str, Callable[[str], None]]:
    """Make the writer of a figure; the suffix of the file name selects the format."""
    return {"figure": lambda to: draw().savefig(to, dpi=110)}


@contextmanager
def opened(to: str) -> Iterator[TextIO]:
    """Open a file, or standard output, for UTF-8 text with the same bytes on every system."""
    if to != _STANDARD:
        with Path(to).open("w", encoding="utf-8", newline="") as file:
            yield file
        return
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8", newline="")
    yield sys.stdout
