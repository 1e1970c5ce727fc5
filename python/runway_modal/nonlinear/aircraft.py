"""The aircraft: a rigid body on struts and tires."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from runway_modal import aircraft as linear
from runway_modal._core import InputError
from runway_modal._input import not_negative, positive, read_only

from .equilibrium import equilibrium
from .series import Series
from .springs import GasSpring, LinearSpring, Orifice

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

#: Share of the weight below which a gear carries nothing but rounding.
_NO_LOAD = 1e-9


@dataclass(frozen=True, slots=True)
class Gear:
    """
    One landing gear: strut and tire in series.

    Without unsprung mass, strut and tire carry the same load. With it, the wheel moves by itself,
    and the strut may have an orifice and friction.

    Parameters
    ----------
    name : str
        Name, unique on its aircraft.
    x : float
        Arm forward of the centre of gravity [length].
    y : float
        Arm to the left of the centre of gravity [length].
    strut : GasSpring, LinearSpring or sequence of GasSpring
        Spring of the strut, or its gas chambers in series.
    tire : float
        Stiffness of the linear tire, > 0 [force/length].
    damping : float
        Viscous damping c, ≥ 0 [force·time/length]: across strut and tire as in `runway_modal.Gear`
        or, where the wheel has mass, across the strut.
    orifice : Orifice, optional
        Velocity-squared damping of the strut.
    friction : float
        Coulomb friction of the strut, ≥ 0 [force].
    unsprung_mass : float
        Mass of the wheel, not included in the aircraft's, ≥ 0 [force·time²/length].

    Raises
    ------
    InputError
        If a value is out of range, or there is an orifice or friction but no unsprung mass.

    Examples
    --------
    >>> from runway_modal import nonlinear
    >>> nose = nonlinear.f4e().gears[0]
    >>> nose.tire
    15600.0
    """

    name: str
    x: float
    y: float
    strut: GasSpring | LinearSpring | Sequence[GasSpring]
    tire: float
    damping: float = 0.0
    orifice: Orifice | None = None
    friction: float = 0.0
    unsprung_mass: float = 0.0

    def __post_init__(self) -> None:
        """Check the values."""
        object.__setattr__(self, "tire", positive("tire", self.tire))
        for key in ("damping", "friction", "unsprung_mass"):
            object.__setattr__(self, key, not_negative(key, getattr(self, key)))
        object.__setattr__(self, "strut", _strut(self.strut))
        if not isinstance(self.orifice, Orifice | None):
            raise InputError(f"orifice = {self.orifice!r} is not an Orifice")
        if not self.unsprung_mass and (self.orifice or self.friction):
            # Its rate would not be smooth, either: it follows the root of the load difference.
            raise InputError(
                f"unsprung_mass = {self.unsprung_mass!r}: orifice and friction act on the strut's "
                "own rate, which only a wheel with mass has"
            )
        # The linear gear checks the name and the arms.
        checked = linear.Gear(self.name, self.x, self.y, self.tire, self.damping)
        object.__setattr__(self, "x", checked.x)
        object.__setattr__(self, "y", checked.y)

    @property
    def _reference_load(self) -> float:
        return self.strut[0].load if isinstance(self.strut, tuple) else 0.0

    def _law(self, load: float, *, strut: bool = True, tire: bool = True) -> Series:
        """Law of strut and tire in series, or of one of them alone, about a static load."""
        chambers: Sequence[GasSpring] = ()
        compliance = 1.0 / self.tire if tire else 0.0
        if strut and isinstance(self.strut, LinearSpring):
            compliance += 1.0 / self.strut.stiffness
        elif strut and isinstance(self.strut, tuple):
            chambers = self.strut
        return Series(chambers, compliance, load, tire=tire)


def _strut(strut: Any) -> LinearSpring | tuple[GasSpring, ...]:
    if isinstance(strut, LinearSpring):
        return strut
    try:
        chambers = (strut,) if isinstance(strut, GasSpring) else tuple(strut)
    except TypeError:
        raise InputError(f"strut = {strut!r} is neither a spring nor gas chambers") from None
    if not chambers:
        raise InputError("strut has 0 chambers, at least 1 needed")
    for i, chamber in enumerate(chambers):
        if not isinstance(chamber, GasSpring):
            raise InputError(f"strut[{i}] = {chamber!r} is not a GasSpring")
    return chambers


@dataclass(frozen=True, slots=True, kw_only=True)
class Aircraft:
    """
    A rigid aircraft on any number of nonlinear gears.

    Parameters
    ----------
    mass : float
        Mass M of the body, without unsprung masses, > 0 [force·time²/length].
    pitch_inertia : float
        Inertia about the lateral axis, > 0 [mass·length²].
    roll_inertia : float
        Inertia about the longitudinal axis, > 0 [mass·length²].
    gears : sequence of Gear
        The gears. Their order is the order of all results.
    gravity : float
        Gravity, > 0 [length/time²]. Default: 386.0886 in/s²;
        give it in any other system.
    stations : mapping of str to (float, float), optional
        Points (x, y) where accelerations are wanted [length]; "cg" is always there.

    Raises
    ------
    InputError
        If a value is out of range, there is no gear, a gear name repeats, the gears cannot
        carry the weight, or a gear would have to pull on the runway.
    NumericalError
        If equilibrium alone does not determine the static loads and they are not found.

    Examples
    --------
    >>> from runway_modal import nonlinear
    >>> nonlinear.f4e().static_load.round(1)
    array([ 8921.8, 23627.1, 23627.1])
    """

    mass: float
    pitch_inertia: float
    roll_inertia: float
    gears: Sequence[Gear]
    gravity: float = linear.GRAVITY_IN
    stations: Mapping[str, tuple[float, float]] = field(default_factory=dict, hash=False)
    _sprung_load: NDArray[np.float64] = field(init=False, repr=False, compare=False)
    _linear: linear.Aircraft = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Check the values and find the static loads."""
        try:
            gears = tuple(self.gears)
        except TypeError:
            raise InputError(f"gears = {self.gears!r} is not a sequence of Gear") from None
        for i, gear in enumerate(gears):
            if not isinstance(gear, Gear):
                raise InputError(f"gears[{i}] = {gear!r} is not a nonlinear Gear")
        object.__setattr__(self, "gears", gears)
        # This checks the values, and finds the loads where equilibrium alone determines them.
        checked = self._linear_with([gear.tire for gear in gears])
        for key in ("mass", "pitch_inertia", "roll_inertia", "gravity", "stations"):
            object.__setattr__(self, key, getattr(checked, key))
        if not 1e-100 <= positive("gravity", self.gravity) <= 1e100:
            why = "1e-100 to 1e100 is allowed"
            raise InputError(f"gravity = {self.gravity!r} is out of range: {why}")
        loads = self._share(checked)
        for i, load in enumerate(loads.tolist()):
            if not load > _NO_LOAD * self.mass * self.gravity:
                raise InputError(
                    f"gears[{i}]: {gears[i].name!r} carries {load!r} at rest, "
                    "but a gear cannot pull"
                )
        slopes = [
            gear._law(load).stiffness_at(load)
            for gear, load in zip(gears, loads.tolist(), strict=True)
        ]
        object.__setattr__(self, "_sprung_load", loads)
        object.__setattr__(self, "_linear", self._linear_with(slopes))

    def __reduce__(self) -> tuple[partial[Aircraft], tuple[()]]:
        """Pickle by values."""
        keys = ("mass", "pitch_inertia", "roll_inertia", "gears", "gravity")
        values: dict[str, Any] = {key: getattr(self, key) for key in keys}
        return partial(Aircraft, **values, stations=dict(self.stations)), ()

    def _linear_with(self, stiffness: Sequence[float]) -> linear.Aircraft:
        return linear.Aircraft(
            mass=self.mass,
            pitch_inertia=self.pitch_inertia,
            roll_inertia=self.roll_inertia,
            gears=[
                linear.Gear(gear.name, gear.x, gear.y, k, gear.damping)
                for gear, k in zip(self.gears, stiffness, strict=True)
            ],
            gravity=self.gravity,
            stations=self.stations,
        )

    def _share(self, determinate: linear.Aircraft) -> NDArray[np.float64]:
        """Share the weight among the struts at rest on the level."""
        geometry = determinate.geometry
        if determinate._core.rank() == len(self.gears):
            return determinate.static_load
        laws = [gear._law(gear._reference_load) for gear in self.gears]
        weight = determinate.mass * determinate.gravity
        return read_only(equilibrium(laws, geometry, np.zeros(len(laws)), weight)[1])

    @property
    def gear_names(self) -> tuple[str, ...]:
        """Names of the gears, in order."""
        return tuple(gear.name for gear in self.gears)

    @property
    def geometry(self) -> NDArray[np.float64]:
        """Geometry matrix G, shape (g, 3): gear displacements from CG coordinates (Eq. 1)."""
        return self._linear.geometry

    @property
    def static_load(self) -> NDArray[np.float64]:
        """
        Load of each gear on a level runway at rest, unsprung mass included, shape (g,) [force].

        From equilibrium alone where that determines the loads. With more gears, as the springs
        share the weight, if the wheels are level when each strut carries its reference load: the
        first chamber's `load`, or none if the strut is linear.
        """
        wheels = [gear.unsprung_mass * self.gravity for gear in self.gears]
        return read_only(self._sprung_load + np.array(wheels))

    def linearised(self) -> linear.Aircraft:
        """
        Linear aircraft with the stiffnesses at static equilibrium, like those of Table 2.

        Dampers are kept; orifices, friction and unsprung masses are left out. With more gears
        than equilibrium determines its static loads are those of linear springs.

        Returns
        -------
        runway_modal.Aircraft
            The linear aircraft.

        Examples
        --------
        Table 3 of the report:

        >>> from runway_modal import nonlinear
        >>> nonlinear.f4e().linearised().modes(0.01).omega.round(3)
        array([ 7.27 , 12.016, 18.199])
        """
        return self._linear


#: Strut and tire of nose and main gears [lbf/in]: Table 2.
_STRUT = {"nose": 1662.0, "left": 27809.0, "right": 27809.0}
_TIRE = {"nose": 15600.0, "left": 13530.0, "right": 13530.0}

#: Circular frequencies at which the dampers have the given ratio [rad/s].
_OMEGA = {"nose": 8.0, "left": 12.0, "right": 12.0}


def f4e(polytropic: float = 1.0, damping_ratio: float = 0.01) -> Aircraft:
    """
    Stand-in for TAXI's model of the F-4E, heavy weight, in lbf, in and s.

    Masses and arms of Table 1 and tires of Table 2, printed in the report. Each strut is one gas
    chamber whose slope at static equilibrium is Table 2's. No drawing of these struts is public:
    the gas law, its exponent and the dampers are inferred, chosen so that the full mat gives the
    stiffnesses the report prints for TAXI. That is a calibration, not a prediction. On the mat its
    main gears bounce at 1.87 Hz, and the trailing edge leaves the range of their loads nearly
    unchanged (after ÷ on the mat 1.11), where the report says that TAXI's range is reduced.

    Parameters
    ----------
    polytropic : float
        Polytropic exponent n of the gas, > 0 [-]. Default inferred.
    damping_ratio : float
        Damping ratio ζ of each gear's damper, ≥ 0 [-]: c = 2ζk/ω, k strut and tire in series,
        ω = 8 rad/s for the nose and 12 rad/s for the main gears. Default: the report's 1 %.

    Returns
    -------
    Aircraft
        Gears "nose", "left" and "right", without unsprung mass, orifices or stops.

    Raises
    ------
    InputError
        If a value is out of range.

    Examples
    --------
    >>> from runway_modal import nonlinear
    >>> left = nonlinear.f4e(polytropic=1.1).gears[1]
    >>> round(left.strut[0].column, 4)
    0.9346
    """
    ratio = not_negative("damping_ratio", damping_ratio)
    report = linear.f4e()

    def gear(at: linear.Gear, load: float) -> Gear:
        name = at.name
        series = linear.Gear.from_series(name, at.x, at.y, strut=_STRUT[name], tire=_TIRE[name])
        strut = GasSpring.from_stiffness(load, _STRUT[name], polytropic)
        damping = 2.0 * ratio * series.stiffness / _OMEGA[name]
        return Gear(name, at.x, at.y, strut, _TIRE[name], damping)

    return Aircraft(
        mass=report.mass,
        pitch_inertia=report.pitch_inertia,
        roll_inertia=report.roll_inertia,
        gears=tuple(map(gear, report.gears, report.static_load.tolist())),
    )
