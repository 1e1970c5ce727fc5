"""Many runs at once: extremes and mean squares, without their histories."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from statistics import NormalDist
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _core
from ._core import InputError
from ._input import any_array, array, number, read_only
from .modes import Modes

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]

#: Results of which quantiles and exceedances are asked.
Quantity = Literal["max_load", "min_load", "rms_load", "max_acceleration", "rms_acceleration"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Estimate:
    """
    Numbers estimated from a sample of runs, with their confidence interval.

    Parameters
    ----------
    value : ndarray, shape (k, c)
        A row a probability or level asked for, a column a gear or station.
    low : ndarray, shape (k, c)
        Lower end of the interval; -inf where the runs are too few to tell.
    high : ndarray, shape (k, c)
        Upper end; inf where the runs are too few to tell.

    Examples
    --------
    >>> import numpy as np, runway_modal as rm
    >>> runway = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
    >>> ensemble = rm.simulate_many(rm.f4e().modes(0.01), runway, 12.0, rm.knots(60))
    >>> median = ensemble.quantile("max_load", 0.5)
    >>> bool((median.low < median.value).all() and (median.value < median.high).all())
    True
    """

    value: Floats
    low: Floats
    high: Floats


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ensemble:
    """
    What many runs come to: a row a run. `simulate_many` makes it.

    Runs that could not be computed hold NaN and are named in `failures`; statistics over runs
    leave them out. Arrays are read-only.

    Parameters
    ----------
    gear_names : tuple of str
        Names of the gears, in the order of the columns.
    setup : Mapping
        What all runs have in common, in plain numbers and words.
    run : ndarray, shape (n,)
        Numbers of the runs.
    speed : ndarray, shape (n,)
        Ground speeds [length/time].
    static_load : ndarray, shape (n, g)
        Static loads [force].
    max_load : ndarray, shape (n, g)
        Largest compression load of each gear, between stations too [force].
    min_load : ndarray, shape (n, g)
        Smallest compression load of each gear [force].
    rms_load : ndarray, shape (n, g)
        Root mean square over time of the dynamic load: load less static load [force].
    max_acceleration : dict of str to ndarray, shape (n,)
        Largest magnitude of vertical acceleration at each station of the aircraft [length/time²].
    rms_acceleration : dict of str to ndarray, shape (n,)
        Its root mean square over time [length/time²].
    failures : dict of int to str
        Why runs could not be computed, by run number.

    Examples
    --------
    >>> import numpy as np, runway_modal as rm
    >>> runway = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
    >>> ensemble = rm.simulate_many(rm.f4e().modes(0.01), runway, 12.0, rm.knots(60))
    >>> ensemble
    <Ensemble: 50 runs 0 to 49, gears nose, left, right, none failed>
    """

    gear_names: tuple[str, ...]
    setup: Mapping[str, Any]
    run: NDArray[np.int64]
    speed: Floats
    static_load: Floats
    max_load: Floats
    min_load: Floats
    rms_load: Floats
    max_acceleration: dict[str, Floats]
    rms_acceleration: dict[str, Floats]
    failures: dict[int, str]

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Whether each run could be computed, shape (n,)."""
        return ~np.isnan(self.max_load[:, 0])

    @property
    def unloaded(self) -> NDArray[np.bool_]:
        """
        Whether each gear's load reaches zero in a run, shape (n, g).

        Past that the linear model, in which a gear may pull on the runway, no longer holds.
        """
        return self.min_load <= 0.0

    @property
    def dynamic_load_coefficient(self) -> Floats:
        """RMS of the dynamic load ÷ static load of each gear, shape (n, g) [-]."""
        return self.rms_load / self.static_load

    def __len__(self) -> int:
        """Count the runs."""
        return self.run.size

    def __repr__(self) -> str:
        """Runs, gears, failures."""
        failed = f"{len(self.failures)} failed" if self.failures else "none failed"
        gears = ", ".join(self.gear_names)
        span = f"{self.run.min()} to {self.run.max()}"
        return f"<Ensemble: {len(self)} runs {span}, gears {gears}, {failed}>"


def simulate_many(
    modes: Modes | Sequence[Modes],
    elevations: ArrayLike,
    spacing: float,
    speed: ArrayLike,
    *,
    damping_input: bool = False,
    on_error: Literal["raise", "mask"] = "raise",
    first_run: int = 0,
) -> Ensemble:
    """Roll."""
    given = _elevations(elevations)
    runs = given.shape[0]
    one = isinstance(modes, Modes)
    each = [modes] if isinstance(modes, Modes) else list(modes)
    speeds = any_array("speed", speed)
    speeds = array("speed", speeds.reshape(1) if speeds.ndim == 0 else speeds)
    stations = [np.array(list(m.aircraft.stations.values())) for m in each]
    names = list(each[0].aircraft.stations)
    results, failed = _core.simulate_many(
        [m._core for m in each],
        given,
        number("spacing", spacing),
        speeds.tolist(),
        stations,
        bool(damping_input),
        on_error == "mask",
    )
    max_load, min_load, rms_load, max_acc, rms_acc = (read_only(result) for result in results)
    return Ensemble(
        gear_names=each[0].aircraft.gear_names,
        setup={},
        run=np.arange(first_run, first_run + runs),
        speed=np.broadcast_to(speeds, runs),
        static_load=np.broadcast_to([m.aircraft.static_load for m in each], max_load.shape),
        max_load=max_load,
        min_load=min_load,
        rms_load=rms_load,
        max_acceleration={name: max_acc[:, i] for i, name in enumerate(names)},
        rms_acceleration={name: rms_acc[:, i] for i, name in enumerate(names)},
        failures={first_run + run: why for run, why in failed},
    )


def _elevations(values: ArrayLike) -> NDArray[Any]:
    given = any_array("elevations", values)
    return np.ascontiguousarray(given)
