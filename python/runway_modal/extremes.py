"""True extremes of one run."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ._input import read_only
from ._pickled import Pickled
from ._text import table
from ._tracks import lag, lags

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd
    from numpy.typing import NDArray

    from ._results import Aircraft
    from .units import Units

#: One time, or one for each speed.
_Times = TypeVar("_Times", "float", "NDArray[np.float64]")


def positions(
    aircraft: Aircraft, speed: float | NDArray[np.float64], times: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Stations of the runway that gears are at, one column of times per gear."""
    return read_only(times * speed - lags(aircraft))


def station_positions(
    aircraft: Aircraft, speed: _Times, times: Mapping[str, _Times]
) -> dict[str, _Times]:
    """Stations of the runway that points of the aircraft are over, by name."""
    points = aircraft.stations
    return {name: at * speed - lag(aircraft, points[name][0]) for name, at in times.items()}


def share(load: float, static: float) -> str:
    """Load as a multiple of the static one, which is 0 without gravity."""
    return f"{load / static:.3f}" if static else "-"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Extremes(Pickled):
    """
    True extremes of a response over its time span, between samples too.

    Returned by `Response.extremes`. Found as zeros of the derivative of the continuous solution.
    At a jump both sides count; the impulse of a vertical step on a damper does not (see
    `simulate`). Of equal peaks the first is reported.

    Parameters
    ----------
    aircraft : Aircraft
        The aircraft of the run.
    speed : float
        Ground speed [length/time].
    max_load : ndarray, shape (g,)
        Largest compression load of each gear [force].
    time_of_max : ndarray, shape (g,)
        When it occurs [time].
    min_load : ndarray, shape (g,)
        Smallest compression load of each gear; ≤ 0 where the gear unloads [force].
    time_of_min : ndarray, shape (g,)
        When it occurs [time].
    max_acceleration : dict of str to float
        Largest magnitude of vertical acceleration at each station [length/time²].
    time_of_max_acceleration : dict of str to float
        When it occurs [time].

    Examples
    --------
    >>> import runway_modal as rm
    >>> response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    >>> extremes = response.extremes()
    >>> extremes.position_of_max.round(1)
    array([1097.7, 1043.8, 1043.8])
    >>> (extremes.max_load / extremes.static_load).round(2)
    array([1.45, 1.85, 1.85])
    >>> extremes
    gear       static  max_load  / static      time  position  min_load      time  position
    nose      8921.76   12939.7     1.450   2.70978   1097.66   4915.21   4.02387   1629.97
    left      23627.1   43685.9     1.849   3.26619    1043.8   3516.15   3.00471   937.879
    right     23627.1   43685.9     1.849   3.26619    1043.8   3516.15   3.00471   937.879
    station  |accel.|      time  position
    cg        296.625   3.00649   982.952
    """

    aircraft: Aircraft
    speed: float
    max_load: NDArray[np.float64]
    time_of_max: NDArray[np.float64]
    min_load: NDArray[np.float64]
    time_of_min: NDArray[np.float64]
    max_acceleration: dict[str, float]
    time_of_max_acceleration: dict[str, float]

    @property
    def gear_names(self) -> tuple[str, ...]:
        """Names of the gears, in the order of the columns."""
        return self.aircraft.gear_names

    @property
    def static_load(self) -> NDArray[np.float64]:
        """Compression load of each gear in equilibrium on a level runway, shape (g,) [force]."""
        return self.aircraft.static_load

    @property
    def unloaded(self) -> NDArray[np.bool_]:
        """
        Whether each gear's load reaches zero, shape (g,).

        Beyond that the linear model, in which a gear may pull on the runway, does not hold.
        """
        return read_only(self.min_load <= 0.0)

    @property
    def position_of_max(self) -> NDArray[np.float64]:
        """Station of the runway under each gear at its largest load, shape (g,) [length]."""
        return positions(self.aircraft, self.speed, self.time_of_max)

    @property
    def position_of_min(self) -> NDArray[np.float64]:
        """Station of the runway under each gear at its smallest load, shape (g,) [length]."""
        return positions(self.aircraft, self.speed, self.time_of_min)

    @property
    def position_of_max_acceleration(self) -> dict[str, float]:
        """Station of the runway below each point at its largest acceleration [length]."""
        return station_positions(self.aircraft, self.speed, self.time_of_max_acceleration)

    def to_pandas(self, units: Units | None = None) -> pd.DataFrame:
        """
        Make a table of the loads, one row per gear (extra ``tables``).

        Parameters
        ----------
        units : Units, optional
            Units of the run, kept in ``attrs["units"]`` by column; Parquet files keep them.

        Returns
        -------
        pandas.DataFrame
            Columns static_load, max_load, time_of_max, position_of_max, min_load, time_of_min and
            position_of_min; the index names the gears.

        Raises
        ------
        InputError
            If `units` is not a `Units`.
        ImportError
            If pandas is not installed.

        Examples
        --------
        >>> import runway_modal as rm
        >>> response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
        >>> table = response.extremes().to_pandas()
        >>> table["max_load"].idxmax(), round(table.loc["nose", "max_load"])
        ('left', 12940)
        """
        from .tables_response import extremes_to_pandas

        return extremes_to_pandas(self, units)

    def __repr__(self) -> str:
        """Make a table: one line per gear, one line per station."""
        shares = map(share, self.max_load, self.static_load)
        smallest = (self.min_load, self.time_of_min, self.position_of_min)
        largest = (self.max_load, shares, self.time_of_max, self.position_of_max)
        accelerations = (
            self.max_acceleration,
            self.max_acceleration.values(),
            self.time_of_max_acceleration.values(),
            self.position_of_max_acceleration.values(),
        )
        where = ("time", "position")
        rows = table(
            [
                ("gear", "static", "max_load", "/ static", *where, "min_load", *where),
                *zip(self.gear_names, self.static_load, *largest, *smallest, strict=True),
                ("station", "|accel.|", *where),
                *zip(*accelerations, strict=True),
            ]
        )
        pulling = [
            name for name, least in zip(self.gear_names, self.min_load, strict=True) if least < 0.0
        ]
        if not pulling:
            return rows
        return (
            f"{rows}\n{', '.join(pulling)} would pull on the runway: the linear model does not hold"
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Section(Extremes):
    """
    True extremes and root mean squares on a section of the runway.

    Returned by `Response.sections`.

    Parameters
    ----------
    aircraft : Aircraft
        The aircraft of the run.
    speed : float
        Ground speed [length/time].
    max_load : ndarray, shape (g,)
        Largest compression load of each gear [force].
    time_of_max : ndarray, shape (g,)
        When it occurs [time].
    min_load : ndarray, shape (g,)
        Smallest compression load of each gear; ≤ 0 where the gear unloads [force].
    time_of_min : ndarray, shape (g,)
        When it occurs [time].
    max_acceleration : dict of str to float
        Largest magnitude of vertical acceleration at each station [length/time²].
    time_of_max_acceleration : dict of str to float
        When it occurs [time].
    rms_load : ndarray, shape (g,)
        Root mean square of each gear's dynamic load, between samples too [force].
    rms_acceleration : dict of str to float
        Root mean square of vertical acceleration at each station [length/time²].

    Examples
    --------
    >>> import runway_modal as rm
    >>> response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    >>> for begin, section in response.sections(1000.0).items():
    ...     rms = section.rms_acceleration["cg"] / response.aircraft.gravity
    ...     print(f"from {begin:g} in: {rms:.3f} g RMS")
    from 0 in: 0.257 g RMS
    from 1000 in: 0.441 g RMS
    from 2000 in: 0.361 g RMS
    from 3000 in: 0.307 g RMS
    """

    rms_load: NDArray[np.float64]
    rms_acceleration: dict[str, float]

    def __repr__(self) -> str:
        """Make a table: that of the extremes, then one of the root mean squares."""
        rms = table(
            [
                ("gear", "RMS"),
                *zip(self.gear_names, self.rms_load, strict=True),
                ("station", "RMS"),
                *self.rms_acceleration.items(),
            ]
        )
        return f"{Extremes.__repr__(self)}\n{rms}"


def section(extremes: Extremes, rms: NDArray[np.float64]) -> Section:
    """Add root mean squares, of the gears' loads and then of the stations' accelerations."""
    gears, stations = np.split(rms, [len(extremes.gear_names)])
    return Section(
        **{each.name: getattr(extremes, each.name) for each in fields(extremes)},
        rms_load=gears,
        rms_acceleration=dict(zip(extremes.aircraft.stations, stations.tolist(), strict=True)),
    )
