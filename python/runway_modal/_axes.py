"""What all figures have in common: axes, colours, units, legends (extra ``plot``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .units import THOUSAND, stated

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .units import Dimension, Units

#: Distinct with any colour vision (Okabe and Ito), blue and vermilion first.
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")


def require() -> None:
    """Name the extra if matplotlib is not there."""
    try:
        import matplotlib as mpl  # noqa: F401
    except ImportError:
        raise ImportError("figures need matplotlib: pip install 'runway_modal[plot]'") from None


def new_axes() -> Axes:
    """Axes of a new figure."""
    require()
    import matplotlib.pyplot as plt

    return plt.subplots(layout="constrained")[1]


def axis_label(quantity: str, dimension: Dimension, units: Units | None) -> str:
    """Label of an axis, with its unit if there is one."""
    units = stated(units)
    return f"{quantity} [{units.name(dimension)}]" if units else quantity


def load_unit(units: Units | None) -> tuple[float, str]:
    """Divisor of loads and their unit for an axis."""
    units = stated(units)
    if units is None:
        return 1.0, ""
    if units.force in THOUSAND:
        return 1e3, f" [{THOUSAND[units.force]}]"
    return 1.0, f" [{units.force}]"


def mark_static(ax: Axes, load: float, color: str, label: str) -> None:
    """Mark a static load by a dashed line."""
    ax.axhline(load, color=color, lw=0.9, ls=(0, (6, 3)), label=label)


def legend_above(ax: Axes, columns: int) -> None:
    """Legend above the curves."""
    across = min(columns, 4)
    rows = -(-len(ax.get_legend_handles_labels()[1]) // across)
    # Of all that is drawn: an earlier call has set limits for less.
    ax.autoscale(axis="y")
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + (0.08 + 0.1 * rows) * (high - low))
    ax.legend(loc="upper right", ncols=across, frameon=False, fontsize="small")
    ax.grid(alpha=0.25)
