"""Names and dimensions of results: extremes of a run, and what an ensemble holds of every run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._core import InputError
from .units import ACCELERATION, FORCE, LENGTH, TIME

if TYPE_CHECKING:
    from .ensemble import Ensemble

#: Extremes of gears, in the order of tables.
EXTREMES_OF_GEARS = {
    "max_load": FORCE,
    "time_of_max": TIME,
    "position_of_max": LENGTH,
    "min_load": FORCE,
    "time_of_min": TIME,
    "position_of_min": LENGTH,
}

#: Extremes at stations of the aircraft.
EXTREMES_OF_STATIONS = {
    "max_acceleration": ACCELERATION,
    "time_of_max_acceleration": TIME,
    "position_of_max_acceleration": LENGTH,
}

#: Quantities of an ensemble: of gears, then of stations.
DIMENSIONS = {
    "max_load": FORCE,
    "min_load": FORCE,
    "rms_load": FORCE,
    "max_acceleration": ACCELERATION,
    "rms_acceleration": ACCELERATION,
}

LABELS = {
    "max_load": "largest load",
    "min_load": "smallest load",
    "rms_load": "RMS of dynamic load",
    "max_acceleration": "largest |vertical acceleration|",
    "rms_acceleration": "RMS of vertical acceleration",
}

#: Vertical acceleration at pilot and CG beyond which a runway counts as rough [g]; published:
#: Morris and Hall, NASA 1965; Navy CEL TR-846, 1976.
ACCELERATION_LIMIT = 0.4

#: Quantities whose small values are the dangerous ones.
DOWNWARD = ("min_load",)


def names_of(ensemble: Ensemble, quantity: str) -> tuple[str, ...]:
    """Names of the gears or stations that have a quantity."""
    of_gears = DIMENSIONS[quantity] == FORCE
    return ensemble.gear_names if of_gears else tuple(getattr(ensemble, quantity))


def column_of(quantity: str, at: str, gears: tuple[str, ...], stations: tuple[str, ...]) -> int:
    """Find the column of a gear or station; refuse a name that has no such quantity."""
    kinds = ("gear", gears), ("station", stations)
    (kind, names), (other, others) = kinds if DIMENSIONS[quantity] == FORCE else kinds[::-1]
    if not isinstance(at, str) or at not in names:
        hint = f"; {at!r} is a {other}, and {quantity} is of {kind}s" if at in tuple(others) else ""
        raise InputError(f"at = {at!r}: no such {kind}; there are {names}{hint}")
    return names.index(at)
