"""
What the response must be, to 40 digits and more, found by a road of its own.

The equation of motion M q'' + C q' + K q = K1 u + C1 u' is solved in CG coordinates: between two
knots the state (q, q', elevations u, their rates s) obeys one linear system and advances by its
matrix exponential. No modes, no particular solution, no recurrence. Inputs are doubles taken as
the rationals they are; so are the instants at which gears meet breakpoints.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

import mpmath
import numpy as np
from flint import arb, arb_mat, ctx, fmpq, fmpq_mat

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    import runway_modal as rm

#: Working precision. 40 digits need 133; the rest is for the squarings of a long segment and for
#: the march over very many.
BITS = 320

#: Radius, relative to the largest entry, that an exponential may have: 60 digits.
RADIUS = 1e-60

Rows = list[list[arb]]


def rational(value: float) -> fmpq:
    """Give the number that a double is."""
    return fmpq(*float(value).as_integer_ratio())


def nearest(value: fmpq) -> float:
    """Round to double (division of Python integers rounds correctly)."""
    return int(value.p) / int(value.q)


def inexact(value: fmpq) -> mpmath.mpf:
    """Round to mpmath's working precision."""
    return mpmath.mpf(int(value.p)) / int(value.q)


@dataclass(frozen=True)
class Knot:
    """Where one or more gears meet a breakpoint."""

    distance: fmpq
    #: Its time in doubles, by which a sample asks for it.
    time: float
    #: (gear, elevation after, its rate after, height of a vertical step).
    events: list[tuple[int, fmpq, fmpq, fmpq]]


class Oracle:
    """One run: an aircraft, one damping ratio for all modes or per mode, one profile per gear."""

    def __init__(
        self,
        aircraft: rm.Aircraft,
        damping_ratio: float | Sequence[float],
        tracks: Sequence[rm.Profile],
        speed: float,
        *,
        damping_input: bool = False,
        bits: int = BITS,
    ) -> None:
        self.bits = bits
        self.speed = rational(speed)
        self.gears = len(aircraft.gears)
        geometry = [[fmpq(1), rational(g.x), rational(g.y)] for g in aircraft.gears]
        # A coordinate that no gear has an arm for is neither held nor moved: it is left out.
        self.freedoms = [i for i in range(3) if any(row[i] != 0 for row in geometry)]
        masses = [aircraft.mass, aircraft.pitch_inertia, aircraft.roll_inertia]
        self.mass = [rational(masses[i]) for i in self.freedoms]
        self.geometry = fmpq_mat([[row[i] for i in self.freedoms] for row in geometry])
        springs = [rational(g.stiffness) for g in aircraft.gears]
        dampers = [rational(g.damping) if damping_input else fmpq(0) for g in aircraft.gears]
        self.k1 = self.geometry.transpose() * diagonal(springs)
        self.c1 = self.geometry.transpose() * diagonal(dampers)
        self.stiffness = self.k1 * self.geometry
        ratios = np.atleast_1d(np.asarray(damping_ratio, dtype=float)).tolist()
        with ctx.workprec(bits), mpmath.workprec(bits):
            self.damping = modal_damping(self.mass, self.stiffness, ratios)
            self.system = self._system()
        self.outputs = self._outputs(aircraft, springs, dampers)
        weight = [-rational(aircraft.mass) * rational(aircraft.gravity)]
        sinkage = self.stiffness.solve(column(weight + [fmpq(0)] * (len(self.freedoms) - 1)))
        self.static_load = -(diagonal(springs) * self.geometry * sinkage)
        self.first = column([rational(track.z[0]) for track in tracks])
        self.knots = list(self._knots(aircraft, tracks, speed))
        self._kept: dict[fmpq, arb_mat] = {}

    def _system(self) -> arb_mat:
        """Build d/dt of (q, q', u, s)."""
        n, g = len(self.freedoms), self.gears
        rows = [[arb(0)] * (2 * n + 2 * g) for _ in range(2 * n + 2 * g)]
        for i in range(n):
            rows[i][n + i] = arb(1)
            for j in range(n):
                rows[n + i][j] = arb(-self.stiffness[i, j] / self.mass[i])
                rows[n + i][n + j] = -self.damping[i, j] / arb(self.mass[i])
            for j in range(g):
                rows[n + i][2 * n + j] = arb(self.k1[i, j] / self.mass[i])
                rows[n + i][2 * n + g + j] = arb(self.c1[i, j] / self.mass[i])
        for j in range(g):
            rows[2 * n + j][2 * n + g + j] = arb(1)
        return arb_mat(rows)

    def _outputs(
        self, aircraft: rm.Aircraft, springs: list[fmpq], dampers: list[fmpq]
    ) -> dict[str, arb_mat]:
        """Quantities as linear forms of the state, by their names in a Response."""
        n, g = len(self.freedoms), self.gears
        with ctx.workprec(self.bits):
            unit = diagonal([fmpq(1)] * (2 * n + 2 * g))
            state = arb_mat(unit)
            place, rate, ground, climb = (
                arb_mat([[state[i, j] for j in range(2 * n + 2 * g)] for i in span])
                for span in (
                    range(n),
                    range(n, 2 * n),
                    range(2 * n, 2 * n + g),
                    range(2 * n + g, 2 * n + 2 * g),
                )
            )
            change = self.system
            acceleration = rate * change
            geometry = arb_mat(self.geometry)
            # Coordinates that were left out stand still.
            spread = arb_mat([[int(f == i) for f in self.freedoms] for i in range(3)])
            points = [[fmpq(1), rational(x), rational(y)] for x, y in aircraft.stations.values()]
            arms = fmpq_mat([[point[i] for i in self.freedoms] for point in points])
            compression = arb_mat(diagonal(springs)) * (ground - geometry * place)
            resistance = arb_mat(diagonal(dampers)) * (climb - geometry * rate)
            return {
                "cg": spread * place,
                "cg_rate": spread * rate,
                "cg_acceleration": spread * acceleration,
                "gear_displacement": geometry * place,
                "load": compression + resistance,
                "acceleration": arb_mat(arms) * acceleration,
            }

    def _knots(
        self, aircraft: rm.Aircraft, tracks: Sequence[rm.Profile], speed: float
    ) -> Iterator[Knot]:
        front = max(rational(gear.x) for gear in aircraft.gears)
        met = []
        for index, (gear, track) in enumerate(zip(aircraft.gears, tracks, strict=True)):
            x = [rational(value) for value in track.x]
            z = [rational(value) for value in track.z]
            lag = front - rational(gear.x)
            for station, group in groupby(range(len(x)), key=x.__getitem__):
                where = list(group)
                first, last = where[0], where[-1]
                rate = fmpq(0)
                if last + 1 < len(x):
                    rate = (z[last + 1] - z[last]) / (x[last + 1] - x[last]) * self.speed
                if len(x) > 1:
                    met.append((station + lag, index, z[last], rate, z[last] - z[first]))
        met.sort(key=lambda event: event[0])
        for distance, events in groupby(met, key=lambda event: event[0]):
            yield Knot(distance, nearest(distance) / speed, [event[1:] for event in events])

    def exponential(self, dt: fmpq) -> arb_mat:
        """Transition over a time, with a proven error bound."""
        if dt not in self._kept:
            with ctx.workprec(self.bits):
                found = (self.system * arb(dt)).exp()
                largest = max(abs(float(entry.mid())) for entry in found.entries())
                radius = max(float(entry.rad()) for entry in found.entries())
                assert radius <= RADIUS * largest, f"{radius} of {largest}: too few bits"
                # Midpoints, or the bounds would grow without bound over ten thousand segments.
                self._kept[dt] = found.mid()
        return self._kept[dt]

    def _cross(self, state: arb_mat, knot: Knot) -> arb_mat:
        n, g = len(self.freedoms), self.gears
        for gear, elevation, rate, step in knot.events:
            state[2 * n + gear, 0] = arb(elevation)
            state[2 * n + g + gear, 0] = arb(rate)
            for i in range(n):
                # The derivative of a step is an impulse, on the damper's force.
                state[n + i, 0] += arb(self.c1[i, gear] * step / self.mass[i])
        return state.mid()

    def states(self, times: Sequence[float]) -> Iterator[arb_mat]:
        """State at times; the rounded time of a knot means that knot, just after it."""
        n, g = len(self.freedoms), self.gears
        rest = self.stiffness.solve(self.k1 * self.first)
        state = arb_mat(
            column(
                [rest[i, 0] for i in range(n)]
                + [fmpq(0)] * n
                + [self.first[i, 0] for i in range(g)]
                + [fmpq(0)] * g
            )
        )
        last: Knot | None = None
        ahead = iter(self.knots)
        knot = next(ahead, None)
        for time in times:
            while knot is not None and knot.time <= time:
                if last is not None:
                    dt = (knot.distance - last.distance) / self.speed
                    state = self.exponential(dt) * state
                state = self._cross(state, knot)
                last, knot = knot, next(ahead, None)
            if last is None or time <= last.time:
                yield state
            else:
                yield (self.exponential(rational(time) - last.distance / self.speed) * state).mid()

    def at(self, times: Sequence[float]) -> dict[str, Rows]:
        """Quantities at times: for each name one row per time, as in a Response."""
        found: dict[str, Rows] = {name: [] for name in self.outputs}
        with ctx.workprec(self.bits):
            still = arb_mat(self.static_load)
            for state in self.states(times):
                for name, form in self.outputs.items():
                    value = form * state + still if name == "load" else form * state
                    found[name].append(value.mid().entries())
        return found


def modal_damping(mass: list[fmpq], stiffness: fmpq_mat, ratios: list[float]) -> arb_mat:
    """Damping matrix that gives every mode its ratio, lowest frequency first."""
    n = len(mass)
    root = [mpmath.sqrt(inexact(m)) for m in mass]
    normal = mpmath.matrix(n, n)
    for i in range(n):
        for j in range(n):
            normal[i, j] = inexact(stiffness[i, j]) / (root[i] * root[j])
    if len(ratios) == 1:
        spread = 2 * mpmath.mpf(ratios[0]) * mpmath.sqrtm(normal)
    else:
        squares, vectors = mpmath.eigsy(normal)
        rates = [2 * mpmath.mpf(z) * mpmath.sqrt(w) for z, w in zip(ratios, squares, strict=True)]
        spread = vectors * mpmath.diag(rates) * vectors.T
    return arb_mat([[arb(root[i] * spread[i, j] * root[j]) for j in range(n)] for i in range(n)])


def diagonal(values: list[fmpq]) -> fmpq_mat:
    """Matrix with these on its diagonal."""
    size = len(values)
    return fmpq_mat([[values[i] if i == j else fmpq(0) for j in range(size)] for i in range(size)])


def column(values: list[fmpq]) -> fmpq_mat:
    """Matrix of one column."""
    return fmpq_mat([[value] for value in values])


def difference(values: NDArray[np.float64], exact: Rows) -> NDArray[np.float64]:
    """Subtract exact values from doubles, rounded after the subtraction."""
    with ctx.workprec(BITS):
        return np.array(
            [
                [float(arb(a) - b) for a, b in zip(*rows, strict=True)]
                for rows in zip(values.tolist(), exact, strict=True)
            ]
        )


def rounded(exact: Rows) -> NDArray[np.float64]:
    """Exact values as doubles."""
    return np.array([[float(value) for value in row] for row in exact])
