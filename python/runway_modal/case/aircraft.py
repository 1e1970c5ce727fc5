"""The aircraft of a case file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from runway_modal._core import InputError
from runway_modal._input import finite
from runway_modal.aircraft import Aircraft, Gear, f4e, single_dof
from runway_modal.modes import Modes
from runway_modal.units import (
    ACCELERATION,
    DAMPING,
    FORCE,
    FREQUENCY,
    INERTIA,
    LENGTH,
    MASS,
    REPORT,
    STIFFNESS,
    Dimension,
    Units,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from runway_modal import nonlinear

    from .toml import Table

#: Keys of an aircraft preset, and of an aircraft whose data the file gives.
_PRESET, _DATA = (
    ("preset", "stiffness", "nonlinear"),
    ("mass", "pitch_inertia", "roll_inertia", "gravity", "gears"),
)


def linear(table: Table, units: Units) -> Modes:
    """Make the modes of a linear aircraft."""
    preset = "preset" in table.values
    table.only(
        *(_PRESET if preset else _DATA), "damping_ratio", "modes", "static_correction", "stations"
    )
    points = _stations(table, units)
    with table.located():
        if not preset:
            aircraft = Aircraft(
                mass=table.quantity("mass", MASS, units),
                pitch_inertia=table.quantity("pitch_inertia", INERTIA, units),
                roll_inertia=table.quantity("roll_inertia", INERTIA, units),
                gears=[_gear(gear, units) for gear in table.tables("gears")],
                gravity=table.quantity("gravity", ACCELERATION, units, units.standard_gravity),
                stations=points,
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
            if "static_correction" in table.values:
                raise InputError("static_correction applies only to measured modes")
            return aircraft.modes(table.values.get("damping_ratio"))
        if "damping_ratio" in table.values:
            raise InputError("damping_ratio: each measured mode has its own")
        for mode in measured:
            mode.only("omega", "damping_ratio", "shape")
        shapes = [mode.get("shape") for mode in measured]
        for mode, shape in zip(measured, shapes, strict=True):
            if not isinstance(shape, list) or len(shape) != 3:
                raise mode.fault(f"shape = {shape!r} is not [bounce, pitch, roll]", "shape")
            with mode.located():
                for i, value in enumerate(shape):
                    finite(f"shape[{i}]", value)
        return Modes(
            aircraft,
            [mode.quantity("omega", FREQUENCY, units) for mode in measured],
            [mode.get("damping_ratio") for mode in measured],
            np.transpose(shapes),
            static_correction=table.flag("static_correction"),
        )


def _stations(table: Table, units: Units) -> dict[str, Any]:
    stations = table.table("stations", {})
    return {name: tuple(stations.quantities(name, LENGTH, units)) for name in stations.values}


def nonlinear_and_modes(
    table: Table, units: Units, notes: list[str]
) -> tuple[nonlinear.Aircraft, Modes]:
    """Make the F-4E on gas struts, and the modes it has near rest."""
    from runway_modal import nonlinear

    table.only("preset", "nonlinear", "damping_ratio", "stations")
    table.choice("preset", ("f4e",))
    ratio = table.get("damping_ratio")
    with table.located():
        aircraft = nonlinear.f4e(damping_ratio=ratio)
        linear = _in_units(aircraft.linearised(), units, _stations(table, units))

        converted = _converter(units)
        gears = []
        for gear, at in zip(aircraft.gears, linear.gears, strict=True):
            (chamber,) = cast("tuple[nonlinear.GasSpring]", gear.strut)
            strut = nonlinear.GasSpring(
                converted(chamber.load, FORCE),
                converted(chamber.column, LENGTH),
                chamber.polytropic,
            )
            tire = converted(gear.tire, STIFFNESS)
            gears.append(nonlinear.Gear(at.name, at.x, at.y, strut, tire, at.damping))
        notes.append(
            f"{table.where()}: gas law and dampers, chosen to fit the report's stiffnesses"
        )
        return nonlinear.Aircraft(
            mass=linear.mass,
            pitch_inertia=linear.pitch_inertia,
            roll_inertia=linear.roll_inertia,
            gears=gears,
            gravity=linear.gravity,
            stations=linear.stations,
        ), linear.modes()


def _gear(table: Table, units: Units) -> Gear:
    table.only("name", "x", "y", "stiffness", "strut", "tire", "damping")
    name = table.text("name")
    x, y = (table.quantity(key, LENGTH, units) for key in ("x", "y"))
    damping = table.quantity("damping", DAMPING, units, 0.0)
    with table.located():
        if "stiffness" in table.values:
            if {"strut", "tire"} & table.values.keys():
                raise table.fault("give either stiffness or strut and tire, not both", "stiffness")
            return Gear(name, x, y, table.quantity("stiffness", STIFFNESS, units), damping)
        strut, tire = (table.quantity(key, STIFFNESS, units) for key in ("strut", "tire"))
        return Gear.from_series(name, x, y, strut=strut, tire=tire, damping=damping)


def _in_units(aircraft: Aircraft, units: Units, stations: Mapping[str, Any]) -> Aircraft:
    """Convert an aircraft from the report's units to the case's."""
    converted = _converter(units)
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


def _converter(units: Units) -> Callable[[float, Dimension], float]:
    """Make the function that converts a quantity from the report's units to the case's."""
    return lambda value, dimension: value * REPORT.factor(units, dimension)


def one_degree_of_freedom(table: Table, units: Units) -> Modes:
    """Make the single mode of the report's simplest model."""
    table.only("mass", "omega", "damping_ratio", "gravity")
    with table.located():
        return single_dof(
            mass=table.quantity("mass", MASS, units),
            omega=table.quantity("omega", FREQUENCY, units),
            damping_ratio=table.get("damping_ratio"),
            gravity=table.quantity("gravity", ACCELERATION, units, units.standard_gravity),
        )
