"""One aircraft over one runway at one speed."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from . import _core
from ._core import InputError
from ._input import flag, number
from ._tracks import by_gear
from .modes import Modes, check_modes
from .response import Response

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from .profile import Profile


def simulate(
    modes: Modes,
    tracks: Profile | Mapping[str, Profile],
    speed: float,
    *,
    times: ArrayLike | None = None,
    duration: float | None = None,
    damping_input: bool = False,
) -> Response:
    """
    Roll an aircraft over a runway profile; exact in continuous time.

    The modes are marched from breakpoint to breakpoint in closed form (Eqs. 12-14, 17-21); no
    time step is involved. At time 0 the foremost gear is at station 0; the gear at x_g meets
    station s at t = (s + x_front - x_g) / speed. The run starts at rest in equilibrium on the
    first elevations.

    Parameters
    ----------
    modes : Modes
        From `Aircraft.modes`, `Modes` or `single_dof`.
    tracks : Profile or mapping of str to Profile
        One profile for all gears, or profiles by gear name; gears not named run on level ground.
    speed : float
        Ground speed, constant, > 0 [length/time].
    times : array_like, shape (n,), optional
        Times at which to sample, never decreasing [time]. Default: every breakpoint of every gear
        and at least 20 points per period of the fastest mode. Where results jump after the first
        time, both sides are sampled: the last instant before, and the time of the jump with what
        follows. They jump at vertical steps and, under dampers with `damping_input`, wherever a
        slope changes.
    duration : float, optional
        End of the default times [time]. Default: 5 after the last gear has passed the last
        breakpoint.
    damping_input : bool
        Whether the gears' dampers take part in the ground input and the loads, the terms
        C₁u̇ of Eq. 12 and c(u̇_P - u̇) of Eqs. 2 and 16. The report drops them, and so does the
        default. That is not safe where gears are strongly damped, or steep ramps are taken fast:
        over the full mat the bounce model's largest load (`single_dof`) is then too low by 0.02,
        0.02 and 9.1 % with 1 % damping at 20, 60 and 100 knots, and by 14, 37 and 50 % with 10 %;
        over random runways hardly at all with 1 %. The terms come from `Gear.damping`, not from
        the damping ratios.

    Returns
    -------
    Response
        Motion and loads.

    Raises
    ------
    InputError
        If an argument is of the wrong kind or out of range, a gear name is unknown, or both
        `times` and `duration` are given.
    NumericalError
        If a result leaves the range of double precision.

    Notes
    -----
    The runway is level before the first and after the last breakpoint: a survey on a grade begins
    and ends with a kink whose loads may be the largest of the run. `Profile.detrended` removes the
    grade.

    With `damping_input`, a vertical step under a damped gear gives the aircraft an impulse. The
    infinite load of that instant is not part of the results, so a sharp edge may seem milder than
    a steep ramp: model the edge as a ramp, or apply `Profile.footprint`.

    Dampers act across strut and tire together, so the tire does not smooth the ground for them: an
    elevation that is wrong by e, at one station h from the next, changes a load by
    c · speed · e / h, 12.6 kN a millimetre at 45 kN·s/m, 70 m/s and 0.25 m. Over a raw survey with
    `damping_input`, apply `Profile.footprint`, and check with a nonlinear gear that has an unsprung
    mass.

    Long runs, from some 5e5 breakpoints of all gears on, and what is read off them later use a
    second processor core where there is one; the results have the same bits. Processes that share
    the cores with others like them are faster with ``RAYON_NUM_THREADS=1`` in their environment.

    Examples
    --------
    The full mat at 20 knots (the report's Figure 10):

    >>> import runway_modal as rm
    >>> response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    >>> response.extremes().max_load.round(-2)
    array([12900., 43700., 43700.])
    """
    check_modes("modes", modes)
    damping_input = flag("damping_input", damping_input)
    names, speed = modes.aircraft.gear_names, number("speed", speed)
    profiles = by_gear(names, tracks)
    run = _core.Run(modes._core, [one._core for one in profiles], speed, damping_input)
    if times is not None and duration is not None:
        raise InputError("give either times or duration, not both")
    span = None if duration is None else number("duration", duration)
    by_name = dict(zip(names, profiles, strict=True))
    again = partial(simulate, modes, by_name, speed, damping_input=damping_input)
    return Response(run, modes, again, times=times, duration=span)
