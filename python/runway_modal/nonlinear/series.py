"""Springs in series: one load, the compressions add."""

from __future__ import annotations

import math
from bisect import bisect
from typing import TYPE_CHECKING

import numpy as np

from runway_modal._core import NumericalError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from .springs import GasSpring, Values

#: No run compresses a gas column to this share of its length or extends it to the inverse, but a
#: trial step of the integration may; the load then stays at its value there.
_EXTREME = 1e-6

#: Newton steps that suffice for any load within 1e40 of the chamber's reference load.
_ITERATIONS = 60


class Branch:
    """
    Smooth piece of the series' law: certain chambers and linear springs in series.

    Parameters
    ----------
    chambers : sequence of GasSpring
        Chambers off their stops.
    compliance : float
        Sum of 1/k of the linear springs [length/force].
    """

    __slots__ = ("_limits", "chambers", "compliance")

    def __init__(self, chambers: Sequence[GasSpring], compliance: float) -> None:
        self.chambers = tuple(chambers)
        self.compliance = compliance
        columns = sum(chamber.column for chamber in self.chambers)
        longest = math.inf if compliance else (1.0 - _EXTREME) * columns
        self._limits = (-columns / _EXTREME, longest)

    def compression(self, load: Values) -> Values:
        """Sum of the compressions at a load."""
        total: Values = self.compliance * load
        for chamber in self.chambers:
            total = total + chamber._compression(load)
        return total

    def stiffness(self, load: Values) -> Values:
        """Tangent stiffness at a load, 1/k = Σ 1/k_i (Table 2)."""
        total: Values = self.compliance + 0.0 * load
        for chamber in self.chambers:
            total = total + 1.0 / chamber._stiffness(load)
        return 1.0 / total

    def load(self, compression: Values) -> Values:
        """Load at a sum of compressions."""
        if not self.chambers:
            return compression / self.compliance
        gas, alone = self.chambers[0], len(self.chambers) == 1
        if self.compliance and alone and gas.polytropic == 1.0:
            return self._isothermal(compression)
        compression = _bounded(compression, *self._limits)
        if self.compliance:
            return self._newton(compression, self._isothermal(compression))
        if alone:
            return gas._force(compression)
        return self._newton(compression, gas._force(_bounded(compression, -math.inf, 0.0)))

    def _isothermal(self, compression: Values) -> Values:
        """
        Load of the first chamber and the linear springs, exact for n = 1.

        It is the root of κF² + (ℓ - D)F - ℓF₀ = 0, κ the compliance, D the compression and ℓ the
        column; ℓ/n has the right slope at F₀ for any n.
        """
        gas = self.chambers[0]
        column = gas.column / gas.polytropic
        gap: Values = column - compression
        scale = column * gas.load
        size: Values = abs(gap) + (gap * gap + 4.0 * self.compliance * scale) ** 0.5
        # Of the two forms of the root, the one that does not subtract.
        if isinstance(gap, float):
            return 2.0 * scale / size if gap > 0.0 else size / (2.0 * self.compliance)
        return np.where(gap > 0.0, 2.0 * scale / size, size / (2.0 * self.compliance))

    def _newton(self, compression: Values, load: Values) -> Values:
        # The compression is a concave function of the load, so from below the root Newton's
        # method climbs to it; from above it falls below at once, held where loads are positive.
        for _ in range(_ITERATIONS):
            better: Values = load - (self.compression(load) - compression) * self.stiffness(load)
            if isinstance(load, float):
                better = max(better, load / 8.0)
                far = abs(better - load) > 1e-9 * better
            else:
                better = np.maximum(better, load / 8.0)
                far = (abs(better - load) > 1e-9 * better).any()
            load = better
            if not far:
                # Convergence is quadratic: that step left an error of 1e-18.
                return load
        raise NumericalError(f"load at the compression {compression!r} not found")


def _bounded(values: Values, low: float, high: float) -> Values:
    if isinstance(values, float):
        return min(max(values, low), high)
    return np.minimum(np.maximum(values, low), high)


class Series:
    """
    Chambers and linear springs in series, as a law in smooth pieces.

    Piece 0 lies below the first kink. There the load is constant: with a tire the gear is off the
    runway, a strut by itself is on its stop. Each further kink is a chamber leaving its stop.

    Parameters
    ----------
    chambers : sequence of GasSpring
        Gas chambers.
    compliance : float
        Sum of 1/k of the linear springs [length/force].
    static : float
        Load at which the compression counts as 0 [force].
    tire : bool
        Whether a tire, which does not pull, is among the linear springs.
    """

    __slots__ = ("_begin", "_branches", "_offsets", "kinks")

    #: Compressions at which the pieces begin; -inf if the load never falls below the first.
    kinks: list[float]

    def __init__(
        self, chambers: Sequence[GasSpring], compliance: float, static: float, *, tire: bool
    ) -> None:
        ordered = sorted(chambers, key=lambda chamber: chamber.preload)
        preloads = [chamber.preload for chamber in ordered]
        least = 0.0 if tire else preloads[0] if preloads else -math.inf
        first = bisect(preloads, least)
        active = range(first, len(ordered) + 1)
        self._branches = [Branch(ordered[:n], compliance) for n in active]
        # How far the chambers on their stops are extended.
        held = [sum(chamber.extension for chamber in ordered[n:]) for n in active]

        def compression(piece: int, load: float) -> float:
            if load <= 0.0 and (self._branches[piece].chambers or load == -math.inf):
                return -math.inf
            return self._branches[piece].compression(load) - held[piece]

        #: Loads at which the pieces begin.
        self._begin = [least, *preloads[first:]]
        static = max(static, least)
        zero = compression(bisect(self._begin, static) - 1, static)
        self.kinks = [compression(i, load) - zero for i, load in enumerate(self._begin)]
        self._offsets = [zero + stops for stops in held]

    def piece(self, compression: float) -> int:
        """Piece that a compression lies in."""
        return bisect(self.kinks, compression)

    def load(self, piece: int, compression: Values) -> Values:
        """Load of a piece, also slightly beyond its ends."""
        if piece == 0:
            return self._begin[0] + 0.0 * compression
        return self._branches[piece - 1].load(compression + self._offsets[piece - 1])

    def compression(self, load: float) -> float:
        """Compression at a load, or at the least load if that is larger."""
        load = max(load, self._begin[0])
        piece = bisect(self._begin, load) - 1
        return self._branches[piece].compression(load) - self._offsets[piece]

    def stiffness(self, piece: int, load: Values) -> Values:
        """Tangent stiffness of a piece at a load; 0 off the runway and on the stop."""
        if piece == 0:
            return 0.0 * load
        return self._branches[piece - 1].stiffness(load)

    def stiffness_at(self, load: float) -> float:
        """Tangent stiffness at a load."""
        return float(self.stiffness(bisect(self._begin, load), load))
