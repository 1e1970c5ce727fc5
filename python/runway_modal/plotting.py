"""Figures of responses and profiles (extra ``plot``)."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import fill
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from ._axes import (
    DASHES,
    STATIC,
    axis_label,
    columns_that_fit,
    in_g,
    legend_above,
    line_style,
    lines_there,
    load_unit,
    mark_limits,
    mark_static,
    marker,
    new_axes,
    prefix,
    require,
    shown,
    with_unit,
)
from ._core import InputError
from ._input import one_of
from .units import LENGTH, TIME

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from ._results import Against, Results
    from .profile import Profile
    from .units import Units

    _Dashes: TypeAlias = str | tuple[float, tuple[float, ...]]

__all__ = ["loads_over_profile"]

#: Of elevations, all in the colour of their run.
_GROUND_DASHES: tuple[_Dashes, ...] = (
    *("-", "--", ":", "-."),
    *((0, pattern) for pattern in ((9, 3), (6, 2, 1, 2, 1, 2), (1, 4), (9, 2, 3, 2))),
)


def loads_over_profile(
    responses: Mapping[str, Results],
    gears: Mapping[str, str],
    title: str = "",
    *,
    units: Units | None = None,
    against: Against = "time",
    stations: Sequence[str] = (),
) -> Figure:
    """
    Draw gear loads, and accelerations if wanted, over the profile that causes them.

    Parameters
    ----------
    responses : mapping of str to Response
        Runs, linear or nonlinear, by the label of their line. Runs over different ground (against
        time, also at different speeds) each have their own line of elevations.
    gears : mapping of str to str
        Gears to show, one panel each: the label of the panel by gear name.
    title : str
        Title of the figure.
    units : Units, optional
        Units of the responses, for the axis labels; loads in lbf and N are drawn in kip and kN.
    against : {"time", "distance"}
        Abscissa; use distance where the runs differ in speed.
    stations : sequence of str
        Stations whose vertical accelerations to show, one panel each, as in
        `Response.plot_acceleration`.

    Returns
    -------
    matplotlib.figure.Figure
        The figure: loads with the static load as a dashed line, elevations below.

    Raises
    ------
    InputError
        If a gear or station is unknown, there is no gear or no response, or another argument is of
        the wrong kind.
    ImportError
        If matplotlib is not installed.

    Examples
    --------
    >>> import runway_modal as rm
    >>> from runway_modal import plotting
    >>> mat = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    >>> figure = plotting.loads_over_profile({"Table 3": mat}, {"left": "Main gear"})
    >>> len(figure.axes)
    2
    """
    require()
    from matplotlib.figure import Figure

    if not isinstance(responses, Mapping):
        raise InputError(f"responses = {responses!r} is not a mapping from labels to responses")
    if not responses:
        raise InputError("responses is empty")
    abscissa = _abscissa(against, units)
    columns = _columns(next(iter(responses.values())), gears)
    for run in responses.values() if stations else ():
        shown("stations", stations, tuple(run.acceleration), "station")
    above = len(gears) + len(stations)
    heights = [3.0] * above + [1.2]
    figure = Figure(figsize=(8.0, 2.6 * above + 1.8), layout="constrained")
    *panels, ground = figure.subplots(above + 1, 1, sharex=True, height_ratios=heights)
    for panel, (label, column) in zip(panels[: len(gears)], columns, strict=True):
        loads = [(name, run, column) for name, run in responses.items()]
        _draw_loads(panel, loads, units, against)
        panel.set_ylabel(fill(f"{label} {panel.get_ylabel()}", 28))
    for panel, station in zip(panels[len(gears) :], stations, strict=True):
        accelerations = [(name, run, station) for name, run in responses.items()]
        _draw_accelerations(panel, accelerations, units, against)
        panel.set_ylabel(f"{station}\n{panel.get_ylabel()}")
    _draw_elevations(ground, responses, columns, units, against)
    ends = np.array([getattr(run, against)[[0, -1]] for run in responses.values()])
    if ends.min() < ends.max():
        ground.set_xlim(ends.min(), ends.max())
    ground.set_xlabel(abscissa)
    if title:
        figure.suptitle(title)
    return figure


def plot_loads(
    response: Results,
    gears: Sequence[str] | None,
    against: Against,
    label: str,
    ax: Axes | None,
    units: Units | None,
) -> Axes:
    """Draw what `Response.plot` documents."""
    abscissa = _abscissa(against, units)
    names = shown("gears", gears, response.gear_names, "gear")
    run = prefix(label)
    columns = _columns(response, {gear: f"{run}{gear}" for gear in names})
    ax = ax or new_axes()
    _draw_loads(ax, [(name, response, column) for name, column in columns], units, against)
    ax.set_xlabel(abscissa)
    return ax


def plot_accelerations(
    response: Results,
    stations: Sequence[str] | None,
    against: Against,
    label: str,
    ax: Axes | None,
    units: Units | None,
) -> Axes:
    """Draw what `Response.plot_acceleration` documents."""
    abscissa = _abscissa(against, units)
    wanted = shown("stations", stations, tuple(response.acceleration), "station")
    run = prefix(label)
    ax = ax or new_axes()
    lines = [(f"{run}{station}", response, station) for station in wanted]
    _draw_accelerations(ax, lines, units, against)
    ax.set_xlabel(abscissa)
    return ax


def _abscissa(against: Against, units: Units | None) -> str:
    """Label of the axis that a response is drawn against."""
    if one_of("against", against, ("time", "distance")) == "time":
        return axis_label("time", TIME, units)
    return axis_label("distance of the foremost gear", LENGTH, units)


def _columns(response: Results, gears: Mapping[str, str]) -> list[tuple[str, int]]:
    """Label and column of each gear."""
    names = response.gear_names
    shown("gears", list(gears), names, "gear")
    return [(label, names.index(gear)) for gear, label in gears.items()]


def _draw_loads(
    ax: Axes, lines: Sequence[tuple[str, Results, int]], units: Units | None, against: Against
) -> None:
    """Draw loads by label, response and column, each static load once."""
    scale, unit = load_unit(units)
    drawn: list[NDArray[np.float64]] = []
    named = STATIC in ax.get_legend_handles_labels()[1]
    for i, (label, response, column) in enumerate(lines, lines_there(ax)):
        load = response.load[:, column]
        # Equal curves would hide each other.
        hidden = sum(np.array_equal(load, other) for other in drawn)
        drawn.append(load)
        color, dashes = line_style(i)
        turn = DASHES.index(dashes) + hidden
        # From there on, the first dashes that no line of this colour has yet, if there are any.
        taken = [line.get_linestyle() for line in ax.lines if line.get_color() == color]
        turns = [DASHES[(turn + k) % len(DASHES)] for k in range(len(DASHES))]
        dashes = next((one for one in turns if one not in taken), turns[0])
        at = getattr(response, against)
        ax.plot(at, load / scale, color=color, marker=marker(at), ls=dashes, lw=1.4, label=label)
    static = dict.fromkeys(float(run.static_load[column]) / scale for _, run, column in lines)
    for i, level in enumerate(static):
        mark_static(ax, level, "0.35", "" if i or named else STATIC)
    ax.set_ylabel(with_unit("load", unit))
    legend_above(ax)


def _draw_accelerations(
    ax: Axes, lines: Sequence[tuple[str, Results, str]], units: Units | None, against: Against
) -> None:
    """Draw accelerations in g by label, response and station, with the limits once."""
    for i, (label, response, station) in enumerate(lines, lines_there(ax)):
        color, dashes = line_style(i)
        share = response.acceleration[station] / in_g("response", response.aircraft, units)
        at = getattr(response, against)
        ax.plot(at, share, color=color, ls=dashes, lw=1.2, marker=marker(at), label=label)
    mark_limits(ax, 1.0, -1.0)
    ax.set_ylabel("vertical acceleration [g]")
    legend_above(ax)


def _draw_elevations(
    ax: Axes,
    responses: Mapping[str, Results],
    columns: Sequence[tuple[str, int]],
    units: Units | None,
    against: Against,
) -> None:
    """Draw the elevations under gears by label; equal elevations share a line."""
    from matplotlib.lines import Line2D

    grounds: dict[str, Results] = {}
    # The longest run shows most.
    for name, run in sorted(responses.items(), key=lambda item: -getattr(item[1], against)[-1]):
        if not any(_same_ground(there, run, columns, against) for there in grounds.values()):
            grounds[name] = run
    drawn: list[NDArray[np.float64]] = []
    keys: dict[tuple[str, _Dashes], None] = {}
    for run_name, response in grounds.items():
        # The colour of its loads; black where the runs share the ground.
        place = list(responses).index(run_name)
        color = "k" if len(grounds) == 1 else line_style(place)[0]
        lines: dict[bytes, tuple[NDArray[np.float64], list[str]]] = {}
        for label, column in columns:
            elevation = response.elevation[:, column]
            lines.setdefault(elevation.tobytes(), (elevation, []))[1].append(label)
        for i, (elevation, labels) in enumerate(lines.values()):
            # Within the label a word is not capitalised; a name of one letter stays as it is.
            words = (each[0].lower() + each[1:] if each[1:2].islower() else each for each in labels)
            dashes = _GROUND_DASHES[i % len(_GROUND_DASHES)]
            at = getattr(response, against)
            ax.plot(at, elevation, color=color, marker=marker(at), ls=dashes, lw=1.1)
            keys[f"under the {', '.join(words)}", dashes] = None
            drawn.append(elevation)
    labels = [fill(under, 60) for under, _ in keys]
    handles = [
        Line2D([], [], color="k", ls=style, lw=1.1, label=label)
        for label, (_, style) in zip(labels, keys, strict=True)
    ]
    across = columns_that_fit(ax, labels)
    rows = -(-sum(label.count("\n") + 1 for label in labels) // across)
    low, high = min(0.0, *map(np.min, drawn)), max(0.0, *map(np.max, drawn))
    height = high - low or 1.0
    ax.set_ylim(low - 0.15 * height, high + (0.3 + 0.6 * rows) * height)
    ax.set_ylabel(axis_label("elevation", LENGTH, units))
    ax.legend(handles=handles, loc="upper right", ncols=across, frameon=False, fontsize="small")
    ax.grid(alpha=0.25)


def _same_ground(
    one: Results, other: Results, columns: Sequence[tuple[str, int]], against: Against
) -> bool:
    """Whether two runs meet the same elevations at the same time or distance."""
    at, there = getattr(one, against), getattr(other, against)

    def area(height: NDArray[np.float64]) -> float:
        return float(abs(height[1:] + height[:-1]) @ np.diff(at))

    for _, column in columns:
        mine = one.elevation[:, column]
        others = np.interp(at, there, other.elevation[:, column])
        # Areas are compared, not samples: at a step a sample may show either side.
        if area(others - mine) > 0.01 * max(area(mine - mine[0]), area(others - mine[0])):
            return False
    return True


def plot_profile(profile: Profile, ax: Axes | None, units: Units | None) -> Axes:
    """Draw what `Profile.plot` documents."""
    ax = ax or new_axes()
    x, z = profile.x, profile.z
    # The runway continues level on both sides.
    beyond = 0.1 * (x[-1] - x[0]) or 1.0
    stations = np.concatenate([[x[0] - beyond], x, [x[-1] + beyond]])
    ax.plot(stations, np.concatenate([z[:1], z, z[-1:]]), "k", lw=1.1)
    ax.set_xlabel(axis_label("station", LENGTH, units))
    ax.set_ylabel(axis_label("elevation", LENGTH, units))
    ax.grid(alpha=0.25)
    return ax
