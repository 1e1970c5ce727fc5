"""Force laws of a strut, one class each: gas, linear spring, orifice."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from runway_modal._core import InputError
from runway_modal._input import not_negative, number, positive

Array: TypeAlias = NDArray[np.float64]

#: A single value in the equations of motion, many values when a run is evaluated.
Values = TypeVar("Values", float, Array)


@dataclass(frozen=True, slots=True)
class GasSpring:
    """
    Gas chamber of a strut: F = F₀ [ℓ / (ℓ - s)]ⁿ, n the polytropic exponent.

    The compression s counts from the point at which the chamber carries F₀ and its gas column
    is ℓ long: the fully extended strut of a drawing, F₀ = p₀A and ℓ = v₀/A with `extension` 0,
    or any other point, such as static equilibrium. A second stage is a second chamber that sits
    on its stop until the load exceeds its precharge.

    Parameters
    ----------
    load : float
        Load F₀ at the reference point, > 0 [force].
    column : float
        Length ℓ of the gas column there, > 0 [length].
    polytropic : float
        Exponent n, > 0 [-]: 1.0 if slow, about 1.1 if oil and gas mix, 1.3 to 1.4 if adiabatic.
    extension : float
        How far the chamber can extend from the reference point to its stop, ≥ 0 [length].
        Default: no stop.

    Raises
    ------
    InputError
        If a value is out of range.

    Notes
    -----
    Milwitzky and Cook, NACA Report 1154, the pneumatic force.

    Examples
    --------
    Compressed to half its column, an isothermal chamber carries twice the load:

    >>> from runway_modal import nonlinear
    >>> nonlinear.GasSpring(load=1000.0, column=8.0).force(4.0)
    2000.0
    """

    load: float
    column: float
    polytropic: float = 1.0
    extension: float = math.inf

    def __post_init__(self) -> None:
        """Check the values."""
        for key in ("load", "column", "polytropic"):
            object.__setattr__(self, key, positive(key, getattr(self, key)))
        extension = number("extension", self.extension)
        if not extension >= 0.0:
            raise InputError(f"extension = {extension!r} is negative or not a number")
        object.__setattr__(self, "extension", extension)

    @classmethod
    def from_stiffness(cls, load: float, stiffness: float, polytropic: float = 1.0) -> GasSpring:
        """
        Chamber with a given slope dF/ds = nF₀/ℓ at its reference point, without a stop.

        Parameters
        ----------
        load : float
            Load F₀ at the reference point, > 0 [force].
        stiffness : float
            Slope of the air curve there, > 0 [force/length].
        polytropic : float
            Exponent n, > 0 [-].

        Returns
        -------
        GasSpring
            The chamber.

        Raises
        ------
        InputError
            If a value is out of range.

        Examples
        --------
        >>> from runway_modal import nonlinear
        >>> nonlinear.GasSpring.from_stiffness(load=1000.0, stiffness=250.0).column
        4.0
        """
        load, stiffness = positive("load", load), positive("stiffness", stiffness)
        return cls(load, positive("polytropic", polytropic) * load / stiffness, polytropic)

    @property
    def preload(self) -> float:
        """Load at which the chamber leaves its stop [force]."""
        return float(self.load * (1.0 + self.extension / self.column) ** -self.polytropic)

    def force(self, compression: Values) -> Values:
        """
        Load at a compression, as if there were no stop.

        Parameters
        ----------
        compression : float or ndarray
            Compression s from the reference point, < ℓ [length].

        Returns
        -------
        float or ndarray
            Load [force].

        Raises
        ------
        InputError
            If a compression is ℓ or more.

        Examples
        --------
        >>> from runway_modal import nonlinear
        >>> nonlinear.GasSpring(load=1000.0, column=8.0).force(-8.0)
        500.0
        """
        if not np.all(np.less(compression, self.column)):
            raise InputError(f"compression = {compression!r} is not below the column's length")
        return self._force(compression)

    def _force(self, compression: Values) -> Values:
        load: Values = self.load * (self.column / (self.column - compression)) ** self.polytropic
        return load

    def compression(self, load: Values) -> Values:
        """
        Compression at a load, as if there were no stop: s = ℓ [1 - (F₀/F)^(1/n)].

        Parameters
        ----------
        load : float or ndarray
            Load F, > 0 [force].

        Returns
        -------
        float or ndarray
            Compression from the reference point [length].

        Raises
        ------
        InputError
            If a load is not positive.

        Examples
        --------
        >>> from runway_modal import nonlinear
        >>> nonlinear.GasSpring(load=1000.0, column=8.0).compression(2000.0)
        4.0
        """
        _check_load(load)
        return self._compression(load)

    def _compression(self, load: Values) -> Values:
        compression: Values = self.column * (1.0 - (self.load / load) ** (1.0 / self.polytropic))
        return compression

    def stiffness(self, load: Values) -> Values:
        """
        Slope of the air curve at a load: dF/ds = nF/ℓ (F/F₀)^(1/n).

        Parameters
        ----------
        load : float or ndarray
            Load F, > 0 [force].

        Returns
        -------
        float or ndarray
            Tangent stiffness [force/length].

        Raises
        ------
        InputError
            If a load is not positive.

        Examples
        --------
        >>> from runway_modal import nonlinear
        >>> nonlinear.GasSpring(load=1000.0, column=8.0).stiffness(2000.0)
        500.0
        """
        _check_load(load)
        return self._stiffness(load)

    def _stiffness(self, load: Values) -> Values:
        slope: Values = load * (load / self.load) ** (1.0 / self.polytropic)
        return self.polytropic / self.column * slope


def _check_load(load: float | Array) -> None:
    if not np.all(np.greater(load, 0.0)):
        raise InputError(f"load = {load!r} is not positive")


@dataclass(frozen=True, slots=True)
class LinearSpring:
    """
    Linear strut: F = k s, without a stop.

    Parameters
    ----------
    stiffness : float
        Stiffness k, > 0 [force/length].

    Raises
    ------
    InputError
        If `stiffness` is not positive and finite.

    Examples
    --------
    >>> from runway_modal import nonlinear
    >>> nonlinear.LinearSpring(27809.0)
    LinearSpring(stiffness=27809.0)
    """

    stiffness: float

    def __post_init__(self) -> None:
        """Check the value."""
        object.__setattr__(self, "stiffness", positive("stiffness", self.stiffness))


@dataclass(frozen=True, slots=True)
class Orifice:
    """
    Velocity-squared damping of the oil: F = C v |v|, v the strut's rate of compression.

    Parameters
    ----------
    compression : float
        Coefficient C while the strut compresses, ≥ 0 [force·time²/length²].
    rebound : float
        Coefficient C while it extends, ≥ 0 [force·time²/length²].

    Raises
    ------
    InputError
        If a coefficient is negative or not finite.

    Notes
    -----
    Milwitzky and Cook, NACA Report 1154, the hydraulic force: C = ρA³ / 2(C_d A_n)², ρ the
    density of the oil, A the hydraulic area, A_n the net orifice area and C_d its discharge
    coefficient.

    Examples
    --------
    >>> from runway_modal import nonlinear
    >>> damper = nonlinear.Orifice(compression=2.0, rebound=8.0)
    >>> damper.force(10.0), damper.force(-10.0)
    (200.0, -800.0)
    """

    compression: float
    rebound: float

    def __post_init__(self) -> None:
        """Check the values."""
        for key in ("compression", "rebound"):
            object.__setattr__(self, key, not_negative(key, getattr(self, key)))

    def force(self, rate: Values) -> Values:
        """
        Force that resists a rate of compression.

        Parameters
        ----------
        rate : float or ndarray
            Rate of compression, negative while the strut extends [length/time].

        Returns
        -------
        float or ndarray
            Force, positive in compression [force].

        Examples
        --------
        >>> from runway_modal import nonlinear
        >>> nonlinear.Orifice(compression=1.0, rebound=2.0).force(3.0)
        9.0
        """
        coefficient = self.compression * (rate > 0.0) + self.rebound * (rate < 0.0)
        return coefficient * rate * abs(rate)
