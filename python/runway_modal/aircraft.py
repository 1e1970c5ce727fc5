"""The aircraft: a rigid body on linear gears."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _core
from ._core import InputError
from ._input import array, number, one_of, read_only, refuse
from .modes import Modes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

#: Standard gravity, 9.80665 m/s², to seven digits [in/s²].
GRAVITY_IN = 386.0886


@dataclass(frozen=True, slots=True)
class Gear:
    """
    One landing gear: strut and tire in series, as one linear spring and damper.

    Parameters
    ----------
    name : str
        Name, unique on its aircraft.
    x : float
        Arm forward of the centre of gravity [length].
    y : float
        Arm to the left of the centre of gravity [length].
    stiffness : float
        Stiffness k of strut and tire in series, > 0 [force/length].
    damping : float
        Damping c, ≥ 0 [force·time/length]. It gives the default damping ratios of
        `Aircraft.modes`; it enters ground input and loads only with ``damping_input=True``. It acts
        across strut and tire together: see `simulate` on raw surveys.

    Raises
    ------
    InputError
        If the name is empty or not a string, a value is not finite, the stiffness is not positive
        or the damping is negative.

    Examples
    --------
    >>> import runway_modal as rm
    >>> rm.Gear("nose", 234.9, 0.0, 1502.0)
    Gear(name='nose', x=234.9, y=0.0, stiffness=1502.0, damping=0.0)
    """

    name: str
    x: float
    y: float
    stiffness: float
    damping: float = 0.0
    _core: _core.Gear = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Check the values."""
        if not isinstance(self.name, str) or not self.name:
            raise InputError(f"name = {self.name!r} is not a gear name")
        if any("\ud800" <= letter <= "\udfff" for letter in self.name):
            raise InputError(f"name = {self.name!r} has a letter that no text can hold")
        for key in ("x", "y", "stiffness", "damping"):
            object.__setattr__(self, key, number(key, getattr(self, key)))
        core = _core.Gear(self.name, self.x, self.y, self.stiffness, self.damping)
        object.__setattr__(self, "_core", core)

    @classmethod
    def from_series(
        cls, name: str, x: float, y: float, *, strut: float, tire: float, damping: float = 0.0
    ) -> Gear:
        """
        Gear whose stiffness is strut and tire in series, 1/k = 1/strut + 1/tire (Table 2).

        Parameters
        ----------
        name : str
            Name, unique on its aircraft.
        x, y : float
            Arms forward and to the left of the centre of gravity [length].
        strut : float
            Stiffness of the strut, > 0 [force/length].
        tire : float
            Stiffness of the tire, > 0 [force/length].
        damping : float
            Damping of the whole gear, ≥ 0 [force·time/length].

        Returns
        -------
        Gear
            The gear.

        Raises
        ------
        InputError
            If a stiffness is not positive or another value is out of range.

        Examples
        --------
        >>> import runway_modal as rm
        >>> main = rm.Gear.from_series("left", -44.35, 109.25, strut=27809.0, tire=13530.0)
        >>> round(main.stiffness)
        9102
        """
        stiffness = _core.series(number("strut", strut), number("tire", tire))
        return cls(name, x, y, stiffness, damping)

    def __reduce__(self) -> tuple[type[Gear], tuple[str, float, float, float, float]]:
        """Pickle by values."""
        return Gear, (self.name, self.x, self.y, self.stiffness, self.damping)


@dataclass(frozen=True, slots=True, kw_only=True)
class Aircraft:
    """
    A rigid aircraft on any number of linear gears (Eqs. 1-5).

    Any consistent unit system will do. The report's is lbf, in, s, and so is that of the default
    `gravity`: in any other system pass `gravity`, too. Bounce is positive up, pitch nose up [rad],
    roll left side up [rad], accelerations up; loads are positive in compression.

    Parameters
    ----------
    mass : float
        Mass M, > 0 [force·time²/length].
    pitch_inertia : float
        Inertia about the lateral axis, > 0 [mass·length²].
    roll_inertia : float
        Inertia about the longitudinal axis, > 0 [mass·length²].
    gears : sequence of Gear
        The gears. Their order is the order of all results.
    gravity : float
        Gravity, ≥ 0 [length/time²]. Default: 386.0886 in/s²;
        give it in any other system.
    stations : mapping of str to (float, float), optional
        Points (x, y) where accelerations are wanted [length]; "cg" is always there.

    Raises
    ------
    InputError
        If a value is out of range, there is no gear, a gear name repeats, or the gears cannot
        carry the weight unless one of them pulls on the runway.

    Examples
    --------
    The report's aircraft, and one in N, m, s with a pilot 12 m ahead of the centre of gravity:

    >>> import runway_modal as rm
    >>> rm.f4e().static_load.round(1)
    array([ 8921.8, 23627.1, 23627.1])
    >>> airliner = rm.Aircraft(
    ...     mass=64_000.0,
    ...     pitch_inertia=3.1e6,
    ...     roll_inertia=1.6e6,
    ...     gravity=9.80665,
    ...     gears=[
    ...         rm.Gear("nose", x=11.5, y=0.0, stiffness=0.6e6, damping=20e3),
    ...         rm.Gear("left", x=-1.2, y=3.8, stiffness=2.4e6, damping=90e3),
    ...         rm.Gear("right", x=-1.2, y=-3.8, stiffness=2.4e6, damping=90e3),
    ...     ],
    ...     stations={"pilot": (12.0, 0.0)},
    ... )
    >>> airliner.static_load.round(-2)
    array([ 59300., 284200., 284200.])

    Its dampers are strong, so the ground must act on them, too:

    >>> modes, ramp, speed = airliner.modes(), rm.Profile([0, 2], [0, 0.04]), rm.knots(60, "m")
    >>> modes.damping_ratio.round(2)
    array([0.09, 0.12, 0.17])
    >>> for damping_input in (False, True):
    ...     found = rm.simulate(modes, ramp, speed, damping_input=damping_input).extremes()
    ...     print(found.max_load.round(-2))
    [ 91800. 376700. 376700.]
    [ 93400. 412200. 412200.]
    """

    mass: float
    pitch_inertia: float
    roll_inertia: float
    gears: Sequence[Gear]
    gravity: float = GRAVITY_IN
    stations: Mapping[str, tuple[float, float]] = field(default_factory=dict, hash=False)
    _core: _core.Aircraft = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Check the values and find the static loads."""
        for key in ("mass", "pitch_inertia", "roll_inertia", "gravity"):
            object.__setattr__(self, key, number(key, getattr(self, key)))
        object.__setattr__(self, "gears", _gears(self.gears))
        object.__setattr__(self, "stations", MappingProxyType(_stations(self.stations)))
        core = _core.Aircraft(
            self.mass,
            self.pitch_inertia,
            self.roll_inertia,
            self.gravity,
            [gear._core for gear in self.gears],
        )
        object.__setattr__(self, "_core", core)

    @property
    def gear_names(self) -> tuple[str, ...]:
        """Names of the gears, in order."""
        return tuple(gear.name for gear in self.gears)

    @property
    def geometry(self) -> NDArray[np.float64]:
        """Geometry matrix G, shape (g, 3): gear displacements from CG coordinates (Eq. 1)."""
        return read_only(np.array([[1.0, gear.x, gear.y] for gear in self.gears]))

    @property
    def mass_matrix(self) -> NDArray[np.float64]:
        """Mass matrix M = diag(M, I_P, I_R), shape (3, 3) (Eq. 4)."""
        return read_only(np.diag([self.mass, self.pitch_inertia, self.roll_inertia]))

    @property
    def stiffness_matrix(self) -> NDArray[np.float64]:
        """Stiffness matrix K_D = GᵀkG, shape (3, 3) (Eq. 5)."""
        return read_only(self._core.stiffness_matrix())

    @property
    def damping_matrix(self) -> NDArray[np.float64]:
        """Damping matrix C_D = GᵀcG, shape (3, 3) (Eq. 5)."""
        return read_only(self._core.damping_matrix())

    @property
    def static_load(self) -> NDArray[np.float64]:
        """
        Compression load of each gear in equilibrium on a level runway, shape (g,) [force].

        From equilibrium alone where that determines the loads; with more gears, as linear springs
        under a rigid body share the weight.
        """
        return read_only(self._core.static_load())

    def modes(self, damping_ratio: ArrayLike | None = None) -> Modes:
        """
        Compute the natural modes (Eqs. 6-8).

        Parameters
        ----------
        damping_ratio : float or array_like, shape (m,), optional
            Damping ratios, one for all modes or one per mode [-]. Default: from the diagonal of
            the gears' damping in modal coordinates (Eqs. 9, 11); `Modes.damping_coupling` shows
            what that neglects.

        Returns
        -------
        Modes
            Modes in order of increasing frequency, each shape with its largest mass-weighted
            component positive.

        Raises
        ------
        InputError
            If a damping ratio is negative or not finite, or there is not one per mode.
        NumericalError
            If the eigenvalue iteration does not converge.

        Notes
        -----
        A degree of freedom that no gear holds and nothing excites is left out: roll with all
        gears on the centreline, pitch and roll with one gear at the centre of gravity.

        Examples
        --------
        Table 3 of the report:

        >>> import runway_modal as rm
        >>> rm.f4e().modes(0.01).omega.round(3)
        array([ 7.27 , 12.016, 18.199])
        """
        return Modes._natural(self, damping_ratio)

    def with_stiffness(self, stiffness: Mapping[str, float]) -> Aircraft:
        """
        Change the stiffness of some gears.

        Parameters
        ----------
        stiffness : mapping of str to float
            New stiffness by gear name [force/length].

        Returns
        -------
        Aircraft
            A new aircraft with those gears changed.

        Raises
        ------
        InputError
            If a name is not that of a gear or a stiffness is not positive.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rm.f4e().with_stiffness({"nose": 1508.0}).gears[0].stiffness
        1508.0
        """
        if not isinstance(stiffness, Mapping):
            raise InputError(f"stiffness = {stiffness!r} is not a mapping from gear names")
        for name in stiffness:
            if name not in self.gear_names:
                raise InputError(f"stiffness[{name!r}]: no such gear; there are {self.gear_names}")
        gears = list(self.gears)
        for i, g in enumerate(gears):
            try:
                gears[i] = Gear(g.name, g.x, g.y, stiffness.get(g.name, g.stiffness), g.damping)
            except InputError as error:
                raise InputError(f"stiffness[{g.name!r}]: {error}") from None
        return Aircraft(**{**self._values(), "gears": gears})

    def _values(self) -> dict[str, Any]:
        keys = ("mass", "pitch_inertia", "roll_inertia", "gears", "gravity", "stations")
        return {**{key: getattr(self, key) for key in keys}, "stations": dict(self.stations)}

    def __reduce__(self) -> tuple[partial[Aircraft], tuple[()]]:
        """Pickle by values."""
        return partial(Aircraft, **self._values()), ()


def _gears(gears: Any) -> tuple[Gear, ...]:
    try:
        each = tuple(gears)
    except TypeError:
        raise InputError(f"gears = {gears!r} is not a sequence of Gear") from None
    for i, gear in enumerate(each):
        if not isinstance(gear, Gear):
            raise InputError(f"gears[{i}] = {gear!r} is not a Gear")
    return each


def _stations(stations: Mapping[str, tuple[float, float]]) -> dict[str, tuple[float, float]]:
    if not isinstance(stations, Mapping):
        raise InputError(f"stations = {stations!r} is not a mapping from names to (x, y)")
    points = {"cg": (0.0, 0.0)}
    for name, point in stations.items():
        key = f"stations[{name!r}]"
        if not isinstance(name, str) or not name:
            raise InputError(f"{key}: {name!r} is not a name")
        arms = array(key, point, ndim=None)
        if arms.shape != (2,):
            raise InputError(f"{key} has shape {arms.shape}, (x, y) expected")
        if not (abs(arms) <= 1e100).all():
            raise InputError(f"{key} = {tuple(arms.tolist())} is not finite and within 1e100")
        if name == "cg" and arms.any():
            raise InputError(
                f"{key} = {tuple(arms.tolist())}: 'cg' is the centre of gravity, (0, 0)"
            )
        points[name] = (float(arms[0]), float(arms[1]))
    return points


#: Series stiffness of nose and main gears [lbf/in]: Table 2, and the text above Table 4.
_F4E_STIFFNESS = {"static": (1502.0, 9102.0), "equivalent": (1508.0, 8081.0)}


def f4e(stiffness: Literal["static", "equivalent"] = "static") -> Aircraft:
    """
    F-4E of the report at heavy weight, in lbf, in and s (Table 1).

    Parameters
    ----------
    stiffness : {"static", "equivalent"}
        Gear stiffnesses: "static", the slope at static equilibrium (Table 2, used for Table 3);
        "equivalent", averaged over the nonlinear response by Eq. 22 (used for Table 4).

    Returns
    -------
    Aircraft
        Gears "nose", "left" and "right", without dampers: the report gives damping ratios, 1 % in
        every mode, to be passed to `Aircraft.modes`.

    Raises
    ------
    InputError
        If `stiffness` is neither.

    Examples
    --------
    >>> import runway_modal as rm
    >>> rm.f4e("equivalent").modes(0.01).frequency_hz[1].round(2)
    np.float64(1.8)
    """
    nose, main = _F4E_STIFFNESS[one_of("stiffness", stiffness, _F4E_STIFFNESS)]
    return Aircraft(
        mass=145.5,
        pitch_inertia=1.92e6,
        roll_inertia=6.56e5,
        gears=(
            Gear("nose", 234.9, 0.0, nose),
            Gear("left", -44.35, 109.25, main),
            Gear("right", -44.35, -109.25, main),
        ),
    )


def single_dof(
    *, mass: float, omega: float, damping_ratio: float, gravity: float = GRAVITY_IN
) -> Modes:
    """
    One degree of freedom: all the mass bouncing on one gear (Eqs. 15, 16).

    The same machinery as for the whole aircraft, with a gear of stiffness Mω² and damping
    2ζωM at the centre of gravity.

    Parameters
    ----------
    mass : float
        Mass M, > 0 [force·time²/length].
    omega : float
        Circular frequency ω, > 0 [rad/s].
    damping_ratio : float
        Damping ratio ζ, ≥ 0 [-].
    gravity : float
        Gravity, ≥ 0 [length/time²]. Default: 386.0886 in/s²;
        give it in any other system.

    Returns
    -------
    Modes
        The one mode of an aircraft with a single gear, named "gear".

    Raises
    ------
    InputError
        If a value is out of range.

    Examples
    --------
    The report's bounce model (Section IV.4):

    >>> import runway_modal as rm
    >>> bounce = rm.single_dof(mass=145.5, omega=12.016, damping_ratio=0.01)
    >>> bounce.aircraft.static_load.round(1)
    array([56175.9])
    """
    mass, omega = number("mass", mass), number("omega", omega)
    ratio = number("damping_ratio", damping_ratio)
    for key, value in (("mass", mass), ("omega", omega)):
        # Before a stiffness is made of them, which would take the blame.
        if not 1e-100 <= value <= 1e100:
            raise InputError(f"{key} = {value!r} is not between 1e-100 and 1e100")
    if not 0 <= ratio < np.inf:
        raise InputError(f"damping_ratio = {ratio!r} is not a finite number ≥ 0")
    gear = Gear("gear", 0.0, 0.0, mass * omega**2, 2.0 * ratio * omega * mass)
    aircraft = Aircraft(
        # Nothing rotates: any inertias will do.
        mass=mass,
        pitch_inertia=mass,
        roll_inertia=mass,
        gears=(gear,),
        gravity=gravity,
    )
    return aircraft.modes(ratio)


def equivalent_stiffness(k: ArrayLike) -> float:
    """
    Stiffness that gives the mean period of a varying one (Eq. 22).

    1/√k_eq is the mean of 1/√k over samples equally spaced in time.

    Parameters
    ----------
    k : array_like, shape (n,)
        Sampled stiffnesses, > 0 [force/length].

    Returns
    -------
    float
        The equivalent stiffness [force/length].

    Raises
    ------
    InputError
        If there is no sample or one is not positive and finite.

    Examples
    --------
    >>> import runway_modal as rm
    >>> rm.equivalent_stiffness([4.0, 1.0, 4.0, 1.0])
    1.7777777777777777
    """
    k = array("k", k)
    if k.size == 0:
        raise InputError("k has 0 entries, at least 1 needed")
    refuse("k", k, ~((k > 0) & np.isfinite(k)), "is not positive and finite")
    return float(np.mean(1.0 / np.sqrt(k)) ** -2)
