"""Confidence intervals of what many runs estimate, as likely missed on either side."""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Degrees of freedom from which Fisher's expansion of Student's quantiles has seven digits, for
#: tails down to 1e-5.
_MANY = 200

#: Newton's steps end here. They converge in ten or so, except to the rounding of 1e8 runs and more.
_MOST_STEPS = 40


def ranks(runs: int, probability: float, tail: float) -> tuple[int, int]:
    """
    Ranks of the order statistics that enclose a quantile, except for `tail` on either side.

    Rank 0 stands for -inf, rank `runs` + 1 for inf. The number B of runs below the quantile is
    binomial: the lower rank r is the largest with P(B < r) <= tail, the upper the smallest with
    P(B >= r) <= tail.
    """
    width = 12.0 * math.sqrt(runs * probability * (1.0 - probability)) + 40.0
    first = max(0, int(runs * probability - width))
    last = min(runs, int(runs * probability + width))
    # Probabilities of first .. last runs, from their ratios; what lies outside is negligible.
    k = np.arange(first + 1, last + 1)
    ratios = np.log((runs - k + 1) / k) + math.log(probability) - math.log1p(-probability)
    logs = np.concatenate(([0.0], np.cumsum(ratios)))
    share = np.exp(logs - logs.max())
    below = np.concatenate(([0.0], np.cumsum(share))) / share.sum()
    above = np.concatenate((np.cumsum(share[::-1])[::-1], [0.0])) / share.sum()
    low = first + int(np.flatnonzero(below <= tail)[-1])
    high = first + int(np.flatnonzero(above <= tail)[0])
    return low, high


def shares(
    count: NDArray[np.int64], runs: int, tail: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """
    Limits of a probability of which `count` out of `runs` were observed.

    Of Clopper and Pearson (1934): the probabilities at which so many or more, or so many or fewer,
    would be observed with probability `tail`.
    """
    return np.exp(_log_least(count, runs, tail)), -np.expm1(_log_least(runs - count, runs, tail))


def _log_least(count: NDArray[np.int64], runs: int, tail: float) -> NDArray[np.float64]:
    """
    Logarithm of the p at which P(B >= count) = `tail` for a binomial B; -inf where `count` is 0.

    With P(B >= k) = P(B = k) S, its logarithm has the slope k/S against log p. S grows with p, so
    the curve is concave: from wherever they start, Newton's steps come to the root from the left.
    """
    found, place = np.unique(count, return_inverse=True)
    k = found[found > 0].astype(float)
    choose = math.lgamma(runs + 1) - np.array(
        [math.lgamma(one + 1) + math.lgamma(runs - one + 1) for one in k]
    )
    log_p = np.log(k / (runs + 1))
    for _ in range(_MOST_STEPS):
        p, rest = np.exp(log_p), -np.expm1(log_p)
        total = term = np.ones_like(k)
        j = 0
        while (term > 1e-16 * total).any():
            term = term * np.maximum(runs - k - j, 0.0) / (k + 1 + j) * (p / rest)
            total = total + term
            j += 1
        log_tail = choose + k * log_p + (runs - k) * np.log(rest) + np.log(total)
        step = (log_tail - math.log(tail)) * total / k
        log_p = log_p - step
        # Steps double their digits: after one this short there is nothing left to gain.
        if (np.abs(step) <= 1e-8 * np.minimum(1.0, -log_p)).all():
            break
    limits = np.full(found.size, -np.inf)
    limits[found > 0] = log_p
    return limits[place].reshape(count.shape)


def student(tail: float, degrees: int) -> float:
    """
    Value that a variable of Student's distribution exceeds with probability `tail` < 1/2.

    To ten digits for tails down to 1e-5; beyond 1e-12 only a few are left.
    """
    z = -NormalDist().inv_cdf(tail)
    # Fisher's expansion (Abramowitz and Stegun, 26.7.5).
    terms = (
        z,
        z * (z**2 + 1) / 4,
        z * (5 * z**4 + 16 * z**2 + 3) / 96,
        z * (3 * z**6 + 19 * z**4 + 17 * z**2 - 15) / 384,
    )
    if degrees >= _MANY:
        return math.fsum(term / degrees**power for power, term in enumerate(terms))
    # The angle whose tangent is t / sqrt(degrees), by halving: the probability grows with it.
    low, high = 0.0, math.pi / 2
    while (middle := (low + high) / 2) not in (low, high):
        low, high = (middle, high) if _within(middle, degrees) < 1 - 2 * tail else (low, middle)
    return math.tan(low) * math.sqrt(degrees)


def _within(angle: float, degrees: int) -> float:
    """Probability of |t| < sqrt(degrees) tan(angle) (Abramowitz and Stegun, 26.7.3 and 26.7.4)."""
    sin, cos = math.sin(angle), math.cos(angle)
    odd = degrees % 2
    term, total = (cos if odd else 1.0), 0.0
    for power in range(1 + odd, degrees, 2):
        total += term
        term *= power / (power + 1) * cos * cos
    return 2 / math.pi * (angle + sin * total) if odd else sin * total
