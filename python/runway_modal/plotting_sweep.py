"""Figures of sweeps over speed (extra ``plot``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ._axes import (
    in_g,
    legend_above,
    line_style,
    lines_there,
    load_unit,
    mark_limits,
    mark_static,
    marker,
    name_static,
    nested_width,
    new_axes,
    prefix,
    require,
    shown,
    with_unit,
)
from .units import check_units

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from .sweep import Sweep
    from .units import Units

__all__ = ["loads_and_accelerations"]


def loads_and_accelerations(sweep: Sweep, title: str = "", *, units: Units | None = None) -> Figure:
    """
    Draw loads over accelerations against speed.

    Parameters
    ----------
    sweep : Sweep
        The sweep.
    title : str
        Title of the figure.
    units : Units, optional
        Units of the sweep, for the axis labels: speeds are drawn in knots, loads in lbf and N in
        kip and kN.

    Returns
    -------
    matplotlib.figure.Figure
        The figure: `Sweep.plot` over `Sweep.plot_acceleration`.

    Raises
    ------
    InputError
        If `units` is not a `Units`, or there are none and the aircraft's gravity is 0.
    ImportError
        If matplotlib is not installed.

    Examples
    --------
    >>> import runway_modal as rm
    >>> from runway_modal import plotting_sweep
    >>> sweep = rm.sweep(rm.f4e().modes(0.01), rm.Profile.full_mat(), [200.0, 400.0, 800.0])
    >>> len(plotting_sweep.loads_and_accelerations(sweep, "F-4E").axes)
    2
    """
    require()
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 7.5), layout="constrained")
    loads, accelerations = figure.subplots(2, 1, sharex=True)
    sweep.plot(ax=loads, units=units)
    sweep.plot_acceleration(ax=accelerations, units=units)
    loads.set_xlabel("")
    if title:
        figure.suptitle(title)
    return figure


def plot_loads(
    sweep: Sweep, gears: Sequence[str] | None, label: str, ax: Axes | None, units: Units | None
) -> Axes:
    """Draw what `Sweep.plot` documents."""
    names = sweep.gear_names
    wanted, run = shown("gears", gears, names, "gear"), prefix(label)
    ax = ax or new_axes()
    scale, unit = load_unit(units)
    order = np.argsort(sweep.speed)
    speed = _speed(ax, sweep.speed[order], units)
    first = lines_there(ax)
    for i, gear in enumerate(wanted):
        column = names.index(gear)
        color, dashes = line_style(first + i)
        width = nested_width(i, len(wanted))
        low, high = sweep.min_load[order, column] / scale, sweep.max_load[order, column] / scale
        for load, name in ((high, f"{run}{gear}"), (low, "")):
            ax.plot(speed, load, color, ls=dashes, lw=width, marker=marker(speed), label=name)
        ax.fill_between(speed, low, high, color=color, alpha=0.12, lw=0)
        mark_static(ax, sweep.static_load[column] / scale, color)
    name_static(ax)
    ax.axhline(0.0, color="0.35", lw=0.9)
    ax.set_ylabel(with_unit("largest and smallest load", unit))
    legend_above(ax)
    return ax


def plot_accelerations(
    sweep: Sweep, stations: Sequence[str] | None, label: str, ax: Axes | None, units: Units | None
) -> Axes:
    """Draw what `Sweep.plot_acceleration` documents."""
    wanted = shown("stations", stations, tuple(sweep.max_acceleration), "station")
    run = prefix(label)
    gravity = in_g("sweep", sweep.aircraft, units)
    ax = ax or new_axes()
    order = np.argsort(sweep.speed)
    speed = _speed(ax, sweep.speed[order], units)
    for i, station in enumerate(wanted, lines_there(ax)):
        share = sweep.max_acceleration[station][order] / gravity
        color, dashes = line_style(i)
        name, dot = f"{run}{station}", marker(speed)
        ax.plot(speed, share, color, ls=dashes, lw=1.3, marker=dot, label=name)
    mark_limits(ax, 1.0)
    ax.set_ylabel("largest |vertical acceleration| [g]")
    legend_above(ax)
    ax.set_ylim(bottom=0.0)
    return ax


def _speed(ax: Axes, speed: NDArray[np.float64], units: Units | None) -> NDArray[np.float64]:
    """Label the abscissa; return its speeds, in knots if units are given."""
    units = check_units(units)
    ax.set_xlabel("ground speed [kt]" if units else "ground speed")
    ax.margins(x=0.0)
    return speed / units.knot if units else speed
