"""
What leaving the velocity terms out of the bounce model does (Eqs. 15, 16; Section III.4).

The report drops 2ζω u̇_M from the excitation and 2ζωM (u̇_M − u̇) from the load, and says that
the load is then estimated on the safe side.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from runway_modal.aircraft import single_dof
from runway_modal.simulate import simulate

from .runs import (
    DOUBLE_SPALL,
    FULL_MAT,
    HALF_MAT,
    MAT_SPEED,
    SPALL_SPEED,
    TWO_FOOT_SPALL,
)
from .tables import TABLE_1, TABLE_3

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from runway_modal.profile import Profile

CASES = {
    "half mat, 20 kt": (HALF_MAT, MAT_SPEED),
    "full mat, 20 kt": (FULL_MAT, MAT_SPEED),
    "two-foot spall, 10 kt": (TWO_FOOT_SPALL, SPALL_SPEED),
    "double spall, 10 kt": (DOUBLE_SPALL, SPALL_SPEED),
}

RATIOS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2)


@dataclass(frozen=True, slots=True)
class Peaks:
    """Largest load of one run [lbf], by which velocity terms are kept."""

    #: Eqs. 15 and 16 in full.
    full: float
    #: Excitation without 2ζω u̇_M, load in full.
    without_input: float
    #: Excitation in full, load of the spring alone.
    without_load: float
    #: What the report does: neither.
    without_both: float


@cache
def peaks(profile: Profile, speed: float, damping_ratio: float) -> Peaks:
    """
    Find the largest loads of Table 3's bounce mode over a profile.

    At a sharp edge the damper's load is infinite for no time at all; that blow moves the mass
    but is not counted as a load.
    """
    mass, omega = TABLE_1[0][1], TABLE_3.omega[1]
    modes = single_dof(mass=mass, omega=omega, damping_ratio=damping_ratio)
    damper = 2.0 * damping_ratio * omega * mass
    knots = profile.x / speed

    def largest(*, excited: bool, damped: bool) -> float:
        run = simulate(modes, profile, speed, times=[0.0], damping_input=excited)

        def load(times: NDArray[np.float64]) -> NDArray[np.float64]:
            at = run.at(times)
            deflection = at.elevation[:, 0] - at.gear_displacement[:, 0]
            force = mass * omega**2 * deflection + run.static_load[0]
            if damped:
                rise = speed * _slope(profile, knots, times)
                force = force + damper * (rise - at.cg_rate[:, 0])
            return np.asarray(force)

        # A load jumps at a breakpoint: look on both sides of each.
        sides = np.concatenate([knots - _ASIDE, knots + _ASIDE])
        span = np.linspace(0.0, knots[-1] + 5.0, 10_001)
        times = np.union1d(span, sides[sides >= 0.0])
        top = int(np.argmax(load(times)))
        near = times[max(top - 1, 0) : top + 2]
        return float(load(np.union1d(np.linspace(near[0], near[-1], 1001), near)).max())

    return Peaks(
        full=largest(excited=True, damped=True),
        without_input=largest(excited=False, damped=True),
        without_load=largest(excited=True, damped=False),
        without_both=largest(excited=False, damped=False),
    )


#: How near to a breakpoint is beside it [s]: the load moves by 1e-3 lbf meanwhile.
_ASIDE = 1e-9


def _slope(
    profile: Profile, knots: NDArray[np.float64], times: NDArray[np.float64]
) -> NDArray[np.float64]:
    segment = np.searchsorted(knots, times, side="right") - 1
    inside = (segment >= 0) & (segment < knots.size - 1)
    run, rise = np.diff(profile.x), np.diff(profile.z)
    # A vertical step takes no time: no time is inside it.
    slopes = np.divide(rise, run, out=np.zeros_like(run), where=run > 0.0)
    return np.asarray(np.where(inside, slopes[np.clip(segment, 0, run.size - 1)], 0.0))
