"""What all figures share: axes, colours, units, legends (extra ``plot``)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ._core import InputError
from ._extras import need
from ._quantities import ACCELERATION_LIMIT
from .units import THOUSAND, check_units

if TYPE_CHECKING:
    from collections.abc import Sequence, Sized

    from matplotlib.axes import Axes

    from ._results import Aircraft
    from .units import Dimension, Units

#: Distinguishable with any colour vision (Okabe and Ito), blue and vermilion first.
COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")

DASHES = ("-", "--", ":")

#: Dashes of static loads, longer than any in `DASHES`.
STATIC_DASHES = (0, (6, 3))

#: Labels of lines that mark a level.
STATIC, LIMIT = "static", f"±{ACCELERATION_LIMIT} g"


def require() -> None:
    """Raise an `ImportError` that names the extra if matplotlib is missing."""
    need("figures", "plot", "matplotlib")


def new_axes() -> Axes:
    """Make the axes of a new figure."""
    require()
    import matplotlib.pyplot as plt

    return plt.subplots(layout="constrained")[1]


def axis_label(quantity: str, dimension: Dimension, units: Units | None) -> str:
    """Label of an axis, with the unit if units are given."""
    units = check_units(units)
    return with_unit(quantity, units.name(dimension) if units else "")


def load_unit(units: Units | None) -> tuple[float, str]:
    """Divisor for loads on an axis, and their unit there."""
    units = check_units(units)
    if units is None:
        return 1.0, ""
    return (1e3, THOUSAND[units.force]) if units.force in THOUSAND else (1.0, units.force)


def with_unit(what: str, unit: str) -> str:
    """Label of an axis, with the unit if there is one."""
    return f"{what} [{unit}]" if unit else what


def in_g(what: str, aircraft: Aircraft, units: Units | None) -> float:
    """Size of one g on an axis: standard gravity or, without units, the aircraft's."""
    units = check_units(units)
    if units is not None:
        return units.standard_gravity
    if not aircraft.gravity:
        raise InputError(f"{what}: without units g is the aircraft's gravity, which is 0")
    return aircraft.gravity


def shown(argument: str, names: Sequence[str] | None, there: Sequence[str], kind: str) -> list[str]:
    """Check the names of what is to be drawn; by default all there are."""
    if isinstance(names, str):
        raise InputError(f"{argument} = {names!r} is a single name; give a list, [{names!r}]")
    if names is not None and not isinstance(names, Iterable):
        raise InputError(f"{argument} = {names!r} is not a list of names")
    wanted = list(there if names is None else names)
    if not wanted:
        raise InputError(f"{argument} is empty")
    for i, name in enumerate(wanted):
        if name not in there:
            raise InputError(
                f"{argument}[{i}] = {name!r}: no such {kind}; there are {tuple(there)}"
            )
    return wanted


def prefix(label: str) -> str:
    """Begin the names of a run's lines in a legend."""
    if not isinstance(label, str):
        raise InputError(f"label = {label!r} is not text")
    return f"{label}: " if label else ""


def lines_there(ax: Axes) -> int:
    """Count the lines that the legend names, but for those that mark a level."""
    there = ax.get_legend_handles_labels()[1]
    return len(there) - there.count(STATIC) - there.count(LIMIT)


def line_style(i: int) -> tuple[str, str]:
    """Colour and dashes of the i-th line; the first eighteen all differ."""
    return COLORS[i % len(COLORS)], DASHES[i // len(COLORS) % len(DASHES)]


def nested_width(i: int, count: int) -> float:
    """Width of the i-th line, thin over wide, so that equal curves do not hide each other."""
    return 1.1 + min(0.7, 2.8 / count) * (count - 1 - i)


def marker(at: Sized) -> str:
    """Marker of a line: a dot for a single point, which no line would show."""
    return "o" if len(at) == 1 else ""


def mark_static(ax: Axes, load: float, color: str, label: str = "") -> None:
    """Mark a static load with a dashed line."""
    ax.axhline(load, color=color, lw=0.9, ls=STATIC_DASHES, label=label)


def name_static(ax: Axes) -> None:
    """Name the lines of static loads, once for the gears in all colours, last in the legend."""
    if STATIC not in ax.get_legend_handles_labels()[1]:
        ax.plot([], [], color="0.35", lw=0.9, ls=STATIC_DASHES, label=STATIC)


def mark_limits(ax: Axes, *signs: float) -> None:
    """Mark the acceleration beyond which a runway counts as rough, once, on an axis in g."""
    if LIMIT in ax.get_legend_handles_labels()[1]:
        return
    for i, sign in enumerate(signs):
        level = sign * ACCELERATION_LIMIT
        ax.axhline(level, color="0.2", lw=0.9, ls="--", label="" if i else LIMIT)


def columns_that_fit(ax: Axes, labels: Sequence[str]) -> int:
    """Columns of a small legend in the width of the axes, at most four."""
    # In characters of this size, fourteen per inch; the sample of a line takes six.
    room = 14.0 * ax.get_window_extent().width / ax.figure.dpi
    widest = max(len(line) for label in labels for line in label.split("\n"))
    return max(1, min(4, len(labels), int(room / (6 + widest))))


def legend_above(ax: Axes, *, crossed: bool = False) -> None:
    """Put the legend above the curves, in as many columns as fit, at most four."""
    labels = ax.get_legend_handles_labels()[1]
    across = columns_that_fit(ax, labels)
    rows = -(-len(labels) // across)
    # From everything drawn: an earlier call has set limits for fewer curves.
    ax.autoscale(axis="y")
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + (0.08 + 0.1 * rows) * (high - low))
    # On a ground of its own where vertical lines pass.
    look: dict[str, Any] = (
        {"framealpha": 0.9, "edgecolor": "none"} if crossed else {"frameon": False}
    )
    ax.legend(loc="upper right", ncols=across, fontsize="small", **look)
    ax.grid(alpha=0.25)
