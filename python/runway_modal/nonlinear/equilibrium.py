"""Where a rigid body comes to rest on springs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from runway_modal._core import NumericalError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .series import Series
    from .springs import Array

#: Most rounds of Newton's method and halvings of a step: the energy is convex, so few are needed.
_ROUNDS, _HALVINGS = 100, 60

#: Unbalanced share of the weight that counts as zero.
_BALANCED = 1e-13


def equilibrium(
    laws: Sequence[Series], geometry: Array, elevation: Array, weight: float
) -> tuple[Array, Array]:
    """
    Find the attitude in which the gears carry the weight: GᵀF(u - Gq) = {W, 0, 0}.

    Parameters
    ----------
    laws : sequence of Series
        Load of each gear against its compression.
    geometry : ndarray, shape (g, 3)
        Geometry matrix G.
    elevation : ndarray, shape (g,)
        Elevations u under the gears.
    weight : float
        Weight W, > 0.

    Returns
    -------
    q : ndarray, shape (3,)
        Bounce, pitch and roll.
    load : ndarray, shape (g,)
        Loads F.

    Raises
    ------
    NumericalError
        If no equilibrium is found.
    """
    # From the first elevation on: a runway high above its datum costs no digits.
    datum = np.array([elevation[0], 0.0, 0.0])
    height = elevation - elevation[0]
    turn = geometry.T
    sizes = weight * np.maximum(abs(turn).max(axis=1), np.finfo(float).tiny)

    def state(q: Array) -> tuple[Array, Array, Array]:
        """Find loads, stiffnesses and the imbalance."""
        travel = (height - geometry @ q).tolist()
        pieces = [law.piece(s) for law, s in zip(laws, travel, strict=True)]
        loads = [law.load(*at) for law, *at in zip(laws, pieces, travel, strict=True)]
        slopes = [law.stiffness(*at) for law, *at in zip(laws, pieces, loads, strict=True)]
        excess = turn @ np.array(loads) - [weight, 0.0, 0.0]
        return np.array(loads), np.array(slopes), excess

    q: Array = np.asarray(np.linalg.lstsq(geometry, height, rcond=None)[0], dtype=np.float64)
    load, slope, excess = state(q)
    for _ in range(_ROUNDS):
        if (abs(excess) <= _BALANCED * sizes).all():
            return datum + q, load
        way = np.linalg.lstsq(turn * slope @ geometry, excess, rcond=None)[0]
        for halving in range(_HALVINGS):
            further = q + 0.5**halving * way
            load, slope, there = state(further)
            if np.linalg.norm(there / sizes) < np.linalg.norm(excess / sizes):
                break
        else:
            break
        q, excess = further, there
    raise NumericalError(f"no equilibrium found on elevations {elevation.tolist()!r}")
