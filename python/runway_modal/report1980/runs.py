"""The runs behind the report's figures; each is made once."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Protocol, Self

import numpy as np

from runway_modal._tracks import lags
from runway_modal.aircraft import equivalent_stiffness, f4e, single_dof
from runway_modal.profile import Profile
from runway_modal.simulate import simulate
from runway_modal.units import knots

from .tables import DAMPING_RATIO, MAT_KNOTS, SPALL_KNOTS, TABLE_1, TABLE_3, TABLE_4

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from runway_modal import nonlinear
    from runway_modal.extremes import Extremes
    from runway_modal.response import Response

    from .tables import Stiffness

#: Speeds [in/s].
MAT_SPEED, SPALL_SPEED = knots(MAT_KNOTS), knots(SPALL_KNOTS)

#: From the nose gear back to the main gears, D_N + D_M [in].
WHEELBASE = TABLE_1[4][1] + TABLE_1[5][1]

HALF_MAT, FULL_MAT = Profile.half_mat(), Profile.full_mat()
TWO_FOOT_SPALL, DOUBLE_SPALL = Profile.two_foot_spall(), Profile.double_spall()

#: When models are compared [s]: until about 5 s after the full mat.
TIMES = np.linspace(0.0, 8.0, 8001)

#: Gears that enter the spall in Figures 14, 15 and 16, and again in 17, 18 and 19.
SPALL_INPUTS = (("left",), ("nose", "left"), ("nose", "left", "right"))


class Run(Protocol):
    """What linear and nonlinear responses have in common, as far as it is used here."""

    @property
    def time(self) -> NDArray[np.float64]:
        """Sample times, shape (n,) [s]."""

    @property
    def load(self) -> NDArray[np.float64]:
        """Compression loads, shape (n, g) [lbf]."""

    @property
    def static_load(self) -> NDArray[np.float64]:
        """Static loads, shape (g,) [lbf]."""

    @property
    def elevation(self) -> NDArray[np.float64]:
        """Elevation under each gear, shape (n, g) [in]."""

    def at(self, times: ArrayLike) -> Self:
        """Evaluate the run at other times."""

    def extremes(self) -> Extremes:
        """Find the true extremes between the first time and the last."""


@cache
def one_dof(stiffness: Stiffness, mat: Profile) -> Response:
    """Bounce mode of Table 3 (1.91 Hz) or 4 (1.80 Hz), at rest until the mains meet the mat."""
    omega = {"static": TABLE_3, "equivalent": TABLE_4}[stiffness].omega[1]
    modes = single_dof(mass=TABLE_1[0][1], omega=omega, damping_ratio=DAMPING_RATIO)
    return simulate(modes, mat.shifted(WHEELBASE), MAT_SPEED)


@cache
def three_dof(stiffness: Stiffness, mat: Profile) -> Response:
    """Run every gear over a mat at 20 kt."""
    return simulate(f4e(stiffness).modes(DAMPING_RATIO), mat, MAT_SPEED)


@cache
def spall(stiffness: Stiffness, profile: Profile, gears: tuple[str, ...]) -> Response:
    """Run some gears through a spall at 10 kt, the others on the level."""
    modes = f4e(stiffness).modes(DAMPING_RATIO)
    return simulate(modes, dict.fromkeys(gears, profile), SPALL_SPEED)


@cache
def taxi(mat: Profile) -> nonlinear.Response:
    """Run the nonlinear reference, which stands for TAXI, over a mat at 20 kt."""
    from runway_modal import nonlinear

    aircraft = nonlinear.f4e(damping_ratio=DAMPING_RATIO)
    return nonlinear.simulate(aircraft, mat, MAT_SPEED, times=TIMES)


def taxi_stiffness(gear: str) -> tuple[float, float, float]:
    """Find a gear's smallest, largest and equivalent stiffness (Eq. 22) on the full mat."""
    sampled = taxi(FULL_MAT).stiffness_between(FULL_MAT.x[0], FULL_MAT.x[-1])[gear]
    return float(sampled.min()), float(sampled.max()), equivalent_stiffness(sampled)


def full_mat(stiffness: Stiffness) -> Response:
    """
    Run the full mat at 20 knots (Figures 10 and 12).

    Parameters
    ----------
    stiffness : {"static", "equivalent"}
        As for `f4e`.

    Returns
    -------
    Response
        All three gears over the mat, 1 % damping in every mode.

    Raises
    ------
    InputError
        If there is no such stiffness.

    Examples
    --------
    >>> from runway_modal import report1980
    >>> report1980.full_mat("static").extremes().max_load.round(0)
    array([12940., 43686., 43686.])
    """
    return three_dof(stiffness, FULL_MAT)


#: Off a mat's edge [s]: there loads jump where a damper is pushed, which is not vibration.
_ASIDE = 1e-6


def load_range(response: Run, column: int, begin: float, end: float) -> float:
    """Find the true range of a gear's load between two edges of a mat [lbf]."""
    extremes = response.at([begin + _ASIDE, end - _ASIDE]).extremes()
    return float(extremes.max_load[column] - extremes.min_load[column])


def after_over_on(response: Response, profile: Profile) -> NDArray[np.float64]:
    """
    Range of each gear's load after the mat ÷ its range on the mat.

    Above 1 the trailing edge amplified the motion, below 1 it cancelled it. "On" is from the end
    of the up ramp to the beginning of the down ramp, for each gear; "after" from the last gear's
    end of the mat on.

    Parameters
    ----------
    response : Response
        Run over the mat with every gear.
    profile : Profile
        The mat, four breakpoints.

    Returns
    -------
    ndarray, shape (g,)
        The ratio of true ranges [-].

    Examples
    --------
    >>> import runway_modal as rm
    >>> from runway_modal import report1980
    >>> mat = report1980.full_mat("static")
    >>> report1980.after_over_on(mat, rm.Profile.full_mat())[1].round(2)
    np.float64(1.53)
    """
    lag = np.array(lags(response.aircraft))
    on = (profile.x[1:3, None] + lag) / response.speed
    off, end = (profile.x[3] + lag.max()) / response.speed, float(response.time[-1])
    return np.array(
        [
            load_range(response, gear, off, end) / load_range(response, gear, *on[:, gear])
            for gear in range(lag.size)
        ]
    )
