"""What readers and writers of profiles share, whatever the format."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Mapping
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from ._core import InputError
from .profile import Profile
from .units import convert_length, is_length_unit, length_unit

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    FilePath: TypeAlias = str | os.PathLike[str]

#: A column of a file: its name, or its number counted from 0.
Column: TypeAlias = str | int

#: Reads a decimal comma; a point for thousands becomes an error.
_DECIMAL_COMMA = str.maketrans({",": ".", ".": ","})

#: Name of a single profile in formats that need one.
ELEVATION = "elevation"


def fault(path: FilePath, line: int, what: str) -> InputError:
    """Make the error for a line of a file."""
    return InputError(f"{path}, line {line}: {what}")


def read_lines(path: FilePath) -> list[str]:
    """Read the lines of a text file with any line ends, without a byte order mark."""
    # Names in another encoding do not keep numbers from being read: their bytes stay as they are.
    text = Path(path).read_bytes().decode("utf-8-sig", errors="surrogateescape")
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        raise fault(path, line, "a zero byte: not a text file in UTF-8 or ASCII")
    return text.split("\n")


def excerpt(line: str) -> str:
    """Show the beginning of a line."""
    return repr(line if len(line) <= 60 else f"{line[:60]}…")


def wanted(elevation: Column | Mapping[str, Column]) -> dict[str, Column]:
    """Column of each profile, by name."""
    if not isinstance(elevation, Mapping):
        return {ELEVATION: elevation}
    if not elevation:
        raise InputError("elevation names no column")
    return dict(elevation)


def find(
    path: FilePath, line: int, column: Column, names: Sequence[str], others: Sequence[str]
) -> int:
    """Find the number of a column, given by number, by name or by its other name."""
    if isinstance(column, str):
        for known in (names, others):
            found = [i for i, name in enumerate(known) if name == column]
            if len(found) == 1:
                return found[0]
            if found:
                raise fault(path, line, f"columns {found} are all called {column!r}")
        known = [name for name in dict.fromkeys((*names, *others)) if name]
        # A heading without its unit need not be told again.
        longer = [name for name in known if any(n != name and n.startswith(name) for n in known)]
        there = ", ".join(repr(name) for name in known if name not in longer) or "no names"
        near = difflib.get_close_matches(column, known, 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        if any("\udc80" <= c <= "\udcff" for name in names for c in name):
            hint += "; the file is not in UTF-8: save it so, or give columns by number"
        raise fault(path, line, f"no column is called {column!r}; there are {there}{hint}")
    if isinstance(column, bool) or not isinstance(column, int | np.integer):
        why = "several are given as a mapping from tracks to columns"
        raise InputError(f"column {column!r} is neither a name nor a whole number; {why}")
    if not 0 <= column < len(names):
        raise fault(path, line, f"no column {column}; there are {len(names)}, counted from 0")
    return int(column)


def unit_of(path: FilePath, line: int, what: str, in_file: str, stated: str | None) -> str:
    """Choose the unit of a column: the file's, or the caller's if the file has none."""
    unit = in_file.lower()
    if is_length_unit(unit):
        if stated not in (None, unit):
            raise fault(
                path, line, f"{what} is in {in_file!r}, which contradicts unit = {stated!r}"
            )
        return unit
    if stated is None:
        said = f"unknown unit {in_file!r}" if in_file else "no unit"
        raise fault(path, line, f"{said} for {what}: give it as unit, or choose another column")
    return stated


def stated_units(unit: str | tuple[str, str] | None) -> tuple[str | None, str | None]:
    """Units of station and elevation as given by the caller."""
    if unit is None:
        return None, None
    if isinstance(unit, str):
        return length_unit("unit", unit), unit
    try:
        station, elevation = unit
    except (TypeError, ValueError):
        raise InputError(f"unit = {unit!r} is not a unit or a pair of units") from None
    return length_unit("unit[0]", station), length_unit("unit[1]", elevation)


def numbers(
    path: FilePath, lines: Sequence[int], cells: Sequence[str], what: str, decimal: str = "."
) -> NDArray[np.float64]:
    """Read finite numbers from cells, each from a line of the file."""
    texts = cells if decimal == "." else [cell.translate(_DECIMAL_COMMA) for cell in cells]
    values = np.array([np.nan])
    with suppress(ValueError):
        values = np.array([float(text) for text in texts])
    if np.isfinite(values).all() and not any("_" in text for text in texts):
        return values
    # Cell by cell, which is slow, only if one is known to be at fault.
    for line, cell, text in zip(lines, cells, texts, strict=True):
        said = repr(cell.strip()) if cell.strip() else "an empty cell"
        if not is_number(text):
            comma = decimal == "." and is_number(cell, ",")
            hint = "; numbers with a decimal comma need decimal = ','" if comma else ""
            raise fault(path, line, f"{what}: {said} is not a number{hint}")
        if not math.isfinite(float(text)):
            raise fault(path, line, f"{what}: {said} is not finite")
    return values


def is_number(text: str, decimal: str = ".") -> bool:
    """Whether a text is a number; 1_000, which Python would take, is not."""
    try:
        float(text if decimal == "." else text.translate(_DECIMAL_COMMA))
    except ValueError:
        return False
    return "_" not in text


def check_rising(path: FilePath, lines: Sequence[int], stations: NDArray[np.float64]) -> None:
    """Refuse stations that decrease, quoting the numbers in the file."""
    falling = np.flatnonzero(np.diff(stations) < 0)
    if falling.size:
        i = int(falling[0])
        step = f"station {stations[i + 1]} comes after {stations[i]}"
        raise fault(path, lines[i + 1], f"{step}: stations must not decrease")


def profiles(
    path: FilePath,
    lines: Sequence[int],
    stations: NDArray[np.float64],
    elevations: Mapping[str, NDArray[np.float64]],
    unit: str,
) -> dict[str, Profile]:
    """Make profiles that share stations, in one unit, each breakpoint from a line of the file."""
    try:
        return {name: Profile(stations, z) for name, z in elevations.items()}
    except InputError as error:
        at = re.match(r"[xz]\[(\d+)\]", str(error))
        raise fault(path, lines[int(at[1]) if at else 0], f"{error} [{unit}]") from None


def in_unit(values: NDArray[np.float64], unit: str, to: str) -> NDArray[np.float64]:
    """Convert lengths to another unit; overflow is left for `Profile` to refuse."""
    with np.errstate(over="ignore"):
        return convert_length(values, unit, to)


def as_tracks(tracks: Profile | Mapping[str, Profile]) -> dict[str, Profile]:
    """Check profiles by name, all on the same stations, as one table needs them."""
    if isinstance(tracks, Profile):
        return {ELEVATION: tracks}
    if not isinstance(tracks, Mapping) or not tracks:
        raise InputError(f"tracks = {tracks!r} is neither a Profile nor profiles by name")
    for name, profile in tracks.items():
        if not isinstance(profile, Profile):
            raise InputError(f"tracks[{name!r}] = {profile!r} is not a Profile")
        if not isinstance(name, str) or not name.isprintable() or name != name.strip() or not name:
            raise InputError(f"tracks: the name {name!r} cannot be written to a file")
    for (one, first), (other, second) in pairwise(tracks.items()):
        if not np.array_equal(first.x, second.x):
            raise InputError(
                f"tracks[{one!r}] and tracks[{other!r}] have different stations, and one table "
                "has room for one set: write each to a file of its own"
            )
    return dict(tracks)


def write_lines(path: FilePath, lines: Iterable[str]) -> None:
    """Write lines as UTF-8, ended by a line feed on every system."""
    Path(path).write_text("".join(f"{line}\n" for line in lines), encoding="utf-8", newline="\n")


def rows(columns: Iterable[NDArray[np.float64]], separator: str) -> Iterable[str]:
    """Rows of a table, with the fewest digits that read back as the same number."""
    texts = [[repr(value) for value in column.tolist()] for column in columns]
    return map(separator.join, zip(*texts, strict=True))
