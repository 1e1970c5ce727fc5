"""Unit names and conversions."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from math import gcd
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, overload

import numpy as np

from ._core import InputError
from ._input import any_array, array, finite, number, one_of, refuse

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

#: Units of length in tenths of a millimetre, all whole: an inch is exactly 25.4 mm, the foot is
#: the international one of 12 in.
_LENGTHS = {"in": 254, "ft": 3048, "m": 10_000, "cm": 100, "mm": 10, "km": 10_000_000}

#: A nautical mile is exactly 1852 m.
_METRES_PER_SECOND = 1852.0 / 3600.0


def length_unit(argument: str, unit: object) -> str:
    """Check a unit of length."""
    return one_of(argument, unit, _LENGTHS)


def is_length_unit(text: str) -> bool:
    """Whether a text names a known unit of length."""
    return text in _LENGTHS


def convert_length(values: NDArray[np.float64], unit: str, to: str) -> NDArray[np.float64]:
    """
    Convert lengths from `unit` to `to`.

    A product and a quotient by whole numbers: correct to two roundings, to one if either unit
    holds the other a whole number of times, and the same bits if the units are the same.
    """
    common = gcd(_LENGTHS[unit], _LENGTHS[to])
    return values * (_LENGTHS[unit] // common) / (_LENGTHS[to] // common)


_Length: TypeAlias = Literal["in", "ft", "m", "cm", "mm", "km"]


@overload
def knots(v: float, length: _Length = ...) -> float: ...
@overload
def knots(v: Sequence[float] | NDArray[Any], length: _Length = ...) -> NDArray[np.float64]: ...
def knots(
    v: float | Sequence[float] | NDArray[Any], length: _Length = "in"
) -> float | NDArray[np.float64]:
    """
    Convert speeds from knots.

    Parameters
    ----------
    v : float or array_like
        Speed, or speeds of any shape [kt].
    length : {"in", "ft", "m", "cm", "mm", "km"}
        Length unit of the result.

    Returns
    -------
    float or ndarray
        Speed, or speeds of the same shape [length unit per second].

    Raises
    ------
    InputError
        If a speed is not a finite number or `length` is not one of the units.

    Examples
    --------
    >>> import runway_modal as rm
    >>> round(rm.knots(20), 4)
    405.0744
    >>> rm.knots([20, 40], "m").round(3)
    array([10.289, 20.578])
    """
    metres = _LENGTHS[length_unit("length", length)] / _LENGTHS["m"]
    one = any_array("v", v).ndim == 0
    given = np.array(number("v", v)) if one else array("v", v, ndim=None)
    refuse("v", given, ~np.isfinite(given), "is not finite")
    with np.errstate(over="ignore"):
        converted = given * _METRES_PER_SECOND / metres
    refuse("v", given, ~np.isfinite(converted), f"is too large in {length}/s")
    return float(converted) if one else converted


#: Exponents of length, force and time.
Dimension = tuple[int, int, int]

ANGLE: Dimension = (0, 0, 0)
LENGTH: Dimension = (1, 0, 0)
FORCE: Dimension = (0, 1, 0)
TIME: Dimension = (0, 0, 1)
FREQUENCY: Dimension = (0, 0, -1)
SPEED: Dimension = (1, 0, -1)
ACCELERATION: Dimension = (1, 0, -2)
MASS: Dimension = (-1, 1, 2)
INERTIA: Dimension = (1, 1, 2)
STIFFNESS: Dimension = (-1, 1, 0)
DAMPING: Dimension = (-1, 1, 1)
#: Of elevation, against cycles per length.
PSD: Dimension = (3, 0, 0)

#: Exact by definition, in SI: the pound, and standard gravity.
_POUND, _GRAVITY = Fraction("0.45359237"), Fraction("9.80665")

#: Forces in newtons.
_FORCES = {
    "N": Fraction(1),
    "kN": Fraction(1000),
    "lbf": _POUND * _GRAVITY,
    "kip": 1000 * _POUND * _GRAVITY,
    "kgf": _GRAVITY,
}

#: Names of their thousands, for axes with large numbers.
THOUSAND = {"N": "kN", "lbf": "kip"}

#: Every unit that a string may name: its size in SI and its dimension. A radian is 1.
_UNITS: dict[str, tuple[Fraction, Dimension]] = {
    **{name: (Fraction(size, _LENGTHS["m"]), LENGTH) for name, size in _LENGTHS.items()},
    **{name: (size, FORCE) for name, size in _FORCES.items()},
    "s": (Fraction(1), TIME),
    "ms": (Fraction(1, 1000), TIME),
    "min": (Fraction(60), TIME),
    "h": (Fraction(3600), TIME),
    "rad": (Fraction(1), ANGLE),
    "Hz": (Fraction(2.0 * math.pi), FREQUENCY),
    "kt": (Fraction(1852, 3600), SPEED),
    "mph": (Fraction(5280 * 12 * 254, 10_000 * 3600), SPEED),
    "g": (_GRAVITY, ACCELERATION),
    "kg": (Fraction(1), MASS),
    "t": (Fraction(1000), MASS),
    "lb": (_POUND, MASS),
    "slug": (_POUND * _GRAVITY / Fraction("0.3048"), MASS),
}

_NUMBER = r"[-+]?[\d.]+(?:[eE][-+]?\d+)?"
_FACTOR = re.compile(r"([A-Za-z]+)\^?([1-4]?)")


def _size(unit: str) -> tuple[Fraction, Dimension]:
    """Size in SI and dimension of a unit such as "lbf*s2/in"; KeyError names an unknown part."""
    size, dimension = Fraction(1), (0, 0, 0)
    above, *below = unit.replace("²", "2").split("/")
    # "1/s" has nothing above the line.
    for i, part in enumerate([above if above.strip() != "1" or not below else "rad", *below]):
        for factor in re.split(r"[\s*·]+", part.strip()):
            found = _FACTOR.fullmatch(factor)
            if not found or found[1] not in _UNITS:
                raise KeyError(factor)
            power = int(found[2] or 1) * (1 if i == 0 else -1)
            base, exponents = _UNITS[found[1]]
            size *= base**power
            a, b, c = (d + power * e for d, e in zip(dimension, exponents, strict=True))
            dimension = (a, b, c)
    return size, dimension


@dataclass(frozen=True, slots=True)
class Units:
    """
    A consistent unit system: a length, a force and the second.

    The library needs none; axis labels and tables of results take one.

    Parameters
    ----------
    length : {"in", "ft", "m", "cm", "mm", "km"}
        Unit of length.
    force : {"N", "kN", "lbf", "kip", "kgf"}
        Unit of force. That of mass follows: force·s²/length.

    Raises
    ------
    InputError
        If a unit is unknown.

    Examples
    --------
    >>> import runway_modal as rm
    >>> from matplotlib.figure import Figure
    >>> mat = rm.Profile.full_mat()
    >>> mat.plot(ax=Figure().subplots(), units=rm.Units("in", "lbf")).get_xlabel()
    'station [in]'
    """

    length: str
    force: str

    def __post_init__(self) -> None:
        """Check the names."""
        length_unit("length", self.length)
        one_of("force", self.force, _FORCES)

    def name(self, dimension: Dimension) -> str:
        """
        Name the unit of a quantity.

        Parameters
        ----------
        dimension : (int, int, int)
            Exponents of length, force and time.

        Returns
        -------
        str
            Its unit.

        Examples
        --------
        >>> from runway_modal.units import MASS, Units
        >>> Units("in", "lbf").name(MASS)
        'lbf·s²/in'
        """

        def product(sign: int) -> str:
            powers = zip(
                (self.force, "s", self.length), (dimension[i] for i in (1, 2, 0)), strict=True
            )
            return "·".join(
                unit + {1: "", 2: "²"}.get(sign * power, str(sign * power))
                for unit, power in powers
                if sign * power > 0
            )

        if dimension == ANGLE:
            return "rad"
        above, below = product(1) or "1", product(-1)
        return f"{above}/{below}" if below else above

    def quantity(self, argument: str, value: object, dimension: Dimension) -> float:
        """
        Convert a quantity to these units.

        Parameters
        ----------
        argument : str
            Name of the quantity, for error messages.
        value : float or str
            A number in these units, or a string with its own, such as "1.5 in" or "38 kN/mm".
        dimension : (int, int, int)
            Exponents of length, force and time.

        Returns
        -------
        float
            The quantity.

        Raises
        ------
        InputError
            If it is not a number, or its unit is unknown or of the wrong kind.

        Examples
        --------
        >>> from runway_modal.units import SPEED, Units
        >>> Units("m", "N").quantity("speed", "36 km/h", SPEED)
        10.0
        """
        if not isinstance(value, str):
            # True is a number to Python.
            if isinstance(value, bool | np.bool_):
                raise InputError(f"{argument} = {value!r} is not a number")
            return finite(argument, value)
        # Atomic: the last digit is no unit.
        found = re.fullmatch(rf"\s*((?>{_NUMBER}))\s*(\S.*?)\s*", value)
        wanted = self.name(dimension)
        if re.match(r"\s*[-+]?\d+,\d", value):
            raise InputError(f"{argument} = {value!r}: numbers have a decimal point, not a comma")
        if not found:
            raise InputError(
                f"{argument} = {value!r} is not a number with a unit; "
                f"a number without one is in '{wanted}'"
            )
        try:
            size, given = _size(found[2])
        except KeyError as error:
            raise InputError(
                f"{argument} = {value!r}: unknown unit {error.args[0]!r}; known are "
                f"{', '.join(_UNITS)}, their powers, products and quotients"
            ) from None
        except OverflowError:
            raise InputError(f"{argument} = {value!r}: a unit beyond all numbers") from None
        if given != dimension:
            raise InputError(
                f"{argument} = {value!r} has the wrong kind of unit; one like '{wanted}' is needed"
            )
        try:
            amount = float(found[1])
        except ValueError:
            raise InputError(f"{argument} = {value!r} does not begin with a number") from None
        return finite(argument, amount * float(size / self._size(dimension)))

    def spatial_frequency(self, argument: str, value: object) -> float:
        """
        Convert a spatial frequency to cycles per unit of length.

        Parameters
        ----------
        argument : str
            Name of the quantity, for error messages.
        value : float or str
            A number in cycles per unit of length, or a string with its own unit, "0.1 cycles/m".
            Radians are not accepted: 1 rad/m is 1/2π cycles/m.

        Returns
        -------
        float
            The frequency.

        Raises
        ------
        InputError
            If it is not a number, or its unit is another.

        Examples
        --------
        >>> from runway_modal.units import Units
        >>> Units("in", "lbf").spatial_frequency("reference", "0.1 cycles/m")
        0.00254
        """
        if not isinstance(value, str):
            return self.quantity(argument, value, LENGTH)
        found = re.fullmatch(rf"\s*({_NUMBER})\s*cycles?/([a-z]+)\s*", value)
        if not found or found[2] not in _LENGTHS:
            raise InputError(
                f"{argument} = {value!r} is not a number of cycles/{', cycles/'.join(_LENGTHS)}"
            )
        number = self.quantity(argument, f"{found[1]} {self.length}", LENGTH)
        return number / self.quantity(argument, f"1 {found[2]}", LENGTH)

    def factor(self, to: Units, dimension: Dimension) -> float:
        """
        Factor that converts a quantity in these units to others.

        Parameters
        ----------
        to : Units
            The other units.
        dimension : (int, int, int)
            Exponents of length, force and time.

        Returns
        -------
        float
            The factor, exactly 1 if the units are the same.

        Examples
        --------
        >>> from runway_modal.units import LENGTH, Units
        >>> Units("ft", "lbf").factor(Units("in", "lbf"), LENGTH)
        12.0
        """
        return float(self._size(dimension) / to._size(dimension))

    @property
    def standard_gravity(self) -> float:
        """Standard gravity, 9.80665 m/s², in these units [length/s²]."""
        return float(_GRAVITY / self._size(ACCELERATION))

    @property
    def knot(self) -> float:
        """A knot, 1852 m/h, in these units [length/s]."""
        return self.quantity("speed", "1 kt", SPEED)

    def _size(self, dimension: Dimension) -> Fraction:
        length, force, _ = dimension
        return _UNITS[self.length][0] ** length * _FORCES[self.force] ** force


def check_units(units: Units | None) -> Units | None:
    """Check the units that a caller gives for results, which may be None."""
    if units is not None and not isinstance(units, Units):
        raise InputError(f"units = {units!r} is not a Units, such as Units('in', 'lbf')")
    return units


#: The report's units, in which presets and the defaults of built-in shapes are given.
REPORT = Units("in", "lbf")
