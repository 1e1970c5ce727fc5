"""Results of a run."""

from __future__ import annotations

from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from ._input import any_array, array, read_only
from ._results import Shown
from .extremes import Extremes

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from . import _core
    from .aircraft import Aircraft
    from .modes import Modes


class Response(Shown):
    """
    Motion and loads of one run, sampled at `time` and exact there.

    Returned by `simulate`. Motion is measured from static equilibrium. `modal` and `modal_rate`
    are computed with the run, everything else on first use; all arrays are read-only, with one
    row per time.

    Parameters
    ----------
    run : _core.Run
        The run.
    modes : Modes
        Its modes.
    again : callable
        Makes the same response again, given `times` or `duration` by name.
    times : array_like, shape (n,), optional
        Times at which to sample [time].
    duration : float, optional
        End of the default times [time].

    Examples
    --------
    >>> import runway_modal as rm
    >>> response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    >>> response.load.shape == (response.time.size, 3)
    True
    """

    _run: _core.Run
    _again: Callable[..., Response]
    _rebuild: partial[Response]
    #: The modes of the run.
    modes: Modes
    #: Sample times, shape (n,) [time].
    time: NDArray[np.float64]
    #: Modal displacements p, shape (n, m) (Eq. 12).
    modal: NDArray[np.float64]
    #: Modal rates ṗ, shape (n, m).
    modal_rate: NDArray[np.float64]

    def __init__(
        self,
        run: _core.Run,
        modes: Modes,
        again: Callable[..., Response],
        *,
        times: ArrayLike | None = None,
        duration: float | None = None,
    ) -> None:
        if times is None:
            time, modal, modal_rate = run.sample(duration)
            rebuild = partial(again, duration=duration)
        else:
            time = array("times", np.atleast_1d(any_array("times", times))).copy()
            modal, modal_rate = run.states(time)
            rebuild = partial(again, times=read_only(time))
        made_of = {"_run": run, "_again": again, "_rebuild": rebuild, "modes": modes}
        vars(self).update(made_of, time=time, modal=modal, modal_rate=modal_rate)

    @property
    def aircraft(self) -> Aircraft:
        """The aircraft of the run."""
        return self.modes.aircraft

    def _read(self, quantity: str) -> NDArray[np.float64]:
        return self._run.read(quantity, self._stations(), self.time)

    def _stations(self) -> list[tuple[float, float]]:
        return list(self.aircraft.stations.values())

    @property
    def speed(self) -> float:
        """Ground speed [length/time]."""
        return self._run.speed()

    @cached_property
    def distance(self) -> NDArray[np.float64]:
        """Distance of the foremost gear past station 0, shape (n,) [length]."""
        return read_only(self.time * self.speed)

    @cached_property
    def cg(self) -> NDArray[np.float64]:
        """
        Bounce, pitch and roll at the centre of gravity, shape (n, 3) [length, rad] (Eq. 19).

        Positive up, nose up and left side up.
        """
        return self._read("cg")

    @cached_property
    def cg_rate(self) -> NDArray[np.float64]:
        """Rates of bounce, pitch and roll, shape (n, 3) [length/time, rad/time]."""
        return self._read("cg_rate")

    @cached_property
    def cg_acceleration(self) -> NDArray[np.float64]:
        """Accelerations of bounce, pitch and roll, shape (n, 3) [length/time², rad/time²]."""
        return self._read("cg_acceleration")

    @cached_property
    def gear_displacement(self) -> NDArray[np.float64]:
        """Vertical displacement of the body at each gear, shape (n, g) [length] (Eq. 20)."""
        return self._read("gear_displacement")

    @cached_property
    def elevation(self) -> NDArray[np.float64]:
        """Elevation under each gear, shape (n, g) [length]; at a vertical step, after it."""
        return self._read("elevation")

    @cached_property
    def load(self) -> NDArray[np.float64]:
        """Compression load of each gear, static load included, shape (n, g) [force] (Eq. 21)."""
        return self._read("load")

    @cached_property
    def acceleration(self) -> dict[str, NDArray[np.float64]]:
        """Vertical acceleration at each station, up, each of shape (n,) [length/time²]."""
        columns = self._read("acceleration")
        return {
            name: read_only(columns[:, i].copy()) for i, name in enumerate(self.aircraft.stations)
        }

    @property
    def static_load(self) -> NDArray[np.float64]:
        """Static load of each gear, shape (g,) [force]."""
        return self.aircraft.static_load

    @property
    def unloaded(self) -> NDArray[np.bool_]:
        """
        Whether each gear's load reaches zero, shape (g,).

        Beyond that the linear model, in which a gear may pull on the runway, does not hold.
        """
        return self.extremes().unloaded

    @cached_property
    def _rms(self) -> NDArray[np.float64]:
        return self._root_mean_squares(np.array((self.time[0], self.time[-1]))).ravel()

    def _root_mean_squares(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of loads, then of accelerations, between each time and the next, a row each."""
        return self._run.root_mean_squares(self._stations(), times)

    def at(self, times: ArrayLike) -> Response:
        """
        Evaluate the same run at other times, exactly.

        Parameters
        ----------
        times : array_like, shape (k,), or float
            Times, never decreasing [time]. At the time of a jump the row shows what follows it.

        Returns
        -------
        Response
            The response at those times.

        Raises
        ------
        InputError
            If there are no times, one is not finite or they decrease.

        Examples
        --------
        >>> import runway_modal as rm
        >>> response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
        >>> response.at([0.5, 1.0]).load.shape
        (2, 3)
        """
        return Response(self._run, self.modes, self._again, times=times)

    def extremes(self) -> Extremes:
        """
        Find the true extremes between the first and the last of the sample times.

        Returns
        -------
        Extremes
            Loads and accelerations, between samples too.

        Raises
        ------
        NumericalError
            If a result leaves the range of double precision.

        Examples
        --------
        >>> import runway_modal as rm
        >>> response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
        >>> bool((response.extremes().max_load >= response.load.max(axis=0)).all())
        True
        """
        return self._extremes

    @cached_property
    def _extremes(self) -> Extremes:
        return self._between(np.array((self.time[0], self.time[-1])))[0]

    def _between(self, times: NDArray[np.float64]) -> list[Extremes]:
        """Find the extremes between each time and the next."""
        loads, accelerations = self._run.extremes(self._stations(), times)
        stations = self.aircraft.stations
        magnitude, time_of_magnitude = accelerations.transpose(0, 2, 1).tolist()
        return [
            Extremes(
                aircraft=self.aircraft,
                speed=self.speed,
                max_load=loads[0, row],
                time_of_max=loads[1, row],
                min_load=loads[2, row],
                time_of_min=loads[3, row],
                max_acceleration=dict(zip(stations, magnitude[row], strict=True)),
                time_of_max_acceleration=dict(zip(stations, time_of_magnitude[row], strict=True)),
            )
            for row in range(times.size - 1)
        ]

    def __reduce__(self) -> tuple[partial[Response], tuple[()]]:
        """Pickle by the arguments of the run: it is computed again, to the same bits."""
        return self._rebuild, ()

    def __repr__(self) -> str:
        """Span and size."""
        return (
            f"<Response: {self.time.size} times from {self.time[0]:g} to {self.time[-1]:g}, "
            f"gears {', '.join(self.aircraft.gear_names)}>"
        )
