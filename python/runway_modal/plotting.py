"""Figures of responses (extra ``plot``)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from matplotlib.figure import Figure

    from .response import Response


def loads_over_profile(
    responses: Mapping[str, Response], gears: Mapping[str, str], title: str = ""
) -> Figure:
    """
    Draw gear loads against time over the profile that causes them.

    Parameters
    ----------
    responses : mapping of str to Response
        Runs over the same tracks, by the label of their line.
    gears : mapping of str to str
        Gears to show, one panel each, by the title of their panel.
    title : str
        Title of the figure.

    Returns
    -------
    matplotlib.figure.Figure
        The figure: loads in kip with the static load as a line, elevations in inches below.

    Raises
    ------
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
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 2.6 * len(gears) + 1.8), layout="constrained")
    panels = len(gears) + 1
    axes = figure.subplots(panels, 1, sharex=True, height_ratios=[3.0] * len(gears) + [1.2])
    first = next(iter(responses.values()))
    names = first.modes.aircraft.gear_names
    for panel, (gear, label) in zip(axes, gears.items(), strict=False):
        column = names.index(gear)
        for (line, response), color in zip(responses.items(), _COLORS, strict=False):
            panel.plot(response.time, response.load[:, column] / 1e3, color, label=line, lw=1.4)
        static = first.static_load[column] / 1e3
        panel.axhline(static, color="0.35", lw=0.9, ls="--", label="static")
        panel.set_ylabel(f"{label} load [kip]")
        panel.legend(loc="upper right", ncols=len(responses) + 1, frameon=False, fontsize="small")
        _headroom(panel)
    _tracks(axes[-1], first, gears)
    axes[-1].set_xlabel("time [s]")
    axes[-1].set_xlim(first.time[0], first.time[-1])
    if title:
        figure.suptitle(title)
    return figure


#: Distinct with any colour vision (Okabe and Ito's blue and vermilion).
_COLORS = ("#0072b2", "#d55e00")


def _headroom(panel: Any) -> None:
    """Leave room for the legend above the curves."""
    low, high = panel.get_ylim()
    panel.set_ylim(low, high + 0.18 * (high - low))
    panel.grid(alpha=0.25)


def _tracks(panel: Any, response: Response, gears: Mapping[str, str]) -> None:
    """Elevation under each gear shown."""
    names = response.modes.aircraft.gear_names
    for (gear, label), style in zip(gears.items(), ("-", ":"), strict=False):
        elevation = response.elevation[:, names.index(gear)]
        panel.plot(
            response.time, elevation, "k", ls=style, lw=1.1, label=f"under the {label.lower()}"
        )
    high = float(np.abs(response.elevation).max()) or 1.0
    panel.set_ylim(min(0.0, response.elevation.min()) - 0.15 * high, 1.9 * high)
    panel.set_ylabel("elevation [in]")
    panel.legend(loc="upper right", ncols=2, frameon=False, fontsize="small")
    panel.grid(alpha=0.25)
