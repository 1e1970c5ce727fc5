"""
The response against 40-digit arithmetic: 1e-12 of the peak of each quantity.

Cases and bar are those of the table that ``python tests/accuracy.py`` prints.
"""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from flint import arb, ctx

import runway_modal as rm
from accuracy import (
    FAMILIES,
    GRID,
    PHASES,
    RATIOS,
    SHARE,
    Case,
    aircraft,
    grid_case,
    measure,
    textbook,
)
from oracle import BITS, Oracle, inexact, rational

FAMILY_CASES = [case for cases in FAMILIES.values() for case in cases]

#: Over nine decades of lengths every exponential is another one: there, one degree of freedom.
LONG = [
    grid_case(i, j, segments=10_000, aircraft="asymmetric" if phase else "single", **variant)
    for i, phase in enumerate(PHASES)
    for j in range(len(RATIOS))
    for variant in (
        {"steps": False, "damping_input": False},
        {"steps": True, "damping_input": True},
    )
]

SLOW = [
    *LONG,
    *(grid_case(i, j, segments=300, aircraft="five", base=1e5) for i in range(6) for j in range(8)),
    *(
        grid_case(i, j, segments=1000, aircraft="f4e", whole=False)
        for i in range(6)
        for j in (0, 2, 6)
    ),
    *(grid_case(6, j, segments=1000) for j in range(8)),
    Case(ratio=0.0, segments=10_000, aircraft="abreast", steps=True),
    Case(ratio=0.01, segments=10_000, aircraft="abreast", damping_input=True),
]


def check(case: Case) -> None:
    """Fail with the quantities that miss the bar."""
    scores = measure(case)
    assert all(np.isfinite(score.error) for score in scores.values())
    missed = {name: score for name, score in scores.items() if not score.ratio <= 1}
    assert not missed


@pytest.mark.parametrize("case", GRID, ids=str)
def test_every_length_and_damping(case: Case) -> None:
    check(case)


@pytest.mark.parametrize("case", FAMILY_CASES, ids=str)
def test_special_cases(case: Case) -> None:
    check(case)


@pytest.mark.slow
@pytest.mark.parametrize("case", SLOW, ids=str)
def test_exhaustively(case: Case) -> None:
    check(case)


# The yardstick itself.


def as_mpf(value: arb) -> mpmath.mpf:
    """Exact conversion of a midpoint."""
    mantissa, exponent = value.mid().man_exp()
    return mpmath.ldexp(int(mantissa), int(exponent))


@pytest.mark.parametrize("ratio", [0.0, 0.01, 1.0, 3.0])
@pytest.mark.parametrize("dt", [3e-8, 1e-3, 0.3, 2.7])
def test_oracle_exponential_is_that_of_mpmath(dt: float, ratio: float) -> None:
    frame = aircraft("asymmetric")
    oracle = Oracle(frame, ratio, [rm.Profile([0.0], [0.0])] * 3, 400.0, damping_input=True)
    found = oracle.exponential(rational(dt))
    size = oracle.system.nrows()
    with mpmath.workprec(2 * BITS):
        system = mpmath.matrix(
            [[as_mpf(oracle.system[i, j]) for j in range(size)] for i in range(size)]
        )
        expected = mpmath.expm(system * inexact(rational(dt)))
        for i in range(size):
            # Row by row: rows differ in unit.
            largest = max(abs(expected[i, j]) for j in range(size))
            for j in range(size):
                assert abs(as_mpf(found[i, j]) - expected[i, j]) <= mpmath.mpf(10) ** -38 * largest


@pytest.mark.parametrize("damping_input", [False, True])
def test_oracle_on_one_step_is_a_cosine(damping_input: bool) -> None:
    # By hand: u jumps by h under a mass on a spring without loss, and a damper that only the
    # ground feels gives the mass the velocity c h / M.
    mass, stiffness, damper, height = 2.0, 50.0, 3.0, 0.25
    gear = rm.Gear("gear", 0.0, 0.0, stiffness, damper)
    frame = rm.Aircraft(mass=mass, pitch_inertia=1.0, roll_inertia=1.0, gears=[gear], gravity=10.0)
    step = rm.Profile([3.0, 3.0], [7.0, 7.0 + height])
    oracle = Oracle(frame, 0.0, [step], 4.0, damping_input=damping_input)
    times = [0.5, 0.75, 1.0, 11.5]
    found = oracle.at(times)
    with ctx.workprec(BITS):
        blow = arb(damper * height / mass if damping_input else 0.0)
        tolerance = arb(10) ** -45
        for time, cg, load in zip(times, found["cg"], found["load"], strict=True):
            turn = 5 * (arb(time) - arb(0.75))
            lag, rate = height * turn.cos() - blow / 5 * turn.sin(), arb(0)
            expected, place = arb(mass * 10.0), arb(7)
            if time >= 0.75:
                rate = 5 * height * turn.sin() + blow * turn.cos()
                expected += stiffness * lag - (damper * rate if damping_input else 0)
                place = 7 + height - lag
            assert abs(cg[0] - place) < tolerance
            assert abs(load[0] - expected) < tolerance


def test_oracle_needs_no_more_bits() -> None:
    rng = np.random.default_rng(5)
    x = np.concatenate([[0.0], np.cumsum(10.0 ** rng.uniform(-4, 4.5, 200))])
    tracks = [rm.Profile(x, 1e5 + rng.uniform(-0.2, 0.2, x.size)) for _ in range(3)]
    args = (aircraft("asymmetric"), (0.0, 1e-6, 3.0), tracks, 400.0)
    few, many = Oracle(*args), Oracle(*args, bits=2 * BITS)
    times = sorted({few.knots[i].time + delay for i in (0, 300, -1) for delay in (0.0, 0.7)})
    coarse, fine = few.at(times), many.at(times)
    with ctx.workprec(2 * BITS):
        for name in coarse:
            for a, b in zip(coarse[name], fine[name], strict=True):
                assert all(abs(p - q) <= arb(10) ** -40 for p, q in zip(a, b, strict=True))


# The bar can be missed.


@pytest.mark.parametrize(
    "case",
    [
        Case(phase=1e-2, ratio=0.01, damping_input=True),
        Case(phase=1.0, ratio=0.0, steps=True),
        Case(phase=1.0, ratio=0.01, aircraft="f4e", base=1e5),
        Case(phase=30.0, ratio=1.0),
    ],
    ids=str,
)
def test_a_speed_wrong_in_the_eleventh_digit_is_noticed(case: Case) -> None:
    assert max(score.ratio for score in measure(case, detune=1e-11).values()) > 1


@pytest.mark.parametrize("phase", [1e-3, 1e-4])
def test_textbook_coefficients_miss_the_bar(phase: float) -> None:
    theirs, ours = textbook(phase)
    assert ours <= SHARE < theirs
