"""The same march by others: a numba loop of our recurrence, and pyyeti's SolveUnc."""

import importlib
import sys
import warnings
from collections.abc import Callable
from types import ModuleType

import numba
import numpy as np

import runway_modal as rm

Motion = tuple[np.ndarray, np.ndarray]


@numba.njit
def _march(nose, main, per_spacing, omega, climb, g, s, w, h, k, p0, modal, rate):
    """Three modes, two tracks; every mode's state and coefficients in scalars of their own."""
    o1, o2, o3 = omega
    (n1, n2, n3), (m1, m2, m3) = climb
    (g1, g2, g3), (s1, s2, s3), (w1, w2, w3) = g, s, w
    (h1, h2, h3), (k1, k2, k3) = h, k
    p1, p2, p3 = p0
    d1 = d2 = d3 = v1 = v2 = v3 = 0.0
    nose_here, main_here = nose[0], main[0]
    for i in range(modal.shape[0]):
        modal[i, 0], modal[i, 1], modal[i, 2] = p1, p2, p3
        rate[i, 0], rate[i, 1], rate[i, 2] = o1 * v1, o2 * v2, o3 * v3
        nose_next, main_next = nose[i + 1], main[i + 1]
        nose_slope = (nose_next - nose_here) * per_spacing
        main_slope = (main_next - main_here) * per_spacing
        nose_here, main_here = nose_next, main_next
        b1 = n1 * nose_slope + m1 * main_slope
        b2 = n2 * nose_slope + m2 * main_slope
        b3 = n3 * nose_slope + m3 * main_slope
        pull1 = s1 * v1 - g1 * d1
        pull2 = s2 * v2 - g2 * d2
        pull3 = s3 * v3 - g3 * d3
        v1 = (v1 + g1 * b1) - (w1 * v1 + s1 * d1)
        v2 = (v2 + g2 * b2) - (w2 * v2 + s2 * d2)
        v3 = (v3 + g3 * b3) - (w3 * v3 + s3 * d3)
        d1 = (d1 - h1 * b1) + pull1
        d2 = (d2 - h2 * b2) + pull2
        d3 = (d3 - h3 * b3) + pull3
        p1 = (p1 + k1 * b1) + pull1
        p2 = (p2 + k2 * b2) + pull2
        p3 = (p3 + k3 * b3) + pull3


def _increments(omega: float, zeta: float, dt: float) -> list[float]:
    """Increments G, S, W, H, K of one short step, by the Taylor series of G (G″ + 2ζG′ + G = 1)."""
    x = omega * dt
    a = [0.0, 0.0, 0.5]
    for n in range(1, 19):
        a.append(-(2 * zeta * (n + 1) * a[n + 1] + a[n]) / ((n + 2) * (n + 1)))
    g = sum(c * x**n for n, c in enumerate(a))
    k = sum(c * x ** (n + 1) / (n + 1) for n, c in enumerate(a))
    s = x - (k + 2 * zeta * g)
    return [g, s, g + 2 * zeta * s, s + 2 * zeta * g, k]


class Equal:
    """One equally spaced profile under nose and main gears, ready to be marched by peers."""

    def __init__(self, modes: rm.Modes, z: np.ndarray, spacing: float, speed: float, lag: int):
        # Level before and after, so that no loop has to ask where it is.
        before, after = np.full(lag, z[0]), np.full(lag + 1, z[-1])
        self.nose = np.concatenate((z, after))
        self.main = np.concatenate((before, z, after[:1]))
        self.rows = z.size + lag
        self.dt = spacing / speed
        self.modes, self.spacing = modes, spacing
        aircraft = modes.aircraft
        stiffness = np.array([gear.stiffness for gear in aircraft.gears])
        # φᵀK₁ of the nose gear and of both mains (Eq. 12).
        force = modes.shapes.T @ aircraft.geometry.T * stiffness
        self.force = np.stack((force[:, 0], force[:, 1:].sum(axis=1)))
        lift = self.force / modes.omega**2
        self.start = lift.sum(axis=0) * z[0]
        self.climb = lift * speed / modes.omega

    def numba(self) -> Callable[[], Motion]:
        """Our own recurrence (rust/transition.rs)."""
        pairs = zip(self.modes.omega, self.modes.damping_ratio, strict=True)
        steps = [_increments(omega, zeta, self.dt) for omega, zeta in pairs]
        columns = [tuple(column) for column in zip(*steps, strict=True)]
        climb = tuple(tuple(row) for row in self.climb.tolist())
        omega, start = tuple(self.modes.omega.tolist()), tuple(self.start.tolist())

        def call() -> Motion:
            # By NumPy, as ours: its allocator asks for large pages where there are any.
            modal, rate = np.empty((self.rows, 3)), np.empty((self.rows, 3))
            per = 1.0 / self.spacing
            _march(self.nose, self.main, per, omega, climb, *columns, start, modal, rate)
            return modal, rate

        return call

    def pyyeti(self, ode: ModuleType) -> Callable[[], Motion]:
        """`SolveUnc(order=1).tsolve` alone: coefficients and modal forces are computed before."""
        omega, zeta = self.modes.omega, self.modes.damping_ratio
        solver = ode.SolveUnc(np.ones(3), 2 * zeta * omega, omega**2, self.dt, order=1)
        tracks = np.stack((self.nose, self.main))[:, : self.rows]
        force = self.force.T @ tracks

        def call() -> Motion:
            solution = solver.tsolve(force, d0=self.start, v0=np.zeros(3))
            return solution.d.T, solution.v.T

        return call


def pyyeti_ode(*, compiled: bool) -> ModuleType:
    """
    pyyeti's solvers, their inner loop compiled by numba or left to Python.

    pyyeti decides at import by whether numba is there; so numba is hidden for a moment. Its
    import also changes how NumPy prints; that is undone.
    """
    for name in [name for name in sys.modules if name.split(".")[0] == "pyyeti"]:
        del sys.modules[name]
    numba_modules = sys.modules["numba"]
    printing = np.get_printoptions()
    try:
        if not compiled:
            sys.modules["numba"] = None  # type: ignore[assignment]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            ode = importlib.import_module("pyyeti.ode")
    finally:
        sys.modules["numba"] = numba_modules
        np.set_printoptions(**printing)
    inner = sys.modules["pyyeti.ode.solveunc"]
    assert inner.HAVE_NUMBA is compiled
    return ode
