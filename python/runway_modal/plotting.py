"""Figures of responses and profiles (extra ``plot``)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .tables import aircraft_of
from .units import THOUSAND

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .profile import Profile
    from .response import Response
    from .units import Units


def loads_over_profile(
    responses: Mapping[str, Response],
    gears: Mapping[str, str],
    title: str = "",
    *,
    units: Units | None = None,
    against: Literal["time", "distance"] = "time",
) -> Figure:
    """
    Draw gear loads over the profile that causes them.

    Parameters
    ----------
    responses : mapping of str to Response
        Runs over the same tracks, by the label of their line.
    gears : mapping of str to str
        Gears to show, one panel each, by the title of their panel.
    title : str
        Title of the figure.
    units : Units, optional
        Units of the responses, for the axes; loads in lbf and N are drawn in kip and kN.
    against : {"time", "distance"}
        Abscissa; distance where the runs differ in speed.

    Returns
    -------
    matplotlib.figure.Figure
        The figure: loads with the static load as a line, elevations below.

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
    _require()
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 2.6 * len(gears) + 1.8), layout="constrained")
    panels = len(gears) + 1
    axes = figure.subplots(panels, 1, sharex=True, height_ratios=[3.0] * len(gears) + [1.2])
    scale, unit = _load_unit(units)
    first = next(iter(responses.values()))
    names = aircraft_of(first).gear_names
    for panel, (gear, label) in zip(axes, gears.items(), strict=False):
        column = names.index(gear)
        for i, (line, response) in enumerate(responses.items()):
            abscissa = getattr(response, against)
            load = response.load[:, column] / scale
            panel.plot(abscissa, load, _COLORS[i % len(_COLORS)], label=line, lw=1.4)
        _static(panel, first.static_load[column] / scale, "0.35", "static")
        panel.set_ylabel(f"{label} load{unit}")
        _legend(panel, len(responses) + 1)
    # With distance the tracks are the same for all; the longest run shows most of them.
    longest = max(responses.values(), key=lambda response: float(getattr(response, against)[-1]))
    plot_elevations(longest, gears, axes[-1], units, against)
    ends = [getattr(response, against)[[0, -1]] for response in responses.values()]
    axes[-1].set_xlim(min(e[0] for e in ends), max(e[1] for e in ends))
    if title:
        figure.suptitle(title)
    return figure


def plot_loads(
    response: Response, gears: Sequence[str] | None, ax: Axes | None, units: Units | None
) -> Axes:
    """Draw what `Response.plot` documents."""
    names = aircraft_of(response).gear_names
    ax = ax or _axes()
    scale, unit = _load_unit(units)
    for i, gear in enumerate(names if gears is None else gears):
        column = names.index(gear)
        color = _COLORS[i % len(_COLORS)]
        # Gears that move as one would hide each other.
        style = ("-", "--", ":")[i % 3]
        ax.plot(response.time, response.load[:, column] / scale, color, ls=style, label=gear)
        _static(ax, response.static_load[column] / scale, color, f"{gear}, static")
    ax.set_ylabel(f"load{unit}")
    ax.set_xlabel("time [s]" if units else "time")
    _legend(ax, 3)
    return ax


def plot_elevations(
    response: Response,
    gears: Mapping[str, str],
    ax: Axes,
    units: Units | None,
    against: str = "time",
) -> None:
    """Draw the elevation under the gears shown."""
    names = aircraft_of(response).gear_names
    for i, (gear, label) in enumerate(gears.items()):
        elevation = response.elevation[:, names.index(gear)]
        style = ("-", ":", "--", "-.")[i % 4]
        ax.plot(
            getattr(response, against), elevation, "k", ls=style, lw=1.1,
            label=f"under the {label[0].lower()}{label[1:]}",
        )  # fmt: skip
    high = float(np.abs(response.elevation).max()) or 1.0
    ax.set_ylim(min(0.0, response.elevation.min()) - 0.15 * high, 1.9 * high)
    length = f" [{units.length}]" if units else ""
    ax.set_ylabel(f"elevation{length}")
    ax.set_xlabel(
        (f"time{' [s]' if units else ''}")
        if against == "time"
        else f"distance of the foremost gear{length}"
    )
    ax.legend(loc="upper right", ncols=3, frameon=False, fontsize="small")
    ax.grid(alpha=0.25)


def plot_profile(profile: Profile, ax: Axes | None, units: Units | None) -> Axes:
    """Draw what `Profile.plot` documents."""
    ax = ax or _axes()
    x, z = profile.x, profile.z
    # The runway goes on, level, on both sides.
    beyond = 0.1 * (x[-1] - x[0]) or 1.0
    stations = np.concatenate([[x[0] - beyond], x, [x[-1] + beyond]])
    ax.plot(stations, np.concatenate([z[:1], z, z[-1:]]), "k", lw=1.1)
    unit = f" [{units.length}]" if units else ""
    ax.set_xlabel(f"station{unit}")
    ax.set_ylabel(f"elevation{unit}")
    ax.grid(alpha=0.25)
    return ax


#: Distinct with any colour vision (Okabe and Ito), blue and vermilion first.
_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")


def _require() -> None:
    try:
        import matplotlib as mpl  # noqa: F401
    except ImportError:
        raise ImportError("figures need matplotlib: pip install runway_modal[plot]") from None


def _axes() -> Axes:
    _require()
    import matplotlib.pyplot as plt

    return plt.subplots(layout="constrained")[1]


def _load_unit(units: Units | None) -> tuple[float, str]:
    """Divisor of loads and their unit for an axis."""
    if units is None:
        return 1.0, ""
    if units.force in THOUSAND:
        return 1e3, f" [{THOUSAND[units.force]}]"
    return 1.0, f" [{units.force}]"


def _static(panel: Axes, load: float, color: str, label: str) -> None:
    panel.axhline(load, color=color, lw=0.9, ls=(0, (6, 3)), label=label)


def _legend(panel: Any, columns: int) -> None:
    """Legend above the curves."""
    rows = -(-len(panel.get_legend_handles_labels()[1]) // min(columns, 4))
    low, high = panel.get_ylim()
    panel.set_ylim(low, high + (0.08 + 0.1 * rows) * (high - low))
    panel.legend(loc="upper right", ncols=min(columns, 4), frameon=False, fontsize="small")
    panel.grid(alpha=0.25)
