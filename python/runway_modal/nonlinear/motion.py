"""
Equations of motion while the gears' states last.

Coordinates are displacements from static equilibrium on a level runway at elevation 0, up
positive: y = {q, q̇, z, ż}, q the body's bounce, pitch and roll, z the wheels that have mass.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from runway_modal._core import InputError

from .equilibrium import equilibrium
from .gears import MasslessGear, SprungGear, State, Travel
from .ground import Stretch

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from .aircraft import Aircraft
    from .springs import Array


@dataclass(frozen=True, slots=True)
class Forces:
    """Forces and accelerations at one time; at many times every array has one more axis."""

    #: Load of each gear on the runway, shape (g,).
    load: Array
    #: Force that holds each strut that does not slide, 0 elsewhere, shape (g,).
    holding: Array
    #: Accelerations of bounce, pitch and roll, shape (3,).
    body: Array
    #: Accelerations of the wheels that have mass, shape (w,).
    wheels: Array


class Motion:
    """
    Body and wheels under the loads of the gears.

    Mq̈ = Gᵀ(S - S_static) and m z̈ = (F - F_static) - (S - S_static), S the loads on the body, F
    those on the runway, m the wheels' masses.

    Parameters
    ----------
    aircraft : Aircraft
        The aircraft.
    """

    def __init__(self, aircraft: Aircraft) -> None:
        linear = aircraft.linearised()
        self._aircraft = aircraft
        self.geometry = linear.geometry
        #: Accelerations of the body by loads on it, M⁻¹Gᵀ.
        self._spread = self.geometry.T / np.diag(linear.mass_matrix)[:, None]
        self._strut_static = aircraft._sprung_load
        self._static = aircraft.static_load
        self._gears: list[MasslessGear | SprungGear] = [
            SprungGear(gear, load, aircraft.gravity)
            if gear.unsprung_mass
            else MasslessGear(gear, load)
            for gear, load in zip(aircraft.gears, self._strut_static.tolist(), strict=True)
        ]
        #: Gears whose wheels have mass, and their masses.
        self._wheels = [i for i, gear in enumerate(aircraft.gears) if gear.unsprung_mass]
        self._mass = np.array([aircraft.gears[i].unsprung_mass for i in self._wheels])

    @property
    def wheels(self) -> int:
        """Number of wheels that have mass."""
        return len(self._wheels)

    def _travels(self, stretch: Stretch, time: float | Array, y: Array) -> list[Travel]:
        ground: Any = stretch.at(time)
        above: Any = self.geometry @ y[:3]
        rise: Any = self.geometry @ y[3:6]
        slope: Any = stretch.slope
        values: Any = y
        if y.ndim == 1:
            # At one time the laws are many small sums: faster without arrays.
            ground, above, rise = ground.tolist(), above.tolist(), rise.tolist()
            slope, values = slope.tolist(), y.tolist()
        travels = [
            Travel(u - w, rate - v)
            for u, w, rate, v in zip(ground, above, slope, rise, strict=True)
        ]
        for z, rate, i in zip(
            values[6 : 6 + self.wheels], values[6 + self.wheels :], self._wheels, strict=True
        ):
            travels[i] = Travel(z - above[i], rate - rise[i], ground[i] - z)
        return travels

    def forces(
        self, states: Sequence[State], stretch: Stretch, time: float | Array, y: Array
    ) -> Forces:
        """
        Evaluate loads and accelerations.

        Parameters
        ----------
        states : sequence of State
            State of each gear.
        stretch : Stretch
            The runway.
        time : float or ndarray, shape (n,)
            Time, or times.
        y : ndarray, shape (k,) or (k, n)
            Coordinates and rates.

        Returns
        -------
        Forces
            Forces and accelerations then.
        """
        gears = list(zip(self._gears, states, self._travels(stretch, time, y), strict=True))
        load = np.array([gear.load(state, travel) for gear, state, travel in gears])
        strut = np.array([gear.strut_load(state, travel) for gear, state, travel in gears])
        strut = (strut.T - self._strut_static).T
        body = self._spread @ strut
        holding = np.zeros_like(load)
        if not self._wheels:
            return Forces(load, holding, body, load[:0])
        net = (load.T - self._static).T - strut
        wheels = (net[self._wheels].T / self._mass).T
        held = [row for row, i in enumerate(self._wheels) if states[i].sense == 0]
        if held:
            gear_of = [self._wheels[row] for row in held]
            holding[gear_of] = self._hold(held, wheels[held] - self.geometry[gear_of] @ body)
            body = body + self._spread @ holding
            wheels = wheels - (holding[self._wheels].T / self._mass).T
        return Forces(load, holding, body, wheels)

    def _hold(self, held: list[int], rate: Array) -> Array:
        """Find the loads, or impulses, on held struts that cancel the given rates of change."""
        gears = [self._wheels[row] for row in held]
        mobility = np.diag(1.0 / self._mass[held]) + self.geometry[gears] @ self._spread[:, gears]
        return np.asarray(np.linalg.solve(mobility, rate))

    def derivative(self, states: Sequence[State], stretch: Stretch, time: float, y: Array) -> Array:
        """Rates of y."""
        forces = self.forces(states, stretch, time, y)
        return np.concatenate((y[3:6], forces.body, y[6 + self.wheels :], forces.wheels))

    def stiffness(self, states: Sequence[State], stretch: Stretch, time: Array, y: Array) -> Array:
        """Tangent stiffness of each gear, shape (g, n)."""
        gears = zip(self._gears, states, self._travels(stretch, time, y), strict=True)
        return np.array([gear.stiffness(state, travel) for gear, state, travel in gears])

    def switches(
        self, states: Sequence[State], stretch: Stretch, time: float | Array, y: Array
    ) -> Iterator[tuple[Any, int, State]]:
        """Quantities that are positive while the states last: value, gear, its next state."""
        # The holding force is needed only if a strut is held.
        holding: Any = states
        if any(state.sense == 0 for state in states):
            holding = self.forces(states, stretch, time, y).holding
        gears = zip(self._gears, states, self._travels(stretch, time, y), holding, strict=True)
        for i, (gear, state, travel, hold) in enumerate(gears):
            for value, follows in gear.switches(state, travel, hold):
                yield value, i, follows

    def at_rest(self, elevation: Array) -> tuple[list[State], Array]:
        """
        Find the equilibrium on given elevations.

        Parameters
        ----------
        elevation : ndarray, shape (g,)
            Elevation under each gear.

        Returns
        -------
        states : list of State
            State of each gear.
        y : ndarray, shape (k,)
            Coordinates and rates.

        Raises
        ------
        InputError
            If a wheel that has mass hangs in the air there.
        NumericalError
            If no equilibrium is found.
        """
        laws = [
            gear._law(load)
            for gear, load in zip(self._aircraft.gears, self._strut_static.tolist(), strict=True)
        ]
        weight = self._aircraft.mass * self._aircraft.gravity
        q, load = equilibrium(laws, self.geometry, elevation, weight)
        y = np.zeros(6 + 2 * self.wheels)
        y[:3] = q
        for row, i in enumerate(self._wheels):
            gear = self._gears[i]
            if not load[i] > 0.0:
                name = self._aircraft.gears[i].name
                raise InputError(f"tracks[{name!r}]: the wheel hangs over the first elevation")
            if isinstance(gear, SprungGear):
                y[6 + row] = self.geometry[i] @ q + gear.squeeze(float(load[i]))
        level = Stretch(0.0, elevation, 0.0 * elevation, 0.0 * elevation)
        travels = self._travels(level, 0.0, y)
        return [gear.start(t) for gear, t in zip(self._gears, travels, strict=True)], y

    def step(self, stretch: Stretch, y: Array) -> Array:
        """Coordinates and rates after the vertical step at the beginning of a stretch."""
        above = self.geometry @ y[:3]
        impulse = [
            gear.impulse(after - height, after) if isinstance(gear, MasslessGear) else 0.0
            for gear, after, height in zip(
                self._gears, stretch.elevation - above, stretch.step, strict=True
            )
        ]
        return np.concatenate((y[:3], y[3:6] + self._spread @ impulse, y[6:]))

    def change(
        self, states: Sequence[State], gear: int, follows: State, y: Array
    ) -> tuple[list[State], Array]:
        """Put a gear into another state: states of all, coordinates and rates after it."""
        changed = [*states[:gear], follows, *states[gear + 1 :]]
        if gear not in self._wheels:
            return changed, y
        if follows.piece == 0 < states[gear].piece:
            return self._strike(changed, y)
        if 0 in (states[gear].sense, follows.sense):
            # What rounding leaves of the strut's rate must not decide its direction.
            y = y.copy()
            y[self._rate_of(gear)] = self.geometry[gear] @ y[3:6]
        return changed, y

    def _strike(self, states: list[State], y: Array) -> tuple[list[State], Array]:
        """States, coordinates and rates after a strut has hit its stop, where it stays."""
        held = [row for row, i in enumerate(self._wheels) if states[i].piece == 0]
        gears = [self._wheels[row] for row in held]
        rates = [self._rate_of(gear) for gear in gears]
        blow = self._hold(held, y[rates] - self.geometry[gears] @ y[3:6])
        y = y.copy()
        y[3:6] += self._spread[:, gears] @ blow
        y[rates] -= blow / self._mass[held]
        for i in self._wheels:
            rate = y[self._rate_of(i)] - self.geometry[i] @ y[3:6]
            # No friction holds against an impulse.
            if states[i].sense == 0 < states[i].piece and rate != 0.0:
                states[i] = replace(states[i], sense=1 if rate > 0.0 else -1)
        return states, y

    def _rate_of(self, gear: int) -> int:
        """Index of a wheel's rate."""
        return 6 + self.wheels + self._wheels.index(gear)

    def settle(self, states: Sequence[State], stretch: Stretch, y: Array) -> list[State]:
        """States in which no switch is negative, at the beginning of a stretch."""
        settled = list(states)
        for _ in range(8 * len(settled)):
            crossed = [
                (gear, follows)
                for value, gear, follows in self.switches(settled, stretch, stretch.begin, y)
                if value < 0.0
            ]
            if not crossed:
                break
            gear, follows = crossed[0]
            settled[gear] = follows
        return settled
