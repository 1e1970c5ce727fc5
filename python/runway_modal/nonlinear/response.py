"""Results of a nonlinear run."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from runway_modal._core import InputError
from runway_modal._input import any_array, array, number, read_only, refuse
from runway_modal._results import Shown
from runway_modal._tracks import lags
from runway_modal.aircraft import equivalent_stiffness
from runway_modal.extremes import Extremes

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from .aircraft import Aircraft
    from .gears import State
    from .ground import Stretch
    from .motion import Motion
    from .springs import Array

#: Nodes and weights on (-1, 1): exact for the square of a step's polynomial of degree 7.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)

#: Points per step at which extremes are sought.
_LOOKS = 8

#: Rounds of refinement, and points in each, until a peak's time is known to 1e-8 of a step and so
#: its height to the last digits.
_ROUNDS, _CLOSER = 8, 17


@dataclass(frozen=True, slots=True)
class Piece:
    """Solution between two breaks."""

    begin: float
    end: float
    stretch: Stretch
    states: Sequence[State]
    #: Ends of the steps and the solution in each; none before the first break.
    knots: list[float]
    steps: list[Any]
    #: Coordinates and rates at the beginning.
    first: Array

    def y(self, times: Array) -> Array:
        """Coordinates and rates, shape (k, n)."""
        out = np.repeat(self.first[:, None], times.size, axis=1)
        if self.steps:
            step = np.searchsorted(self.knots[1:-1], times, side="right")
            for i in np.unique(step):
                out[:, step == i] = self.steps[i](times[step == i])
        return out

    def looks(self, begin: float, end: float) -> Array:
        """Choose times in the piece, and its ends, close enough together to show every peak."""
        begin, end = max(begin, self.begin), min(end, self.end)
        if not self.steps:
            return np.array([end if begin == -np.inf else begin])
        knots = np.array(self.knots)
        inner = (knots[:-1, None] + np.diff(knots)[:, None] * np.arange(_LOOKS) / _LOOKS).ravel()
        return np.concatenate(([begin], inner[(inner > begin) & (inner < end)], [end]))

    def nodes(self, begin: float, end: float) -> tuple[Array, Array]:
        """Choose times in the piece, and their weights in integrals over it."""
        begin, end = max(begin, self.begin), min(end, self.end)
        knots = np.array([begin, *(knot for knot in self.knots if begin < knot < end), end])
        half = np.diff(knots)[:, None] / 2.0
        return (knots[:-1, None] + half * (1.0 + _NODES)).ravel(), (half * _WEIGHTS).ravel()


class Response(Shown):
    """
    Motion, loads and stiffnesses of one nonlinear run, sampled at `time`.

    Returned by `simulate`. Motion is measured from static equilibrium on a level runway at
    elevation 0. All arrays are read-only, with one row per time; at the time of a vertical step,
    or when a gear changes state, the row shows what follows.

    Parameters
    ----------
    aircraft : Aircraft
        The aircraft.
    motion : Motion
        Its equations of motion.
    pieces : sequence of Piece
        The solution.
    speed : float
        Ground speed [length/time].
    times : array_like, shape (n,)
        Times at which to sample [time].

    Examples
    --------
    >>> import runway_modal as rm
    >>> from runway_modal import nonlinear
    >>> response = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), rm.knots(20))
    >>> response.stiffness.shape == response.load.shape
    True
    """

    _of_gears = (*Shown._of_gears, "stiffness")

    _motion: Motion
    _pieces: Sequence[Piece]
    _begins: Array
    #: The aircraft of the run.
    aircraft: Aircraft
    #: Ground speed [length/time].
    speed: float
    #: Sample times, shape (n,) [time].
    time: Array

    def __init__(
        self,
        aircraft: Aircraft,
        motion: Motion,
        pieces: Sequence[Piece],
        speed: float,
        times: ArrayLike,
    ) -> None:
        time = array("times", np.atleast_1d(any_array("times", times))).copy()
        if not time.size:
            raise InputError("times has 0 entries, at least 1 needed")
        end = pieces[-1].end
        within = np.isfinite(time) & (time <= end)
        refuse("times", time, ~within, f"is not a time of the run, up to {end!r}")
        for i in np.flatnonzero(np.diff(time) < 0.0):
            raise InputError(
                f"times[{i + 1}] = {float(time[i + 1])!r} is less than {float(time[i])!r} before it"
            )
        begins = np.array([piece.begin for piece in pieces])
        made_of = {"_motion": motion, "_pieces": pieces, "_begins": begins, "aircraft": aircraft}
        vars(self).update(made_of, speed=speed, time=read_only(time))

    @cached_property
    def _rows(self) -> dict[str, Array]:
        """All that is computed from the coordinates, piece by piece."""
        gears, count = len(self.aircraft.gears), self.time.size
        widths = {
            "cg": 3,
            "cg_rate": 3,
            "cg_acceleration": 3,
            "elevation": gears,
            "load": gears,
            "stiffness": gears,
        }
        rows = {name: np.empty((count, width)) for name, width in widths.items()}
        piece_of = np.searchsorted(self._begins, self.time, side="right") - 1
        for index in np.unique(piece_of):
            here = piece_of == index
            piece, times = self._pieces[index], self.time[here]
            y = piece.y(times)
            forces = self._motion.forces(piece.states, piece.stretch, times, y)
            rows["cg"][here] = y[:3].T
            rows["cg_rate"][here] = y[3:6].T
            rows["cg_acceleration"][here] = forces.body.T
            rows["elevation"][here] = piece.stretch.at(times).T
            # Where a gear leaves the runway, rounding may make the load negative.
            rows["load"][here] = np.maximum(forces.load, 0.0).T
            rows["stiffness"][here] = self._motion.stiffness(
                piece.states, piece.stretch, times, y
            ).T
        return {name: read_only(values) for name, values in rows.items()}

    @cached_property
    def distance(self) -> Array:
        """Distance of the foremost gear past station 0, shape (n,) [length]."""
        return read_only(self.time * self.speed)

    @property
    def cg(self) -> Array:
        """Bounce, pitch and roll at the centre of gravity, shape (n, 3) [length, rad]."""
        return self._rows["cg"]

    @property
    def cg_rate(self) -> Array:
        """Rates of bounce, pitch and roll, shape (n, 3) [length/time, rad/time]."""
        return self._rows["cg_rate"]

    @property
    def cg_acceleration(self) -> Array:
        """Accelerations of bounce, pitch and roll, shape (n, 3) [length/time², rad/time²]."""
        return self._rows["cg_acceleration"]

    @cached_property
    def gear_displacement(self) -> Array:
        """Vertical displacement of the body at each gear, shape (n, g) [length] (Eq. 20)."""
        return read_only(self.cg @ self.aircraft.geometry.T)

    @property
    def elevation(self) -> Array:
        """Elevation under each gear, shape (n, g) [length]; at a vertical step, after it."""
        return self._rows["elevation"]

    @property
    def load(self) -> Array:
        """Load of each gear on the runway, static load included, ≥ 0, shape (n, g) [force]."""
        return self._rows["load"]

    @property
    def stiffness(self) -> Array:
        """
        Tangent stiffness of each gear, shape (n, g) [force/length].

        Slope of the gas law and the tire in series, without dampers and friction; 0 off the
        runway.
        """
        return self._rows["stiffness"]

    @cached_property
    def acceleration(self) -> dict[str, Array]:
        """Vertical acceleration at each station, each of shape (n,) [length/time²]."""
        return {
            name: read_only(self.cg_acceleration @ arms)
            for name, arms in zip(self.aircraft.stations, self._arms, strict=True)
        }

    @cached_property
    def _arms(self) -> Array:
        return np.array([(1.0, x, y) for x, y in self.aircraft.stations.values()])

    @property
    def static_load(self) -> Array:
        """Static load of each gear, shape (g,) [force]."""
        return self.aircraft.static_load

    @property
    def unloaded(self) -> NDArray[np.bool_]:
        """Whether each gear leaves the runway between the first and the last time, shape (g,)."""
        return self.extremes().unloaded

    def at(self, times: ArrayLike) -> Response:
        """
        Sample the same run at other times.

        Parameters
        ----------
        times : array_like, shape (k,), or float
            Times, never decreasing, up to the end of the run [time].

        Returns
        -------
        Response
            The response at those times.

        Raises
        ------
        InputError
            If there are no times, one is not finite or after the end, or they decrease.

        Examples
        --------
        >>> import runway_modal as rm
        >>> from runway_modal import nonlinear
        >>> response = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), rm.knots(20))
        >>> response.at([0.5, 1.0]).load.shape
        (2, 3)
        """
        return Response(self.aircraft, self._motion, self._pieces, self.speed, times)

    def extremes(self) -> Extremes:
        """
        Find the extremes between the first and the last of the sample times.

        Returns
        -------
        Extremes
            Loads and accelerations, between samples too.

        Examples
        --------
        >>> import runway_modal as rm
        >>> from runway_modal import nonlinear
        >>> response = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), rm.knots(20))
        >>> bool((response.extremes().max_load >= response.load.max(axis=0)).all())
        True
        """
        return self._extremes

    def _loads_and_accelerations(self, piece: Piece, times: Array) -> tuple[Array, Array]:
        """Find loads of gears and accelerations at stations, a column per time."""
        forces = self._motion.forces(piece.states, piece.stretch, times, piece.y(times))
        return np.maximum(forces.load, 0.0), self._arms @ forces.body

    def _peaks(self, piece: Piece, times: Array) -> Array:
        """Quantities whose maxima are wanted: ± loads, ± accelerations at stations."""
        load, acceleration = self._loads_and_accelerations(piece, times)
        return np.concatenate((load, -load, acceleration, -acceleration))

    @cached_property
    def _rms(self) -> Array:
        return self._root_mean_squares(np.array((self.time[0], self.time[-1]))).ravel()

    def _root_mean_squares(self, times: Array) -> Array:
        """Of loads, then of accelerations, between each time and the next, a row each."""
        return read_only(np.array([self._rms_of(*span) for span in pairwise(times.tolist())]))

    def _rms_of(self, begin: float, end: float) -> Array:
        if begin == end:
            now = self.at(begin)
            return np.abs(
                [*(now.load[0] - self.static_load), *(a[0] for a in now.acceleration.values())]
            )
        total = np.zeros(len(self.aircraft.gears) + len(self.aircraft.stations))
        for piece in self._pieces:
            if piece.begin < end and piece.end > begin:
                times, weights = piece.nodes(begin, end)
                load, acceleration = self._loads_and_accelerations(piece, times)
                dynamic = load - self.static_load[:, None]
                total += np.concatenate((dynamic, acceleration)) ** 2 @ weights
        return np.asarray(np.sqrt(total / (end - begin)))

    @cached_property
    def _extremes(self) -> Extremes:
        return self._span(float(self.time[0]), float(self.time[-1]))

    def _between(self, times: Array) -> list[Extremes]:
        """Find the extremes between each time and the next."""
        return [self._span(begin, end) for begin, end in pairwise(times.tolist())]

    def _span(self, begin: float, end: float) -> Extremes:
        seen = []
        for piece in self._pieces:
            if piece.begin <= end and piece.end >= begin:
                times = piece.looks(begin, end)
                seen.append((piece, times, self._peaks(piece, times)))
        best = np.max([values.max(axis=1) for _, _, values in seen], axis=0)
        when = np.empty_like(best)
        for row in range(best.size):
            height, when[row] = max(
                (
                    self._closer(
                        row, piece, times[max(i - 1, 0)], times[min(i + 1, times.size - 1)]
                    )
                    for piece, times, values in seen
                    for i in _promising(values[row], best[row])
                ),
                key=lambda peak: peak[0],
            )
            best[row] = height
        gears = len(self.aircraft.gears)
        stations = list(self.aircraft.stations)
        upward, downward = best[2 * gears :].reshape(2, -1)
        larger = np.where(upward >= downward, 0, len(stations)) + np.arange(len(stations))
        return Extremes(
            aircraft=self.aircraft,
            speed=self.speed,
            max_load=read_only(best[:gears].copy()),
            time_of_max=read_only(when[:gears].copy()),
            min_load=read_only(0.0 - best[gears : 2 * gears]),
            time_of_min=read_only(when[gears : 2 * gears].copy()),
            max_acceleration=dict(
                zip(stations, np.maximum(upward, downward).tolist(), strict=True)
            ),
            time_of_max_acceleration=dict(
                zip(stations, when[2 * gears :][larger].tolist(), strict=True)
            ),
        )

    def _closer(self, row: int, piece: Piece, begin: float, end: float) -> tuple[float, float]:
        """Height and time of a peak between two times."""
        for _ in range(_ROUNDS):
            times = np.linspace(begin, end, _CLOSER)
            values = self._peaks(piece, times)[row]
            top = int(values.argmax())
            begin, end = times[max(top - 1, 0)], times[min(top + 1, _CLOSER - 1)]
        return float(values[top]), float(times[top])

    def _window(self, begin: float, end: float, gear: int) -> tuple[float, float]:
        lag = lags(self.aircraft)[gear]
        return (begin + lag) / self.speed, (end + lag) / self.speed

    def stiffness_between(self, begin: float, end: float, step: float = 0.01) -> dict[str, Array]:
        """
        Sample each gear's tangent stiffness while that gear is on a stretch of the runway.

        Parameters
        ----------
        begin, end : float
            Stations of the stretch [length].
        step : float
            Time between samples, > 0; they are taken at its multiples [time].

        Returns
        -------
        dict of str to ndarray
            Stiffnesses by gear name [force/length].

        Raises
        ------
        InputError
            If `end` is not after `begin`, `step` is not positive, there is no sample on the
            stretch, or the run ends before a gear leaves it.

        Examples
        --------
        What the report prints for TAXI on the full mat: main gear 4733 to 11,362 lbf/in.

        >>> import runway_modal as rm
        >>> from runway_modal import nonlinear
        >>> response = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), rm.knots(20))
        >>> left = response.stiffness_between(0.0, 930.0)["left"]
        >>> round(left.min()), round(left.max())
        (4749, 11428)
        """
        begin, end, step = number("begin", begin), number("end", end), number("step", step)
        if not begin < end:
            raise InputError(f"end = {end!r} is not after begin = {begin!r}")
        if not 0.0 < step < np.inf:
            raise InputError(f"step = {step!r} is not positive and finite")
        found = {}
        for i, name in enumerate(self.aircraft.gear_names):
            first, last = self._window(begin, end, i)
            if not last <= self._pieces[-1].end:
                raise InputError(
                    f"end = {end!r}: gear {name!r} leaves the stretch at {last!r}, "
                    f"after the end of the run at {self._pieces[-1].end!r}"
                )
            times = step * np.arange(np.ceil(first / step), np.floor(last / step) + 1.0)
            if not times.size:
                raise InputError(
                    f"step = {step!r}: no sample while gear {name!r} is on the stretch"
                )
            found[name] = self.at(times).stiffness[:, i]
        return found

    def equivalent_stiffness(
        self, begin: float, end: float, step: float = 0.01
    ) -> dict[str, float]:
        """
        Stiffness of each gear that gives its mean period on a stretch of the runway (Eq. 22).

        The result can be passed to `runway_modal.Aircraft.with_stiffness`.

        Parameters
        ----------
        begin, end : float
            Stations of the stretch [length].
        step : float
            Time between samples, > 0; they are taken at its multiples [time].

        Returns
        -------
        dict of str to float
            Stiffnesses by gear name [force/length].

        Raises
        ------
        InputError
            As for `stiffness_between`, or if a gear leaves the runway there: it then has no period.

        Examples
        --------
        The report prints 8081 lbf/in for the main gears:

        >>> import runway_modal as rm
        >>> from runway_modal import nonlinear
        >>> response = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), rm.knots(20))
        >>> k = response.equivalent_stiffness(0.0, 930.0)
        >>> round(k["left"])
        8079
        >>> rm.f4e().with_stiffness(k).modes(0.01).frequency_hz[1].round(2)
        np.float64(1.8)
        """
        sampled = self.stiffness_between(begin, end, step)
        for name, k in sampled.items():
            if not k.all():
                raise InputError(
                    f"begin = {begin!r}, end = {end!r}: gear {name!r} leaves the runway there"
                )
        return {name: equivalent_stiffness(k) for name, k in sampled.items()}

    def __reduce__(self) -> tuple[type[Response], tuple[Any, ...]]:
        """Pickle by the solution: what follows from it is computed again, to the same bits."""
        return Response, (self.aircraft, self._motion, self._pieces, self.speed, self.time)

    def __repr__(self) -> str:
        """Span and size."""
        return (
            f"<nonlinear Response: {self.time.size} times from {self.time[0]:g} to "
            f"{self.time[-1]:g}, gears {', '.join(self.aircraft.gear_names)}>"
        )


def _promising(values: Array, best: float) -> list[int]:
    """Find the highest sample, if it is here, and those that may have a higher peak beside them."""
    bend = np.zeros_like(values)
    bend[1:-1] = abs(np.diff(values, 2))
    bend[[0, -1]] = bend[[1, -2]] if values.size > 2 else 0.0
    before, after = np.r_[-np.inf, values[:-1]], np.r_[values[1:], -np.inf]
    peak = (values >= before) & (values >= after) & (values + bend > best)
    top = int(values.argmax())
    peak[top] |= values[top] == best
    return np.flatnonzero(peak).tolist()
