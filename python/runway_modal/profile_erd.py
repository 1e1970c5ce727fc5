"""Profiles in ERD files, the exchange format of road profilers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, overload

import numpy as np

from ._core import InputError
from ._files import (
    ELEVATION,
    as_tracks,
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
from .units import length_unit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._files import Column, FilePath
    from .profile import Profile

_FIRST = "ERDFILEV2.00"
_SECOND = ("NCHAN", "NSAMP", "NRECS", "NBYTES", "KEYNUM", "STEP", "KEYOPT")

#: KEYNUM of numbers written as text.
_TEXT = 5

#: More channels than that are taken for a typing error.
_MOST_CHANNELS = 1e6

#: Characters of a keyword, and of each channel's entry after it.
_KEYWORD = 8
_ENTRY = {"SHORTNAM": 8, "LONGNAME": 32, "UNITSNAM": 8}


@overload
def read_erd(
    path: FilePath,
    to: str,
    *,
    unit: str | tuple[str, str] | None = ...,
    elevation: Column = ...,
) -> Profile: ...
@overload
def read_erd(
    path: FilePath,
    to: str,
    *,
    unit: str | tuple[str, str] | None = ...,
    elevation: Mapping[str, Column],
) -> dict[str, Profile]: ...
def read_erd(
    path: FilePath,
    to: str,
    *,
    unit: str | tuple[str, str] | None = None,
    elevation: Column | Mapping[str, Column] = 0,
) -> Profile | dict[str, Profile]:
    r"""
    Read profiles from an ERD file whose numbers are text.

    Parameters
    ----------
    path : str or path-like
        The file.
    to : {"in", "ft", "m", "cm", "mm", "km"}
        Unit of the profiles.
    unit : str or (str, str), optional
        Unit in the file: one for all channels, or a pair for station and elevation. Required where
        XUNITS or UNITSNAM is missing; must not contradict them.
    elevation : str, int or mapping
        Channel of the elevations: its LONGNAME or SHORTNAM, or its number counted from 0; for
        several tracks, the channel of each by the track's name.

    Returns
    -------
    Profile or dict of Profile
        The profile, or one for each entry of `elevation`, by its name [to]. Stations are
        0, STEP, 2 STEP, …: the format has no other start; `Profile.shifted` moves the profile.

    Raises
    ------
    InputError
        If an argument is not as above or the file has a fault; the message names the file and the
        line, and quotes what it found there.
    OSError
        If the file cannot be read.

    Notes
    -----
    M. W. Sayers and S. M. Karamihas, *ERD file format for storage and analysis of road profiles*,
    University of Michigan Transportation Research Institute; also RoadRuf User Reference Manual,
    October 1997, Appendix A. Line 1 is ERDFILEV2.00; line 2 holds NCHAN, NSAMP, NRECS, NBYTES,
    KEYNUM, STEP, KEYOPT; then come lines with a keyword of eight characters and its text, then
    END, then the numbers.

    Assumptions: KEYNUM 5 means numbers as text; any other value (binary, in a separate file) is
    refused. Numbers are separated by blanks or commas, whatever FORMAT says, and a line holds whole
    samples. NSAMP = -1 means as many samples as there are. NRECS, NBYTES, KEYOPT and other
    keywords are not used.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import runway_modal as rm
    >>> path = pathlib.Path(tempfile.mkdtemp(), "run1.erd")
    >>> _ = path.write_text(
    ...     "ERDFILEV2.00\n2, 3, -1, 1, 5, 0.254, -1,\nTITLE   Runway 26L\n"
    ...     "SHORTNAMLElev   RElev\nUNITSNAMmm      mm\nXUNITS  m\nEND\n0 0\n12.7 25.4\n0 0\n"
    ... )
    >>> rm.read_erd(path, "in", elevation="RElev")
    Profile(x=[0.0, 10.0, 20.0], z=[0.0, 1.0, 0.0])
    """
    to = length_unit("to", to)
    stated_x, stated_z = stated_units(unit)
    text = read_lines(path)
    if text[0].strip() != _FIRST:
        raise fault(path, 1, f"{excerpt(text[0])} where an ERD file has {_FIRST!r}")
    channels, samples, step = _second(path, text)
    try:
        end = next(i for i, line in enumerate(text) if line.strip() == "END")
    except StopIteration:
        raise fault(path, len(text), "the file ends without a line END") from None

    entries = {line[:_KEYWORD].strip().upper(): i for i, line in enumerate(text[2:end], 2)}
    per_channel = {
        key: _entries(text[entries[key]], width, channels) if key in entries else [""] * channels
        for key, width in _ENTRY.items()
    }
    x_line = entries.get("XUNITS", end)
    x_unit = text[x_line][_KEYWORD:].strip() if "XUNITS" in entries else ""
    unit_line = entries.get("UNITSNAM", end) + 1
    unit_x = unit_of(path, x_line + 1, "XUNITS", x_unit, stated_x)

    names = per_channel["LONGNAME"], per_channel["SHORTNAM"]
    several = wanted(elevation)
    columns = [find(path, end + 1, column, *names) for column in several.values()]
    lines, cells = _samples(path, text, end + 1, channels)
    if samples not in (-1, len(lines)):
        found = f"{len(lines)} samples where NSAMP = {samples} in line 2"
        raise fault(path, lines[-1] if lines else end + 1, found)
    if not lines:
        raise fault(path, end + 1, "no numbers after END")
    elevations = {}
    for name, column in zip(several, columns, strict=True):
        what = f"channel {column}"
        unit_z = unit_of(path, unit_line, what, per_channel["UNITSNAM"][column], stated_z)
        values = numbers(path, lines, cells[column::channels], what)
        elevations[name] = in_unit(values, unit_z, to)
    spacing = in_unit(np.array(step), unit_x, to)
    if not math.isfinite(float(spacing) * len(lines)):
        raise fault(path, 2, f"STEP = {step!r}: the stations leave the range of double precision")
    stations = np.arange(len(lines)) * spacing
    tracks = profiles(path, lines, stations, elevations, to)
    return tracks if isinstance(elevation, Mapping) else tracks[ELEVATION]


def _second(path: FilePath, text: list[str]) -> tuple[int, int, float]:
    """NCHAN, NSAMP and STEP from line 2."""
    line = text[1] if len(text) > 1 else ""
    cells = line.replace(",", " ").split()
    if len(cells) != len(_SECOND):
        raise fault(path, 2, f"{excerpt(line)} is not the seven numbers {', '.join(_SECOND)}")
    values = {}
    for name, cell in zip(_SECOND, cells, strict=True):
        if not is_number(cell):
            raise fault(path, 2, f"{name}: {cell!r} is not a number")
        values[name] = float(cell)
    if values["KEYNUM"] != _TEXT:
        keynum = f"KEYNUM = {values['KEYNUM']:g}"
        raise fault(path, 2, f"{keynum}: only text, KEYNUM = 5, can be read, not binary")
    channels, samples, step = values["NCHAN"], values["NSAMP"], values["STEP"]
    if not (1 <= channels <= _MOST_CHANNELS and channels.is_integer()):
        raise fault(path, 2, f"NCHAN = {channels:g} is not a number of channels")
    if not (samples == -1 or (samples >= 1 and samples.is_integer())):
        raise fault(path, 2, f"NSAMP = {samples:g} is neither a number of samples nor -1")
    if not 0 < step < np.inf:
        raise fault(path, 2, f"STEP = {step:g} is not a positive distance")
    return int(channels), int(samples), step


def _entries(line: str, width: int, channels: int) -> list[str]:
    """Entries of a header line, one per channel."""
    starts = range(_KEYWORD, _KEYWORD + width * channels, width)
    return [line[start : start + width].strip() for start in starts]


def _samples(
    path: FilePath, text: list[str], start: int, channels: int
) -> tuple[list[int], list[str]]:
    """Line of each sample, and all numbers in order."""
    lines, cells = [], []
    for number, line in enumerate(text[start:], start + 1):
        found = (line.replace(",", " ") if "," in line else line).split()
        if len(found) % channels:
            raise fault(
                path, number, f"{len(found)} number(s) for {channels} channels: {excerpt(line)}"
            )
        lines += [number] * (len(found) // channels)
        cells += found
    return lines, cells


def write_erd(path: FilePath, tracks: Profile | Mapping[str, Profile], unit: str) -> None:
    """
    Write profiles with equally spaced stations as a text ERD file, one channel each.

    Numbers have the fewest digits that read back as the same number, so `read_erd` returns the
    elevations to the last bit. It returns the stations as multiples of STEP: to the last bit if
    they are exactly that, like those from `read_erd` or ``step * numpy.arange(n)``, and otherwise
    to rounding.

    Parameters
    ----------
    path : str or path-like
        The file; an existing one is replaced.
    tracks : Profile or mapping of Profile
        One profile, or several by name on the same stations: 0, STEP, 2 STEP, … [unit].
    unit : {"in", "ft", "m", "cm", "mm", "km"}
        Unit of the profiles; nothing is converted.

    Raises
    ------
    InputError
        If an argument is not as above, a station differs by more than rounding from its multiple
        of STEP, or a name is longer than 32 characters.
    OSError
        If the file cannot be written.

    Notes
    -----
    The format is that of `read_erd`, with LONGNAME and SHORTNAM from the tracks' names, the latter
    cut at eight characters.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import runway_modal as rm
    >>> path = pathlib.Path(tempfile.mkdtemp(), "bump.erd")
    >>> bump = rm.Profile.one_minus_cosine(8.0, 2.0, segments=4)
    >>> rm.write_erd(path, bump, "in")
    >>> rm.read_erd(path, "in") == bump
    True
    """
    unit = length_unit("unit", unit)
    named = as_tracks(tracks)
    for name in named:
        if len(name) > _ENTRY["LONGNAME"]:
            raise InputError(f"tracks: the name {name!r} is longer than 32 characters")
    stations = next(iter(named.values())).x
    header = [
        _FIRST,
        f"{len(named)}, {stations.size}, -1, 1, {_TEXT}, {_step(stations)!r}, -1,",
        *(
            key + "".join(entry[:width].ljust(width) for entry in entries)
            for (key, width), entries in zip(
                _ENTRY.items(), (named, named, [unit] * len(named)), strict=True
            )
        ),
        "XLABEL  Distance",
        f"XUNITS  {unit}",
        "END",
    ]
    write_lines(path, [*header, *rows((profile.z for profile in named.values()), " ")])


def _step(stations: NDArray[np.float64]) -> float:
    """Spacing of equally spaced stations from 0."""
    if stations.size < 2:
        raise InputError("tracks: an ERD file needs at least two stations")
    count = stations.size - 1
    steps = (float(stations[1]), float(stations[-1]) / count)
    departures = [np.abs(stations - np.arange(count + 1) * step) for step in steps]
    best = min((0, 1), key=lambda i: departures[i].max())
    rounding = 4 * np.spacing(stations[-1])
    at = int(departures[best].argmax())
    if steps[best] <= 0 or departures[best][at] > rounding:
        raise InputError(
            f"tracks: x[{at}] = {stations[at]} is not a multiple of the step {steps[best]}: an ERD "
            "file needs stations 0, STEP, 2 STEP, …"
        )
    return steps[best]
