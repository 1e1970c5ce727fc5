"""Set-ups: what all runs of an ensemble share, in plain numbers and words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .aircraft import Aircraft
    from .modes import Modes


def describe_body(aircraft: Aircraft) -> dict[str, Any]:
    """List the gears and stations of an aircraft."""
    keys = ("name", "x", "y", "stiffness", "damping")
    return {
        "gears": [{key: getattr(gear, key) for key in keys} for gear in aircraft.gears],
        "stations": [[name, *point] for name, point in aircraft.stations.items()],
        "static_load": aircraft.static_load.tolist(),
    }


def describe(modes: Modes) -> dict[str, Any]:
    """List what determines the results of an aircraft and its modes."""
    return {
        **describe_body(modes.aircraft),
        "omega": modes.omega.tolist(),
        "damping_ratio": modes.damping_ratio.tolist(),
        "shapes": modes.shapes.tolist(),
        "static_correction": modes.static_correction,
    }


def difference(one: Any, other: Any, place: str = "") -> tuple[str, Any, Any] | None:
    """Find the first entry in which two set-ups differ: where, and what it is in each."""
    if isinstance(one, dict) and isinstance(other, dict):
        keys = {**one, **other}
        pairs = [(f"{place}.{key}" if place else key, one.get(key), other.get(key)) for key in keys]
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        both = enumerate(zip(one, other, strict=True))
        pairs = [(f"{place}[{i}]", mine, theirs) for i, (mine, theirs) in both]
    else:
        return None if one == other else (place, one, other)
    found = (difference(mine, theirs, at) for at, mine, theirs in pairs)
    return next((entry for entry in found if entry), None)
