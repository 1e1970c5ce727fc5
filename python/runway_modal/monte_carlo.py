"""Runs over very many random profiles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from ._chunks import CHUNK, Options, chunks, joined, roll, told

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from .ensemble import Ensemble
    from .modes import Modes
    from .roughness import Roughness


def monte_carlo(
    modes: Modes,
    roughness: Roughness,
    *,
    length: float,
    spacing: float,
    speed: ArrayLike,
    runs: int,
    seed: int,
    first_run: int = 0,
    tracks: Literal["one", "isotropic"] = "one",
    damping_input: bool = False,
    on_error: Literal["raise", "mask"] = "raise",
    progress: Callable[[int, int], object] | None = None,
) -> Ensemble:
    """
    Roll an aircraft over random profiles, like `simulate_many` but without holding them in memory.

    Profiles are made, used and discarded block by block: only the results grow with the number of
    runs. A run is the same to the last bit in any batch, on any number of threads: a million runs
    can be split in any way, by `first_run`.

    Parameters
    ----------
    modes : Modes
        From `Aircraft.modes`, `Modes` or `single_dof`.
    roughness : Roughness
        The spectrum.
    length, spacing : float
        Length and spacing of the profiles, as for `Roughness.elevations` [length].
    speed : float or array_like, shape (runs,)
        Ground speed, > 0; one for all runs or one per run [length/time].
    runs : int
        Number of runs, > 0.
    seed : int
        Which of the 2⁶⁴ sets of runs to make; as for `Roughness.elevations`.
    first_run : int
        Number of the first run.
    tracks : {"one", "isotropic"}
        One track for all gears, or each gear's own on an isotropic surface.
    damping_input : bool
        As for `simulate`.
    on_error : {"raise", "mask"}
        What to do about runs with a result that leaves the range of double precision: raise for
        the first, or keep the other runs and mark these with NaN and in `Ensemble.failures`.
        Speeds out of range are refused in either case.
    progress : callable, optional
        Called with the numbers of runs finished and wanted, before the first and after every
        4096 runs; it does not change the result.

    Returns
    -------
    Ensemble
        One row per run. `Roughness.profiles` makes the profiles of any of them again.

    Raises
    ------
    InputError
        If an argument is of the wrong kind or out of range.
    NumericalError
        If a result leaves the range of double precision, unless that run is to be masked.

    Notes
    -----
    Statistics cover the time from the start, at rest in equilibrium, until the last gear passes the
    last station. They include the growth of the motion from rest, which takes about 1/(ζω) of the
    slowest mode; for stationary values the length must be many times speed/(ζω).

    Examples
    --------
    >>> import runway_modal as rm
    >>> surface = rm.Roughness.iso8608("B", unit="in")
    >>> runway = dict(length=12000.0, spacing=10.0, seed=1980)
    >>> modes = rm.f4e().modes(0.05)
    >>> ensemble = rm.monte_carlo(modes, surface, speed=rm.knots(60), runs=100, **runway)

    The worst run again, over the same time: by default `simulate` continues for 5 s, and on the
    level behind a random runway a load may exceed all before. (With `damping_input` a load jumps
    at the last station; both sides count here, and a duration rounded down may miss the second.)

    >>> worst = int(ensemble.worst("nose", 1)[0])
    >>> profiles = surface.profiles(modes, worst, **runway)
    >>> wheelbase = 234.9 + 44.35
    >>> duration = (runway["length"] + wheelbase) / rm.knots(60)
    >>> response = rm.simulate(modes, profiles, rm.knots(60), duration=duration)
    >>> again = response.extremes().max_load[0] / ensemble.max_load[worst, 0]
    >>> bool(abs(again - 1) < 1e-9)
    True
    """
    options: Options = {
        "length": length,
        "spacing": spacing,
        "speed": speed,
        "runs": runs,
        "seed": seed,
        "first_run": first_run,
        "tracks": tracks,
        "damping_input": damping_input,
        "on_error": on_error,
    }
    if progress is None:
        return roll(modes, roughness, **options)
    parts = told(chunks(modes, roughness, options, CHUNK), int(options["runs"]), progress)
    return joined(part.compute() for part in parts)
