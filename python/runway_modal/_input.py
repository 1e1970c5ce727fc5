"""Checks of kind and shape, and of values that never reach the core."""

from __future__ import annotations

import math
import operator
from contextlib import suppress
from numbers import Real
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ._core import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import ArrayLike, NDArray

_Array = TypeVar("_Array", bound="NDArray[Any]")


def number(argument: str, value: Any) -> float:
    """Check a real number; return it as a float."""
    if type(value) is float:
        return value
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise InputError(f"{argument} is masked")
    try:
        kind = value.dtype.kind if isinstance(value, np.ndarray | np.generic) else ""
        # float() would read strings and drop imaginary parts and masks.
        if isinstance(value, str | bytes) or value is np.ma.masked or kind not in "biufO":
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{argument} = {value!r} is not a real number") from None


def finite(argument: str, value: Any) -> float:
    """Check a finite real number; return it as a float."""
    passed = number(argument, value)
    if not math.isfinite(passed):
        raise InputError(f"{argument} = {passed!r} is not finite")
    return passed


def positive(argument: str, value: Any) -> float:
    """Check a finite number > 0; return it as a float."""
    passed = finite(argument, value)
    if not passed > 0.0:
        raise InputError(f"{argument} = {passed!r} is not positive")
    return passed


def not_negative(argument: str, value: Any) -> float:
    """Check a finite number ≥ 0; return it as a float."""
    passed = finite(argument, value)
    if not passed >= 0.0:
        raise InputError(f"{argument} = {passed!r} is negative")
    return passed


def integer(argument: str, value: Any, least: int, below: int | None = None) -> int:
    """Check a whole number and its limits; return it as an int."""
    try:
        passed = operator.index(value)
    except TypeError:
        raise InputError(f"{argument} = {value!r} is not a whole number") from None
    if passed < least or (below is not None and passed >= below):
        limits = f"at least {least}" + ("" if below is None else f" and below {below}")
        raise InputError(f"{argument} = {passed} must be {limits}")
    return passed


def flag(argument: str, value: Any) -> bool:
    """Check for True or False; anything else that has a truth value is refused."""
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{argument} = {value!r} is not True or False")
    return bool(value)


def array(argument: str, values: ArrayLike, ndim: int | None = 1) -> NDArray[np.float64]:
    """Check real numbers; return a C-ordered float64 array of `ndim` dimensions (None: any)."""
    given = any_array(argument, values)
    if given.dtype == object:
        for place, value in np.ndenumerate(given):
            if not isinstance(value, Real):
                raise InputError(f"{argument}{_where(place)} = {value!r} is not a real number")
        with suppress(OverflowError):
            given = given.astype(np.float64)
    if given.dtype.kind not in "biuf":
        what = "text" if given.dtype.kind in "US" else given.dtype
        raise InputError(f"{argument} holds {what}, not real numbers")
    refuse_masked(argument, given)
    if ndim is not None and given.ndim != ndim:
        raise InputError(f"{argument} has shape {given.shape}, {ndim} dimension(s) expected")
    return in_order(given, np.float64)


def one_or_each(
    argument: str, values: ArrayLike, count: int | None = None, of: str = "run"
) -> NDArray[np.float64]:
    """Check one number for all, shape (1,), or one for each of `count`, shape (count,)."""
    given = any_array(argument, values)
    if given.ndim == 0:
        return np.array([number(argument, values)])
    each = array(argument, given)
    if count is not None and each.size != count:
        raise InputError(f"{argument} has {entries(each.size)}, {count} expected (one per {of})")
    return each


def one_of(argument: str, value: object, known: Iterable[str]) -> str:
    """Check a name against those that are known."""
    names = tuple(known)
    if not isinstance(value, str) or value not in names:
        raise InputError(f"{argument} = {value!r} is none of {', '.join(map(repr, names))}")
    return value


def in_order(values: NDArray[Any], dtype: type[np.floating[Any]]) -> NDArray[Any]:
    """Values one after the other in memory, at addresses that the core can read."""
    # What comes out of a file's or a message's buffer may begin anywhere.
    return np.require(values, dtype, ["C_CONTIGUOUS", "ALIGNED", "ENSUREARRAY"])


def entries(count: int) -> str:
    """So many entries, in words."""
    return "1 entry" if count == 1 else f"{count} entries"


def refuse_masked(argument: str, values: NDArray[Any]) -> None:
    """Raise for the first masked value, if there is one."""
    for index in np.argwhere(np.ma.getmaskarray(values)) if np.ma.is_masked(values) else ():
        raise InputError(f"{argument}{_where(index)} is masked")


def refuse(argument: str, values: NDArray[Any], wrong: NDArray[np.bool_], why: str) -> None:
    """Raise for the first wrong value, if there is one."""
    # Small arrays are many, and wrong ones few.
    for index in np.argwhere(wrong) if wrong.any() else ():
        value = values[tuple(index)].item()
        raise InputError(f"{argument}{_where(index)} = {value!r} {why}")


def _where(index: Sequence[int] | NDArray[np.intp]) -> str:
    return f"[{', '.join(map(str, index))}]" if len(index) else ""


def any_array(argument: str, values: ArrayLike) -> NDArray[Any]:
    """Make a rectangular array of any kind."""
    try:
        return np.asanyarray(values)
    except ValueError:
        raise InputError(f"{argument} is not a rectangular array") from None


def read_only(values: _Array) -> _Array:
    """Mark an array that belongs to a result as read-only."""
    values.flags.writeable = False
    return values
