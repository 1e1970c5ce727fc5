"""Kind and shape of what a caller passes; values are checked by the Rust core."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._core import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def number(argument: str, value: Any) -> float:
    """Pass one real number as a float."""
    try:
        if isinstance(value, str | bytes):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{argument} = {value!r} is not a real number") from None


def array(argument: str, values: ArrayLike, ndim: int = 1) -> NDArray[np.float64]:
    """Pass real numbers as a C-ordered float64 array of `ndim` dimensions."""
    try:
        given = np.asanyarray(values)
    except ValueError:
        raise InputError(f"{argument} is not a rectangular array") from None
    if given.dtype.kind not in "biuf":
        raise InputError(f"{argument} holds {given.dtype}, not real numbers")
    if isinstance(given, np.ma.MaskedArray) and np.ma.is_masked(given):
        index = int(np.flatnonzero(np.ma.getmaskarray(given))[0])
        raise InputError(f"{argument}[{index}] is masked")
    if given.ndim != ndim:
        raise InputError(f"{argument} has shape {given.shape}, {ndim} dimension(s) expected")
    return np.ascontiguousarray(given, dtype=np.float64)


def read_only(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mark an array that belongs to a result as read-only."""
    values.flags.writeable = False
    return values
