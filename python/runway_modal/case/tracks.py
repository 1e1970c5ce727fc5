"""Tracks of a case file."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from runway_modal._core import InputError
from runway_modal.profile import Profile
from runway_modal.profile_csv import read_csv
from runway_modal.profile_erd import read_erd
from runway_modal.units import LENGTH, REPORT

from .toml import hint

if TYPE_CHECKING:
    from collections.abc import Callable

    from runway_modal.units import Units

    from .toml import Table

#: Built-in shapes by name.
_SHAPES: dict[str, Callable[..., Profile]] = {
    shape.__name__: shape
    for shape in (
        Profile.mat,
        Profile.crater_repair,
        Profile.spall,
        Profile.one_minus_cosine,
        Profile.full_mat,
        Profile.half_mat,
        Profile.two_foot_spall,
        Profile.double_spall,
    )
}

#: Shapes whose fixed dimensions are in the report's units.
_OF_REPORT = ("full_mat", "half_mat", "two_foot_spall", "double_spall")

#: What is inferred about a shape whatever its parameters; the report's figures are lost.
_INFERRED = {
    "crater_repair": "the arrangement of its slopes",
    "full_mat": "ramps of 12 in",
    "half_mat": "sharp edges",
}

#: Defaults of a shape that are inferred.
_INFERRED_DEFAULTS = {
    "mat": ("ramp",),
    "crater_repair": ("ramp",),
    "half_mat": ("length",),
    "two_foot_spall": ("depth", "ramp"),
    "double_spall": ("depth", "ramp", "spacing"),
}


def read_tracks(
    root: Table, gears: tuple[str, ...], units: Units, notes: list[str]
) -> dict[str, Profile]:
    """Make the profile under each gear; add to `notes` what is inferred."""
    tracks: dict[str, Profile] = {}
    for table in root.tables("track"):
        under = table.values.get("gears", list(gears))
        if not isinstance(under, list) or not under:
            raise table.fault(f"gears = {under!r} is not a list of gear names", "gears")
        for i, name in enumerate(under):
            if name in under[:i]:
                raise table.fault(f"gears: {name!r} is listed twice", "gears")
            if name not in gears:
                raise table.fault(f"gears: {name!r} is not a gear{hint(name, gears)}", "gears")
        if ("file" in table.values) == ("shape" in table.values):
            raise table.fault("exactly one of shape and file is needed", "file")
        profile = _file(table, units) if "file" in table.values else _shape(table, units, notes)
        with table.located():
            if "gap" in table.values:
                if "start" in table.values:
                    raise table.fault("give either gap or start, not both", "gap")
                before = [float(tracks[name].x[-1]) for name in under if name in tracks]
                if not before:
                    raise InputError("gap: no earlier track lies under these gears")
                gap = table.quantity("gap", LENGTH, units)
                if gap < 0.0:
                    raise InputError(f"gap = {gap!r} is negative")
                end = max(before) + gap
                profile = profile.shifted(end - float(profile.x[0]))
            else:
                profile = profile.shifted(table.quantity("start", LENGTH, units, 0.0))
        for name in under:
            tracks[name] = tracks[name] + profile if name in tracks else profile
    footprint = root.table("footprint", {})
    footprint.only(*gears)
    for name in footprint.values:
        length = footprint.quantity(name, LENGTH, units)
        with footprint.located(name):
            # Under a gear on level runway the mean is level, too.
            tracks[name] = tracks.get(name, Profile([0], [0])).footprint(length)
    return tracks


_PLACE = ("gears", "start", "gap")


def _file(table: Table, units: Units) -> Profile:
    path = table.path.parent / table.text("file")
    if path.suffix.lower() == ".erd":
        table.only("file", "unit", "elevation", "detrend", *_PLACE)
    else:
        layout = ("delimiter", "decimal", "skiprows")
        table.only("file", "unit", "station", "elevation", "detrend", *layout, *_PLACE)
    others = ("file", "detrend", *_PLACE)
    options = {key: table.get(key) for key in table.values if key not in others}
    if isinstance(options.get("elevation"), dict):
        raise table.fault("elevation is neither a heading nor a number", "elevation")
    if isinstance(options.get("unit"), list):
        options["unit"] = tuple(options["unit"])
    with table.located():
        try:
            reader: Callable[..., Profile] = read_erd if path.suffix.lower() == ".erd" else read_csv
            profile = reader(path, units.length, **options)
        except OSError as error:
            raise InputError(f"file: cannot read {path}: {error.strerror}") from None
    return profile.detrended() if table.flag("detrend") else profile


def _shape(table: Table, units: Units, notes: list[str]) -> Profile:
    name = table.choice("shape", (*_SHAPES, "points"))
    if name == "points":
        table.only("shape", "x", "z", *_PLACE)
        x, z = (table.quantities(key, LENGTH, units) for key in ("x", "z"))
        with table.located():
            return Profile(x, z)
    shape = _SHAPES[name]
    parameters = {k: p for k, p in inspect.signature(shape).parameters.items() if k != "start"}
    table.only("shape", *parameters, *_PLACE)
    # The report's shapes are in inches; the others work in any unit, except for their defaults.
    native = REPORT if name in _OF_REPORT else units
    given: dict[str, Any] = {}
    for key, parameter in parameters.items():
        if key == "segments":
            given[key] = table.get(key, parameter.default)
        elif key in table.values or parameter.default is inspect.Parameter.empty:
            length, text = table.quantity(key, LENGTH, units), table.values[key]
            given[key] = (
                native.quantity(key, text, LENGTH)  # "24 in" is 24 without rounding
                if isinstance(text, str)
                else length * units.factor(native, LENGTH)
            )
        else:
            given[key] = parameter.default * REPORT.factor(native, LENGTH)
            if key in _INFERRED_DEFAULTS.get(name, ()):
                notes.append(f"{table.where()}: {key} = {parameter.default:g} in, the default")
    if name in _INFERRED:
        notes.append(f"{table.where()}: {_INFERRED[name]}")
    with table.located():
        try:
            profile = shape(**given)
        except InputError as error:
            if native == units:
                raise
            raise InputError(f"{error} [{native.length}]") from None
        scale = native.factor(units, LENGTH)
        return Profile(profile.x * scale, profile.z * scale)
