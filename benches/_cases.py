"""What is simulated: the report's aircraft on a long random profile."""

import numpy as np

import runway_modal as rm

#: The wheelbase, 279.25 in, is a whole number of these: every gear's knots are rows of all.
SPACING = 0.25
SPEED = rm.knots(20)


def modes() -> rm.Modes:
    return rm.f4e().modes(0.01)


def lag() -> int:
    """Spacings from the nose gear back to the main gears."""
    nose, main, _ = rm.f4e().gears
    return round((nose.x - main.x) / SPACING)


def elevations(segments: int) -> np.ndarray:
    return np.random.default_rng(1980).normal(scale=0.1, size=segments + 1)


def equal(segments: int) -> rm.Profile:
    return rm.Profile(SPACING * np.arange(segments + 1), elevations(segments))


def irregular(segments: int) -> rm.Profile:
    """No two segments of one length, the same length in all."""
    lengths = np.random.default_rng(22).uniform(0.5, 1.5, size=segments)
    stations = np.concatenate(([0.0], np.cumsum(lengths)))
    return rm.Profile(stations * (SPACING * segments / stations[-1]), elevations(segments))
