"""Figures of sweeps over speed (extra ``plot``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ._axes import (
    STATIC_DASHES,
    in_g,
    legend_above,
    line_style,
    load_unit,
    mark_limits,
    mark_static,
    marker,
    nested_width,
    new_axes,
    shown,
)
from .units import SPEED, stated

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from .sweep import Sweep
    from .units import Units


def plot_loads(
    sweep: Sweep, gears: Sequence[str] | None, ax: Axes | None, units: Units | None
) -> Axes:
    """Draw what `Sweep.plot` documents."""
    names = sweep.modes.aircraft.gear_names
    wanted = shown("gears", gears, names, "gear")
    ax = ax or new_axes()
    scale, unit = load_unit(units)
    order = np.argsort(sweep.speed)
    speed = _speed(ax, sweep.speed[order], units)
    for i, gear in enumerate(wanted):
        column = names.index(gear)
        color, dashes = line_style(i)
        width = nested_width(i, len(wanted))
        low, high = sweep.min_load[order, column] / scale, sweep.max_load[order, column] / scale
        for load, label in ((high, gear), (low, "")):
            ax.plot(speed, load, color, ls=dashes, lw=width, marker=marker(speed), label=label)
        ax.fill_between(speed, low, high, color=color, alpha=0.12, lw=0)
        mark_static(ax, sweep.static_load[column] / scale, color)
    if "static" not in ax.get_legend_handles_labels()[1]:
        # Last in the legend, in no gear's colour.
        ax.plot([], [], color="0.35", lw=0.9, ls=STATIC_DASHES, label="static")
    ax.axhline(0.0, color="0.35", lw=0.9)
    ax.set_ylabel(f"largest and smallest load{unit}")
    legend_above(ax)
    return ax


def plot_accelerations(
    sweep: Sweep, stations: Sequence[str] | None, ax: Axes | None, units: Units | None
) -> Axes:
    """Draw what `Sweep.plot_acceleration` documents."""
    wanted = shown("stations", stations, tuple(sweep.max_acceleration), "station")
    gravity = in_g("sweep", sweep.modes.aircraft)
    ax = ax or new_axes()
    order = np.argsort(sweep.speed)
    speed = _speed(ax, sweep.speed[order], units)
    for i, station in enumerate(wanted):
        share = sweep.max_acceleration[station][order] / gravity
        color, dashes = line_style(i)
        ax.plot(speed, share, color, ls=dashes, lw=1.3, marker=marker(speed), label=station)
    mark_limits(ax, 1.0)
    ax.set_ylabel("largest |vertical acceleration| [g]")
    legend_above(ax)
    ax.set_ylim(bottom=0.0)
    return ax


def _speed(ax: Axes, speed: NDArray[np.float64], units: Units | None) -> NDArray[np.float64]:
    """Label the abscissa; return its speeds, in knots if units are given."""
    units = stated(units)
    ax.set_xlabel("ground speed [kt]" if units else "ground speed")
    ax.margins(x=0.0)
    return speed / units.quantity("speed", "1 kt", SPEED) if units else speed
