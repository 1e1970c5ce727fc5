"""What the commands that run a case have in common: where results go, and their modes."""

from __future__ import annotations

import io
import math
import os
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from ._core import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from matplotlib.figure import Figure

    from .case import Case

#: Stands for standard output.
STANDARD = "-"

#: Kinds of files that may go there.
_STREAMS = ("csv", "json")


def told(case: Case, wanted: Mapping[str, str]) -> TextIO:
    """Check the files wanted, by kind; the stream for what is said: a table goes out alone."""
    for kind, to in wanted.items():
        if to == STANDARD and kind not in _STREAMS:
            there = " or ".join(kind for kind in _STREAMS if kind in wanted)
            raise InputError(f"--{kind} -: standard output takes {there}")
    taken = {source.resolve(): "this is a track of the case" for source in case.sources}
    taken[case.sources[0].resolve()] = "this is the case file"
    for kind, to in wanted.items():
        if to and to != STANDARD:
            path = Path(to).resolve()
            if path in taken:
                raise InputError(f"{kind} {to}: {taken[path]}")
            taken[path] = f"this is where {kind} goes"
    if list(wanted.values()).count(STANDARD) > 1:
        raise InputError("--csv - and --json -: standard output takes one of them")
    return sys.stderr if STANDARD in wanted.values() else sys.stdout


def say(text: str, stream: TextIO) -> None:
    """Print; if nobody reads on, the rest goes nowhere, and files are written all the same."""
    try:
        print(text, file=stream, flush=True)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def modes_table(case: Case) -> Iterator[str]:
    """Say what the modes are."""
    modes = case.modes
    node = f"node [{case.units.length}]"
    yield f"  mode   frequency [Hz]   omega [rad/s]   damping ratio {node:>12}"
    rows = zip(modes.frequency_hz, modes.omega, modes.damping_ratio, modes.node, strict=True)
    for i, (hertz, omega, ratio, node) in enumerate(rows, 1):
        # Roll leaves the whole centreline at rest, and pure bounce nothing.
        where = f"{node:.2f}" if math.isfinite(node) else "-"
        yield f"  {i:>4} {hertz:16.4f} {omega:15.4f} {ratio:15.4f} {where:>12}"


def stated_speed(case: Case, name: str) -> str:
    """Say a speed as the file has it and in the case's units."""
    exact = f"{case.speeds[name]:.6g} {case.units.length}/s"
    return name if name == exact else f"{name} = {exact}"


@contextmanager
def opened(to: str) -> Iterator[TextIO]:
    """Open a file for text in UTF-8, the same on every system; or standard output."""
    if to != STANDARD:
        with Path(to).open("w", encoding="utf-8", newline="") as file:
            yield file
        return
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8", newline="")
    yield sys.stdout


def save_figure(figure: Figure, to: str) -> None:
    """Write a figure; its kind is the ending of the name."""
    try:
        figure.savefig(to, dpi=110)
    except ValueError as error:
        raise InputError(f"figure {to}: {error}") from None
