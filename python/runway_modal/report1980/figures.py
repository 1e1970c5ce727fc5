"""The report's Figures 3 to 19: what each shows, and its picture."""

from __future__ import annotations

import io
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from . import runs
from .tables import MAT_KNOTS, SPALL_KNOTS

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import matplotlib.figure
    from numpy.typing import NDArray

    from runway_modal.profile import Profile

    from .runs import Run


@dataclass(frozen=True, slots=True)
class Picture:
    """An SVG and what it shows in words."""

    svg: bytes
    alt: str


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure of the report."""

    number: int
    caption: str
    #: What was run here, and what of it is inferred.
    note: str
    draw: Callable[[], Picture]


_BLUE, _GREY, _EARTH = "#0b5394", "#6b6b6b", "#8a5a2b"

_STYLE: dict[Any, Any] = {
    "svg.hashsalt": "runway_modal",
    "svg.fonttype": "path",
    "font.size": 9.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#444444",
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "grid.color": "#e3e3e3",
    "grid.linewidth": 0.7,
}

#: Gears of the three-degree-of-freedom model by the title of their panel.
_MAT_GEARS = {"Nose gear": 0, "Main gear": 1}
_SPALL_GEARS = {"Nose gear": 0, "Left main gear": 1, "Right main gear": 2}


def _save(height: float, paint: Callable[[matplotlib.figure.Figure], None]) -> bytes:
    """Draw in our style; the same bytes every time: no date, no random names."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(7.4, height), layout="constrained")
        paint(figure)
        file = io.BytesIO()
        figure.savefig(file, format="svg", metadata={"Date": None, "Creator": None})
    return file.getvalue()


def _loads(simulate: Callable[[], Run], panels: Mapping[str, int]) -> Picture:
    """Draw loads against time, static loads as lines, the tracks beneath."""
    run = _with_approach(simulate())
    heights = [2.6] * len(panels) + [1.0]

    def paint(figure: matplotlib.figure.Figure) -> None:
        *axes, ground = figure.subplots(len(heights), 1, sharex=True, height_ratios=heights)
        for axis, (title, column) in zip(axes, panels.items(), strict=True):
            axis.plot(run.time, run.load[:, column] / 1e3, color=_BLUE, lw=1.3)
            static = run.static_load[column] / 1e3
            axis.axhline(static, color=_GREY, lw=1.0, ls="--")
            _beside(axis, static, f"static {static:.1f}")
            low, high = (float(each) / 1e3 for each in _span(run.load[:, column]))
            axis.set_ylim(low - 0.04 * (high - low), high + 0.08 * (high - low))
            axis.set_title(title, loc="left", fontsize=10, fontweight="bold")
            axis.set_ylabel("load [kip]")
        _tracks(ground, run, panels)
        ground.set_xlim(run.time[0], run.time[-1])
        ground.set_xlabel("time [s]; 0 when the nose gear is at the profile's start")

    described = "; ".join(
        f"{title.lower()} between {run.load[:, column].min() / 1e3:.1f} and "
        f"{run.load[:, column].max() / 1e3:.1f} kip, static {run.static_load[column] / 1e3:.1f}"
        for title, column in panels.items()
    )
    alt = f"Loads against time over the profile: {described}."
    return Picture(_save(0.85 * sum(heights), paint), alt)


#: Rest before the nose gear meets the profile, for its leading edge to be seen [s].
_APPROACH = 0.25


def _with_approach(run: Run) -> Run:
    """Sample the same run from a little earlier on, finely enough for a smooth line."""
    fine = np.linspace(-_APPROACH, run.time[-1], 1500)
    return run.at(np.union1d(np.append(fine, np.nextafter(0.0, -1.0)), run.time))


def _beside(axis: Any, height: float, text: str) -> None:
    """Label a level line at the right, outside the axes."""
    axis.annotate(
        text,
        (1.0, height),
        xycoords=("axes fraction", "data"),
        xytext=(4, 0),
        textcoords="offset points",
        va="center",
        fontsize=8.5,
        color=_GREY,
        annotation_clip=False,
    )


def _tracks(axis: Any, run: Run, panels: Mapping[str, int]) -> None:
    """Elevation under each gear that has a panel; gears over the same share a line."""
    lines: dict[bytes, tuple[NDArray[np.float64], list[str]]] = {}
    for title, column in panels.items():
        elevation = run.elevation[:, column]
        _, names = lines.setdefault(elevation.tobytes(), (elevation, []))
        names.append(title.removesuffix(" gear").lower())
    for (elevation, names), style in zip(lines.values(), ("-", "--", ":"), strict=False):
        axis.plot(run.time, elevation, color=_EARTH, lw=1.3, ls=style, label=",\n".join(names))
    _level(axis, run.elevation)
    axis.set_ylabel("track [in]")
    axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=8.5)


def _span(values: NDArray[np.float64]) -> tuple[float, float]:
    """Smallest and largest, zero included."""
    return min(0.0, float(values.min())), max(0.0, float(values.max()))


def _level(axis: Any, elevation: NDArray[np.float64]) -> None:
    low, high = _span(elevation)
    axis.set_ylim(low - 0.2 * (high - low), high + 0.2 * (high - low))


def _profiles(profiles: Mapping[str, Profile], margin: float) -> Picture:
    """Elevation against station."""

    def paint(figure: matplotlib.figure.Figure) -> None:
        axes = figure.subplots(len(profiles), 1, squeeze=False)[:, 0]
        for axis, (title, profile) in zip(axes, profiles.items(), strict=True):
            x = np.concatenate(([profile.x[0] - margin], profile.x, [profile.x[-1] + margin]))
            z = np.concatenate((profile.z[:1], profile.z, profile.z[-1:]))
            axis.plot(x, z, color=_EARTH, lw=1.6)
            axis.fill_between(x, z, -10.0, color=_EARTH, alpha=0.12, lw=0)
            axis.set_xlim(x[0], x[-1])
            _level(axis, z)
            axis.set_title(title, loc="left", fontsize=10, fontweight="bold")
            axis.set_ylabel("elevation [in]")
        axes[-1].set_xlabel("station [in] (elevation exaggerated)")

    described = "; ".join(
        f"{title.lower()} from station {profile.x[0]:g} to {profile.x[-1]:g} in, "
        f"{profile.z.min():g} to {profile.z.max():g} in high"
        for title, profile in profiles.items()
    )
    return Picture(_save(1.7 * len(profiles) + 0.3, paint), f"Elevation: {described}.")


_TAXI_NOTE = (
    "Nonlinear reference in the place of TAXI: gas struts (isothermal), tires that only push, 1 % "
    "damping; calibrated (inferred) on the report's stiffnesses over the full mat."
)
_MAT_NOTE = f"{MAT_KNOTS:g} kt, 1 % damping in every mode (printed)."
_SDOF_NOTE = (
    "One mass on one gear, the mains' track; its load is the whole aircraft's. "
    f"{MAT_KNOTS:g} kt, 1 % damping (printed)."
)


def _spall_figures() -> list[Figure]:
    figures = []
    number = 14
    spalls = {"Two-Foot Spall": runs.TWO_FOOT_SPALL, "Double Spall": runs.DOUBLE_SPALL}
    inputs = ("Left Main Gear", "Left Main and Nose Gear", "Three Gear")
    for name, profile in spalls.items():
        for title, gears in zip(inputs, runs.SPALL_INPUTS, strict=True):
            figures.append(
                Figure(
                    number,
                    f"Response to {name} for {title} Input",
                    f"{SPALL_KNOTS:g} kt (printed); 1 % damping and Table 3's stiffness (inferred: "
                    "the text names neither for the spalls).",
                    partial(_loads, partial(runs.spall, "static", profile, gears), _SPALL_GEARS),
                )
            )
            number += 1
    return figures


FIGURES = (
    Figure(
        3,
        "Half Mat Profile",
        "1.5 in thick (published: UFC 3-270-07); 45 ft long with sharp edges (inferred).",
        lambda: _profiles({"Half mat": runs.HALF_MAT}, 200.0),
    ),
    Figure(
        4,
        "TAXI Results for Half Mat Profile",
        _TAXI_NOTE,
        lambda: _loads(lambda: runs.taxi(runs.HALF_MAT), _MAT_GEARS),
    ),
    Figure(
        5,
        "SDOF Results for Half Mat Profile",
        f"{_SDOF_NOTE} 1.91 Hz.",
        lambda: _loads(lambda: runs.one_dof("static", runs.HALF_MAT), {"Whole aircraft": 0}),
    ),
    Figure(
        6,
        "3DOF Results for Half Mat Profile",
        f"{_MAT_NOTE} Table 3's modes.",
        lambda: _loads(lambda: runs.three_dof("static", runs.HALF_MAT), _MAT_GEARS),
    ),
    Figure(
        7,
        "Full Mat Profile",
        "1.5 in thick, 77.5 ft long (published: UFC 3-270-07); 12 in ramps (inferred).",
        lambda: _profiles({"Full mat": runs.FULL_MAT}, 200.0),
    ),
    Figure(
        8,
        "TAXI Code Response to Full Mat Profile",
        _TAXI_NOTE,
        lambda: _loads(lambda: runs.taxi(runs.FULL_MAT), _MAT_GEARS),
    ),
    Figure(
        9,
        "SDOF Code Response to Full Mat Profile",
        f"{_SDOF_NOTE} 1.91 Hz.",
        lambda: _loads(lambda: runs.one_dof("static", runs.FULL_MAT), {"Whole aircraft": 0}),
    ),
    Figure(
        10,
        "3DOF Code Response to Full Mat Profile",
        f"{_MAT_NOTE} Table 3's modes.",
        lambda: _loads(lambda: runs.three_dof("static", runs.FULL_MAT), _MAT_GEARS),
    ),
    Figure(
        11,
        "SDOF Code Response with Frequency = 1.80 Hertz",
        f"{_SDOF_NOTE} 1.80 Hz.",
        lambda: _loads(lambda: runs.one_dof("equivalent", runs.FULL_MAT), {"Whole aircraft": 0}),
    ),
    Figure(
        12,
        "3DOF Code Response with Modified Spring Constants",
        f"{_MAT_NOTE} Table 4's modes.",
        lambda: _loads(lambda: runs.three_dof("equivalent", runs.FULL_MAT), _MAT_GEARS),
    ),
    Figure(
        13,
        "Spall Models",
        "Two feet wide (printed); 1.5 in deep, sharp edges, 4 ft from one to the next (inferred).",
        lambda: _profiles(
            {"Two-foot spall": runs.TWO_FOOT_SPALL, "Double spall": runs.DOUBLE_SPALL}, 24.0
        ),
    ),
    *_spall_figures(),
)
