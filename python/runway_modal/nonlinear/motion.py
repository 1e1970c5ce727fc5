"""
Equations of motion between two breaks: which branch every force law is on stays as it is.

Coordinates are displacements from static equilibrium on a level runway at elevation 0, up
positive: y = {q, q̇, z, ż}, q the body's bounce, pitch and roll, z the wheels that have mass.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .._core import NumericalError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from .aircraft import Aircraft, Gear
    from .ground import Stretch
    from .springs import Values

#: Rounds of Newton's method for the equilibrium on uneven first elevations.
_ROUNDS = 100

Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Contact:
    """State of a gear without unsprung mass."""

    #: Piece of the series' law; 0 is off the runway.
    piece: int
    #: Whether the damper would pull harder than the springs push, so that nothing touches.
    slack: bool = False


@dataclass(frozen=True, slots=True)
class Sliding:
    """State of a gear whose wheel has mass."""

    #: Piece of the strut's law; 0 is on the stop.
    strut: int
    #: Piece of the tire's law; 0 is off the runway.
    tire: int
    #: 1 compressing, -1 extending, 0 held by friction or the stop. Without friction 1 or 0.
    sense: int


class MasslessGear:
    """Strut and tire in series with a viscous damper across both; the load is F ≥ 0."""

    __slots__ = ("damping", "law", "static")

    def __init__(self, gear: Gear, static: float) -> None:
        self.law = gear._law(static)
        self.damping = gear.damping
        self.static = static

    def start(self, compression: float) -> Contact:
        """State at rest."""
        return Contact(self.law.piece(compression))

    def load(self, state: Contact, compression: Values, rate: Values) -> Values:
        """Load on the runway and on the body."""
        if state.piece == 0 or state.slack:
            return 0.0 * compression
        return self.law.load(state.piece, compression) + self.damping * rate

    def switches(
        self, state: Contact, compression: Values, rate: Values
    ) -> Iterator[tuple[Values, Contact]]:
        """Quantities that stay positive while the state lasts, and the state that follows."""
        kinks, piece = self.law.kinks, state.piece
        if piece < len(kinks):
            yield kinks[piece] - compression, Contact(piece + 1, state.slack)
        if piece == 0:
            return
        if kinks[piece - 1] > -np.inf:
            yield compression - kinks[piece - 1], Contact(piece - 1, state.slack and piece > 1)
        if self.damping:
            pull = self.law.load(piece, compression) + self.damping * rate
            yield (-pull if state.slack else pull), Contact(piece, not state.slack)

    def stiffness(self, state: Contact, compression: Array, _rate: Array) -> Array:
        """Tangent stiffness; 0 off the runway."""
        if state.slack:
            return 0.0 * compression
        return self.law.stiffness(state.piece, self.law.load(state.piece, compression))

    def impulse(self, before: float, after: float) -> float:
        """
        Blow of the damper as the elevation steps: c times what the springs are compressed.

        A step down gives none: the gear does not pull.
        """
        return self.damping * max(0.0, after - max(before, self.law.kinks[0]))


class Wheel:
    """A wheel with mass between a tire and a strut with orifice, damper and friction."""

    __slots__ = ("gear", "mass", "static", "strut", "tire", "weight")

    def __init__(self, gear: Gear, static: float, gravity: float) -> None:
        self.gear = gear
        self.mass = gear.unsprung_mass
        self.weight = self.mass * gravity
        self.strut = gear._law(static, tire=False)
        self.tire = gear._law(static + self.weight, strut=False)
        #: Static load of the strut.
        self.static = static

    def start(self, compression: float, deflection: float) -> Sliding:
        """State at rest."""
        strut = self.strut.piece(compression)
        held = strut == 0 or self.gear.friction > 0.0
        return Sliding(strut, self.tire.piece(deflection), 0 if held else 1)

    def strut_load(self, state: Sliding, compression: Values, rate: Values) -> Values:
        """
        Load of the strut: gas, viscous damper, orifice and, if it slides, friction.

        What holds a strut that does not slide comes on top.
        """
        gear = self.gear
        load: Values = self.strut.load(state.strut, compression) + gear.damping * rate
        if gear.orifice is not None:
            load = load + gear.orifice.force(rate)
        return load + gear.friction * state.sense

    def tire_load(self, state: Sliding, deflection: Values) -> Values:
        """Load on the runway."""
        return self.tire.load(state.tire, deflection)

    def stiffness(
        self, state: Sliding, compression: Array, _rate: Array, deflection: Array
    ) -> Array:
        """Tangent stiffness of gas and tire in series; the tire's alone on the stop."""
        tire = self.tire.stiffness(state.tire, self.tire_load(state, deflection))
        if state.strut == 0 or state.tire == 0:
            return tire
        strut = self.strut.stiffness(state.strut, self.strut.load(state.strut, compression))
        return tire * strut / (tire + strut)

    def switches(
        self,
        state: Sliding,
        compression: Values,
        rate: Values,
        deflection: Values,
        holding: Values,
    ) -> Iterator[tuple[Values, Sliding]]:
        """Quantities that stay positive while the state lasts, and the state that follows."""
        touch = self.tire.kinks[0]
        yield (
            (deflection - touch if state.tire else touch - deflection),
            Sliding(state.strut, 1 - state.tire, state.sense),
        )
        friction, piece = self.gear.friction, state.strut
        if state.sense == 0:
            yield friction - holding, Sliding(max(piece, 1), state.tire, 1)
            if piece > 0:
                yield friction + holding, Sliding(piece, state.tire, -1)
            return
        if friction > 0.0:
            yield state.sense * rate, Sliding(piece, state.tire, 0)
        kinks = self.strut.kinks
        if kinks[piece - 1] > -np.inf:
            sense = state.sense if piece > 1 else 0
            yield compression - kinks[piece - 1], Sliding(piece - 1, state.tire, sense)
        if piece < len(kinks):
            yield kinks[piece] - compression, Sliding(piece + 1, state.tire, state.sense)


State: TypeAlias = Contact | Sliding


@dataclass(frozen=True, slots=True)
class Forces:
    """What acts at one time, or at many: then every array has one more axis."""

    #: Load of each gear on the runway, shape (g,).
    load: Array
    #: What holds each strut that does not slide, 0 elsewhere, shape (g,).
    holding: Array
    #: Accelerations of bounce, pitch and roll, shape (3,).
    body: Array
    #: Accelerations of the wheels that have mass, shape (w,).
    wheels: Array


class Motion:
    """
    Equations of motion of an aircraft.

    Parameters
    ----------
    aircraft : Aircraft
        The aircraft.
    """

    def __init__(self, aircraft: Aircraft) -> None:
        linear = aircraft.linearised()
        self._aircraft = aircraft
        self.geometry = linear.geometry
        self._spread = self.geometry.T / np.diag(linear.mass_matrix)[:, None]
        self._static = linear.static_load
        self._gears: list[MasslessGear | Wheel] = [
            Wheel(gear, load, aircraft.gravity) if gear.unsprung_mass else MasslessGear(gear, load)
            for gear, load in zip(aircraft.gears, self._static.tolist(), strict=True)
        ]
        wheels = [i for i, gear in enumerate(self._gears) if isinstance(gear, Wheel)]
        self._wheel_of = {i: 6 + row for row, i in enumerate(wheels)}
        self._wheels = len(wheels)
        self._mass = np.array([gear.mass for gear in self._gears if isinstance(gear, Wheel)])

    @property
    def size(self) -> int:
        """Number of coordinates and rates."""
        return 6 + 2 * self._wheels

    def _kinematics(
        self, stretch: Stretch, time: float | Array, y: Array
    ) -> Iterator[tuple[int, MasslessGear | Wheel, tuple[Any, ...]]]:
        """Compression and rate of each spring; with a wheel also the tire's deflection."""
        ground: Any = stretch.at(time)
        above: Any = self.geometry @ y[:3]
        rise: Any = self.geometry @ y[3:6]
        slope, values = stretch.slope, y
        if y.ndim == 1:
            # At one time the laws are many small sums: faster without arrays.
            ground, above, rise = ground.tolist(), above.tolist(), rise.tolist()
            slope, values = slope.tolist(), y.tolist()
        for i, gear in enumerate(self._gears):
            if isinstance(gear, Wheel):
                wheel = self._wheel_of[i]
                z, rate = values[wheel], values[wheel + self._wheels]
                yield i, gear, (z - above[i], rate - rise[i], ground[i] - z)
            else:
                yield i, gear, (ground[i] - above[i], slope[i] - rise[i])

    def forces(
        self, states: Sequence[State], stretch: Stretch, time: float | Array, y: Array
    ) -> Forces:
        """
        Loads and accelerations.

        Parameters
        ----------
        states : sequence of Contact or Sliding
            State of each gear.
        stretch : Stretch
            The runway.
        time : float or ndarray, shape (n,)
            When.
        y : ndarray, shape (k,) or (k, n)
            Coordinates and rates.

        Returns
        -------
        Forces
            What acts then.
        """
        gears = (len(self._gears), *y.shape[1:])
        load, strut, holding = np.empty(gears), np.empty(gears), np.zeros(gears)
        wheels = np.empty((self._wheels, *y.shape[1:]))
        held = []
        for i, gear, where in self._kinematics(stretch, time, y):
            state = states[i]
            if isinstance(gear, Wheel):
                strut[i] = gear.strut_load(state, *where[:2]) - gear.static
                load[i] = gear.tire_load(state, where[2])
                wheels[self._wheel_of[i] - 6] = (
                    (load[i] - gear.static - gear.weight) - strut[i]
                ) / gear.mass
                if state.sense == 0:
                    held.append(i)
            else:
                load[i] = gear.load(state, *where)
                strut[i] = load[i] - gear.static
        if held:
            rows = [self._wheel_of[i] - 6 for i in held]
            body = self._spread @ strut
            holding[held] = self._hold(held, wheels[rows] - self.geometry[held] @ body)
            strut += holding
            wheels[rows] -= (holding[held].T / self._mass[rows]).T
        return Forces(load, holding, self._spread @ strut, wheels)

    def _hold(self, held: list[int], rate: Array) -> Array:
        """Forces on held struts that take away the rates of compression they would have."""
        rows = [self._wheel_of[i] - 6 for i in held]
        mobility = np.diag(1.0 / self._mass[rows]) + self.geometry[held] @ self._spread[:, held]
        return np.linalg.solve(mobility, rate)

    def derivative(
        self, states: Sequence[State], stretch: Stretch, time: float, y: Array
    ) -> Array:
        """Rates of y."""
        forces = self.forces(states, stretch, time, y)
        rates = y[6 + self._wheels :]
        return np.concatenate((y[3:6], forces.body, rates, forces.wheels))

    def switches(
        self, states: Sequence[State], stretch: Stretch, time: float | Array, y: Array
    ) -> list[tuple[Any, int, State]]:
        """Quantities that stay positive while the states last: value, gear and its next state."""
        held = any(isinstance(state, Sliding) and state.sense == 0 for state in states)
        holding = self.forces(states, stretch, time, y).holding if held else states
        return [
            (value, i, follows)
            for i, gear, where in self._kinematics(stretch, time, y)
            for value, follows in (
                gear.switches(states[i], *where, holding[i])
                if isinstance(gear, Wheel)
                else gear.switches(states[i], *where)
            )
        ]

    def at_rest(self, elevation: Array) -> tuple[list[State], Array]:
        """
        Equilibrium on given elevations.

        Parameters
        ----------
        elevation : ndarray, shape (g,)
            Elevation under each gear.

        Returns
        -------
        states : list of Contact or Sliding
            State of each gear.
        y : ndarray, shape (k,)
            Coordinates and rates.

        Raises
        ------
        NumericalError
            If it is not found: some gears hang in the air.
        """
        laws = [gear._law(load) for gear, load in zip(self._aircraft.gears, self._static.tolist(), strict=True)]
        q = np.linalg.lstsq(self.geometry, elevation)[0]
        for _ in range(_ROUNDS):
            compression = (elevation - self.geometry @ q).tolist()
            pieces = [law.piece(s) for law, s in zip(laws, compression, strict=True)]
            load = np.array([law.load(p, s) for law, p, s in zip(laws, pieces, compression, strict=True)])
            excess = load - self._static
            if (abs(self.geometry.T @ excess) <= 1e-14 * (abs(self.geometry.T) @ self._static)).all():
                break
            slope = [law.stiffness(p, f) for law, p, f in zip(laws, pieces, load.tolist(), strict=True)]
            stiffness = self.geometry.T * np.array(slope) @ self.geometry
            q += np.linalg.lstsq(stiffness, self.geometry.T @ excess)[0]
        else:
            raise NumericalError(f"no equilibrium on the first elevations {elevation.tolist()!r} found")
        y = np.zeros(self.size)
        y[:3] = q
        states: list[State] = []
        for i, gear in enumerate(self._gears):
            if isinstance(gear, Wheel):
                squeeze = gear.strut.compression(float(load[i]))
                wheel = self._wheel_of[i]
                y[wheel] = self.geometry[i] @ q + squeeze
                states.append(gear.start(squeeze, elevation[i] - y[wheel]))
            else:
                states.append(gear.start(compression[i]))
        return states, y

    def blow(self, stretch: Stretch, y: Array) -> Array:
        """Coordinates and rates after the vertical step at the beginning of a stretch."""
        y = y.copy()
        above = self.geometry @ y[:3]
        impulse = np.array([
            0.0
            if isinstance(gear, Wheel)
            else gear.impulse(stretch.elevation[i] - stretch.step[i] - above[i], stretch.elevation[i] - above[i])
            for i, gear in enumerate(self._gears)
        ])
        y[3:6] += self._spread @ impulse
        return y

    def strike(self, states: Sequence[State], y: Array) -> Array:
        """Coordinates and rates after struts have run onto their stops, where they stay."""
        y = y.copy()
        stopped = [i for i, state in enumerate(states) if isinstance(state, Sliding) and state.strut == 0]
        rows = [self._wheel_of[i] + self._wheels for i in stopped]
        impulse = self._hold(stopped, y[rows] - self.geometry[stopped] @ y[3:6])
        y[3:6] += self._spread[:, stopped] @ impulse
        y[rows] -= impulse / self._mass[[self._wheel_of[i] - 6 for i in stopped]]
        return y

    def settle(self, states: list[State], stretch: Stretch, y: Array) -> list[State]:
        """States in which all switches are positive, at the beginning of a stretch."""
        states = list(states)
        for _ in range(8 * len(states)):
            value, gear, follows = min(
                self.switches(states, stretch, stretch.begin, y), key=lambda switch: switch[0], default=(0.0, 0, states[0])
            )
            if value >= 0.0:
                return states
            states[gear] = follows
        return states

    def stiffness(
        self, states: Sequence[State], stretch: Stretch, time: Array, y: Array
    ) -> Array:
        """Tangent stiffness of strut and tire in series, shape (g, n)."""
        out = np.empty((len(self._gears), time.size))
        for i, gear, where in self._kinematics(stretch, time, y):
            out[i] = gear.stiffness(states[i], *where)
        return out
