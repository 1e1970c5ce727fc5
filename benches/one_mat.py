"""
One mat: a whole `simulate` call with its extremes, against scipy.

The peer integrates the same modes with `scipy.signal.lsim` on 20 points per period of the fastest
mode and takes the largest samples; its system is set up before. It is exact only where knots
fall on its grid, and its maxima are samples.
"""

import os

# lsim's small products are faster on one thread, and idle threads of BLAS, which spin, would
# slow our turns down. NumPy reads this when it is first imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from scipy.signal import StateSpace, lsim

import runway_modal as rm
from _cases import SPACING, SPEED, modes
from _timing import line, machine, options, ratio, take_turns

BAR = 60e-6


class Scipy:
    def __init__(self, own: rm.Modes, profile: rm.Profile):
        self.aircraft, self.shapes, self.profile = own.aircraft, own.shapes, profile
        self.stiffness = np.array([gear.stiffness for gear in own.aircraft.gears])
        self.front = max(gear.x for gear in own.aircraft.gears)
        omega, zeta = own.omega, own.damping_ratio
        count = omega.size
        none, one = np.zeros((count, count)), np.eye(count)
        a = np.block([[none, one], [-np.diag(omega**2), -np.diag(2 * zeta * omega)]])
        b = np.vstack((none, one))
        self.system = StateSpace(a, b, np.hstack((one, none)), none)

    def load(self, time: np.ndarray) -> np.ndarray:
        station = [time * SPEED - (self.front - gear.x) for gear in self.aircraft.gears]
        elevation = np.stack([np.interp(s, self.profile.x, self.profile.z) for s in station], 1)
        geometry = self.aircraft.geometry
        _, modal, _ = lsim(self.system, elevation * self.stiffness @ geometry @ self.shapes, time)
        motion = modal @ self.shapes.T @ geometry.T
        return self.stiffness * (elevation - motion) + self.aircraft.static_load

    def extremes(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        load = self.load(time)
        return load.max(axis=0), load.min(axis=0)


def measure(rounds: int, inner: int) -> None:
    own, mat = modes(), rm.Profile.full_mat()
    peer = Scipy(own, mat)
    response = rm.simulate(own, mat, SPEED)
    # All knots of all gears are whole numbers of this step.
    fine = np.arange(0.0, response.time[-1], SPACING / SPEED)
    exact = response.at(fine).load
    error = np.abs(peer.load(fine) - exact).max() / np.abs(exact).max()
    assert error < 1e-9, f"scipy disagrees by {error:.1e} of the peak"

    step = 1.0 / (20 * own.frequency_hz.max())
    coarse = np.arange(0.0, response.time[-1], step)
    turns = take_turns(
        rounds,
        inner,
        ours=lambda: rm.simulate(own, mat, SPEED).extremes(),
        simulate=lambda: rm.simulate(own, mat, SPEED),
        scipy=lambda: peer.extremes(coarse),
    )
    median = {name: float(np.median(seconds)) for name, seconds in turns.items()}
    true = response.extremes().max_load
    missed = np.abs(peer.extremes(coarse)[0] - true).max() / true.max()
    print(f"\nfull mat at 20 kt, {response.time.size} rows, medians of {rounds} times {inner} runs")
    met = median["ours"] <= BAR
    line("simulate and extremes", f"{1e6 * median['ours']:.1f} µs", "≤ 60 µs", met)
    line("simulate alone", f"{1e6 * median['simulate']:.1f} µs")
    line(f"scipy lsim, {coarse.size} samples", f"{1e6 * median['scipy']:.0f} µs")
    line("scipy / ours", f"{ratio(turns['scipy'], turns['ours']):.0f}")
    line("largest load by scipy's samples, off the true one by", f"{missed:.1e}")


if __name__ == "__main__":
    quick = options(__doc__)
    machine("runway_modal", "numpy", "scipy")
    measure(1 if quick else 15, 1 if quick else 100)
