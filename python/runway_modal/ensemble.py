"""Many runs at once: extremes and root mean squares, without time histories."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _core
from ._core import InputError
from ._input import (
    any_array,
    array,
    entries,
    flag,
    in_order,
    integer,
    number,
    one_of,
    one_or_each,
    read_only,
    refuse,
    refuse_masked,
)
from ._intervals import ranks, shares, student
from ._pickled import Pickled
from ._quantities import DIMENSIONS, DOWNWARD, column_of, names_of
from ._setups import describe, difference
from ._text import table
from .modes import Modes, check_modes

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from .aircraft import Aircraft
    from .units import Units


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Estimate(Pickled):
    """
    Estimates from a sample of runs, with confidence intervals.

    Returned by `Ensemble.mean`, `Ensemble.quantile` and `Ensemble.exceedance`.

    Parameters
    ----------
    names : tuple of str
        The gears or stations, in the order of the columns.
    asked : ndarray, shape (k,)
        Probabilities or levels asked for, in the order of the rows; NaN for a mean.
    value : ndarray, shape (k, c)
        Estimates: one row per probability or level, or a single row for a mean; one column per
        gear or station.
    low : ndarray, shape (k, c)
        Lower ends of the intervals; -inf where runs are too few for a bound.
    high : ndarray, shape (k, c)
        Upper ends; inf where runs are too few for a bound.

    Examples
    --------
    >>> import numpy as np, runway_modal as rm
    >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
    >>> ensemble = rm.simulate_many(rm.f4e().modes(0.01), runways, 12.0, rm.knots(60))
    >>> median = ensemble.quantile("max_load", 0.5)
    >>> bool((median.low < median.value).all() and (median.value < median.high).all())
    True
    >>> ensemble.exceedance("max_load", 27e3)
                 nose       left      right
    27000           0       0.38       0.38
      from          0   0.246501   0.246501
      to    0.0711217   0.528251   0.528251
    """

    names: tuple[str, ...]
    asked: NDArray[np.float64]
    value: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]

    def __repr__(self) -> str:
        """Make a table: each row followed by its interval."""
        rows: list[tuple[str | float, ...]] = [("", *self.names)]
        for asked, *parts in zip(self.asked, self.value, self.low, self.high, strict=True):
            heads = ("mean" if np.isnan(asked) else f"{asked:g}", "  from", "  to")
            rows += [(head, *part) for head, part in zip(heads, parts, strict=True)]
        return table(rows)

    def to_pandas(self) -> pd.DataFrame:
        """
        Make a table, one row per estimate (extra ``tables``).

        Returns
        -------
        pandas.DataFrame
            Columns asked, at (the gear or station), value, low and high.

        Raises
        ------
        ImportError
            If pandas is not installed.

        Examples
        --------
        >>> import numpy as np, runway_modal as rm
        >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
        >>> ensemble = rm.simulate_many(rm.f4e().modes(0.01), runways, 12.0, rm.knots(60))
        >>> table = ensemble.quantile("max_load", [0.5, 0.9]).to_pandas()
        >>> table[table["at"] == "left"].round({"value": -2, "low": -2, "high": -2})
           asked    at    value      low     high
        1    0.5  left  26700.0  26600.0  27100.0
        4    0.9  left  28000.0  27500.0  29200.0
        """
        from .tables_ensemble import estimate_to_pandas

        return estimate_to_pandas(self)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ensemble(Pickled):
    """
    Statistics of many runs, one row per run.

    Returned by `simulate_many` and `monte_carlo`. A run that could not be computed holds NaN and
    is listed in `failures`; means, quantiles, exceedances and the worst runs leave it out. Arrays
    are read-only.

    Parameters
    ----------
    gear_names : tuple of str
        Names of the gears, in the order of the columns.
    setup : mapping
        What all runs share, in plain numbers and words; `merge` compares it.
    run : ndarray, shape (n,)
        Numbers of the runs.
    speed : ndarray, shape (n,)
        Ground speeds [length/time].
    static_load : ndarray, shape (n, g)
        Static loads [force].
    max_load : ndarray, shape (n, g)
        Largest compression load of each gear, between stations too [force].
    min_load : ndarray, shape (n, g)
        Smallest compression load of each gear, between stations too [force].
    rms_load : ndarray, shape (n, g)
        Root mean square over time of the dynamic load (load minus static load) [force].
    max_acceleration : dict of str to ndarray, shape (n,)
        Largest magnitude of vertical acceleration at each station [length/time²].
    rms_acceleration : dict of str to ndarray, shape (n,)
        Root mean square over time of the vertical acceleration there [length/time²].
    failures : dict of int to str
        Why runs could not be computed, by run number.

    Examples
    --------
    >>> import numpy as np, runway_modal as rm
    >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
    >>> rm.simulate_many(rm.f4e().modes(0.01), runways, 12.0, rm.knots(60))
    <Ensemble: 50 runs, gears nose, left, right, none failed>
    """

    gear_names: tuple[str, ...]
    setup: Mapping[str, Any]
    run: NDArray[np.int64]
    speed: NDArray[np.float64]
    static_load: NDArray[np.float64]
    max_load: NDArray[np.float64]
    min_load: NDArray[np.float64]
    rms_load: NDArray[np.float64]
    max_acceleration: dict[str, NDArray[np.float64]]
    rms_acceleration: dict[str, NDArray[np.float64]]
    failures: dict[int, str]

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Whether each run could be computed, shape (n,)."""
        return read_only(~np.isnan(self.max_load[:, 0]))

    @property
    def unloaded(self) -> NDArray[np.bool_]:
        """
        Whether each gear's load reaches zero in a run, shape (n, g).

        Beyond that the linear model, in which a gear may pull on the runway, does not hold.
        """
        return read_only(self.min_load <= 0.0)

    def merge(self, other: Ensemble) -> Ensemble:
        """
        Merge two parts of one ensemble, in the order of their run numbers.

        Parameters
        ----------
        other : Ensemble
            Other runs of the same set-up.

        Returns
        -------
        Ensemble
            The runs of both.

        Raises
        ------
        InputError
            If `other` is not an `Ensemble`, the set-ups differ or a run is in both.

        Examples
        --------
        >>> import numpy as np, runway_modal as rm
        >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
        >>> def roll(part, first_run):
        ...     modes = rm.f4e().modes(0.01)
        ...     return rm.simulate_many(modes, part, 12.0, rm.knots(60), first_run=first_run)
        >>> roll(runways[30:], 30).merge(roll(runways[:30], 0))
        <Ensemble: 50 runs, gears nose, left, right, none failed>
        """
        if not isinstance(other, Ensemble):
            raise InputError(f"other = {other!r} is not an Ensemble")
        differ = difference(dict(self.setup), dict(other.setup))
        if differ:
            raise InputError("merge: {} is {!r} here and {!r} there".format(*differ))
        run = np.concatenate((self.run, other.run))
        order = np.argsort(run, kind="stable")
        twice = np.flatnonzero(np.diff(run[order]) == 0)
        if twice.size:
            raise InputError(f"merge: run {run[order][twice[0]]} is in both")

        def both(mine: NDArray[Any], theirs: NDArray[Any]) -> NDArray[Any]:
            return read_only(np.concatenate((mine, theirs))[order])

        def each(
            mine: dict[str, NDArray[np.float64]], theirs: dict[str, NDArray[np.float64]]
        ) -> dict[str, NDArray[np.float64]]:
            return {name: both(column, theirs[name]) for name, column in mine.items()}

        return Ensemble(
            gear_names=self.gear_names,
            setup=self.setup,
            run=read_only(run[order]),
            speed=both(self.speed, other.speed),
            static_load=both(self.static_load, other.static_load),
            max_load=both(self.max_load, other.max_load),
            min_load=both(self.min_load, other.min_load),
            rms_load=both(self.rms_load, other.rms_load),
            max_acceleration=each(self.max_acceleration, other.max_acceleration),
            rms_acceleration=each(self.rms_acceleration, other.rms_acceleration),
            failures=dict(sorted({**self.failures, **other.failures}.items())),
        )

    def _of(self, quantity: str) -> NDArray[np.float64]:
        """Values of a quantity, one row per run, one column per gear or station."""
        values = getattr(self, one_of("quantity", quantity, DIMENSIONS))
        return np.column_stack(list(values.values())) if isinstance(values, dict) else values

    def _sorted(self, quantity: str) -> NDArray[np.float64]:
        """Values of a quantity over the valid runs, ascending, one column per gear or station."""
        values = self._of(quantity)[self.valid]
        if values.shape[0] == 0:
            raise InputError("no run could be computed")
        return np.asarray(np.sort(values, axis=0))

    def mean(self, quantity: str, *, confidence: float = 0.95) -> Estimate:
        """
        Estimate the mean over all runways, with Student's interval.

        It is exact for normal values, and for any others if runs are many.

        Parameters
        ----------
        quantity : str
            One of "max_load", "min_load", "rms_load", "max_acceleration", "rms_acceleration".
        confidence : float
            Probability that an interval contains the true mean [-].

        Returns
        -------
        Estimate
            One row, one column per gear or station; a single run gives no finite interval.

        Raises
        ------
        InputError
            If the quantity is unknown, no run could be computed or `confidence` is not between 0
            and 1.

        Examples
        --------
        >>> import numpy as np, runway_modal as rm
        >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
        >>> ensemble = rm.simulate_many(rm.f4e().modes(0.01), runways, 12.0, rm.knots(60))
        >>> ensemble.mean("max_load").value.round(-2)
        array([[ 9500., 26900., 26900.]])
        """
        values, tail = self._sorted(quantity), _tail(confidence)
        runs = values.shape[0]
        mean = values.mean(axis=0, keepdims=True)
        half = np.full_like(mean, np.inf)
        if runs > 1:
            error = values.std(axis=0, ddof=1, keepdims=True) / math.sqrt(runs)
            half = student(tail, runs - 1) * error
        return Estimate(
            names=names_of(self, quantity),
            asked=read_only(np.array([np.nan])),
            value=read_only(mean),
            low=read_only(mean - half),
            high=read_only(mean + half),
        )

    def quantile(
        self, quantity: str, probability: ArrayLike, *, confidence: float = 0.95
    ) -> Estimate:
        """
        Estimate quantiles, with intervals that assume no distribution.

        The interval lies between two order statistics: the number of runs below a quantile is
        binomial, whatever the distribution (David and Nagaraja, *Order Statistics*, 7.1).

        Parameters
        ----------
        quantity : str
            One of "max_load", "min_load", "rms_load", "max_acceleration", "rms_acceleration".
        probability : array_like, shape (k,), or float
            Share of the runs below, between 0 and 1 [-].
        confidence : float
            Least probability that an interval contains the true quantile [-].

        Returns
        -------
        Estimate
            One row per probability, one column per gear or station.

        Raises
        ------
        InputError
            If the quantity is unknown, a probability or `confidence` is not between 0 and 1, or
            no run could be computed.

        Examples
        --------
        >>> import numpy as np, runway_modal as rm
        >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
        >>> ensemble = rm.simulate_many(rm.f4e().modes(0.01), runways, 12.0, rm.knots(60))
        >>> ensemble.quantile("max_load", [0.5, 0.999]).high[:, 0].round(-2)
        array([9500.,   inf])
        """
        values = self._sorted(quantity)
        runs = values.shape[0]
        asked = np.atleast_1d(_between_0_and_1("probability", probability))
        if asked.ndim > 1:
            raise InputError(f"probability has shape {asked.shape}, 1 dimension(s) expected")
        tail = _tail(confidence)
        bounded = np.concatenate(
            (np.full_like(values[:1], -np.inf), values, np.full_like(values[:1], np.inf))
        )
        enclosing = np.array([ranks(runs, float(p), tail) for p in asked], int).reshape(-1, 2)
        low, high = (bounded[rank] for rank in enclosing.T)
        return Estimate(
            names=names_of(self, quantity),
            asked=read_only(asked.copy()),
            # Of few runs the largest may lie below the quantile, and an interpolation below that.
            value=read_only(np.quantile(values, asked, axis=0).clip(low, high)),
            low=read_only(low),
            high=read_only(high),
        )

    def exceedance(self, quantity: str, level: ArrayLike, *, confidence: float = 0.95) -> Estimate:
        """
        Estimate the probability of exceeding a level (for `min_load`: of being at or below it).

        The interval holds the probabilities for which the number of runs observed would not be
        surprising (Clopper and Pearson, 1934). `plot_exceedance` draws both.

        Parameters
        ----------
        quantity : str
            One of "max_load", "min_load", "rms_load", "max_acceleration", "rms_acceleration".
        level : array_like, shape (k,), or float
            Levels, in the unit of the quantity.
        confidence : float
            Least probability that an interval contains the true probability [-].

        Returns
        -------
        Estimate
            One row per level, one column per gear or station.

        Raises
        ------
        InputError
            If the quantity is unknown, a level is not a number, `confidence` is not between 0 and
            1, or no run could be computed.

        Examples
        --------
        >>> import numpy as np, runway_modal as rm
        >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
        >>> ensemble = rm.simulate_many(rm.f4e().modes(0.01), runways, 12.0, rm.knots(60))
        >>> ensemble.exceedance("max_load", 10_000.0).value.round(2)
        array([[0., 1., 1.]])
        """
        values = self._sorted(quantity)
        runs = values.shape[0]
        levels = array("level", np.atleast_1d(any_array("level", level)))
        refuse("level", levels, np.isnan(levels), "is not a number")
        count = np.array(
            [[np.searchsorted(c, one, side="right") for c in values.T] for one in levels], int
        ).reshape(levels.size, values.shape[1])
        if quantity not in DOWNWARD:
            count = runs - count
        low, high = shares(count, runs, _tail(confidence))
        return Estimate(
            names=names_of(self, quantity),
            asked=read_only(levels.copy()),
            value=read_only(count / runs),
            low=read_only(low),
            high=read_only(high),
        )

    def worst(self, at: str, count: int = 10, *, quantity: str = "max_load") -> NDArray[np.int64]:
        """
        List the runs that are worst for a gear or station, worst first.

        The worst runs have the largest values, or for `min_load` the smallest.

        Parameters
        ----------
        at : str
            Name of the gear, or of the station for accelerations.
        count : int
            Number of runs to list.
        quantity : str
            One of "max_load", "min_load", "rms_load", "max_acceleration", "rms_acceleration".

        Returns
        -------
        ndarray, shape (count,)
            Run numbers; fewer if there are fewer runs.

        Raises
        ------
        InputError
            If there is no such gear, station or quantity, or `count` is not a whole number ≥ 0.

        Examples
        --------
        Run numbers are not row numbers unless the first run is 0:

        >>> import numpy as np, runway_modal as rm
        >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
        >>> modes, speed = rm.f4e().modes(0.01), rm.knots(60)
        >>> ensemble = rm.simulate_many(modes, runways, 12.0, speed, first_run=700)
        >>> worst = ensemble.worst("left", 1)[0]
        >>> row = np.flatnonzero(ensemble.run == worst)[0]
        >>> bool(ensemble.max_load[row, 1] == ensemble.max_load[:, 1].max())
        True
        """
        values = self._of(quantity)
        at_column = column_of(quantity, at, self.gear_names, tuple(self.max_acceleration))
        column = values[self.valid, at_column]
        rising = column if quantity in DOWNWARD else -column
        order = np.argsort(rising, kind="stable")[: integer("count", count, 0)]
        return read_only(self.run[self.valid][order])

    def plot(
        self,
        quantity: str = "max_load",
        names: Sequence[str] | None = None,
        *,
        ax: Axes | None = None,
        units: Units | None = None,
    ) -> Axes:
        """
        Draw a histogram of a quantity for each gear or station; load extremes with static loads.

        Parameters
        ----------
        quantity : str
            One of "max_load", "min_load", "rms_load", "max_acceleration", "rms_acceleration".
        names : sequence of str, optional
            Gears or stations to draw. Default: all.
        ax : matplotlib.axes.Axes, optional
            Axes to draw on. Default: those of a new figure.
        units : Units, optional
            Units of the ensemble, for the axis labels: loads in lbf and N are drawn in kip and kN,
            accelerations in g.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        InputError
            If there is no such quantity, gear or station, no run could be computed, or `units` is
            not a `Units`.
        ImportError
            If matplotlib is not installed.

        Examples
        --------
        >>> import numpy as np, runway_modal as rm
        >>> from matplotlib.figure import Figure
        >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
        >>> ensemble = rm.simulate_many(rm.f4e().modes(0.01), runways, 12.0, rm.knots(60))
        >>> axes = Figure().subplots()
        >>> ensemble.plot("max_load", ax=axes, units=rm.Units("in", "lbf")).get_xlabel()
        'largest load [kip]'
        """
        from .plotting_ensemble import plot_histogram

        return plot_histogram(self, quantity, names, ax, units)

    def plot_exceedance(
        self,
        quantity: str = "max_load",
        names: Sequence[str] | None = None,
        *,
        confidence: float = 0.95,
        ax: Axes | None = None,
        units: Units | None = None,
    ) -> Axes:
        """
        Draw the probability of exceeding a level, with its confidence band.

        For `min_load`, the probability of being at or below it. The band is that of `exceedance`
        at each level.

        Parameters
        ----------
        quantity : str
            One of "max_load", "min_load", "rms_load", "max_acceleration", "rms_acceleration".
        names : sequence of str, optional
            Gears or stations to draw. Default: all.
        confidence : float
            Approximate probability that the band contains the true curve at a level [-].
        ax : matplotlib.axes.Axes, optional
            Axes to draw on. Default: those of a new figure.
        units : Units, optional
            As for `plot`.

        Returns
        -------
        matplotlib.axes.Axes
            The axes, with probability on a logarithmic scale.

        Raises
        ------
        InputError
            As for `plot`, or if `confidence` is not between 0 and 1.
        ImportError
            If matplotlib is not installed.

        Examples
        --------
        >>> import numpy as np, runway_modal as rm
        >>> from matplotlib.figure import Figure
        >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
        >>> ensemble = rm.simulate_many(rm.f4e().modes(0.01), runways, 12.0, rm.knots(60))
        >>> ensemble.plot_exceedance("max_load", ["left"], ax=Figure().subplots()).get_yscale()
        'log'
        """
        from .plotting_ensemble import plot_exceedance

        return plot_exceedance(self, quantity, names, confidence, ax, units)

    def to_pandas(self, units: Units | None = None) -> pd.DataFrame:
        """
        Make a table, one row per run (extra ``tables``).

        Parameters
        ----------
        units : Units, optional
            Units of the ensemble, kept in ``attrs["units"]`` by column; Parquet files keep them.

        Returns
        -------
        pandas.DataFrame
            Indexed by run number; columns such as ``max_load_nose``.

        Raises
        ------
        InputError
            If `units` is not a `Units`.
        ImportError
            If pandas is not installed.

        Examples
        --------
        >>> import numpy as np, runway_modal as rm
        >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
        >>> ensemble = rm.simulate_many(rm.f4e().modes(0.01), runways, 12.0, rm.knots(60))
        >>> ensemble.to_pandas().shape
        (50, 15)
        """
        from .tables_ensemble import to_pandas

        return to_pandas(self, units)

    def to_xarray(self, units: Units | None = None) -> xr.Dataset:
        """
        Make a data set of the runs with named gears and stations (extra ``tables``).

        Parameters
        ----------
        units : Units, optional
            Units of the ensemble, kept in ``attrs["units"]`` of every variable.

        Returns
        -------
        xarray.Dataset
            Variables speed, static_load, max_load, min_load, rms_load, max_acceleration and
            rms_acceleration over run, gear and station.

        Raises
        ------
        InputError
            If `units` is not a `Units`.
        ImportError
            If xarray is not installed.

        Examples
        --------
        >>> import numpy as np, runway_modal as rm
        >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
        >>> ensemble = rm.simulate_many(rm.f4e().modes(0.01), runways, 12.0, rm.knots(60))
        >>> ensemble.to_xarray()["max_load"].sel(gear="left").dims
        ('run',)
        """
        from .tables_ensemble import to_xarray

        return to_xarray(self, units)

    def __len__(self) -> int:
        """Count the runs."""
        return int(self.run.size)

    def __repr__(self) -> str:
        """Tell how many runs, which gears, how many failures."""
        failed = f"{len(self.failures)} failed" if self.failures else "none failed"
        return f"<Ensemble: {len(self)} runs, gears {', '.join(self.gear_names)}, {failed}>"


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
    """
    Roll an aircraft over many equally spaced profiles; exact in continuous time, like `simulate`.

    Only extremes and root mean squares are kept. They cover the time from t = 0, when the foremost
    gear is at the first station, until the last gear passes the last station. Extremes are true,
    between stations too, and mean squares are closed-form integrals. Where loads jump, under
    dampers with `damping_input`, both sides count: at the first station the static load.

    A gear's distance behind the foremost one need not be a multiple of the spacing. A run gives the
    same bits alone, in any batch and on any number of threads (one per core, unless the environment
    variable ``RAYON_NUM_THREADS`` sets another number).

    Parameters
    ----------
    modes : Modes or sequence of Modes
        One for all runs, or one per run, of aircraft with the same gear and station names.
    elevations : array_like, shape (n, t, s)
        Elevations of n runs at s stations, the first station at 0: t = 1 track under all gears,
        or one per gear in the aircraft's order. float64, or float32 to save memory; the
        computation is in float64 [length].
    spacing : float
        Distance between stations, > 0 [length].
    speed : float or array_like, shape (n,)
        Ground speed, one for all runs or one per run, > 0 [length/time].
    damping_input : bool
        Whether the gears' dampers take part in the ground input and the loads, as in `simulate`.
    on_error : {"raise", "mask"}
        What to do about runs with an elevation that is not finite, or a result that leaves the
        range of double precision: raise for the first, or keep the other runs and mark these with
        NaN and in `Ensemble.failures`. Speeds out of range are refused in either case.
    first_run : int
        Number of the first run.

    Returns
    -------
    Ensemble
        One row per run.

    Raises
    ------
    InputError
        If an argument is of the wrong kind, shape or range.
    NumericalError
        If a result leaves the range of double precision, unless that run is to be masked.

    Notes
    -----
    With `damping_input` a load jumps where a slope begins or ends; at the last station both sides
    count. Where a mode is damped far beyond critical, the mean square of an acceleration is a
    difference of terms about ζ⁴ times as large: the relative error of `rms_acceleration` is 1e-13
    at a damping ratio of 3 and 1e-10 at 100. With more gears than the aircraft has degrees of
    freedom, `rms_load` loses digits where a spacing lasts many periods: in an example of three
    gears on the centreline 2e-12 of itself at 10 s a spacing, 4e-10 at 100 s.

    Examples
    --------
    >>> import numpy as np, runway_modal as rm
    >>> runways = np.random.default_rng(1).normal(scale=0.1, size=(50, 1, 200))
    >>> ensemble = rm.simulate_many(rm.f4e().modes(0.01), runways, 12.0, rm.knots(60))
    >>> ensemble.max_load.mean(axis=0).round(-2)
    array([ 9500., 26900., 26900.])
    """
    if not isinstance(modes, Iterable):
        check_modes("modes", modes)
    each = [modes] if isinstance(modes, Modes) else list(modes)
    given = _elevations(elevations)
    runs, tracks, count = given.shape
    _check_modes(each, one=isinstance(modes, Modes), runs=runs)
    damping_input = flag("damping_input", damping_input)
    mask = masks(on_error)
    # Run numbers of ensembles have 63 bits.
    first_run = integer("first_run", first_run, 0, 2**63 - runs + 1)
    speeds = one_or_each("speed", speed, runs)
    names = list(each[0].aircraft.stations)
    h = number("spacing", spacing)
    results, failed = _core.simulate_many(
        [(one._core, np.array(list(one.aircraft.stations.values()))) for one in each],
        given,
        h,
        speeds.tolist(),
        damping_input,
        mask,
    )
    of_modes = describe(each[0])
    if not isinstance(modes, Modes):
        gears = list(each[0].aircraft.gear_names)
        of_modes = {"gears": gears, "stations": names, "modes": "one per run"}
    setup = {
        **of_modes,
        "tracks": tracks,
        "station_count": count,
        "spacing": h,
        "damping_input": damping_input,
    }
    static = np.stack([one.aircraft.static_load for one in each])
    return assembled(each[0].aircraft, results, failed, setup, first_run, speeds, static)


def assembled(
    aircraft: Aircraft,
    results: Sequence[NDArray[np.float64]],
    failed: Iterable[tuple[int, str]],
    setup: dict[str, Any],
    first_run: int,
    speeds: NDArray[np.float64],
    static: NDArray[np.float64],
) -> Ensemble:
    """Make an ensemble of what the core gives; speeds and static loads may be of all runs alike."""
    max_load, min_load, rms_load, max_acceleration, rms_acceleration = map(read_only, results)
    runs = len(max_load)

    def by_station(columns: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        return {name: columns[:, i] for i, name in enumerate(aircraft.stations)}

    return Ensemble(
        gear_names=aircraft.gear_names,
        setup=setup,
        run=read_only(np.arange(first_run, first_run + runs, dtype=np.int64)),
        # A copy: they may be the caller's own.
        speed=np.broadcast_to(speeds.copy(), runs),
        static_load=np.broadcast_to(static, max_load.shape),
        max_load=max_load,
        min_load=min_load,
        rms_load=rms_load,
        max_acceleration=by_station(max_acceleration),
        rms_acceleration=by_station(rms_acceleration),
        failures={first_run + run: reason for run, reason in failed},
    )


def _elevations(values: ArrayLike) -> NDArray[Any]:
    """Elevations as a C-ordered array of three dimensions, float32 or float64."""
    given = any_array("elevations", values)
    if given.dtype.kind not in "biuf":
        raise InputError(f"elevations holds {given.dtype}, not real numbers")
    refuse_masked("elevations", given)
    if given.ndim != 3 or 0 in given.shape:
        raise InputError(
            f"elevations has shape {given.shape}, (runs, tracks, stations) expected, none of them 0"
        )
    return in_order(given, np.float32 if given.dtype == np.float32 else np.float64)


def _check_modes(each: list[Modes], *, one: bool, runs: int) -> None:
    """Check that each is a Modes, and all are of aircraft with the same names."""
    if not one and len(each) != runs:
        hint = "; np.broadcast_to repeats one profile" if runs == 1 else ""
        raise InputError(f"modes has {entries(len(each))}, {runs} expected (one per run){hint}")
    for i, modes in enumerate(each):
        check_modes(f"modes[{i}]", modes)
        for kind in ("gear_names", "stations"):
            first, other = (tuple(getattr(m.aircraft, kind)) for m in (each[0], modes))
            if first != other:
                raise InputError(f"modes[{i}]: {kind} {other} differ from {first} of modes[0]")


def _tail(confidence: float) -> float:
    """Probability on either side of an interval."""
    confidence = number("confidence", confidence)
    return (1.0 - float(_between_0_and_1("confidence", confidence))) / 2.0


def masks(on_error: str) -> bool:
    """Check `on_error`: whether runs that give no result are masked."""
    return one_of("on_error", on_error, ("raise", "mask")) == "mask"


def _between_0_and_1(argument: str, values: ArrayLike) -> NDArray[np.float64]:
    """Check numbers strictly between 0 and 1."""
    given = array(argument, values, ndim=None)
    refuse(argument, given, ~((given > 0.0) & (given < 1.0)), "is not between 0 and 1")
    return given
