"""
Monte Carlo: random profiles under three coherent tracks, rolled over and summed up, against NumPy.

The peer draws its own normal deviates, transforms them with `numpy.fft`, and marches all profiles
of a batch side by side, one matrix product a station: exact for straight lines between stations.
It gets what follows from spectrum and aircraft prepared, takes its extremes at the stations only,
and its main gears' elevations are interpolated to the nose gear's stations. Loads alone, one
thread each.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ["RAYON_NUM_THREADS"] = "1"

from dataclasses import replace

import numpy as np
from scipy.linalg import expm
from scipy.special import kv

import runway_modal as rm
from _timing import line, machine, options, ratio, take_turns

METRE = 1 / 0.0254
SPACING = 0.25 * METRE
SPEED = rm.knots(60)
SURFACE = rm.Roughness.iso8608("B", unit="in")
MODES = replace(rm.f4e(), stations={}).modes(0.05)
LATERAL = np.array([gear.y for gear in MODES.aircraft.gears])


class Peer:
    def __init__(self, stations: int, runs: int):
        self.runs, self.stations = runs, stations
        aircraft = MODES.aircraft
        # As long a period as ours: four of the longest waves more than the profile.
        low, high = SURFACE.band
        least = stations + 4 / (low * SPACING)
        self.period = min(m << e for m in (1, 3, 5, 9, 15) for e in range(30) if m << e > least)
        n = np.arange(self.period // 2) / (self.period * SPACING)
        self.band = slice(*np.searchsorted(n, (low, high)))
        n = n[self.band]
        apart = 2 * np.pi * n[:, None, None] * np.abs(LATERAL[:, None] - LATERAL)
        gamma = np.where(apart > 0, apart * kv(1, np.where(apart > 0, apart, 1.0)), 1.0)
        amplitude = np.sqrt(SURFACE.psd(n) / (self.period * SPACING)) * self.period / 2
        self.factor = (np.linalg.cholesky(gamma) * amplitude[:, None, None]).astype(complex)
        self.rng = np.random.default_rng(1)

        # Elevations under all gears at the stations of the foremost one.
        arms = np.array([gear.x for gear in aircraft.gears])
        behind = (arms.max() - arms) / SPACING
        self.rows = stations + int(np.ceil(behind.max()))
        self.behind = [divmod(lag, 1.0) for lag in behind]

        # State and loads from the state and the elevations before and after: one matrix.
        omega, zeta = MODES.omega, MODES.damping_ratio
        k = np.array([gear.stiffness for gear in aircraft.gears])
        geometry = aircraft.geometry @ MODES.shapes
        none, one = np.zeros((3, 3)), np.eye(3)
        drift = np.block([[none, one], [-np.diag(omega**2), -np.diag(2 * zeta * omega)]])
        push = np.vstack((none, geometry.T * k))
        dt = SPACING / SPEED
        whole = np.zeros((12, 12))
        whole[:6, :6], whole[:6, 6:9], whole[6:9, 9:] = drift, push, np.eye(3) / dt
        grown = expm(whole * dt)[:6]
        step = np.hstack((grown[:, :6], grown[:, 6:9] - grown[:, 9:], grown[:, 9:]))
        load = np.hstack((-k[:, None] * geometry, none))
        self.step = np.vstack((step, load @ step + np.hstack((np.zeros((3, 9)), np.diag(k)))))
        self.rest = geometry.T * k / omega[:, None] ** 2

    def profiles(self) -> np.ndarray:
        """Elevations (track, station, run)."""
        band = self.band
        draws = self.rng.standard_normal((band.stop - band.start, 3, 2 * self.runs))
        lines = np.zeros((self.period // 2 + 1, 3, self.runs), complex)
        np.matmul(self.factor, draws.view(complex), out=lines[band])
        z = np.fft.irfft(lines.transpose(1, 2, 0), self.period)[..., : self.stations]
        return np.ascontiguousarray(z.transpose(0, 2, 1))

    def march(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Largest, smallest and RMS dynamic loads (gear, run)."""
        under = np.empty((self.rows, 3, self.runs))
        for gear, (whole, part) in enumerate(self.behind):
            rows = np.arange(self.rows) - int(whole)
            after, before = (np.clip(rows - i, 0, self.stations - 1) for i in (0, 1))
            under[:, gear] = (1 - part) * z[gear][after] + part * z[gear][before]
        both = np.zeros((12, self.runs))
        both[:3] = self.rest @ under[0]
        out = np.empty((9, self.runs))
        load = out[6:]
        largest, smallest = np.full((2, 3, self.runs), 0.0)
        squares = np.zeros((3, self.runs))
        for row in range(1, self.rows):
            both[6:9], both[9:] = under[row - 1], under[row]
            np.matmul(self.step, both, out=out)
            both[:6] = out[:6]
            np.maximum(largest, load, out=largest)
            np.minimum(smallest, load, out=smallest)
            squares += load * load
        return largest, smallest, np.sqrt(squares / self.rows)


def measure(stations: int, runs: int, rounds: int) -> None:
    length = SPACING * (stations - 1)
    peer = Peer(stations, runs)
    grid = {"length": length, "spacing": SPACING, "runs": runs, "seed": 1}

    def monte_carlo() -> rm.Ensemble:
        return rm.monte_carlo(MODES, SURFACE, **grid, speed=SPEED, tracks="isotropic")

    def synthesis() -> np.ndarray:
        return SURFACE.elevations(**grid, y=LATERAL)

    # The same profiles give the peer the same loads, but for the interpolation.
    ours, z = monte_carlo(), synthesis()
    assert z.shape[2] == stations
    theirs = peer.march(np.ascontiguousarray(z.transpose(1, 2, 0)))
    for mine, other in zip((ours.max_load, ours.min_load), theirs[:2], strict=True):
        error = np.abs(mine - ours.static_load - other.T).max() / np.abs(other).max()
        assert error < 0.05, f"loads disagree by {error:.1e} of the largest"
    error = np.abs(ours.rms_load / theirs[2].T - 1).max()
    assert error < 0.02, f"RMS loads disagree by {error:.1e}"
    spread = peer.profiles().var() / SURFACE.variance
    assert 0.9 < spread < 1.1, f"the peer's profiles have {spread:.2f} of the variance"

    turns = take_turns(
        rounds,
        ours=monte_carlo,
        synthesis=synthesis,
        numpy_synthesis=peer.profiles,
        numpy=lambda: peer.march(peer.profiles()),
    )
    print(f"\n{runs} runs of {stations} stations, three coherent tracks, one thread")
    each = {name: 1e9 * np.min(seconds) / (runs * stations) for name, seconds in turns.items()}
    line("synthesis alone, a station", f"{each['synthesis']:.1f} ns")
    line("NumPy synthesis alone", f"{each['numpy_synthesis']:.1f} ns")
    line("synthesis, response and statistics, a station", f"{each['ours']:.1f} ns")
    line("NumPy synthesis and march", f"{each['numpy']:.1f} ns")
    line("NumPy synthesis / ours", f"{ratio(turns['numpy_synthesis'], turns['synthesis']):.1f}")
    whole = ratio(turns["numpy"], turns["ours"])
    line("NumPy / ours", f"{whole:.1f}", "≥ 6", whole >= 6)


def flatness(cases: list[tuple[int, int]], rounds: int) -> None:
    print("\ncost a station, three coherent tracks, one thread")
    for stations, runs in cases:
        grid = {"length": SPACING * (stations - 1), "spacing": SPACING, "runs": runs, "seed": 1}
        turns = take_turns(
            rounds,
            whole=lambda grid=grid: rm.monte_carlo(
                MODES, SURFACE, **grid, speed=SPEED, tracks="isotropic"
            ),
            synthesis=lambda grid=grid: SURFACE.elevations(**grid, y=LATERAL),
        )
        each = [1e9 * np.min(turns[name]) / (runs * stations) for name in ("synthesis", "whole")]
        line(
            f"{runs} runs of {stations} stations: synthesis, whole",
            "{:.1f}, {:.1f} ns".format(*each),
        )


if __name__ == "__main__":
    quick = options(__doc__)
    machine("runway_modal", "numpy", "scipy")
    measure(2_000 if quick else 12_001, 8 if quick else 128, 1 if quick else 5)
    sizes = [(1_000, 512), (12_001, 8), (12_001, 64), (12_001, 512), (120_001, 16), (1_000_001, 8)]
    flatness([(500, 8)] if quick else sizes, 1 if quick else 3)
