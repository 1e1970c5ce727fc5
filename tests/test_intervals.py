"""Confidence intervals, against scipy's distributions and by how often they hold."""

import numpy as np
import pytest
from scipy import stats

from runway_modal._intervals import shares, student

TAILS = (0.4, 0.1, 0.025, 0.005, 1e-5)


@pytest.mark.parametrize("tail", TAILS)
@pytest.mark.parametrize("runs", [1, 2, 3, 64, 1000, 1_000_000])
def test_limits_of_a_probability_are_clopper_and_pearsons(runs: int, tail: float) -> None:
    count = np.unique([0, 1, 2, runs // 10, runs // 2, runs - 1, runs])
    count = count[count <= runs]
    low, high = shares(count, runs, tail)
    expected = stats.beta.ppf(tail, count[1:], runs - count[1:] + 1)
    np.testing.assert_allclose(low[1:], expected, rtol=1e-8)
    expected = stats.beta.isf(tail, count[:-1] + 1, runs - count[:-1])
    np.testing.assert_allclose(high[:-1], expected, rtol=1e-8)
    assert low[0] == 0.0
    assert high[-1] == 1.0


@pytest.mark.parametrize("runs", [10**6, 10**8])
def test_limits_of_few_among_many_keep_their_digits_alone(runs: int) -> None:
    for few in (0, 1, 20):
        _, high = shares(np.array([few]), runs, 0.025)
        assert high[0] == pytest.approx(stats.beta.isf(0.025, few + 1, runs - few), rel=1e-6)


def test_limits_come_in_the_shape_of_their_counts() -> None:
    count = np.array([[3, 0], [3, 7], [7, 1]])
    low, high = shares(count, 7, 0.025)
    assert low.shape == high.shape == count.shape
    assert low[0, 0] == low[1, 0] > low[2, 1] > low[0, 1] == 0.0
    assert high[1, 1] == high[2, 0] == 1.0


@pytest.mark.parametrize("confidence", [0.9, 0.95, 0.99])
@pytest.mark.parametrize("runs", [10, 100, 1000])
def test_limits_hold_as_often_as_they_say(runs: int, confidence: float) -> None:
    """For probabilities so small that most sets of runs do not exceed once, too."""
    count = np.arange(runs + 1)
    low, high = shares(count, runs, (1 - confidence) / 2)
    for probability in np.geomspace(0.01 / runs, 0.5, 200):
        holds = (low <= probability) & (probability <= high)
        assert stats.binom.pmf(count[holds], runs, probability).sum() >= confidence


@pytest.mark.parametrize("tail", TAILS)
def test_students_quantiles(tail: float) -> None:
    for degrees in (1, 2, 3, 4, 5, 30, 199):
        assert student(tail, degrees) == pytest.approx(stats.t.isf(tail, degrees), rel=1e-10)
    for degrees in (200, 201, 1000, 10**7):
        assert student(tail, degrees) == pytest.approx(stats.t.isf(tail, degrees), rel=1e-7)
