"""
Direct integration of the matrix equations against the exact march (the report's Section III.1).

The full mat at 20 kt by Newmark's methods and by Wilson's, at smaller and smaller steps: error,
cost beside the exact march. One compiled loop serves all three; its matrices are factored and its
elevations sampled before the clock starts, while ours starts from the profile every time. Both give
loads, and the largest and smallest: theirs among their samples.
"""

from functools import partial

import numba
import numpy as np

import runway_modal as rm
from _cases import SPEED, modes
from _peers import pyyeti_ode
from _timing import line, machine, options, ratio, take_turns
from runway_modal.report1980 import direct

#: Steps [s].
STEPS = [m * 10.0**e for e in (-2, -3, -4, -5) for m in (2, 1, 0.5)][:-1]


@numba.njit(inline="always")
def _times(m, x, y, z):
    """3×3 matrix times vector, in scalars."""
    return (
        m[0] * x + m[1] * y + m[2] * z,
        m[3] * x + m[4] * y + m[5] * z,
        m[6] * x + m[7] * y + m[8] * z,
    )


@numba.njit
def _march(elevation, dt, beta, theta, stiff, damp, ground, gears, spring, load):
    """`direct.march` from rest on the level, and loads; `stiff` to `ground` give accelerations."""
    tau, early = theta * dt, 0.5 - beta
    k1, k2, k3 = spring
    u1 = u2 = u3 = v1 = v2 = v3 = a1 = a2 = a3 = 0.0
    z1, z2, z3 = elevation[0]
    most1 = most2 = most3 = -np.inf
    least1 = least2 = least3 = np.inf
    for i in range(elevation.shape[0]):
        if i:
            n1, n2, n3 = elevation[i, 0], elevation[i, 1], elevation[i, 2]
            f1, f2, f3 = _times(
                ground,
                z1 + theta * (n1 - z1),
                z2 + theta * (n2 - z2),
                z3 + theta * (n3 - z3),
            )
            z1, z2, z3 = n1, n2, n3
            half, square = 0.5 * tau, tau * tau * early
            s1, s2, s3 = _times(
                stiff,
                u1 + tau * v1 + square * a1,
                u2 + tau * v2 + square * a2,
                u3 + tau * v3 + square * a3,
            )
            d1, d2, d3 = _times(damp, v1 + half * a1, v2 + half * a2, v3 + half * a3)
            e1 = a1 + (f1 - s1 - d1 - a1) / theta
            e2 = a2 + (f2 - s2 - d2 - a2) / theta
            e3 = a3 + (f3 - s3 - d3 - a3) / theta
            u1 += dt * v1 + dt * dt * (early * a1 + beta * e1)
            u2 += dt * v2 + dt * dt * (early * a2 + beta * e2)
            u3 += dt * v3 + dt * dt * (early * a3 + beta * e3)
            v1 += 0.5 * dt * (a1 + e1)
            v2 += 0.5 * dt * (a2 + e2)
            v3 += 0.5 * dt * (a3 + e3)
            a1, a2, a3 = e1, e2, e3
        g1, g2, g3 = _times(gears, u1, u2, u3)
        p1, p2, p3 = k1 * (z1 - g1), k2 * (z2 - g2), k3 * (z3 - g3)
        load[i, 0], load[i, 1], load[i, 2] = p1, p2, p3
        most1, most2, most3 = max(most1, p1), max(most2, p2), max(most3, p3)
        least1, least2, least3 = min(least1, p1), min(least2, p2), min(least3, p3)
    return (most1, most2, most3), (least1, least2, least3)


class Direct:
    """The aircraft, ready to be integrated with a step."""

    def __init__(self, own: rm.Modes, run: rm.Response, dt: float):
        aircraft, shapes = own.aircraft, own.shapes
        self.geometry, self.spring = (
            aircraft.geometry,
            np.array([g.stiffness for g in aircraft.gears]),
        )
        self.mass, self.stiffness = aircraft.mass_matrix, aircraft.stiffness_matrix
        rates = np.diag(2 * own.damping_ratio * own.omega)
        self.damping = self.mass @ shapes @ rates @ shapes.T @ self.mass
        self.dt = dt
        self.time = dt * np.arange(int(run.time[-1] / dt) + 1)
        exact = run.at(self.time)
        self.elevation, self.exact = exact.elevation, exact.load - exact.static_load

    def march(self, method: direct.Method):
        tau = method.theta * self.dt
        solve = np.linalg.inv(
            self.mass + tau / 2 * self.damping + method.beta * tau**2 * self.stiffness
        )
        ground = self.geometry.T * self.spring
        matrices = [
            tuple(each.ravel().tolist())
            for each in (
                solve @ self.stiffness,
                solve @ self.damping,
                solve @ ground,
                self.geometry,
            )
        ]
        spring = tuple(self.spring.tolist())
        elevation = np.ascontiguousarray(self.elevation)

        def call() -> np.ndarray:
            load = np.empty_like(elevation)
            _march(elevation, self.dt, method.beta, method.theta, *matrices, spring, load)
            return load

        return call

    def pyyeti(self, ode):
        solver = ode.SolveNewmark(self.mass, self.damping, self.stiffness, self.dt)
        force = np.ascontiguousarray((self.elevation * self.spring @ self.geometry).T)

        def call() -> np.ndarray:
            return self.spring * (self.elevation - solver.tsolve(force).d.T @ self.geometry.T)

        return call

    def error(self, load: np.ndarray) -> float:
        """Largest error of a gear's load ÷ that gear's largest dynamic load."""
        return float((np.abs(load - self.exact).max(axis=0) / np.abs(self.exact).max(axis=0)).max())

    def check(self) -> None:
        """The loop is the package's readable one."""
        force = self.elevation * self.spring @ self.geometry
        for method in direct.METHODS:
            u = direct.march(method, self.mass, self.damping, self.stiffness, force, self.dt)
            load = self.spring * (self.elevation - u @ self.geometry.T)
            apart = np.abs(load - self.march(method)()).max() / np.abs(load).max()
            assert apart < 1e-10, f"{method.name}: loops disagree by {apart:.1e} of the peak"


def measure(steps: list[float], rounds: int) -> None:
    own, mat = modes(), rm.Profile.full_mat()
    run = rm.simulate(own, mat, SPEED)
    Direct(own, run, steps[0]).check()

    def ours(times: np.ndarray | None = None) -> np.ndarray:
        response = rm.simulate(own, mat, SPEED, times=times)
        response.extremes()
        return response.load

    print(f"\nfull mat at 20 kt, {run.time[-1]:.1f} s: loads and extremes of 3 gears")
    print("error: of a gear's load, at worst ÷ its largest dynamic load; times: medians")
    print(f"exact: {run.time.size} rows, extremes between them too; or at the same rows\n")
    print("  step            error: Newmark     Wilson     direct   direct    exact at   direct")
    print("  [ms]     rows  average    linear  θ = 1.4       [µs]  / exact   rows [µs]  / that")
    for dt in steps:
        peer = Direct(own, run, dt)
        errors = "".join(f"{peer.error(peer.march(m)()):10.1e}" for m in direct.METHODS)
        turns = take_turns(
            rounds,
            max(1, min(10 * rounds, int(2e5 / peer.time.size))),
            direct=peer.march(direct.AVERAGE),
            exact=ours,
            same=partial(ours, peer.time),
        )
        slow, same = (1e6 * np.median(turns[name]) for name in ("direct", "same"))
        print(
            f"{1e3 * dt:6g}{peer.time.size:9d}{errors}{slow:11.1f}"
            f"{ratio(turns['direct'], turns['exact']):9.2f}{same:12.1f}"
            f"{ratio(turns['direct'], turns['same']):9.2f}"
        )

    peer = Direct(own, run, steps[len(steps) // 2])
    theirs = peer.pyyeti(pyyeti_ode(compiled=True))
    turns = take_turns(max(1, rounds // 3), theirs=theirs, exact=ours)
    print()
    line(f"pyyeti SolveNewmark, {1e3 * peer.dt:g} ms: error", f"{peer.error(theirs()):.1e}")
    line("its loop in Python / exact", f"{ratio(turns['theirs'], turns['exact']):.0f}")


if __name__ == "__main__":
    quick = options(__doc__)
    machine("runway_modal", "numpy", "numba", "pyyeti")
    measure(STEPS[:3] if quick else STEPS, 1 if quick else 11)
