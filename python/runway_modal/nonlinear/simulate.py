"""One nonlinear aircraft meets one runway at one speed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .._core import InputError, NumericalError
from .._input import number
from ..simulate import _by_gear
from ..simulate import simulate as simulate_linear
from .aircraft import Aircraft
from .ground import stretches
from .motion import Motion, Sliding
from .response import Piece, Response

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import ArrayLike

    from ..profile import Profile
    from .ground import Stretch
    from .motion import Array, State

#: Points of each step at which it is looked for a gear that changes state.
_LOOKS = np.arange(1, 9) / 8.0

#: Tolerance of a step for a tolerance of the run: over a run errors add up to some 8 times the
#: former where the linear model is the judge.
_SAFETY = 0.01

#: More changes of state at one time are a fault, not physics.
_MOST_AT_ONCE = 100


def simulate(
    aircraft: Aircraft,
    tracks: Profile | Mapping[str, Profile],
    speed: float,
    *,
    times: ArrayLike | None = None,
    duration: float | None = None,
    rtol: float = 1e-8,
) -> Response:
    """
    Roll a nonlinear aircraft over a runway profile.

    An eighth-order Runge-Kutta method with error control (scipy's DOP853) integrates from break
    to break: at every breakpoint and vertical step under a gear, and wherever a gear leaves the
    runway or meets it again, a chamber or a strut reaches its stop or friction sticks or slips.
    Between breaks all laws are smooth, so the tolerance holds.

    Conventions are those of `runway_modal.simulate`: at time 0 the foremost gear is at station 0,
    the gear at x_g meets station s at t = (s + x_front - x_g) / speed, and the run starts at rest
    in equilibrium on the first elevations.

    Parameters
    ----------
    aircraft : Aircraft
        The aircraft.
    tracks : Profile or mapping of str to Profile
        One profile for every gear, or profiles by gear name; gears left out run on the level.
    speed : float
        Ground speed, constant, > 0 [length/time].
    times : array_like, shape (n,), optional
        When to sample, never decreasing [time]. Default: those of the linear run.
    duration : float, optional
        End of the default times [time]. Default: 5 after the last gear has passed the last
        breakpoint.
    rtol : float
        Error of motion and loads aimed at, relative to static deflection and static load, 1e-11
        to 1e-2 [-].

    Returns
    -------
    Response
        Motion, loads and stiffnesses.

    Raises
    ------
    InputError
        If an argument is of the wrong kind or out of range, or a gear name is unknown.
    ImportError
        If scipy is not installed.
    NumericalError
        If the integration fails.

    Examples
    --------
    The full mat at 20 knots (the report's Figure 8 is TAXI's run):

    >>> import runway_modal as rm
    >>> from runway_modal import nonlinear
    >>> response = nonsimulate_linear(nonlinear.f4e(), rm.Profile.full_mat(), rm.knots(20))
    >>> response.extremes().max_load.round(-2)
    array([13000., 39600., 39600.])
    """
    if not isinstance(aircraft, Aircraft):
        raise InputError(f"aircraft = {aircraft!r} is not a nonlinear Aircraft")
    rtol = number("rtol", rtol)
    if not 1e-11 <= rtol <= 1e-2:
        raise InputError(f"rtol = {rtol!r} is not between 1e-11 and 1e-2")
    modes = aircraft.linearised().modes(0.0)
    # It checks the arguments, knows the default times and gives each scale its size.
    reference = simulate_linear(modes, tracks, speed, times=times, duration=duration)
    profiles = _by_gear(aircraft.gear_names, tracks)
    front = max(gear.x for gear in aircraft.gears)
    ground = stretches(profiles, [front - gear.x for gear in aircraft.gears], speed)
    motion = Motion(aircraft)
    run = _Integration(motion, ground, rtol, _scales(aircraft, motion, modes.omega.max()))
    return Response(aircraft, motion, list(run.pieces(reference.time[-1])), float(speed), reference.time)


def _scales(aircraft: Aircraft, motion: Motion, omega: float) -> Array:
    """Size of each coordinate and rate: the static deflection and its rate at a frequency."""
    gears = aircraft.linearised().gears
    loads = aircraft.linearised().static_load.tolist()
    length = max(load / gear.stiffness for gear, load in zip(gears, loads, strict=True))
    radius = np.sqrt(np.diag(aircraft.linearised().mass_matrix) / aircraft.mass)
    radius[0] = 1.0
    wheels = np.full((motion.size - 6) // 2, length)
    return np.concatenate((length / radius, omega * length / radius, wheels, omega * wheels))


class _Integration:
    """From the first break to the end."""

    def __init__(self, motion: Motion, ground: list[Stretch], rtol: float, scales: Array) -> None:
        try:
            from scipy.integrate import DOP853
            from scipy.optimize import brentq
        except ImportError:
            raise ImportError(
                "nonlinear.simulate needs scipy: pip install runway_modal[taxi]"
            ) from None
        self._solver, self._root = DOP853, brentq
        self._motion = motion
        self._ground = ground
        self._rtol = _SAFETY * rtol
        self._atol = _SAFETY * rtol * scales

    def pieces(self, end: float) -> Iterator[Piece]:
        """Smooth pieces of the run, without gaps."""
        level, *rest = self._ground
        states, y = self._motion.at_rest(level.elevation)
        yield Piece(-np.inf, min([stretch.begin for stretch in rest[:1]], default=np.inf), level, states, [], [], y)
        for stretch, until in zip(rest, [*(s.begin for s in rest[1:]), np.inf], strict=True):
            if stretch.begin >= end:
                return
            y = self._motion.blow(stretch, y)
            states = self._motion.settle(states, stretch, y)
            time, last = stretch.begin, min(until, end)
            at_once = 0
            while time < last:
                piece, y, change = self._smooth(states, stretch, time, last, y)
                if piece.end > time:
                    yield piece
                    at_once = 0
                else:
                    at_once += 1
                    if at_once > _MOST_AT_ONCE:
                        raise NumericalError(f"gears change state without end at the time {time!r}")
                time = piece.end
                if change is not None:
                    gear, follows = change
                    struck = isinstance(follows, Sliding) and follows.strut == 0 != states[gear].strut
                    states = [*states[:gear], follows, *states[gear + 1 :]]
                    if struck:
                        y = self._motion.strike(states, y)

    def _smooth(
        self, states: list[State], stretch: Stretch, begin: float, end: float, y: Array
    ) -> tuple[Piece, Array, tuple[int, State] | None]:
        """Integrate until a gear changes state, at most until the end."""
        solver = self._solver(
            lambda t, y: self._motion.derivative(states, stretch, t, y),
            begin, y, end, rtol=self._rtol, atol=self._atol,
        )
        knots, steps = [begin], []
        first = y
        while solver.status == "running":
            message = solver.step()
            if solver.status == "failed":
                raise NumericalError(f"integration failed at the time {solver.t!r}: {message}")
            dense = solver.dense_output()
            change = self._first_change(states, stretch, dense, knots[-1], solver.t)
            steps.append(dense)
            if change is not None:
                time, gear, follows = change
                knots.append(time)
                return Piece(begin, time, stretch, states, knots, steps, first), dense(time), (gear, follows)
            knots.append(solver.t)
        return Piece(begin, end, stretch, states, knots, steps, first), solver.y, None

    def _first_change(
        self, states: list[State], stretch: Stretch, dense: Any, begin: float, end: float
    ) -> tuple[float, int, State] | None:
        """The first change of state in a step: time, gear and what follows."""
        looks = begin + (end - begin) * _LOOKS
        switches = self._motion.switches(states, stretch, looks, dense(looks))
        if not switches:
            return None
        crossed = np.array([value for value, _, _ in switches]) < 0.0
        if not crossed.any():
            return None
        look = int(np.flatnonzero(crossed.any(axis=0))[0])
        before = begin if look == 0 else float(looks[look - 1])

        def time_of(switch: int) -> float:
            def value(time: float) -> float:
                return float(self._motion.switches(states, stretch, time, dense(time))[switch][0])

            if value(before) <= 0.0:
                return before
            return float(self._root(value, before, looks[look], xtol=1e-300, rtol=1e-15))

        time, switch = min((time_of(i), i) for i in np.flatnonzero(crossed[:, look]).tolist())
        return time, switches[switch][1], switches[switch][2]
