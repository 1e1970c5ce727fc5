"""Unit conversions: the only place that knows any unit."""

from __future__ import annotations

from typing import Literal

from ._core import InputError
from ._input import finite

#: A nautical mile is 1852 m exactly, an inch 0.0254 m exactly.
_METRES_PER_SECOND = 1852.0 / 3600.0
_METRES = {"m": 1.0, "in": 0.0254, "ft": 0.3048}


def knots(v: float, length: Literal["in", "m", "ft"] = "in") -> float:
    """
    Convert a speed from knots.

    Parameters
    ----------
    v : float
        Speed [kt].
    length : {"in", "m", "ft"}
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
    if not isinstance(length, str) or length not in _METRES:
        raise InputError(f"length = {length!r} is none of {', '.join(map(repr, _METRES))}")
    speed = finite("v", v)
    return finite("v in the new unit", speed * _METRES_PER_SECOND / _METRES[length])
