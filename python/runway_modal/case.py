"""Case files of the command line: TOML to modes, tracks and speeds in one unit system."""

from __future__ import annotations

import difflib
import inspect
import re
import tomllib
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ._core import InputError
from .aircraft import Aircraft, Gear, f4e, single_dof
from .modes import Modes
from .profile import Profile
from .profile_csv import read_csv
from .profile_erd import read_erd
from .simulate import simulate
from .units import (
    ACCELERATION,
    DAMPING,
    FREQUENCY,
    INERTIA,
    LENGTH,
    MASS,
    SPEED,
    STIFFNESS,
    TIME,
    Dimension,
    Units,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping
    from pathlib import Path

    from .response import Response

#: Presets and the defaults of built-in shapes are in the report's units.
_REPORT = Units("in", "lbf")

#: Built-in shapes by name.
_SHAPES: dict[str, Callable[..., Profile]] = {
    shape.__name__: shape
    for shape in (
        Profile.mat,
        Profile.spall,
        Profile.one_minus_cosine,
        Profile.full_mat,
        Profile.half_mat,
        Profile.two_foot_spall,
        Profile.double_spall,
    )
}

#: What each shape takes for granted where the report's figures are lost.
_INFERRED = {
    "mat": ("ramp",),
    "half_mat": ("length",),
    "two_foot_spall": ("depth", "ramp"),
    "double_spall": ("depth", "ramp", "spacing"),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """What a case file says, in its unit system."""

    title: str
    units: Units
    modes: Modes
    tracks: Mapping[str, Profile]
    #: Speeds [length/s] by the text that names them.
    speeds: Mapping[str, float]
    duration: float | None
    damping_input: bool
    #: Files to write, by kind.
    output: Mapping[str, Path]
    #: Inferred data that the case rests on.
    notes: tuple[str, ...]

    def run(self) -> dict[str, Response]:
        """Simulate every speed."""
        return {
            name: simulate(
                self.modes,
                self.tracks,
                speed,
                duration=self.duration,
                damping_input=self.damping_input,
            )
            for name, speed in self.speeds.items()
        }


def read_case(path: Path) -> Case:
    """Read a case file; `InputError` names file, line and key."""
    try:
        text = path.read_text(encoding="utf-8")
        values = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: {error}") from None
    root = _Table(path, text, (), values)
    root.only("title", "units", "aircraft", "single_dof", "track", "run", "output")
    system = root.table("units")
    system.only("length", "force")
    with system.located():
        units = Units(system.get("length"), system.get("force"))
    if ("aircraft" in values) == ("single_dof" in values):
        raise root.fault("either [aircraft] or [single_dof] is needed", "single_dof")
    modes = _modes(root.table("aircraft"), units) if "aircraft" in values else _single(root, units)
    tracks, notes = _tracks(root, modes.aircraft.gear_names, units)
    run = root.table("run")
    run.only("speeds", "duration", "damping_input")
    output = root.table("output", {})
    output.only("csv", "json", "parquet", "figure")
    return Case(
        title=root.text("title", path.stem),
        units=units,
        modes=modes,
        tracks=tracks,
        speeds=_speeds(run, units),
        duration=run.quantity("duration", TIME, units, None),
        damping_input=run.flag("damping_input"),
        output={kind: path.parent / output.text(kind) for kind in output.values},
        notes=notes,
    )


def _speeds(run: _Table, units: Units) -> dict[str, float]:
    given = run.get("speeds")
    speeds = {}
    for i, value in enumerate(given if isinstance(given, list) else [given]):
        with run.located():
            speed = units.quantity(f"speeds[{i}]", value, SPEED)
            if not speed > 0:
                raise InputError(f"speeds[{i}] = {value!r} is not positive")
        name = value if isinstance(value, str) else f"{value} {units.name(SPEED)}"
        speeds[name] = speed
    if not speeds:
        raise run.fault("speeds is empty", "speeds")
    return speeds


def _modes(table: _Table, units: Units) -> Modes:
    preset = table.values.get("preset")
    data = ("mass", "pitch_inertia", "roll_inertia", "gravity", "gears")
    common = ("damping_ratio", "modes", "stations")
    table.only(*(data if preset is None else ("preset", "stiffness")), *common)
    stations = table.table("stations", {})
    points = {name: tuple(stations.quantities(name, LENGTH, units)) for name in stations.values}
    with table.located():
        if preset is None:
            aircraft = Aircraft(
                mass=table.quantity("mass", MASS, units),
                pitch_inertia=table.quantity("pitch_inertia", INERTIA, units),
                roll_inertia=table.quantity("roll_inertia", INERTIA, units),
                gears=[_gear(gear, units) for gear in table.tables("gears")],
                gravity=table.quantity("gravity", ACCELERATION, units, units.standard_gravity),
                stations=points,  # type: ignore[arg-type]
            )
        else:
            table.choice("preset", ("f4e",))
            aircraft = _in_units(
                f4e(table.choice("stiffness", ("static", "equivalent"), "static")),  # type: ignore[arg-type]
                units,
                points,
            )
    measured = table.tables("modes", [])
    with table.located():
        if not measured:
            return aircraft.modes(table.values.get("damping_ratio"))
        if "damping_ratio" in table.values:
            raise InputError("damping_ratio: each of the measured modes has its own")
        for mode in measured:
            mode.only("omega", "damping_ratio", "shape")
        shapes = [mode.get("shape") for mode in measured]
        for mode, shape in zip(measured, shapes, strict=True):
            if not isinstance(shape, list) or len(shape) != 3:
                raise mode.fault(f"shape = {shape!r} is not [bounce, pitch, roll]", "shape")
        return Modes(
            aircraft,
            [mode.quantity("omega", FREQUENCY, units) for mode in measured],
            [mode.get("damping_ratio") for mode in measured],
            np.transpose(shapes),
        )


def _gear(table: _Table, units: Units) -> Gear:
    table.only("name", "x", "y", "stiffness", "strut", "tire", "damping")
    name = table.text("name")
    x, y = (table.quantity(key, LENGTH, units) for key in ("x", "y"))
    damping = table.quantity("damping", DAMPING, units, 0.0)
    with table.located():
        if "stiffness" in table.values:
            if {"strut", "tire"} & table.values.keys():
                raise InputError("stiffness: give it or strut and tire, not both")
            return Gear(name, x, y, table.quantity("stiffness", STIFFNESS, units), damping)
        strut, tire = (table.quantity(key, STIFFNESS, units) for key in ("strut", "tire"))
        return Gear.from_series(name, x, y, strut=strut, tire=tire, damping=damping)


def _in_units(aircraft: Aircraft, units: Units, stations: Mapping[str, Any]) -> Aircraft:
    """Turn an aircraft of the report's units into one of the case's."""

    def converted(value: float, dimension: Dimension) -> float:
        return value * _REPORT.factor(units, dimension)

    return Aircraft(
        mass=converted(aircraft.mass, MASS),
        pitch_inertia=converted(aircraft.pitch_inertia, INERTIA),
        roll_inertia=converted(aircraft.roll_inertia, INERTIA),
        gears=[
            Gear(
                gear.name,
                converted(gear.x, LENGTH),
                converted(gear.y, LENGTH),
                converted(gear.stiffness, STIFFNESS),
                converted(gear.damping, DAMPING),
            )
            for gear in aircraft.gears
        ],
        gravity=converted(aircraft.gravity, ACCELERATION),
        stations=stations,
    )


def _single(root: _Table, units: Units) -> Modes:
    table = root.table("single_dof")
    table.only("mass", "omega", "damping_ratio", "gravity")
    with table.located():
        return single_dof(
            mass=table.quantity("mass", MASS, units),
            omega=table.quantity("omega", FREQUENCY, units),
            damping_ratio=table.get("damping_ratio"),
            gravity=table.quantity("gravity", ACCELERATION, units, units.standard_gravity),
        )


def _tracks(
    root: _Table, gears: tuple[str, ...], units: Units
) -> tuple[dict[str, Profile], tuple[str, ...]]:
    tracks: dict[str, Profile] = {}
    notes: list[str] = []
    for table in root.tables("track"):
        under = table.values.get("gears", list(gears))
        if not isinstance(under, list) or not under:
            raise table.fault(f"gears = {under!r} is not a list of gear names", "gears")
        for name in under:
            if name not in gears:
                raise table.fault(f"gears: {name!r} is no gear{_hint(name, gears)}", "gears")
        profile = _file(table, units) if "file" in table.values else _shape(table, units, notes)
        with table.located():
            if "gap" in table.values:
                if "start" in table.values:
                    raise InputError("gap: give it or start, not both")
                before = [float(tracks[name].x[-1]) for name in under if name in tracks]
                if not before:
                    raise InputError("gap: there is no track before it under its gears")
                end = max(before) + table.quantity("gap", LENGTH, units)
                profile = profile.shifted(end - float(profile.x[0]))
            else:
                profile = profile.shifted(table.quantity("start", LENGTH, units, 0.0))
        for name in under:
            tracks[name] = tracks[name] + profile if name in tracks else profile
    return tracks, tuple(notes)


_PLACE = ("gears", "start", "gap")


def _file(table: _Table, units: Units) -> Profile:
    path = table.path.parent / table.text("file")
    if path.suffix.lower() == ".erd":
        table.only("file", "unit", "elevation", *_PLACE)
    else:
        table.only("file", "unit", "station", "elevation", "delimiter", "decimal", *_PLACE)
    options = {key: table.get(key) for key in table.values if key not in ("file", *_PLACE)}
    if isinstance(options.get("unit"), list):
        options["unit"] = tuple(options["unit"])
    with table.located():
        try:
            reader: Callable[..., Profile] = read_erd if path.suffix.lower() == ".erd" else read_csv
            return reader(path, units.length, **options)
        except OSError as error:
            raise InputError(f"file: cannot read {path}: {error.strerror}") from None


def _shape(table: _Table, units: Units, notes: list[str]) -> Profile:
    name = table.choice("shape", (*_SHAPES, "points"))
    if name == "points":
        table.only("shape", "x", "z", *_PLACE)
        x, z = (table.quantities(key, LENGTH, units) for key in ("x", "z"))
        with table.located():
            return Profile(x, z)
    shape = _SHAPES[name]
    parameters = {k: p for k, p in inspect.signature(shape).parameters.items() if k != "start"}
    table.only("shape", *parameters, *_PLACE)
    given: dict[str, Any] = {}
    for key, parameter in parameters.items():
        if key not in table.values and parameter.default is not inspect.Parameter.empty:
            if key in _INFERRED.get(name, ()):
                notes.append(f"{table.where()}: {key} = {parameter.default:g} in")
            continue
        whole = key == "segments"
        given[key] = table.get(key) if whole else table.quantity(key, LENGTH, _REPORT, scale=units)
    if name == "full_mat":
        notes.append(f"{table.where()}: ramps of 12 in")
    with table.located("" if units.length == "in" else " (lengths of shapes in in)"):
        profile = shape(**given)
        scale = _REPORT.factor(units, LENGTH)
        return Profile(profile.x * scale, profile.z * scale)


def _hint(name: object, allowed: Iterable[str]) -> str:
    allowed = tuple(allowed)
    near = difflib.get_close_matches(str(name), allowed, 1)
    guess = f"; did you mean {near[0]!r}?" if near else ""
    return f"{guess} Allowed: {', '.join(allowed)}" if guess else f"; allowed: {', '.join(allowed)}"


_REQUIRED: Any = object()


@dataclass(frozen=True, slots=True)
class _Table:
    """One table of a case file; hands out checked values and knows where they stand."""

    path: Path
    source: str
    keys: tuple[str | int, ...]
    values: dict[str, Any]

    def where(self, key: str | None = None) -> str:
        """Name the place of a key as TOML does, arrays counted from 0."""
        keys = self.keys if key is None else (*self.keys, key)
        return "".join(f"[{k}]" if isinstance(k, int) else f".{k}" for k in keys).lstrip(".")

    def fault(self, what: str, key: str | None = None) -> InputError:
        """Make the error that names file, line and table."""
        keys = (*self.keys, key) if key is not None and key in self.values else self.keys
        line = _line(self.source, keys)
        place = f"{self.path}:{line}" if line else f"{self.path}"
        return _Located(": ".join(part for part in (place, self.where(), what) if part))

    @contextmanager
    def located(self, suffix: str = "") -> Iterator[None]:
        """Say where the input stands that the library refuses."""
        try:
            yield
        except _Located:
            raise
        except InputError as error:
            # The library's messages begin with the name of the argument: the key's name.
            named = re.match(r"\w+", str(error))
            raise self.fault(f"{error}{suffix}", named[0] if named else None) from None

    def only(self, *allowed: str) -> None:
        """Refuse keys that nobody reads."""
        for key in self.values:
            if key not in allowed:
                raise self.fault(f"unknown key {key!r}{_hint(key, allowed)}", key)

    def get(self, key: str, default: Any = _REQUIRED) -> Any:
        value = self.values.get(key, default)
        if value is _REQUIRED:
            raise self.fault(f"{key} is missing")
        return value

    def text(self, key: str, default: Any = _REQUIRED) -> str:
        value = self.get(key, default)
        if not isinstance(value, str) or not value:
            raise self.fault(f"{key} = {value!r} is not a text", key)
        return value

    def choice(self, key: str, allowed: tuple[str, ...], default: Any = _REQUIRED) -> str:
        value = self.get(key, default)
        if value not in allowed:
            raise self.fault(f"{key} = {value!r} is unknown{_hint(value, allowed)}", key)
        return str(value)

    def flag(self, key: str) -> bool:
        value = self.get(key, False)
        if not isinstance(value, bool):
            raise self.fault(f"{key} = {value!r} is not true or false", key)
        return value

    def quantity(
        self,
        key: str,
        dimension: Dimension,
        units: Units,
        default: Any = _REQUIRED,
        *,
        scale: Units | None = None,
    ) -> Any:
        """Pass a quantity in `units`; a bare number is in `scale`, by default the same."""
        value = self.get(key, default)
        if key not in self.values:
            return value
        if isinstance(value, bool):
            raise self.fault(f"{key} = {value!r} is not a number", key)
        with self.located():
            amount = units.quantity(key, value, dimension)
        if scale is None or isinstance(value, str):
            return amount
        return amount * scale.factor(units, dimension)

    def quantities(self, key: str, dimension: Dimension, units: Units) -> list[float]:
        values = self.get(key)
        if not isinstance(values, list):
            raise self.fault(f"{key} = {values!r} is not a list", key)
        with self.located():
            return [
                units.quantity(f"{key}[{i}]", value, dimension) for i, value in enumerate(values)
            ]

    def table(self, key: str, default: Any = _REQUIRED) -> _Table:
        value = self.get(key, default)
        if not isinstance(value, dict):
            raise self.fault(f"{key} is not a table: [{self.where(key)}]", key)
        return _Table(self.path, self.source, (*self.keys, key), value)

    def tables(self, key: str, default: Any = _REQUIRED) -> list[_Table]:
        values = self.get(key, default)
        if not isinstance(values, list) or not all(isinstance(v, dict) for v in values):
            raise self.fault(f"{key} is not a list of tables: [[{self.where(key)}]]", key)
        return [
            _Table(self.path, self.source, (*self.keys, key, i), value)
            for i, value in enumerate(values)
        ]


class _Located(InputError):
    """Says where already."""


def _line(source: str, keys: tuple[str | int, ...]) -> int | None:
    """
    Line of the statement that brings a key: tomllib itself says which prefix of the file has it.

    Quadratic in the lines, so not for files that hold data by the thousand.
    """
    lines = source.splitlines()
    if not keys or len(lines) > 1000:
        return None
    begin = 0
    for end in range(1, len(lines) + 1):
        try:
            found: Any = tomllib.loads("\n".join(lines[:end]))
        except tomllib.TOMLDecodeError:
            continue
        try:
            for key in keys:
                found = found[key]
        except (KeyError, IndexError, TypeError):
            begin = end
        else:
            # Comments and blank lines before the statement are whole prefixes: none is between.
            return begin + 1
    return None
