"""
Many runs: the kernel against NumPy over profiles, a numba loop, pyyeti and reading memory.

Three tracks, three gears, a wheelbase that is no whole number of spacings. Peers get what they need
prepared, and find loads alone, extremes at the stations only: so the kernel is called without the
acceleration of the centre of gravity that `simulate_many` always gives.
"""

import multiprocessing
import os
from functools import partial

import numba
import numpy as np

import runway_modal as rm
from _peers import pyyeti_ode
from _timing import line, machine, options, ratio, take_turns

SPACING = 10.0
SPEED = rm.knots(60)
MODES = rm.f4e().modes(0.01)


def elevations(runs: int, stations: int) -> np.ndarray:
    """Random walks, detrended by their mean: roughness with long waves."""
    steps = np.random.default_rng(1980).normal(scale=0.06, size=(runs, 3, stations))
    return np.cumsum(steps, axis=2)


class March:
    """
    The recurrence of a period in matrices: two legs, three loads, products for the mean square.

    State {d, ẏ} of three modes; rises of the nose (after its station) and of the mains (before
    and after theirs). Everything constant is computed by `expm`.
    """

    def __init__(self, own: rm.Modes, stations: int):
        from scipy.linalg import expm

        aircraft = own.aircraft
        arm = np.array([gear.x for gear in aircraft.gears])
        stiffness = np.array([gear.stiffness for gear in aircraft.gears])
        shape = aircraft.geometry @ own.shapes  # gears × modes
        lag = (arm.max() - arm[1]) / SPACING
        self.whole = int(lag)
        share = lag - self.whole
        # d/dt of {displacement above static, rate}: ḋ = v − lift · slope.
        lift = (shape * stiffness[:, None]).T / own.omega[:, None] ** 2 * SPEED
        system = np.zeros((9, 9))
        system[:3, 3:6] = np.eye(3)
        system[3:6, :3] = -np.diag(own.omega**2)
        system[3:6, 3:6] = -np.diag(2 * own.damping_ratio * own.omega)
        system[:3, 6:9] = -lift / SPACING
        period = SPACING / SPEED
        lengths = share * period, (1 - share) * period
        self.first, self.second = (expm(system * length)[:6] for length in lengths)
        self.load = -(shape * stiffness[:, None])  # on d
        self.static = aircraft.static_load
        self.periods = stations - 1 + self.whole
        self.duration = (self.periods + share) * period
        # ∫ F² over a leg = xᵀ W x, x = {state, rises}: Gauss's rule.
        nodes, weights = np.polynomial.legendre.leggauss(8)
        self.squares = []
        for length in lengths:
            square = np.zeros((3, 9, 9))
            for node, weight in zip(nodes, weights, strict=True):
                rows = self.load @ expm(system * (0.5 * length * (1 + node)))[:3]
                square += 0.5 * length * weight * rows[:, :, None] * rows[:, None, :]
            self.squares.append(square)

    def rises(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rises under nose and mains, one row per period, the mains' first before their first."""
        up = np.diff(z, axis=-1)
        level = np.zeros((*up.shape[:1], 2, self.whole + 1))
        nose = np.concatenate((up[:, 0], level[:, 0]), axis=1)
        return nose, np.concatenate((level, up[:, 1:], level[:, :, :1]), axis=2)

    def numpy(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """All runs at once, period by period."""
        nose, main = self.rises(z)
        nose, main = np.ascontiguousarray(nose.T), np.ascontiguousarray(main.transpose(2, 1, 0))
        runs = z.shape[0]
        x = np.zeros((9, runs))
        high, low = np.zeros((3, runs)), np.zeros((3, runs))
        sums = [np.zeros((9, 9, runs)) for _ in range(2)]
        for i in range(self.periods + 1):
            x[6] = nose[i]
            for leg, step in enumerate((self.first, self.second)):
                x[7:] = main[i + leg]
                gears = slice(0, 1) if leg == 0 else slice(1, 3)
                load = self.load[gears] @ x[:3]
                np.maximum(high[gears], load, out=high[gears])
                np.minimum(low[gears], load, out=low[gears])
                # Of the last period only the first leg.
                if i == self.periods and leg == 1:
                    break
                for row in range(9):
                    sums[leg][row, : row + 1] += x[row] * x[: row + 1]
                x[:6] = step @ x
        return self.results(high.T, low.T, [np.moveaxis(each, 2, 0) for each in sums])

    def numba(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """A loop of the same work, run by run."""
        high, low = np.zeros((z.shape[0], 3)), np.zeros((z.shape[0], 3))
        sums = np.zeros((2, z.shape[0], 9, 9))
        # Modes do not mix: leg, row, column, mode.
        steps = np.stack((self.first, self.second))
        blocks = np.zeros((2, 2, 2, 3))
        for row, column in np.ndindex(2, 2):
            part = steps[:, 3 * row : 3 * row + 3, 3 * column : 3 * column + 3]
            blocks[:, row, column] = np.diagonal(part, axis1=1, axis2=2)
        inputs = np.ascontiguousarray(steps[:, :, 6:])
        _loop(z, self.whole, blocks, inputs, self.load, high, low, sums)
        return self.results(high, low, list(sums))

    def results(
        self, high: np.ndarray, low: np.ndarray, sums: list[np.ndarray]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        total = 0.0
        for square, each in zip(self.squares, sums, strict=True):
            lower = np.tril(square) + np.tril(square, -1)
            total = total + np.einsum("gij,nij->ng", lower, each)
        return self.static + high, self.static + low, np.sqrt(total / self.duration)


@numba.njit
def _loop(z, whole, blocks, inputs, load, high, low, sums):
    runs, _, stations = z.shape
    periods = stations - 1 + whole
    for run in range(runs):
        x = np.zeros(9)
        y = np.zeros(6)
        for i in range(periods + 1):
            x[6] = z[run, 0, i + 1] - z[run, 0, i] if i + 1 < stations else 0.0
            for leg in range(2):
                k = i - whole - 1 + leg
                for main in range(2):
                    inside = 0 <= k < stations - 1
                    x[7 + main] = z[run, 1 + main, k + 1] - z[run, 1 + main, k] if inside else 0.0
                for gear in range(0 if leg == 0 else 1, 1 if leg == 0 else 3):
                    f = load[gear, 0] * x[0] + load[gear, 1] * x[1] + load[gear, 2] * x[2]
                    high[run, gear] = max(high[run, gear], f)
                    low[run, gear] = min(low[run, gear], f)
                if i == periods and leg == 1:
                    break
                for row in range(9):
                    for column in range(row + 1):
                        sums[leg, run, row, column] += x[row] * x[column]
                b, a = blocks[leg], inputs[leg]
                for m in range(3):
                    d, v, n = x[m], x[3 + m], 3 + m
                    up = a[m, 0] * x[6] + a[m, 1] * x[7] + a[m, 2] * x[8]
                    y[m] = b[0, 0, m] * d + b[0, 1, m] * v + up
                    up = a[n, 0] * x[6] + a[n, 1] * x[7] + a[n, 2] * x[8]
                    y[n] = b[1, 0, m] * d + b[1, 1, m] * v + up
                x[:6] = y


def pyyeti(own: rm.Modes, z: np.ndarray, ode) -> None:
    """`SolveUnc` run by run, on a grid of whole spacings."""
    aircraft = own.aircraft
    stiffness = np.array([gear.stiffness for gear in aircraft.gears])
    omega, zeta = own.omega, own.damping_ratio
    force = own.shapes.T @ aircraft.geometry.T * stiffness
    load = aircraft.geometry @ own.shapes * stiffness[:, None]
    for run in z:
        solver = ode.SolveUnc(np.ones(3), 2 * zeta * omega, omega**2, SPACING / SPEED, order=1)
        solution = solver.tsolve(force @ (run - run[:, :1]))
        dynamic = stiffness[:, None] * (run - run[:, :1]) - load @ solution.d
        dynamic.max(axis=1), dynamic.min(axis=1), np.sqrt((dynamic**2).mean(axis=1))


def kernel(z: np.ndarray, *, between: bool = True) -> np.ndarray:
    """Largest loads, found with the smallest and the mean squares, and no accelerations."""
    nowhere = np.empty((0, 2))
    results, _ = rm._core.simulate_many(
        [(MODES._core, nowhere)], z, SPACING, [SPEED], False, False, between=between
    )
    return results[0]


def against_peers(runs: int, stations: int, rounds: int) -> None:
    z = elevations(runs, stations)
    march = March(MODES, stations)
    whole = partial(rm.simulate_many, MODES, z, SPACING, SPEED)
    found = whole()
    for peer in (march.numpy, march.numba):
        high, low, rms = peer(z)
        # Peers see values at stations only.
        assert (high <= found.max_load * (1 + 1e-9)).all()
        assert (low >= found.min_load - 1e-9 * found.max_load).all()
        assert abs(high / found.max_load - 1).max() < 0.02
        assert abs(rms / found.rms_load - 1).max() < 1e-9
    ours = partial(kernel, z)
    at_stations = partial(kernel, z, between=False)
    assert (ours() == found.max_load).all()
    assert (at_stations() <= found.max_load).all()
    assert (at_stations() < found.max_load).any()
    turns = take_turns(
        rounds,
        whole=whole,
        ours=ours,
        at_stations=at_stations,
        numba=partial(march.numba, z),
        read=partial(np.sum, z),
    )
    slow = take_turns(max(1, rounds // 6), numpy=partial(march.numpy, z), ours=ours)
    few = z[: max(1, runs // 50)]
    ode = pyyeti_ode(compiled=False)
    by_run = take_turns(max(1, rounds // 6), pyyeti=partial(pyyeti, MODES, few, ode), ours=ours)
    count = runs * (stations - 1)
    print(f"\n{runs} runs of {stations} stations on three tracks, one thread")
    line("kernel, loads alone", f"{1e9 * turns['ours'].min() / count:.1f} ns", "a station")
    line("simulate_many", f"{1e9 * turns['whole'].min() / count:.1f} ns", "a station")
    quotient = ratio(slow["numpy"], slow["ours"])
    line("NumPy over profiles / ours", f"{quotient:.1f}", "≥ 20", quotient >= 20)
    quotient = ratio(turns["numba"], turns["ours"])
    line("numba loop / ours", f"{quotient:.1f}", "≥ 5", quotient >= 5)
    quotient = ratio(by_run["pyyeti"] * (runs / few.shape[0]), by_run["ours"])
    line("pyyeti run by run / ours", f"{quotient:.0f}", "≥ 1000", quotient >= 1000)
    quotient = ratio(turns["ours"], turns["read"])
    line("ours / reading the elevations once (np.sum)", f"{quotient:.1f}", "≤ 5", quotient <= 5)
    quotient = ratio(turns["ours"], turns["at_stations"])
    line("ours / ours with extremes at stations only", f"{quotient:.2f}", "≤ 1.3", quotient <= 1.3)


def on_cores(runs: int, stations: int, rounds: int) -> None:
    """One thread against two, each in a process of its own: threads are made once a process."""
    call = partial(rm.simulate_many, MODES, elevations(runs, stations), SPACING, SPEED)

    def seconds(threads: int) -> float:
        here, there = multiprocessing.get_context("fork").Pipe(duplex=False)

        def measure() -> None:
            os.environ["RAYON_NUM_THREADS"] = str(threads)
            there.send(take_turns(rounds, ours=call)["ours"].min())

        child = multiprocessing.get_context("fork").Process(target=measure)
        child.start()
        result = here.recv()
        child.join()
        return result

    turns = np.array([[seconds(threads) for threads in (1, 2)] for _ in range(max(1, rounds // 2))])
    quotient = ratio(turns[:, 0], turns[:, 1])
    line("one thread / two", f"{quotient:.2f}", "≥ 1.8", quotient >= 1.8)


def own_speeds(runs: int, stations: int, rounds: int) -> None:
    """A speed for each run against one for all: what depends on it is worked out run by run."""
    z = elevations(runs, stations)
    speeds = SPEED * np.linspace(0.8, 1.2, runs)
    turns = take_turns(
        rounds,
        each=partial(rm.simulate_many, MODES, z, SPACING, speeds),
        one=partial(rm.simulate_many, MODES, z, SPACING, SPEED),
    )
    cost = 1e6 * (turns["each"].min() - turns["one"].min()) / runs
    line(f"a speed for each of {runs} runs of {stations} stations", f"{cost:.1f} µs", "more a run")
    line("... / one for all", f"{ratio(turns['each'], turns['one']):.2f}")


def flatness(shapes: list[tuple[int, int]], rounds: int) -> None:
    print("\ncost a station and run")
    costs = []
    for runs, stations in shapes:
        z = elevations(runs, stations)
        call = partial(rm.simulate_many, MODES, z, SPACING, SPEED)
        best = take_turns(rounds, max(1, 200_000 // z.size), ours=call)["ours"].min()
        costs.append(best / (runs * stations))
        line(f"{runs} runs of {stations} stations", f"{1e9 * costs[-1]:.1f} ns")
    quotient = max(costs) / min(costs)
    line("dearest / cheapest", f"{quotient:.2f}", "≤ 1.67", quotient <= 1.67)


if __name__ == "__main__":
    os.environ.setdefault("RAYON_NUM_THREADS", "1")
    quick = options(__doc__)
    machine("runway_modal", "numpy", "numba", "pyyeti")
    against_peers(*((16, 100, 1) if quick else (1024, 2000, 12)))
    on_cores(*((16, 100, 1) if quick else (1024, 2000, 6)))
    own_speeds(*((16, 100, 1) if quick else (1024, 1000, 6)))
    flatness([(8, 100)] if quick else [(8, 100), (800, 1000), (10_000, 100), (8, 100_000)], 5)
