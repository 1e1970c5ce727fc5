"""Profiles in delimited text."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, overload

from ._core import InputError
from ._files import (
    ELEVATION,
    as_tracks,
    check_rising,
    excerpt,
    fault,
    find,
    in_unit,
    is_number,
    numbers,
    profiles,
    read_lines,
    rows,
    stated_units,
    unit_of,
    wanted,
    write_lines,
)
from ._input import integer, one_of
from .units import length_unit

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._files import Column, FilePath
    from .profile import Profile

#: The unit at the end of a heading: "station [m]" or "station (m)".
_UNIT = re.compile(r"[\[(]([^][()]*)[\])]$")

#: The delimiter as spreadsheets state it, in a line of its own above the header.
_STATED = re.compile(r"\s*sep=([^\w\s\"]|\t)\s*", re.IGNORECASE)

#: A cell in quotes, whatever it contains.
_QUOTED = re.compile(r'"[^"]*"')


@overload
def read_csv(
    path: FilePath,
    to: str,
    *,
    unit: str | tuple[str, str] | None = ...,
    station: Column = ...,
    elevation: Column = ...,
    delimiter: str | None = ...,
    decimal: str = ...,
    skiprows: int = ...,
) -> Profile: ...
@overload
def read_csv(
    path: FilePath,
    to: str,
    *,
    unit: str | tuple[str, str] | None = ...,
    station: Column = ...,
    elevation: Mapping[str, Column],
    delimiter: str | None = ...,
    decimal: str = ...,
    skiprows: int = ...,
) -> dict[str, Profile]: ...
def read_csv(
    path: FilePath,
    to: str,
    *,
    unit: str | tuple[str, str] | None = None,
    station: Column = 0,
    elevation: Column | Mapping[str, Column] = 1,
    delimiter: str | None = None,
    decimal: str = ".",
    skiprows: int = 0,
) -> Profile | dict[str, Profile]:
    r"""
    Read profiles from delimited text, one row per breakpoint.

    The first row is a header if no cell in it is a number. A heading may end in its unit, as in
    "station [m]" or "station (m)". Blank lines and lines that begin with # are skipped; a repeated
    station is a vertical step. Nothing else is guessed, and nothing but rows of empty cells
    is dropped: every row must have as many cells as the first.

    Parameters
    ----------
    path : str or path-like
        The file, in UTF-8 or ASCII.
    to : {"in", "ft", "m", "cm", "mm", "km"}
        Unit of the profiles.
    unit : str or (str, str), optional
        Unit in the file: one for all columns, or a pair for station and elevation. Required where
        the header gives none; must not contradict the header.
    station : str or int
        Column of the stations: its heading, with or without the unit, or its number counted from 0.
    elevation : str, int or mapping
        Column of the elevations; for several tracks, the column of each by the track's name. With
        gear names the result can be passed to `simulate` as it is.
    delimiter : str, optional
        Character between cells. Default: that of a first line such as "sep=;", or the first of
        tab, ; and , that occurs in the first row; if none does, any number of blanks.
    decimal : {".", ","}
        Decimal point or comma; a decimal comma does not separate cells.
    skiprows : int, default 0
        Number of lines to skip at the top of the file, such as a title.

    Returns
    -------
    Profile or dict of Profile
        The profile, or one for each entry of `elevation`, by its name [to]. For a runway on a grade
        see `Profile.detrended`.

    Raises
    ------
    InputError
        If an argument is not as above or the file has a fault; the message names the file and the
        line, and quotes what it found there.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import runway_modal as rm
    >>> path = pathlib.Path(tempfile.mkdtemp(), "survey.csv")
    >>> _ = path.write_text("station [m];left [mm];right [mm]\n0;0;0\n2,54;12,7;25,4\n")
    >>> tracks = rm.read_csv(path, "in", elevation={"left": "left", "right": 2}, decimal=",")
    >>> tracks["right"]
    Profile(x=[0.0, 100.0], z=[0.0, 1.0])
    """
    to = length_unit("to", to)
    stated_x, stated_z = stated_units(unit)
    decimal = one_of("decimal", decimal, (".", ","))
    if delimiter is not None and (
        not isinstance(delimiter, str) or len(delimiter) != 1 or delimiter in f'{decimal}"'
    ):
        raise InputError(f"delimiter = {delimiter!r} cannot separate cells")
    skiprows = integer("skiprows", skiprows, 0)

    table = [
        (number, line)
        for number, line in enumerate(read_lines(path), 1)
        if number > skiprows
        and line.strip(f"\t ;,{delimiter or ''}")
        and not line.lstrip().startswith("#")
    ]
    if not table:
        raise fault(path, skiprows + 1, f"no data: the file {'ends' if skiprows else 'is empty'}")
    said = _STATED.fullmatch(table[0][1])
    if said and len(table) > 1:
        if said[1] == decimal:
            raise fault(path, table[0][0], f"{excerpt(table[0][1])} names the decimal comma")
        delimiter = delimiter or said[1]
        del table[0]
    first, heading = table[0]
    if delimiter is None:
        between = _QUOTED.sub("", heading)
        delimiter = next((c for c in "\t;," if c in between and c != decimal), None)
    headings = [cell.strip() for cell in _cells(path, table[0], delimiter)]
    header = not any(is_number(cell, decimal) for cell in headings)
    if not header:
        headings = [""] * len(headings)
    elif len(table) == 1:
        raise fault(path, first, f"no data after the header {excerpt(heading)}")

    several = wanted(elevation)
    names, units = zip(*map(_name_and_unit, headings), strict=True)
    columns = [
        find(path, first, column, headings, names) for column in (station, *several.values())
    ]
    lines, picked = _pick(path, table, columns, delimiter)
    if header:
        lines, picked = lines[1:], [cells[1:] for cells in picked]
    values: list[NDArray[np.float64]] = []
    for column, cells, stated in zip(
        columns, picked, [stated_x] + [stated_z] * len(several), strict=True
    ):
        what = f"column {headings[column] or column!r}"
        in_file = unit_of(path, first, what, units[column], stated)
        found = numbers(path, lines, cells, what, decimal)
        if not values:
            check_rising(path, lines, found)
        values.append(in_unit(found, in_file, to))
    tracks = profiles(path, lines, values[0], dict(zip(several, values[1:], strict=True)), to)
    return tracks if isinstance(elevation, Mapping) else tracks[ELEVATION]


def _pick(
    path: FilePath, table: list[tuple[int, str]], columns: list[int], delimiter: str | None
) -> tuple[list[int], list[list[str]]]:
    """Line of each row, and the cells of each column."""
    first = table[0][0]
    width = len(_cells(path, table[0], delimiter))
    lines: list[int] = []
    picked: list[list[str]] = [[] for _ in columns]
    for number, line in table:
        cells = _cells(path, (number, line), delimiter)
        if len(cells) != width:
            counts = f"{len(cells)} cell(s) where line {first} has {width}"
            title = "; to skip lines above the header use skiprows" if len(lines) == 1 else ""
            raise fault(path, number, f"{counts}: {excerpt(line)}{title}")
        lines.append(number)
        for column, found in zip(columns, picked, strict=True):
            found.append(cells[column])
    return lines, picked


def _cells(path: FilePath, row: tuple[int, str], delimiter: str | None) -> list[str]:
    number, line = row
    if delimiter is None or '"' not in line:
        return line.split(delimiter)
    try:
        return next(csv.reader([line], delimiter=delimiter, strict=True))
    except csv.Error as error:
        raise fault(path, number, f"{error}: {excerpt(line)}") from None


def _name_and_unit(cell: str) -> tuple[str, str]:
    unit = _UNIT.search(cell)
    return (cell[: unit.start()].strip(), unit[1].strip()) if unit else (cell, "")


def write_csv(path: FilePath, tracks: Profile | Mapping[str, Profile], unit: str) -> None:
    """
    Write profiles as comma-separated text that `read_csv` reads back to the last bit.

    The header names the columns and their unit: "station [in],elevation [in]", or the tracks' names
    instead of "elevation". Numbers have the fewest digits that read back as the same number.

    Parameters
    ----------
    path : str or path-like
        The file; an existing one is replaced.
    tracks : Profile or mapping of Profile
        One profile, or several by name on the same stations [unit].
    unit : {"in", "ft", "m", "cm", "mm", "km"}
        Unit of the profiles; nothing is converted.

    Raises
    ------
    InputError
        If an argument is not as above, the stations differ or a name cannot be written in a header.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import runway_modal as rm
    >>> path = pathlib.Path(tempfile.mkdtemp(), "mat.csv")
    >>> rm.write_csv(path, rm.Profile.full_mat(), "in")
    >>> print(path.read_text())
    station [in],elevation [in]
    0.0,0.0
    12.0,1.5
    918.0,1.5
    930.0,0.0
    >>> rm.read_csv(path, "in") == rm.Profile.full_mat()
    True
    """
    unit = length_unit("unit", unit)
    named = as_tracks(tracks)
    stations = next(iter(named.values())).x
    header = ",".join(_quoted(f"{name} [{unit}]") for name in ("station", *named))
    columns = (stations, *(profile.z for profile in named.values()))
    write_lines(path, [header, *rows(columns, ",")])


def _quoted(cell: str) -> str:
    return '"' + cell.replace('"', '""') + '"' if any(c in cell for c in ',;"') else cell
