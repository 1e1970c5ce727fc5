"""
Direct integration of the matrix equations, what Section III.1 sets against the exact march.

One step covers the three methods: acceleration is taken as linear (or, for Newmark's average,
as its mean) over θΔt, the equation of motion is met at the end of that, and the acceleration at
the end of Δt lies on the line between.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Method:
    """A method of direct integration: Newmark's β, with γ = 1/2, and Wilson's θ."""

    name: str
    beta: float
    theta: float = 1.0


AVERAGE = Method("Newmark, average acceleration", 1 / 4)
LINEAR = Method("Newmark, linear acceleration", 1 / 6)
WILSON = Method("Wilson, θ = 1.4", 1 / 6, 1.4)
METHODS = (AVERAGE, LINEAR, WILSON)


def march(
    method: Method, mass: Array, damping: Array, stiffness: Array, force: Array, dt: float
) -> Array:
    """Displacements (n, m) under sampled forces (n, m), from equilibrium with the first."""
    b, theta, tau = method.beta, method.theta, method.theta * dt
    solve = np.linalg.inv(mass + tau / 2 * damping + b * tau**2 * stiffness)
    u = np.empty_like(force)
    u[0] = np.linalg.solve(stiffness, force[0])
    v = np.zeros(force.shape[1])
    a = np.zeros(force.shape[1])
    for i in range(len(force) - 1):
        ahead = force[i] + theta * (force[i + 1] - force[i])
        predicted = u[i] + tau * v + tau**2 * (0.5 - b) * a
        met = solve @ (ahead - damping @ (v + tau / 2 * a) - stiffness @ predicted)
        end = a + (met - a) / theta
        u[i + 1] = u[i] + dt * v + dt**2 * ((0.5 - b) * a + b * end)
        v = v + dt / 2 * (a + end)
        a = end
    return u


def amplification(method: Method, phase: float, damping_ratio: float = 0.0) -> Array:
    """Matrix that advances {u, Δt u̇, Δt² ü} by one unforced step of ωΔt = `phase`."""
    b, theta = method.beta, method.theta
    d, k = 2 * damping_ratio * phase, phase**2
    mass = 1 + theta / 2 * d + b * theta**2 * k
    predicted = np.array([1.0, theta, theta**2 * (0.5 - b)])
    rate = np.array([0.0, 1.0, theta / 2])
    now = np.array([0.0, 0.0, 1.0])
    end = now + (-(d * rate + k * predicted) / mass - now) / theta
    return np.array(
        [
            np.array([1.0, 1.0, 0.5 - b]) + b * end,
            np.array([0.0, 1.0, 0.5]) + end / 2,
            end,
        ]
    )


def period_and_decay(method: Method, phase: float) -> tuple[float, float]:
    """Relative elongation of the period and loss of amplitude a cycle, undamped, at ωΔt."""
    eigenvalues = np.linalg.eigvals(amplification(method, phase))
    pair = eigenvalues[np.argmax(eigenvalues.imag)]
    angle = float(np.angle(pair))
    return phase / angle - 1.0, 1.0 - float(np.abs(pair)) ** (2 * np.pi / angle)


def spectral_radius(method: Method, phase: float) -> float:
    """Largest magnitude by which an unforced, undamped step multiplies a state; > 1: unstable."""
    return float(np.abs(np.linalg.eigvals(amplification(method, phase))).max())
