"""What the responses of linear and nonlinear aircraft share: sections, means, figures, tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, Literal, Protocol, TypeAlias

import numpy as np

from ._core import InputError
from ._input import positive
from .extremes import section

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from .extremes import Extremes, Section
    from .units import Units

    Array: TypeAlias = NDArray[np.float64]


#: More sections than this in one response are a slip in the units.
_MOST_SECTIONS = 1_000_000

#: What a response may be drawn against.
Against: TypeAlias = Literal["time", "distance"]


class Gear(Protocol):
    """What gears of linear and nonlinear aircraft share."""

    @property
    def x(self) -> float: ...


class Aircraft(Protocol):
    """What linear and nonlinear aircraft share."""

    @property
    def gears(self) -> Sequence[Gear]: ...
    @property
    def gear_names(self) -> tuple[str, ...]: ...
    @property
    def gravity(self) -> float: ...
    @property
    def static_load(self) -> Array: ...
    @property
    def stations(self) -> Mapping[str, tuple[float, float]]: ...


class Results(Protocol):
    """What these need of a response; `runway_modal.Response` documents each name."""

    _of_gears: ClassVar[tuple[str, ...]]

    def _between(self, times: Array) -> list[Extremes]: ...
    def _root_mean_squares(self, times: Array) -> Array: ...
    @property
    def _rms(self) -> Array: ...
    @property
    def speed(self) -> float: ...
    @property
    def aircraft(self) -> Aircraft: ...
    @property
    def gear_names(self) -> tuple[str, ...]: ...
    @property
    def time(self) -> Array: ...
    @property
    def distance(self) -> Array: ...
    @property
    def cg(self) -> Array: ...
    @property
    def elevation(self) -> Array: ...
    @property
    def load(self) -> Array: ...
    @property
    def static_load(self) -> Array: ...
    @property
    def acceleration(self) -> Mapping[str, Array]: ...


class Shown:
    """Sections, root mean squares, figures and tables of a response."""

    __slots__ = ()

    #: Quantities with one column per gear.
    _of_gears: ClassVar[tuple[str, ...]] = ("load", "elevation")

    def __setattr__(self, name: str, value: object) -> None:
        """Refuse: what follows from the old value would stay."""
        raise AttributeError(f"a Response cannot be changed: {name} = {value!r}")

    def __delattr__(self, name: str) -> None:
        """Refuse."""
        raise AttributeError(f"a Response cannot be changed: del {name}")

    @property
    def gear_names(self: Results) -> tuple[str, ...]:
        """Names of the gears, in the order of the columns."""
        return self.aircraft.gear_names

    @property
    def rms_load(self: Results) -> Array:
        """
        Root mean square of each gear's dynamic load, shape (g,) [force].

        Of load - static load, over the whole time from the first sample to the last and between
        them too. ``response.at([begin, end]).rms_load`` is that of another span; of a single time,
        it is the magnitude.
        """
        return self._rms[: len(self.aircraft.gears)]

    @property
    def rms_acceleration(self: Results) -> dict[str, float]:
        """
        Root mean square of vertical acceleration at each station [length/time²].

        Over the whole time from the first sample to the last, as for `rms_load`.
        """
        values = self._rms[len(self.aircraft.gears) :].tolist()
        return dict(zip(self.aircraft.stations, values, strict=True))

    def sections(self: Results, length: float) -> dict[float, Section]:
        """
        Find extremes and root mean squares section by section, to tell which places are the worst.

        A section ends where the foremost gear has come to a multiple of `length`. What a place
        does to gears further back, or later on, counts in the section in which it happens; each
        extreme has its own time and position.

        Parameters
        ----------
        length : float
            Length of a section, > 0 [length].

        Returns
        -------
        dict of float to Section
            By the distance at which a section begins, in order; together all of the response.

        Raises
        ------
        InputError
            If `length` is not a finite number > 0, or there would be more than a million sections.
        NumericalError
            If a result leaves the range of double precision.

        Examples
        --------
        The sections of 20 ft in which the left gear's load is largest:

        >>> import runway_modal as rm
        >>> response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
        >>> sections = response.sections(240.0)
        >>> sorted(sections, key=lambda begin: -sections[begin].max_load[1])[:3]
        [1200.0, 1440.0, 1680.0]
        >>> left = max(section.max_load[1] for section in sections.values())
        >>> bool(abs(left / response.extremes().max_load[1] - 1.0) < 1e-12)
        True
        """
        length = positive("length", length)
        begin, end = float(self.distance[0]), float(self.distance[-1])
        count = (end - begin) / length
        if count > _MOST_SECTIONS:
            raise InputError(f"length = {length!r} makes {count:.3g} sections of this response")
        edges = length * np.arange(np.floor(begin / length) + 1.0, np.ceil(end / length))
        edges = edges[(edges > begin) & (edges < end)]
        # Rounding must not take them outside.
        within = np.clip(edges / self.speed, self.time[0], self.time[-1])
        times = np.concatenate((self.time[:1], within, self.time[-1:]))
        found = map(section, self._between(times), self._root_mean_squares(times))
        return dict(zip([begin, *edges.tolist()], found, strict=True))

    def plot(
        self: Results,
        gears: Sequence[str] | None = None,
        *,
        against: Against = "time",
        label: str = "",
        ax: Axes | None = None,
        units: Units | None = None,
    ) -> Axes:
        """
        Draw gear loads, with static loads as dashed lines.

        Parameters
        ----------
        gears : sequence of str, optional
            Gears to draw. Default: all.
        against : {"time", "distance"}
            Abscissa; distance is that of the foremost gear past station 0.
        label : str
            What to put before the names in the legend, to tell runs on the same axes apart.
        ax : matplotlib.axes.Axes, optional
            Axes to draw on. Default: those of a new figure.
        units : Units, optional
            Units of the response, for the axis labels; loads in lbf and N are drawn in kip and kN.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        InputError
            If a gear is unknown, `gears` is empty or a single name, `against` is neither,
            `label` is not text, or `units` is not a `Units`.
        ImportError
            If matplotlib is not installed.

        Examples
        --------
        >>> import runway_modal as rm
        >>> from matplotlib.figure import Figure
        >>> response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
        >>> axes = Figure().subplots()
        >>> response.plot(["left"], ax=axes, units=rm.Units("in", "lbf")).get_ylabel()
        'load [kip]'
        """
        from .plotting import plot_loads

        return plot_loads(self, gears, against, label, ax, units)

    def plot_acceleration(
        self: Results,
        stations: Sequence[str] | None = None,
        *,
        against: Against = "time",
        label: str = "",
        ax: Axes | None = None,
        units: Units | None = None,
    ) -> Axes:
        """
        Draw vertical accelerations in g, with lines at ±0.4 g.

        The lines are the limit at the pilot's station and the centre of gravity (published:
        Morris and Hall, NASA 1965; Navy CEL TR-846, 1976). The g is standard gravity or,
        without `units`, the aircraft's.

        Parameters
        ----------
        stations : sequence of str, optional
            Stations of `Aircraft.stations` to draw. Default: all.
        against : {"time", "distance"}
            Abscissa; distance is that of the foremost gear past station 0.
        label : str
            What to put before the names in the legend, to tell runs on the same axes apart.
        ax : matplotlib.axes.Axes, optional
            Axes to draw on. Default: those of a new figure.
        units : Units, optional
            Units of the response, for the axis labels.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        InputError
            If a station is unknown, `stations` is empty or a single name, `against` is neither,
            `label` is not text, `units` is not a `Units`, or there are none and the aircraft's
            gravity is 0.
        ImportError
            If matplotlib is not installed.

        Examples
        --------
        >>> import runway_modal as rm
        >>> from matplotlib.figure import Figure
        >>> response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
        >>> response.plot_acceleration(against="distance", ax=Figure().subplots()).get_ylabel()
        'vertical acceleration [g]'
        """
        from .plotting import plot_accelerations

        return plot_accelerations(self, stations, against, label, ax, units)

    def to_pandas(self: Results, units: Units | None = None) -> pd.DataFrame:
        """
        Make a table of the response, one row per time (extra ``tables``).

        Parameters
        ----------
        units : Units, optional
            Units of the response, kept in ``attrs["units"]`` by column; Parquet files keep them.

        Returns
        -------
        pandas.DataFrame
            Columns time, distance, load_<gear>, elevation_<gear>, bounce, pitch, roll and
            acceleration_<station>; for a nonlinear run also stiffness_<gear>.

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
        >>> table = response.to_pandas(rm.Units("in", "lbf"))
        >>> table.attrs["units"]["load_left"]
        'lbf'
        """
        from .tables_response import to_pandas

        return to_pandas(self, units)

    def to_xarray(self: Results, units: Units | None = None) -> xr.Dataset:
        """
        Make a data set of the response with named gears and stations (extra ``tables``).

        Parameters
        ----------
        units : Units, optional
            Units of the response, kept in ``attrs["units"]`` of every variable.

        Returns
        -------
        xarray.Dataset
            Variables distance, load, elevation, bounce, pitch, roll, acceleration and
            static_load over time, gear and station; for a nonlinear run also stiffness. A
            jump has two times: the last floating-point number before it, and its own.

        Raises
        ------
        InputError
            If `units` is not a `Units`.
        ImportError
            If xarray is not installed.

        Examples
        --------
        >>> import runway_modal as rm
        >>> response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
        >>> response.to_xarray()["load"].sel(gear="left").dims
        ('time',)
        """
        from .tables_response import to_xarray

        return to_xarray(self, units)
