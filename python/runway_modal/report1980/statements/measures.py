"""Main and nose gear loads of any model on one time axis, so that models can be compared."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from runway_modal.report1980 import runs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from runway_modal.profile import Profile
    from runway_modal.report1980.runs import Run

    Array = NDArray[np.float64]

#: Models by name: the bounce model with Table 3's and Table 4's frequency, the three-degree-of-
#: freedom model with their stiffnesses, and the nonlinear reference, which stands for TAXI.
Model = Literal["sdof 1.91", "sdof 1.80", "3dof 3", "3dof 4", "taxi"]


def run(model: Model, mat: Profile) -> Run:
    """Run a model over a mat, sampled at `runs.TIMES`."""
    if model == "taxi":
        return runs.taxi(mat)
    simulate = runs.one_dof if model.startswith("sdof") else runs.three_dof
    stiffness: Literal["static", "equivalent"] = (
        "static" if model in ("sdof 1.91", "3dof 3") else "equivalent"
    )
    return simulate(stiffness, mat).at(runs.TIMES)


def _main_column(response: Run) -> int:
    """Find the bounce model's only gear; else the left one, which loads as the right does."""
    return min(1, response.static_load.size - 1)


def main(response: Run) -> Array:
    """
    Take the main gear load over its static load.

    The bounce model carries the whole weight on one gear; over static load all are alike.
    """
    column = _main_column(response)
    return np.asarray(response.load[:, column] / response.static_load[column])


def nose(response: Run) -> Array:
    """Take the nose gear load over its static load."""
    return np.asarray(response.load[:, 0] / response.static_load[0])


def largest_and_smallest(response: Run) -> tuple[float, float]:
    """Find true extremes of one main gear's load [kip]; of the bounce model's half, as of two."""
    column = _main_column(response)
    found = response.extremes()
    gears = 2.0 if response.static_load.size == 1 else 1.0
    return (
        float(found.max_load[column]) / gears / 1e3,
        float(found.min_load[column]) / gears / 1e3,
    )


def trailing_edge(response: Run, mat: Profile) -> float:
    """Divide the true range of main gear load after the mat by that on it; > 1: amplified."""
    column = _main_column(response)
    begin, end, off = (mat.x[1:4] + runs.WHEELBASE) / runs.MAT_SPEED
    after = runs.load_range(response, column, off, float(runs.TIMES[-1]))
    return after / runs.load_range(response, column, begin, end)


def on(mat: Profile) -> slice:
    """Select samples while the mains are on the mat's level."""
    begin, end = (mat.x[1:3] + runs.WHEELBASE) / runs.MAT_SPEED
    return slice(*np.searchsorted(runs.TIMES, (begin, end)))


def after(mat: Profile) -> slice:
    """Select samples since the mains left the mat."""
    off = (mat.x[-1] + runs.WHEELBASE) / runs.MAT_SPEED
    return slice(int(np.searchsorted(runs.TIMES, off)), None)


def difference(one: Array, other: Array) -> float:
    """Divide the root mean square of a difference by that of `other`'s dynamic part."""
    return float(np.sqrt(np.mean((one - other) ** 2) / np.mean((other - 1.0) ** 2)))


def rises(load: Array) -> NDArray[np.intp]:
    """Find the samples after which a load over its static load rises through 1, one a cycle."""
    return np.flatnonzero((load[:-1] < 1.0) & (load[1:] >= 1.0))


def frequency(load: Array, time: Array) -> float:
    """Mean frequency of a load over its static load [Hz]."""
    before = rises(load)
    share = (1.0 - load[before]) / (load[before + 1] - load[before])
    through = time[before] + share * (time[before + 1] - time[before])
    return float((through.size - 1) / (through[-1] - through[0]))


def minima(load: Array) -> Array:
    """Local minima, in the order of time."""
    inner = load[1:-1]
    return np.asarray(inner[(inner < load[:-2]) & (inner <= load[2:])])
