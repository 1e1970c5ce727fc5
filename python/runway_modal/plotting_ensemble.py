"""Figures of ensembles (extra ``plot``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ._axes import (
    STATIC_DASHES,
    legend_above,
    line_style,
    load_unit,
    name_static,
    nested_width,
    new_axes,
    require,
    shown,
    with_unit,
)
from ._core import InputError
from ._quantities import DIMENSIONS, DOWNWARD, LABELS, names_of
from .units import FORCE, check_units

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .ensemble import Ensemble
    from .units import Units

__all__ = ["histograms_and_exceedances"]

#: Most bins of a histogram (more would show sampling noise), and levels of a curve.
_BINS, _LEVELS = 60, 300


def histograms_and_exceedances(
    ensembles: Mapping[str, Ensemble],
    title: str = "",
    *,
    units: Units | None = None,
    quantities: Sequence[str] = ("max_load",),
) -> Figure:
    """
    Draw quantities of ensembles, one row each: histogram and exceedance.

    Parameters
    ----------
    ensembles : mapping of str to Ensemble
        Ensembles by the title of their row.
    title : str
        Title of the figure.
    units : Units, optional
        Units of the ensembles, for the axis labels; loads in lbf and N are drawn in kip and kN.
    quantities : sequence of str
        What to draw of each ensemble, as for `Ensemble.plot`. Default: the largest gear loads.

    Returns
    -------
    matplotlib.figure.Figure
        The figure.

    Raises
    ------
    InputError
        If there is no ensemble, quantity or such quantity, no run of one could be computed, or
        `units` is not a `Units`.
    ImportError
        If matplotlib is not installed.

    Examples
    --------
    >>> import runway_modal as rm
    >>> from runway_modal import plotting_ensemble
    >>> runway = dict(length=2400.0, spacing=12.0, seed=1980, speed=rm.knots(60), runs=100)
    >>> rough = rm.monte_carlo(rm.f4e().modes(0.01), rm.Roughness.iso8608("B", "in"), **runway)
    >>> figure = plotting_ensemble.histograms_and_exceedances({"60 kt": rough})
    >>> len(figure.axes)
    2
    """
    require()
    from matplotlib.figure import Figure

    if not ensembles:
        raise InputError("ensembles is empty")
    if isinstance(quantities, str) or not quantities:
        raise InputError(f"quantities = {quantities!r} is not a list of quantities")
    drawn = [(label, one, each) for label, one in ensembles.items() for each in quantities]
    figure = Figure(figsize=(10.0, 3.6 * len(drawn) + 0.4), layout="constrained")
    rows = figure.subplots(len(drawn), 2, squeeze=False, sharex="row")
    for (label, ensemble, quantity), (left, right) in zip(drawn, rows, strict=True):
        ensemble.plot(quantity, ax=left, units=units)
        ensemble.plot_exceedance(quantity, ax=right, units=units)
        runs = f"{int(ensemble.valid.sum())} runs"
        left.set_title(f"{label}, {runs}" if label else runs, loc="left", fontsize="medium")
    if title:
        figure.suptitle(title)
    return figure


def plot_histogram(
    ensemble: Ensemble,
    quantity: str,
    names: Sequence[str] | None,
    ax: Axes | None,
    units: Units | None,
) -> Axes:
    """Draw what `Ensemble.plot` documents."""
    values = ensemble._sorted(quantity)
    columns = _columns(ensemble, quantity, names)
    ax = ax or new_axes()
    scale, unit = _scale(quantity, units)
    for i, (name, column) in enumerate(columns):
        (color, dashes), drawn = line_style(i), values[:, column] / scale
        bins = min(_BINS, len(np.histogram_bin_edges(drawn, "auto")) - 1)
        ax.hist(drawn, bins, density=True, histtype="stepfilled", fc=color, alpha=0.12)
        ax.hist(
            drawn, bins, density=True, histtype="step", ec=color, ls=dashes,
            lw=nested_width(i, len(columns)), label=name,
        )  # fmt: skip
    if quantity in ("max_load", "min_load"):
        _mark_static(ax, ensemble, columns, scale)
    if quantity == "min_load":
        ax.axvline(0.0, color="0.35", lw=0.9)
    ax.set_xlabel(with_unit(LABELS[quantity], unit))
    ax.set_ylabel(with_unit("density of runs", f"1/{unit}" if unit else ""))
    legend_above(ax, crossed=True)
    return ax


def _mark_static(
    ax: Axes, ensemble: Ensemble, columns: Sequence[tuple[str, int]], scale: float
) -> None:
    """Mark each static load once with a line; none if it differs between runs."""
    static = ensemble.static_load[0]
    if not (ensemble.static_load == static).all():
        return
    colors: dict[float, str] = {}
    for i, (_, column) in enumerate(columns):
        colors.setdefault(float(static[column]) / scale, line_style(i)[0])
    for load, color in colors.items():
        ax.axvline(load, color=color, lw=1.1, ls=STATIC_DASHES)
    name_static(ax)


def plot_exceedance(
    ensemble: Ensemble,
    quantity: str,
    names: Sequence[str] | None,
    confidence: float,
    ax: Axes | None,
    units: Units | None,
) -> Axes:
    """Draw what `Ensemble.plot_exceedance` documents."""
    values = ensemble._sorted(quantity)
    columns = _columns(ensemble, quantity, names)
    ax = ax or new_axes()
    scale, unit = _scale(quantity, units)
    runs, below = values.shape[0], quantity in DOWNWARD
    # Equally dense in every power of ten; the last step ends at the extreme of all runs.
    counts = np.unique(np.geomspace(1, runs, _LEVELS).astype(int))
    for i, (name, column) in enumerate(columns):
        one = values[:, column]
        levels = one[counts - 1] if below else one[(runs - 1 - counts[counts < runs])[::-1]]
        levels = np.unique(np.concatenate((one[:1], levels)))
        found = ensemble.exceedance(quantity, levels, confidence=confidence)
        share, low, high = (part[:, column] for part in (found.value, found.low, found.high))
        (color, dashes), width = line_style(i), nested_width(i, len(columns))
        at = np.append(levels, one[-1]) / scale
        share, low, high = (np.append(part, part[-1]) for part in (share, low, high))
        ax.plot(at, share, color, ls=dashes, lw=width, drawstyle="steps-post", label=name)
        ax.fill_between(at, low, high, step="post", color=color, alpha=0.15, lw=0)
    ax.set_yscale("log")
    ax.set_ylim(0.5 / runs, 1.5)
    ax.set_xlabel(with_unit(LABELS[quantity], unit))
    ax.set_ylabel(f"share of runs {'at or below' if below else 'above'}")
    ax.legend(framealpha=0.9, edgecolor="none", fontsize="small")
    ax.grid(alpha=0.25)
    return ax


def _columns(
    ensemble: Ensemble, quantity: str, names: Sequence[str] | None
) -> list[tuple[str, int]]:
    """Names and columns of what is to be drawn."""
    there = names_of(ensemble, quantity)
    kind = "gear" if DIMENSIONS[quantity] == FORCE else "station"
    return [(name, there.index(name)) for name in shown("names", names, there, kind)]


def _scale(quantity: str, units: Units | None) -> tuple[float, str]:
    """Divisor for a quantity on its axis, and the unit to print there."""
    if DIMENSIONS[quantity] == FORCE:
        return load_unit(units)
    units = check_units(units)
    return (1.0, "") if units is None else (units.standard_gravity, "g")
