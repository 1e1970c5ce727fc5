"""The runway as the gears meet it: straight pieces over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from runway_modal.profile import Profile


@dataclass(frozen=True, slots=True)
class Stretch:
    """Elevation under each gear, linear in time from `begin` on."""

    begin: float
    #: Elevations at `begin`, after any vertical step, shape (g,).
    elevation: NDArray[np.float64]
    #: Rates of elevation, shape (g,).
    slope: NDArray[np.float64]
    #: Height of the vertical step at `begin`, shape (g,).
    step: NDArray[np.float64]

    def at(self, time: float | NDArray[np.float64]) -> NDArray[np.float64]:
        """Elevations at one time, shape (g,), or at many, shape (g, n)."""
        return np.asarray((self.elevation + np.multiply.outer(time - self.begin, self.slope)).T)


def stretches(profiles: Sequence[Profile], lags: Sequence[float], speed: float) -> list[Stretch]:
    """
    Cut the tracks wherever one of them bends or steps.

    Parameters
    ----------
    profiles : sequence of Profile
        One per gear.
    lags : sequence of float
        Distance of each gear behind the foremost one.
    speed : float
        Ground speed.

    Returns
    -------
    list of Stretch
        The first is the level on which the run starts; it lasts until the second begins.
    """
    knots = [(profile.x + lag) / speed for profile, lag in zip(profiles, lags, strict=True)]
    times = np.unique(np.concatenate(knots))
    elevation, before, slope = (np.empty((times.size, len(profiles))) for _ in range(3))
    for i, (profile, knot) in enumerate(zip(profiles, knots, strict=True)):
        x, z = profile.x, profile.z
        rise = np.zeros(x.size + 1)
        # Slopes from differences of stations: differences of rounded times lose digits.
        inner = np.diff(x) > 0.0
        rise[1:-1][inner] = np.diff(z)[inner] / np.diff(x)[inner] * speed
        for side, out in (("left", before), ("right", elevation)):
            passed = np.searchsorted(knot, times, side=side)  # type: ignore[call-overload]
            last = np.maximum(passed - 1, 0)
            out[:, i] = z[last] + rise[passed] * (times - knot[last])
        slope[:, i] = rise[passed]
    level = np.zeros(len(profiles))
    found = [Stretch(float(times[0]), np.array([p.z[0] for p in profiles]), level, level)]
    for row, time in enumerate(times.tolist()):
        step = elevation[row] - before[row]
        # A breakpoint on a straight line does not count, nor does a step that is mere rounding.
        step[abs(step) <= 1e-14 * (abs(elevation[row]) + abs(before[row]))] = 0.0
        if step.any() or (slope[row] != found[-1].slope).any():
            found.append(Stretch(time, elevation[row], slope[row], step))
    return found
