"""
Many speeds over the full mat: `sweep` against a loop of `simulate` and its extremes.

And the worst speed of the same range, proven within a tolerance, against a grid so dense that
neighbours differ by no more than that.
"""

import os

import numpy as np

import runway_modal as rm
from _cases import modes
from _timing import line, machine, options, ratio, take_turns

RANGE = rm.knots(5), rm.knots(100)
#: A thousandth of the left gear's largest load, about [lbf].
TOLERANCE = 50.0


def many_speeds(count: int, rounds: int, inner: int) -> None:
    own, mat = modes(), rm.Profile.full_mat()
    speeds = np.linspace(*RANGE, count)

    def loop() -> np.ndarray:
        return np.array([rm.simulate(own, mat, speed).extremes().max_load for speed in speeds])

    assert (rm.sweep(own, mat, speeds).max_load == loop()).all(), "the loop disagrees"
    turns = take_turns(rounds, inner, sweep=lambda: rm.sweep(own, mat, speeds), loop=loop)
    threads = os.environ.get("RAYON_NUM_THREADS", os.cpu_count())
    print(f"\n{count} speeds over the full mat, {threads} threads, medians of {rounds}")
    line("sweep", f"{1e3 * np.median(turns['sweep']):.2f} ms")
    line("loop of simulate(...).extremes()", f"{1e3 * np.median(turns['loop']):.2f} ms")
    line("loop / sweep", f"{ratio(turns['loop'], turns['sweep']):.1f}")


def worst(rounds: int, inner: int) -> None:
    own, mat = modes(), rm.Profile.full_mat()

    def search() -> rm.WorstSpeed:
        return rm.worst_speed(own, mat, RANGE, at="left", tolerance=TOLERANCE)

    def grid(count: int) -> np.ndarray:
        return rm.sweep(own, mat, np.linspace(*RANGE, count)).max_load[:, 1]

    count = 100
    while np.abs(np.diff(grid(count))).max() > TOLERANCE:
        count *= 2
    found = search()
    assert grid(count).max() <= found.bound, "a speed of the grid exceeds the bound"
    turns = take_turns(rounds, inner, search=search, grid=lambda: grid(count))
    print(f"\nworst of 5 to 100 kt for the left gear, to {TOLERANCE:g} lbf")
    line(f"worst_speed, {found.runs} runs, proven", f"{1e3 * np.median(turns['search']):.1f} ms")
    line(f"sweep, {count} speeds, not proven", f"{1e3 * np.median(turns['grid']):.1f} ms")


if __name__ == "__main__":
    quick = options(__doc__)
    machine("runway_modal", "numpy")
    many_speeds(20 if quick else 200, 1 if quick else 15, 1 if quick else 5)
    worst(1 if quick else 15, 1)
