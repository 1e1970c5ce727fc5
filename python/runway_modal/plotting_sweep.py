"""Figures of sweeps over speed (extra ``plot``)."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, Literal

from ._core import InputError
from .units import knots

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from .sweep import Sweep

__all__ = ["ACCELERATION_LIMIT", "accelerations", "loads"]

#: Vertical acceleration at pilot and CG beyond which a runway counts as rough [g]; published:
#: Morris and Hall, NASA 1965; Navy CEL TR-846, 1976.
ACCELERATION_LIMIT = 0.4

#: Distinct with any colour vision (Okabe and Ito).
_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")

#: A thousand of the force that goes with a unit of length: lbf, N.
_THOUSAND = {"in": "kip", "ft": "kip", "m": "kN"}

Length = Literal["in", "ft", "m"]


def loads(axes: Axes, sweep: Sweep, gears: Sequence[str] = (), *, length: Length = "in") -> Axes:
    """
    Draw the largest and smallest load of gears against speed.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    sweep : Sweep
        What to draw, speeds rising.
    gears : sequence of str
        Names of the gears to draw. Default: all.
    length : {"in", "ft", "m"}
        The aircraft's unit of length; with it go lbf and N.

    Returns
    -------
    matplotlib.axes.Axes
        The axes: a gear's band between its smallest and its largest load, its static load as a
        dashed line, in kip or kN against knots.

    Raises
    ------
    InputError
        If a gear is unknown.

    Examples
    --------
    >>> import numpy as np
    >>> import runway_modal as rm
    >>> from matplotlib.figure import Figure
    >>> from runway_modal import plotting_sweep
    >>> speeds = rm.knots(1) * np.linspace(5, 100, 200)
    >>> sweep = rm.sweep(rm.f4e().modes(0.01), rm.Profile.full_mat(), speeds)
    >>> axes = plotting_sweep.loads(Figure().subplots(), sweep, ["nose", "left"])
    >>> axes.get_ylabel()
    'load [kip]'
    """
    names = sweep.modes.aircraft.gear_names
    speed = sweep.speed / knots(1.0, length)
    for gear, color in zip(gears or names, cycle(_COLORS), strict=False):
        if gear not in names:
            raise InputError(f"gears: no gear {gear!r}; there are {names}")
        column = names.index(gear)
        low, high = sweep.min_load[:, column] / 1e3, sweep.max_load[:, column] / 1e3
        axes.fill_between(speed, low, high, color=color, alpha=0.13, lw=0)
        axes.plot(speed, high, color=color, lw=1.3, label=gear)
        axes.plot(speed, low, color=color, lw=1.3)
        axes.axhline(sweep.static_load[column] / 1e3, color=color, lw=0.9, ls="--")
    axes.axhline(0.0, color="0.35", lw=0.9)
    axes.plot([], [], color="0.35", lw=0.9, ls="--", label="static")
    return _finish(axes, f"load [{_THOUSAND[length]}]")


def accelerations(
    axes: Axes, sweep: Sweep, stations: Sequence[str] = (), *, length: Length = "in"
) -> Axes:
    """
    Draw the largest vertical acceleration at stations against speed, with the 0.4 g line.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    sweep : Sweep
        What to draw, speeds rising.
    stations : sequence of str
        Names of the stations to draw. Default: all.
    length : {"in", "ft", "m"}
        The aircraft's unit of length.

    Returns
    -------
    matplotlib.axes.Axes
        The axes: magnitudes in g (the aircraft's gravity) against knots, and the limit of 0.4 g
        either way (published: Morris and Hall, NASA 1965; Navy CEL TR-846, 1976).

    Raises
    ------
    InputError
        If a station is unknown or the aircraft has no gravity.

    Examples
    --------
    >>> import numpy as np
    >>> import runway_modal as rm
    >>> from matplotlib.figure import Figure
    >>> from runway_modal import plotting_sweep
    >>> speeds = rm.knots(1) * np.linspace(5, 100, 200)
    >>> sweep = rm.sweep(rm.f4e().modes(0.01), rm.Profile.full_mat(), speeds)
    >>> axes = plotting_sweep.accelerations(Figure().subplots(), sweep, ["cg"])
    >>> axes.get_ylabel()
    'largest |vertical acceleration| [g]'
    """
    speed = sweep.speed / knots(1.0, length)
    gravity = sweep.modes.aircraft.gravity
    if not gravity:
        raise InputError("sweep: without gravity there is no g to draw in")
    for station, color in zip(stations or sweep.max_acceleration, cycle(_COLORS), strict=False):
        if station not in sweep.max_acceleration:
            raise InputError(
                f"stations: no station {station!r}; there are {tuple(sweep.max_acceleration)}"
            )
        share = sweep.max_acceleration[station] / gravity
        axes.plot(speed, share, color=color, lw=1.3, label=station)
    axes.axhline(ACCELERATION_LIMIT, color="0.2", lw=0.9, ls="--", label="±0.4 g")
    axes.set_ylim(bottom=0.0)
    return _finish(axes, "largest |vertical acceleration| [g]")


def _finish(axes: Axes, label: str) -> Axes:
    axes.set_ylabel(label)
    axes.set_xlabel("ground speed [kt]")
    axes.grid(alpha=0.25)
    axes.margins(x=0.0)
    # Above the curves, which leave no corner free.
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), frameon=False, fontsize="small", ncols=4)
    return axes
