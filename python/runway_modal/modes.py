"""Natural and measured modes."""

from __future__ import annotations

import reprlib
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._core import InputError
from ._input import array, entries, flag, one_or_each, read_only

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from ._core import Modes as CoreModes
    from .aircraft import Aircraft


def check_modes(argument: str, value: object) -> None:
    """Refuse anything but a `Modes`; an aircraft is the likely mistake."""
    if isinstance(value, Modes):
        return
    if isinstance(value, Sequence) and value and isinstance(value[0], Modes):
        raise InputError(
            f"{argument} has {entries(len(value))}, a single Modes expected; simulate_many takes "
            "one for each run"
        )
    hint = "see Aircraft.modes"
    if hasattr(value, "linearised"):
        hint = "nonlinear.simulate takes nonlinear aircraft; linearised() has modes"
    # The repr of an aircraft is long.
    raise InputError(f"{argument} = {reprlib.repr(value)} is not a Modes; {hint}")


class Modes:
    """
    Modes of an aircraft: frequencies, damping ratios and shapes (Eqs. 6-11).

    `Aircraft.modes` computes them. This constructor takes measured modes, however many were
    measured. The response then follows from Eq. 12 with these modes and the aircraft's gear
    stiffnesses, and loads from Eq. 21.

    Parameters
    ----------
    aircraft : Aircraft
        The aircraft on which the modes were measured.
    omega : array_like, shape (m,)
        Circular frequencies [rad/s].
    damping_ratio : float or array_like, shape (m,)
        Damping ratios, ≥ 0 [-].
    shapes : array_like, shape (3, m)
        Mode shapes {bounce, pitch, roll}, positive up, nose up [rad] and left side up [rad], one
        per column, orthonormal with respect to the mass matrix (Eq. 7) within 5e-3 per term:
        three printed digits suffice. To normalise a shape φ, divide it by √(φᵀMφ).
    static_correction : bool, default False
        If True, the body follows the runway by the aircraft's static position, and the modes add
        only their deviation from their own static position; see Notes. It has no effect on the
        complete set of an aircraft's computed modes.

    Raises
    ------
    InputError
        If a value is out of range, array shapes disagree or the mode shapes are not orthonormal.

    Notes
    -----
    If measured frequencies do not match the gear stiffnesses, or there are fewer modes than the
    aircraft has, the modes do not follow a rise of the runway to the full static height. With
    Eqs. 12 and 21 as they stand, loads are right near the elevations on which the run starts, and
    wrong on a plateau or a grade: with frequencies 1 % too high, a main gear of the F-4E seems to
    carry 179 lbf more for every inch that it has climbed.

    `static_correction` replaces the body's displacement y = Φp in Eqs. 19 to 21 by

        y = K⁻¹K₁u + Φ (p − ω⁻²ΦᵀK₁u)

    with u the elevations under the gears, K the gears' stiffness matrix and K₁u the forces that
    the elevations exert through the gears (Eq. 4): the static position on the gears, plus the
    deviation of the modes from their own. Loads on a plateau are then the static ones. What the
    modes lack follows the ground at once, without inertia: right for frequencies that are slightly
    off and for missing modes much faster than what the runway excites; slower modes must not be
    left out. Accelerations are those of the modes. This is the static correction method of
    structural dynamics (A. K. Chopra, Dynamics of Structures, chapter 12). Alternatively, make the
    two agree: multiply stiffnesses by the square of measured over computed frequency
    (`Aircraft.with_stiffness`).

    Examples
    --------
    The bounce mode of the report's Table 3, as printed:

    >>> import runway_modal as rm
    >>> shape = [[0.078743], [-0.000226], [0.0]]
    >>> bounce = rm.Modes(rm.f4e("static"), omega=[12.016], damping_ratio=0.01, shapes=shape)
    >>> bounce.frequency_hz.round(2)
    array([1.91])
    """

    __slots__ = (
        "_core",
        "_rebuild",
        "aircraft",
        "damping_ratio",
        "omega",
        "shapes",
        "static_correction",
    )

    #: The aircraft.
    aircraft: Aircraft
    #: Circular frequencies, shape (m,) [rad/s]; ascending for an aircraft's own modes.
    omega: NDArray[np.float64]
    #: Damping ratios, shape (m,) [-].
    damping_ratio: NDArray[np.float64]
    #: Mode shapes, shape (3, m): rows bounce, pitch, roll; ΦᵀMΦ = I (Eq. 7).
    shapes: NDArray[np.float64]
    #: Whether the body follows the runway by the aircraft's static position.
    static_correction: bool
    _core: CoreModes
    _rebuild: tuple[Callable[..., Modes], tuple[Any, ...]]

    def __init__(
        self,
        aircraft: Aircraft,
        omega: ArrayLike,
        damping_ratio: ArrayLike,
        shapes: ArrayLike,
        *,
        static_correction: bool = False,
    ) -> None:
        omega = array("omega", omega)
        ratio = np.full(
            omega.shape, one_or_each("damping_ratio", damping_ratio, omega.size, "mode")
        )
        shapes = array("shapes", shapes, ndim=2)
        if shapes.shape != (3, omega.size):
            raise InputError(
                f"shapes has shape {shapes.shape}, (3, {omega.size}) expected: bounce, pitch and "
                "roll of each mode"
            )
        if not isinstance(getattr(aircraft, "_core", None), _core.Aircraft):
            hint = "; linearised() gives one" if hasattr(aircraft, "linearised") else ""
            raise InputError(f"aircraft = {reprlib.repr(aircraft)} is not a linear Aircraft{hint}")
        correction = flag("static_correction", static_correction)
        core = _core.Modes.measured(aircraft._core, omega, ratio, shapes, correction)
        self._fill(aircraft, core, static_correction=correction)
        again = partial(Modes, static_correction=correction)
        made_of = (aircraft, self.omega, self.damping_ratio, self.shapes)
        object.__setattr__(self, "_rebuild", (again, made_of))

    @classmethod
    def _natural(cls, aircraft: Aircraft, damping_ratio: ArrayLike | None) -> Modes:
        ratio: float | NDArray[np.float64] | None = None
        if damping_ratio is not None:
            given = one_or_each("damping_ratio", damping_ratio)
            ratio = given if np.ndim(damping_ratio) else float(given[0])
        modes = cls.__new__(cls)
        core = _core.Modes.natural(aircraft._core, ratio)
        modes._fill(aircraft, core, static_correction=False)
        made_of = (aircraft, None if ratio is None else modes.damping_ratio)
        object.__setattr__(modes, "_rebuild", (cls._natural, made_of))
        return modes

    def _fill(self, aircraft: Aircraft, core: CoreModes, *, static_correction: bool) -> None:
        values = {
            "aircraft": aircraft,
            "_core": core,
            "static_correction": static_correction,
            "omega": read_only(core.omega()),
            "damping_ratio": read_only(core.damping_ratio()),
            "shapes": read_only(core.shapes()),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @property
    def frequency_hz(self) -> NDArray[np.float64]:
        """Undamped natural frequencies ω/2π, shape (m,) [Hz]."""
        return read_only(self.omega / (2.0 * np.pi))

    @property
    def node(self) -> NDArray[np.float64]:
        """
        Point of the centreline that each mode leaves at rest, shape (m,) [length].

        Measured forward of the centre of gravity. Infinite for pure bounce, NaN for a mode that
        leaves the whole centreline at rest (roll).
        """
        return read_only(self._core.node())

    @property
    def damping_coupling(self) -> NDArray[np.float64]:
        """
        Relative size of the neglected off-diagonal damping terms (Eq. 9), shape (m, m) [-].

        ``|C_ij| / sqrt(C_ii C_jj)`` with C the gears' damping in modal coordinates; 0 on the
        diagonal, which is kept, and where a mode has no damping.
        """
        return read_only(self._core.damping_coupling())

    def __setattr__(self, name: str, value: object) -> None:
        """Refuse: the core would still use the old values."""
        raise AttributeError(f"Modes cannot be changed: {name} = {value!r}; make new ones")

    def __delattr__(self, name: str) -> None:
        """Refuse."""
        raise AttributeError(f"Modes cannot be changed: del {name}")

    def __eq__(self, other: object) -> bool:
        """Whether both hold the same numbers, of equal aircraft."""
        if not isinstance(other, Modes):
            return NotImplemented
        names = ("omega", "damping_ratio", "shapes", "static_correction")
        return self.aircraft == other.aircraft and all(
            np.array_equal(getattr(self, name), getattr(other, name)) for name in names
        )

    def __hash__(self) -> int:
        """Hash of the aircraft and the frequencies."""
        return hash((self.aircraft, tuple(self.omega.tolist())))

    def __reduce__(self) -> tuple[Callable[..., Modes], tuple[Any, ...]]:
        """Pickle by the arguments the modes were made from."""
        return self._rebuild

    def __repr__(self) -> str:
        """Frequencies and damping ratios."""
        listing = ", ".join(
            f"{f:.4g} Hz ζ={z:.3g}"
            for f, z in zip(self.frequency_hz, self.damping_ratio, strict=True)
        )
        return f"<Modes: {listing}>"
