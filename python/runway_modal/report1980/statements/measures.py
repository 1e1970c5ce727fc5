"""Main and nose gear loads of any model on one time axis, so that models can be compared."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np

from runway_modal.report1980 import runs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from runway_modal.profile import Profile

    Array = NDArray[np.float64]


class _Sampled(Protocol):
    """What linear and nonlinear responses have in common."""

    @property
    def load(self) -> Array: ...

    @property
    def static_load(self) -> Array: ...


#: Models by name: the bounce model with Table 3's and Table 4's frequency, the three-degree-of-
#: freedom model with their stiffnesses, and the nonlinear reference in the place of TAXI.
Model = Literal["sdof 1.91", "sdof 1.80", "3dof 3", "3dof 4", "taxi"]


def _run(model: Model, mat: Profile) -> _Sampled:
    if model == "taxi":
        return runs.taxi(mat)
    simulate = runs.one_dof if model.startswith("sdof") else runs.three_dof
    return simulate("static" if model in ("sdof 1.91", "3dof 3") else "equivalent", mat).at(
        runs.TIMES
    )


def main(model: Model, mat: Profile) -> Array:
    """
    Take the main gear load over its static load, sampled at `runs.TIMES`.

    The bounce model carries the whole weight on one gear; over static load all are alike.
    """
    run = _run(model, mat)
    column = 0 if model.startswith("sdof") else 1
    return np.asarray(run.load[:, column] / run.static_load[column])


def main_kip(model: Model, mat: Profile) -> Array:
    """Load of one main gear [kip]: of the bounce model's, which is the whole aircraft's, half."""
    run = _run(model, mat)
    return np.asarray(run.load[:, 0] / 2e3 if model.startswith("sdof") else run.load[:, 1] / 1e3)


def nose(model: Model, mat: Profile) -> Array:
    """Take the nose gear load over its static load, sampled at `runs.TIMES`."""
    run = _run(model, mat)
    return np.asarray(run.load[:, 0] / run.static_load[0])


def on(mat: Profile) -> NDArray[np.bool_]:
    """When the mains are on the mat's level."""
    begin, end = (mat.x[1:3] + runs.WHEELBASE) / runs.MAT_SPEED
    return np.asarray((begin <= runs.TIMES) & (end > runs.TIMES))


def after(mat: Profile) -> NDArray[np.bool_]:
    """When the mains have left the mat."""
    return np.asarray((mat.x[-1] + runs.WHEELBASE) / runs.MAT_SPEED <= runs.TIMES)


def trailing_edge(model: Model, mat: Profile) -> float:
    """Range of the main gear load after the mat ÷ on it: > 1 amplified, < 1 cancelled."""
    return after_over_on(main(model, mat), mat)


def after_over_on(load: Array, mat: Profile) -> float:
    """Range of a main gear load after the mat ÷ on it."""
    return float(np.ptp(load[after(mat)]) / np.ptp(load[on(mat)]))


def difference(one: Array, other: Array) -> float:
    """Root mean square of the difference ÷ that of `other`'s dynamic part."""
    return float(np.sqrt(np.mean((one - other) ** 2) / np.mean((other - 1.0) ** 2)))


def frequency(load: Array, time: Array) -> float:
    """Mean frequency of a load over its static load, from its rises through static [Hz]."""
    below = np.flatnonzero((load[:-1] < 1.0) & (load[1:] >= 1.0))
    share = (1.0 - load[below]) / (load[below + 1] - load[below])
    rises = time[below] + share * (time[below + 1] - time[below])
    return float((rises.size - 1) / (rises[-1] - rises[0]))


def minima(load: Array) -> Array:
    """Local minima, in the order of time."""
    inner = load[1:-1]
    return np.asarray(inner[(inner < load[:-2]) & (inner <= load[2:])])
