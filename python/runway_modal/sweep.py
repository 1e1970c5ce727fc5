"""One aircraft over one runway at many speeds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from . import _core
from ._core import InputError
from ._input import any_array, array, flag, integer, number, one_of, read_only
from ._pickled import Pickled
from ._quantities import column_of
from ._tracks import by_gear
from .extremes import positions, station_positions
from .modes import Modes, check_modes

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from .aircraft import Aircraft
    from .profile import Profile
    from .units import Units


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sweep(Pickled):
    """
    True extremes of a response, speed by speed, between samples too.

    Returned by `sweep`.

    Parameters
    ----------
    modes : Modes
        The modes of all runs.
    speed : ndarray, shape (s,)
        Ground speeds, in the order given [length/time].
    max_load : ndarray, shape (s, g)
        Largest compression load of each gear [force].
    time_of_max : ndarray, shape (s, g)
        When it occurs [time].
    min_load : ndarray, shape (s, g)
        Smallest compression load of each gear; ≤ 0 where the gear unloads [force].
    time_of_min : ndarray, shape (s, g)
        When it occurs [time].
    max_acceleration : dict of str to ndarray, shape (s,)
        Largest magnitude of vertical acceleration at each station [length/time²].
    time_of_max_acceleration : dict of str to ndarray, shape (s,)
        When it occurs [time].

    Examples
    --------
    >>> import runway_modal as rm
    >>> sweep = rm.sweep(rm.f4e().modes(0.01), rm.Profile.full_mat(), [200.0, 400.0, 800.0])
    >>> sweep.max_load.shape
    (3, 3)
    """

    modes: Modes
    speed: NDArray[np.float64]
    max_load: NDArray[np.float64]
    time_of_max: NDArray[np.float64]
    min_load: NDArray[np.float64]
    time_of_min: NDArray[np.float64]
    max_acceleration: dict[str, NDArray[np.float64]]
    time_of_max_acceleration: dict[str, NDArray[np.float64]]

    @property
    def aircraft(self) -> Aircraft:
        """The aircraft of all runs."""
        return self.modes.aircraft

    @property
    def gear_names(self) -> tuple[str, ...]:
        """Names of the gears, in the order of the columns."""
        return self.aircraft.gear_names

    @property
    def static_load(self) -> NDArray[np.float64]:
        """Compression load of each gear in equilibrium on a level runway, shape (g,) [force]."""
        return self.aircraft.static_load

    @property
    def position_of_max(self) -> NDArray[np.float64]:
        """Station of the runway under each gear at its largest load, shape (s, g) [length]."""
        return positions(self.aircraft, self.speed[:, None], self.time_of_max)

    @property
    def position_of_min(self) -> NDArray[np.float64]:
        """Station of the runway under each gear at its smallest load, shape (s, g) [length]."""
        return positions(self.aircraft, self.speed[:, None], self.time_of_min)

    @property
    def position_of_max_acceleration(self) -> dict[str, NDArray[np.float64]]:
        """Station of the runway below each point at its largest acceleration [length]."""
        times = self.time_of_max_acceleration
        return station_positions(self.aircraft, self.speed, times)

    @property
    def unloaded(self) -> NDArray[np.bool_]:
        """
        Whether each gear's load reaches zero, shape (s, g).

        Beyond that the linear model, in which a gear may pull on the runway, does not hold.
        """
        return read_only(self.min_load <= 0.0)

    def plot(
        self,
        gears: Sequence[str] | None = None,
        *,
        label: str = "",
        ax: Axes | None = None,
        units: Units | None = None,
    ) -> Axes:
        """
        Draw largest and smallest gear loads against speed, each gear with its static load.

        Parameters
        ----------
        gears : sequence of str, optional
            Gears to draw. Default: all.
        label : str
            What to put before the names in the legend, to tell runs on the same axes apart.
        ax : matplotlib.axes.Axes, optional
            Axes to draw on. Default: those of a new figure.
        units : Units, optional
            Units of the sweep, for the axis labels: speeds are drawn in knots, loads in lbf and N
            in kip and kN.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        InputError
            If a gear is unknown, `gears` is empty or a single name, `label` is not text, or
            `units` is not a `Units`.
        ImportError
            If matplotlib is not installed.

        Examples
        --------
        >>> import runway_modal as rm
        >>> from matplotlib.figure import Figure
        >>> from runway_modal.units import Units
        >>> sweep = rm.sweep(rm.f4e().modes(0.01), rm.Profile.full_mat(), [200.0, 400.0, 800.0])
        >>> sweep.plot(["left"], ax=Figure().subplots(), units=Units("in", "lbf")).get_xlabel()
        'ground speed [kt]'
        """
        from .plotting_sweep import plot_loads

        return plot_loads(self, gears, label, ax, units)

    def plot_acceleration(
        self,
        stations: Sequence[str] | None = None,
        *,
        label: str = "",
        ax: Axes | None = None,
        units: Units | None = None,
    ) -> Axes:
        """
        Draw the largest vertical acceleration against speed, in g, with a line at 0.4 g.

        The line is the limit of ±0.4 g at the pilot's station and the centre of gravity
        (published: Morris and Hall, NASA 1965; Navy CEL TR-846, 1976). The g is standard
        gravity or, without `units`, the aircraft's.

        Parameters
        ----------
        stations : sequence of str, optional
            Stations of `Aircraft.stations` to draw. Default: all.
        label : str
            What to put before the names in the legend, to tell runs on the same axes apart.
        ax : matplotlib.axes.Axes, optional
            Axes to draw on. Default: those of a new figure.
        units : Units, optional
            Units of the sweep, for the axis labels: speeds are drawn in knots.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        InputError
            If a station is unknown, `stations` is empty or a single name, `units` is not a
            `Units`, or there are none and the aircraft's gravity is 0.
        ImportError
            If matplotlib is not installed.

        Examples
        --------
        >>> import runway_modal as rm
        >>> from matplotlib.figure import Figure
        >>> sweep = rm.sweep(rm.f4e().modes(0.01), rm.Profile.full_mat(), [200.0, 400.0, 800.0])
        >>> sweep.plot_acceleration(["cg"], ax=Figure().subplots()).get_ylabel()
        'largest |vertical acceleration| [g]'
        """
        from .plotting_sweep import plot_accelerations

        return plot_accelerations(self, stations, label, ax, units)

    def to_pandas(self, units: Units | None = None) -> pd.DataFrame:
        """
        Make a table of the sweep, one row per speed (extra ``tables``).

        Parameters
        ----------
        units : Units, optional
            Units of the sweep, kept in ``attrs["units"]`` by column; Parquet files keep them.

        Returns
        -------
        pandas.DataFrame
            Columns speed, and max_load, time_of_max, position_of_max, min_load, time_of_min,
            position_of_min, each with _<gear>, and max_acceleration, time_of_max_acceleration
            and position_of_max_acceleration, each with _<station>.

        Raises
        ------
        InputError
            If `units` is not a `Units`.
        ImportError
            If pandas is not installed.

        Examples
        --------
        >>> import runway_modal as rm
        >>> sweep = rm.sweep(rm.f4e().modes(0.01), rm.Profile.full_mat(), [200.0, 400.0, 800.0])
        >>> sweep.to_pandas()["max_load_left"].idxmax()
        1
        """
        from .tables_sweep import to_pandas

        return to_pandas(self, units)

    def to_xarray(self, units: Units | None = None) -> xr.Dataset:
        """
        Make a data set of the sweep with named gears and stations (extra ``tables``).

        Parameters
        ----------
        units : Units, optional
            Units of the sweep, kept in ``attrs["units"]`` of every variable.

        Returns
        -------
        xarray.Dataset
            Every result over speed, gear and station.

        Raises
        ------
        InputError
            If `units` is not a `Units`.
        ImportError
            If xarray is not installed.

        Examples
        --------
        >>> import runway_modal as rm
        >>> sweep = rm.sweep(rm.f4e().modes(0.01), rm.Profile.full_mat(), [200.0, 400.0, 800.0])
        >>> sweep.to_xarray()["max_load"].sel(gear="left").dims
        ('speed',)
        """
        from .tables_sweep import to_xarray

        return to_xarray(self, units)

    def __repr__(self) -> str:
        """Span and size."""
        gears = ", ".join(self.aircraft.gear_names)
        if not self.speed.size:
            return f"<Sweep: no speeds, gears {gears}>"
        low, high = self.speed.min(), self.speed.max()
        return f"<Sweep: {self.speed.size} speeds from {low:g} to {high:g}, gears {gears}>"


def sweep(
    modes: Modes,
    tracks: Profile | Mapping[str, Profile],
    speeds: ArrayLike,
    *,
    damping_input: bool = False,
) -> Sweep:
    """
    Roll an aircraft over one runway at many speeds; return the true extremes of each run.

    Runs are shared among all processor cores (``RAYON_NUM_THREADS`` sets how many threads);
    no response is kept. The numbers are those of ``simulate(modes, tracks, v).extremes()``, to
    the last bit, on any number of threads.

    Parameters
    ----------
    modes : Modes
        From `Aircraft.modes`, `Modes` or `single_dof`.
    tracks : Profile or mapping of str to Profile
        One profile for all gears, or profiles by gear name; gears not named run on level ground.
    speeds : array_like, shape (s,), or float
        Ground speeds, each constant over its run, > 0, in any order [length/time].
    damping_input : bool
        As for `simulate`.

    Returns
    -------
    Sweep
        Extremes of loads and accelerations, one row per speed.

    Raises
    ------
    InputError
        If an argument is of the wrong kind or out of range, or a gear name is unknown.
    NumericalError
        If a result leaves the range of double precision.

    See Also
    --------
    worst_speed : The worst speed of a range, to a tolerance.

    Notes
    -----
    Each run lasts from 0 or the first breakpoint until 5 after the last gear has passed the last
    breakpoint [time], as by default in `simulate`. With `damping_input` the impulse of a vertical
    step is left out, as there.

    Examples
    --------
    The full mat from 5 to 100 knots. At which speed is the left gear's load largest?

    >>> import numpy as np
    >>> import runway_modal as rm
    >>> modes, mat = rm.f4e().modes(0.01), rm.Profile.full_mat()
    >>> knots = np.arange(5.0, 100.0, 0.25)
    >>> sweep = rm.sweep(modes, mat, rm.knots(knots))
    >>> float(knots[sweep.max_load[:, 1].argmax()])
    58.0

    To vary the gap between two bumps, loop over profiles, each at as many speeds as wanted:

    >>> bump = rm.Profile.mat(120.0)
    >>> gaps = [0.0, 120.0, 240.0, 360.0, 480.0]
    >>> pairs = [rm.Profile.sequence([bump, bump], gap) for gap in gaps]
    >>> worst = [rm.sweep(modes, pair, [rm.knots(40)]).max_load[0, 1] for pair in pairs]
    >>> gaps[int(np.argmax(worst))]
    360.0
    """
    course = _course(modes, tracks, damping_input)
    speed = array("speeds", np.atleast_1d(any_array("speeds", speeds))).copy()
    stations = modes.aircraft.stations
    loads, accelerations = course.sweep(speed, list(stations.values()))
    max_load, time_of_max, min_load, time_of_min = loads
    magnitude, time_of_magnitude = accelerations
    return Sweep(
        modes=modes,
        speed=read_only(speed),
        max_load=max_load,
        time_of_max=time_of_max,
        min_load=min_load,
        time_of_min=time_of_min,
        max_acceleration=dict(zip(stations, magnitude, strict=True)),
        time_of_max_acceleration=dict(zip(stations, time_of_magnitude, strict=True)),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstSpeed:
    """
    The worst speed of a range, and a bound on what any speed of the range gives.

    Returned by `worst_speed`.

    Parameters
    ----------
    speed : float
        A speed at which `value` occurs [length/time].
    value : float
        The worst value found, the true extreme of the run at `speed`.
    bound : float
        No speed of the range gives a worse value than this; within the tolerance of `value`.
    runs : int
        Number of runs that it took.

    Examples
    --------
    >>> import runway_modal as rm
    >>> modes, mat = rm.f4e().modes(0.01), rm.Profile.full_mat()
    >>> worst = rm.worst_speed(modes, mat, (300, 500), at="left", tolerance=50.0)
    >>> worst.value <= worst.bound <= worst.value + 50.0
    True
    """

    speed: float
    value: float
    bound: float
    runs: int


def worst_speed(
    modes: Modes,
    tracks: Profile | Mapping[str, Profile],
    speeds: Sequence[float],
    quantity: Literal["max_load", "min_load", "max_acceleration"] = "max_load",
    *,
    at: str,
    tolerance: float,
    max_runs: int = 100_000,
    damping_input: bool = False,
) -> WorstSpeed:
    """
    Find the worst speed of a range; no other is worse by more than a tolerance, guaranteed.

    An extreme as a function of speed has many local maxima with corners between them, so no grid
    of speeds is known to be dense enough. Here each run also bounds the values at nearby speeds,
    and speeds are tried until the bound over the whole range is within `tolerance` of the worst
    value found.

    Parameters
    ----------
    modes : Modes
        From `Aircraft.modes`, `Modes` or `single_dof`.
    tracks : Profile or mapping of str to Profile
        One profile for all gears, or profiles by gear name; gears not named run on level ground.
    speeds : (float, float)
        Lowest and highest speed, > 0 [length/time].
    quantity : {"max_load", "min_load", "max_acceleration"}
        Quantity whose worst value is wanted: the largest load of a gear, its smallest load, or the
        largest magnitude of vertical acceleration at a station.
    at : str
        Name of the gear or the station.
    tolerance : float
        How much worse than the value found any other speed may be, > 0 [unit of the quantity].
    max_runs : int
        Largest number of runs to make, at least 100.
    damping_input : bool
        As for `simulate`.

    Returns
    -------
    WorstSpeed
        The speed, its value and the bound on all others.

    Raises
    ------
    InputError
        If an argument is of the wrong kind or out of range, a name is unknown, or `tolerance` is
        not reached within `max_runs`; the message gives the value found and its bound.
    NumericalError
        If a result leaves the range of double precision.

    Notes
    -----
    *Guaranteed*: with the extremes that `sweep` gives, every speed of the range has a value no
    worse than `bound`, and ``|bound - value| <= tolerance``. *Not guaranteed*: that `speed` is near
    the worst speed, if another speed does the same within the tolerance; and rounding, some 1e-12
    of the peak.

    Why: with p₀ the response of a mode (Eq. 12) at speed V₀ and p that at V = ρV₀, the difference
    w = p - p₀ at one station obeys ẅ + 2ζωẇ + ω²w = -(ρ² - 1) p̈₀ - 2ζω(ρ - 1) ṗ₀. The runway has
    dropped out: the largest |p̈₀| and |ṗ₀| of one run and the integral of the impulse response
    bound w while the gears are on the profile, and a free motion does not grow afterwards.

    With the dampers' input g = φᵀC₁(u - u at the start), p̈₀ stands for its part without ġ₀, and
    -(ρ - 1) ġ joins the right side; the largest |g| and the derivatives of the impulse response
    bound its effect. A load also changes by (ρ - 1) c u̇₀. Steep ramps and elevations far from the
    first one therefore cost runs. At vertical steps the values before and after count; the impulse
    on dampers is left out, as in `simulate`.

    The number of runs grows with the length of the profile in periods, up to about 1/(2ζ) of them,
    and as 1/√tolerance for small tolerances.

    Examples
    --------
    The left gear's largest load over the full mat, 5 to 100 knots, to 100 lbf:

    >>> import runway_modal as rm
    >>> modes, mat = rm.f4e().modes(0.01), rm.Profile.full_mat()
    >>> limits = rm.knots(5), rm.knots(100)
    >>> worst = rm.worst_speed(modes, mat, limits, at="left", tolerance=100.0)
    >>> round(worst.speed / rm.knots(1), 1)
    57.9
    """
    course = _course(modes, tracks, damping_input)
    low, high = _limits(speeds)
    aircraft = modes.aircraft
    quantities = ("max_load", "min_load", "max_acceleration")
    one_of("quantity", quantity, quantities)
    column = column_of(quantity, at, aircraft.gear_names, tuple(aircraft.stations))
    point = aircraft.stations[at] if quantity == "max_acceleration" else (0.0, 0.0)
    most = integer("max_runs", max_runs, 100, 2**53)
    speed, value, bound, runs = course.worst(
        quantity, column, point, (low, high), number("tolerance", tolerance), most
    )
    return WorstSpeed(speed=speed, value=value, bound=bound, runs=runs)


def _course(
    modes: Modes, tracks: Profile | Mapping[str, Profile], damping_input: bool
) -> _core.Course:
    check_modes("modes", modes)
    damping_input = flag("damping_input", damping_input)
    profiles = [profile._core for profile in by_gear(modes.aircraft.gear_names, tracks)]
    return _core.Course(modes._core, profiles, damping_input)


def _limits(speeds: Sequence[float]) -> tuple[float, float]:
    limits = array("speeds", speeds, ndim=None)
    if limits.shape != (2,):
        raise InputError(f"speeds has shape {limits.shape}, (lowest, highest) expected")
    low, high = limits.tolist()
    if low > high:
        raise InputError(f"speeds = ({low!r}, {high!r}): the lowest comes first")
    return low, high
