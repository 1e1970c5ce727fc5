"""A Monte Carlo, at once or in chunks of runs that can be computed anywhere, at any time."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, Literal, TypedDict

import numpy as np

from . import _core
from ._core import InputError, NumericalError
from ._input import flag, integer, one_or_each, refuse
from ._setups import describe
from .ensemble import assembled, masks
from .roughness import Roughness, lateral_positions, run_numbers

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from typing import NotRequired

    from numpy.typing import ArrayLike

    from .ensemble import Ensemble
    from .modes import Modes

#: Runs per chunk: seconds of work, a file of a few hundred kilobytes.
CHUNK = 4096


class Options(TypedDict):
    """Keyword arguments of `monte_carlo`."""

    length: float
    spacing: float
    speed: ArrayLike
    runs: int
    seed: int
    first_run: NotRequired[int]
    tracks: NotRequired[Literal["one", "isotropic"]]
    damping_input: NotRequired[bool]
    on_error: NotRequired[Literal["raise", "mask"]]


@dataclass(frozen=True)
class Chunk:
    """Some runs of a Monte Carlo, with all that a process needs to compute them."""

    modes: Modes
    roughness: Roughness
    options: Options

    @property
    def first_run(self) -> int:
        """Number of the first run."""
        return self.options.get("first_run", 0)

    def compute(self) -> Ensemble:
        """Compute the runs."""
        return roll(self.modes, self.roughness, **self.options)


def roll(
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
) -> Ensemble:
    """Compute all runs at once."""
    if not isinstance(roughness, Roughness):
        raise InputError(f"roughness = {roughness!r} is not a Roughness")
    damping_input = flag("damping_input", damping_input)
    mask = masks(on_error)
    runs, first_run = run_numbers(runs, first_run)
    y = lateral_positions(modes, tracks)
    generator = roughness._generator(length, spacing, seed, y)
    speeds = one_or_each("speed", speed, runs)
    points = np.array(list(modes.aircraft.stations.values()))
    results, failed = _core.monte_carlo(
        modes._core, generator, first_run, runs, speeds.tolist(), points, damping_input, mask
    )
    about = setup(
        modes,
        roughness,
        length=length,
        spacing=spacing,
        seed=seed,
        tracks=tracks,
        damping_input=damping_input,
    )
    static = modes.aircraft.static_load
    return assembled(modes.aircraft, results, failed, about, first_run, speeds, static)


def setup(
    modes: Modes,
    roughness: Roughness,
    *,
    length: float,
    spacing: float,
    seed: int,
    tracks: str = "one",
    damping_input: bool = False,
) -> dict[str, Any]:
    """List what the runs of one Monte Carlo share, in plain numbers for JSON."""
    made_of = roughness._rebuild[1]
    return {
        **describe(modes),
        "roughness": [np.asarray(part).tolist() for part in made_of],
        "length": float(length),
        "spacing": float(spacing),
        "seed": int(seed),
        "tracks": tracks,
        "damping_input": bool(damping_input),
    }


def chunks(modes: Modes, roughness: Roughness, options: Options, size: int) -> Iterator[Chunk]:
    """Cut a Monte Carlo into chunks of runs; faulty arguments are refused at once."""
    if not isinstance(roughness, Roughness):
        raise InputError(f"roughness = {roughness!r} is not a Roughness")
    for key in ("length", "spacing", "speed", "runs", "seed"):
        if key not in options:
            raise TypeError(f"monte_carlo() missing keyword argument: {key!r}")
    for key in options.keys() - Options.__annotations__:
        raise TypeError(f"monte_carlo() got an unexpected keyword argument: {key!r}")
    lateral_positions(modes, options.get("tracks", "one"))
    masks(options.get("on_error", "raise"))
    runs, first_run = run_numbers(options["runs"], options.get("first_run", 0))
    size = integer("chunk", size, 1)
    speed = one_or_each("speed", options["speed"], runs)
    given = speed.reshape(np.shape(options["speed"]))
    refuse("speed", given, ~((given > 0) & np.isfinite(given)), "is not positive and finite")

    def part(begin: int, end: int) -> Chunk:
        own = options.copy()
        own["speed"] = speed[begin:end] if given.ndim else speed[0]
        own["first_run"], own["runs"] = first_run + begin, end - begin
        return Chunk(modes, roughness, own)

    # Trial runs check the other arguments before any result is kept, with the speeds that are most
    # likely to be out of range.
    for row in sorted({int(given.argmin()), int(given.argmax())}):
        try:
            part(row, row + 1).compute()
        except InputError as error:
            # To it, this speed is the only one.
            named = f"speed[{row}] = " if given.ndim else "speed = "
            raise InputError(re.sub(r"^speed(\[0\])? = ", named, str(error))) from None
        except NumericalError:
            pass  # met again with its own number, or after the runs before it
    return (part(begin, min(begin + size, runs)) for begin in range(0, runs, size))


def told(
    parts: Iterable[Chunk], runs: int, progress: Callable[[int, int], object] | None
) -> Iterable[Chunk]:
    """Pass on the chunks of so many runs, telling `progress` of each that is done with."""
    if progress is None:
        return parts
    if not callable(progress):
        raise InputError(f"progress = {progress!r} cannot be called")
    return _telling(parts, runs, progress)


def _telling(
    parts: Iterable[Chunk], runs: int, progress: Callable[[int, int], object]
) -> Iterator[Chunk]:
    done = 0
    progress(done, runs)
    for part in parts:
        yield part
        done += part.options["runs"]
        progress(done, runs)


def joined(parts: Iterable[Ensemble]) -> Ensemble:
    """Merge the results of chunks in pairs of neighbours, so that no row is copied often."""
    waiting = list(parts)
    while len(waiting) > 1:
        pairs = zip_longest(waiting[::2], waiting[1::2])
        waiting = [one if other is None else one.merge(other) for one, other in pairs]
    return waiting[0]
