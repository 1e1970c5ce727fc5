"""Unit conversions: the only place that knows any unit."""

from __future__ import annotations

from math import gcd
from typing import TYPE_CHECKING, Literal

from ._core import InputError
from ._input import finite

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

#: Units of length in tenths of a millimetre, whole for all: an inch is 25.4 mm exactly, the foot
#: the international one of 12 in.
_LENGTHS = {"in": 254, "ft": 3048, "m": 10_000, "cm": 100, "mm": 10, "km": 10_000_000}

#: A nautical mile is 1852 m exactly.
_METRES_PER_SECOND = 1852.0 / 3600.0


def length_unit(argument: str, unit: object) -> str:
    """Pass a known unit of length."""
    if not isinstance(unit, str) or unit not in _LENGTHS:
        raise InputError(f"{argument} = {unit!r} is none of {', '.join(map(repr, _LENGTHS))}")
    return unit


def is_length_unit(text: str) -> bool:
    """Whether a text names a known unit of length."""
    return text in _LENGTHS


def convert_length(values: NDArray[np.float64], unit: str, to: str) -> NDArray[np.float64]:
    """
    Lengths given in `unit`, in the unit `to`.

    A product and a quotient by whole numbers: correct to two roundings, to one if either unit
    holds the other a whole number of times, and the same bits if the units are the same.
    """
    common = gcd(_LENGTHS[unit], _LENGTHS[to])
    return values * (_LENGTHS[unit] // common) / (_LENGTHS[to] // common)


def knots(v: float, length: Literal["in", "ft", "m", "cm", "mm", "km"] = "in") -> float:
    """
    Convert a speed from knots.

    Parameters
    ----------
    v : float
        Speed [kt].
    length : {"in", "ft", "m", "cm", "mm", "km"}
        Length unit of the result.

    Returns
    -------
    float
        Speed [length unit per second].

    Raises
    ------
    InputError
        If `v` is not a finite number or `length` is not one of the units.

    Examples
    --------
    >>> import runway_modal as rm
    >>> round(rm.knots(20), 4)
    405.0744
    """
    metres = _LENGTHS[length_unit("length", length)] / _LENGTHS["m"]
    return finite("v in the new unit", finite("v", v) * _METRES_PER_SECOND / metres)
