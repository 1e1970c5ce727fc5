"""One nonlinear aircraft over one runway at one speed."""

from __future__ import annotations

import reprlib
from typing import TYPE_CHECKING, Any

import numpy as np

from runway_modal._core import InputError, NumericalError
from runway_modal._extras import need
from runway_modal._input import number
from runway_modal._tracks import by_gear, lags
from runway_modal.simulate import simulate as simulate_linear

from .aircraft import Aircraft
from .ground import stretches
from .motion import Motion
from .response import Piece, Response

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import ArrayLike

    from runway_modal.profile import Profile

    from .gears import State
    from .ground import Stretch
    from .springs import Array

#: Points of each step at which changes of state are sought.
_LOOKS = np.arange(1, 9) / 8.0

#: Points between the last of them before a change and the first that shows it.
_CLOSER = np.exp2(np.arange(-30.0, 1.0))

#: Tolerance of a step for a tolerance of the run: over a run, errors add up to about 8 times the
#: former as judged by the linear model.
_SAFETY = 0.01

#: More changes of state than this at one time are an error, not physics.
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
        One profile for all gears, or profiles by gear name; gears not named run on level ground.
    speed : float
        Ground speed, constant, > 0 [length/time].
    times : array_like, shape (n,), optional
        Times at which to sample, never decreasing [time]. Default: every breakpoint of every gear
        (both sides where results jump: at vertical steps and under dampers), and at least 20
        points per period of the fastest mode of `Aircraft.linearised`.
    duration : float, optional
        End of the default times [time]. Default: 5 after the last gear has passed the last
        breakpoint.
    rtol : float
        Target error of motion and loads, relative to static deflection and static load, 1e-11 to
        1e-2 [-].

    Returns
    -------
    Response
        Motion, loads and stiffnesses.

    Raises
    ------
    InputError
        If an argument is of the wrong kind or out of range, a gear name is unknown, or both
        `times` and `duration` are given.
    ImportError
        If scipy is not installed.
    NumericalError
        If the integration fails.

    Examples
    --------
    The full mat at 20 knots (the report's Figure 8 is TAXI's run):

    >>> import runway_modal as rm
    >>> from runway_modal import nonlinear
    >>> response = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), rm.knots(20))
    >>> response.extremes().max_load.round(-2)
    array([13700., 40400., 40400.])
    """
    if not isinstance(aircraft, Aircraft):
        # The repr of a linear aircraft is long.
        raise InputError(f"aircraft = {reprlib.repr(aircraft)} is not a nonlinear Aircraft")
    speed, rtol = number("speed", speed), number("rtol", rtol)
    if not 1e-11 <= rtol <= 1e-2:
        raise InputError(f"rtol = {rtol!r} is not between 1e-11 and 1e-2")
    modes = aircraft.linearised().modes(0.0)
    # The linear run checks the arguments and provides the default times.
    reference = simulate_linear(
        modes, tracks, speed, times=times, duration=duration, damping_input=True
    )
    profiles = by_gear(aircraft.gear_names, tracks)
    ground = stretches(profiles, lags(aircraft), speed)
    motion = Motion(aircraft)
    run = _Integration(motion, ground, rtol, _scales(aircraft, motion, modes.omega.max()))
    pieces = list(run.pieces(reference.time[-1]))
    return Response(aircraft, motion, pieces, speed, reference.time)


def _scales(aircraft: Aircraft, motion: Motion, omega: float) -> Array:
    """Size of each coordinate and rate: the static deflection and its rate at a frequency."""
    stiffness = np.array([gear.stiffness for gear in aircraft.linearised().gears])
    length = float((aircraft.static_load / stiffness).max())
    radius = np.sqrt(np.diag(aircraft.linearised().mass_matrix) / aircraft.mass)
    radius[0] = 1.0
    wheels = np.full(motion.wheels, length)
    return np.concatenate((length / radius, omega * length / radius, wheels, omega * wheels))


class _Integration:
    """Integration from the first break to the end."""

    def __init__(self, motion: Motion, ground: list[Stretch], rtol: float, scales: Array) -> None:
        need("nonlinear runs", "taxi", "scipy")
        from scipy.integrate import DOP853
        from scipy.optimize import brentq

        # The stepper itself and not `solve_ivp`, which looks for events only at the ends of steps:
        # a short lift-off within one would go unseen.
        self._stepper, self._root = DOP853, brentq
        self._motion = motion
        self._ground = ground
        self._rtol = _SAFETY * rtol
        self._atol = _SAFETY * rtol * scales

    def pieces(self, end: float) -> Iterator[Piece]:
        """Smooth pieces of the run, without gaps."""
        level, *moving = self._ground
        states, y = self._motion.at_rest(level.elevation)
        breaks = [*(stretch.begin for stretch in moving), np.inf]
        yield Piece(-np.inf, breaks[0], level, states, [], [], y)
        for stretch, until in zip(moving, breaks[1:], strict=True):
            if stretch.begin > end:
                return
            y = self._motion.step(stretch, y)
            states = self._motion.settle(states, stretch, y)
            if stretch.begin == end:
                # The far side of a step at the very end.
                yield Piece(end, end, stretch, states, [], [], y)
            time, at_once = stretch.begin, 0
            while time < min(until, end):
                piece, y, change = self._smooth(states, stretch, time, min(until, end), y)
                at_once = 0 if piece.end > time else at_once + 1
                if at_once > _MOST_AT_ONCE:
                    raise NumericalError(f"gears change state endlessly at the time {time!r}")
                if piece.end > time:
                    yield piece
                time = piece.end
                if change is not None:
                    states, y = self._motion.change(states, *change, y)

    def _smooth(
        self, states: Sequence[State], stretch: Stretch, begin: float, end: float, y: Array
    ) -> tuple[Piece, Array, tuple[int, State] | None]:
        """Integrate until a gear changes state, at most until the end."""
        stepper = self._stepper(
            lambda t, y: self._motion.derivative(states, stretch, t, y),
            begin,
            y,
            end,
            rtol=self._rtol,
            atol=self._atol,
        )
        knots, steps, change = [begin], [], None
        while stepper.status == "running" and change is None:
            # A trial step may overflow, as v² does; it is then repeated with a shorter one.
            with np.errstate(over="ignore", invalid="ignore"):
                message = stepper.step()
            if stepper.status == "failed":
                raise NumericalError(f"integration failed at the time {stepper.t!r}: {message}")
            steps.append(stepper.dense_output())
            time, change = self._first_change(states, stretch, steps[-1])
            knots.append(time)
        piece = Piece(begin, knots[-1], stretch, states, knots, steps, y)
        return piece, stepper.y if change is None else steps[-1](piece.end), change

    def _first_change(
        self, states: Sequence[State], stretch: Stretch, step: Any
    ) -> tuple[float, tuple[int, State] | None]:
        """Find the first change of state in a step, or its end and none."""

        def switches(time: float | Array) -> list[tuple[Any, int, State]]:
            return list(self._motion.switches(states, stretch, time, step(time)))

        looks = step.t_old + (step.t - step.t_old) * _LOOKS
        seen = switches(looks)
        crossed = np.array([value for value, _, _ in seen]) < 0.0
        if not crossed.any():
            return float(step.t), None
        look = int(crossed.any(axis=0).argmax())
        before, after = float(looks[look - 1]) if look else float(step.t_old), float(looks[look])

        def time_of(switch: int) -> float:
            begin, end = before, after
            if switches(begin)[switch][0] <= 0.0:
                # A gear that has just changed state starts at zero and may have changed back. Or
                # it is the second of two gears that meet a bump together: negative throughout.
                closer = before + (after - before) * _CLOSER
                positive = np.flatnonzero(switches(closer)[switch][0] > 0.0)
                if not positive.size:
                    return before
                begin, end = closer[positive[-1]], closer[positive[-1] + 1]
            found = self._root(
                lambda time: switches(time)[switch][0],
                begin,
                end,
                xtol=np.finfo(float).tiny,
                rtol=4.0 * np.finfo(float).eps,
            )
            return float(found)

        time, first = min((time_of(i), i) for i in np.flatnonzero(crossed[:, look]).tolist())
        return time, seen[first][1:]
