"""
One long profile: a whole `simulate` call against a numba loop and pyyeti.

Three modes, three gears on one profile, displacement and rate at every knot. Ours also checks,
finds the times and returns them; peers get what they need prepared.
"""

import os
from collections.abc import Callable
from functools import partial

import numpy as np

import runway_modal as rm
from _cases import SPACING, SPEED, elevations, equal, irregular, lag, modes
from _peers import Equal, pyyeti_ode
from _timing import line, machine, options, ratio, take_turns


def against_peers(segments: int, rounds: int) -> None:
    own, profile = modes(), equal(segments)

    def ours() -> rm.Response:
        return rm.simulate(own, profile, SPEED)

    case = Equal(own, elevations(segments), SPACING, SPEED, lag())
    numba = case.numba()
    fast, slow = (case.pyyeti(pyyeti_ode(compiled=compiled)) for compiled in (True, False))
    response = ours()
    for peer in (numba, fast, slow):
        for theirs, mine in zip(peer(), (response.modal, response.modal_rate), strict=True):
            error = np.abs(theirs - mine[: case.rows]).max() / np.abs(mine).max()
            assert error < 1e-9, f"peers disagree by {error:.1e} of the peak"

    quick = take_turns(rounds, ours=ours, numba=numba, pyyeti=fast)
    slow_turns = take_turns(max(1, rounds // 4), pyyeti=slow, ours=ours)
    loops = ratio(slow_turns["pyyeti"], slow_turns["ours"])
    compiled = ratio(quick["numba"], quick["ours"])
    print(f"\n{segments:.0e} equal segments, {case.rows} rows, medians of {rounds} runs")
    line("runway_modal.simulate", milliseconds(quick["ours"]))
    line("numba loop of the same recurrence", milliseconds(quick["numba"]))
    line("pyyeti SolveUnc(order=1).tsolve, its loop in Python", milliseconds(slow_turns["pyyeti"]))
    line("pyyeti SolveUnc(order=1).tsolve, its loop in numba", milliseconds(quick["pyyeti"]))
    line("numba / ours", f"{compiled:.2f}", "≥ 1", compiled >= 1)
    line("pyyeti (Python loop) / ours", f"{loops:.0f}", "≥ 300", loops >= 300)
    line("pyyeti (numba loop) / ours", f"{ratio(quick['pyyeti'], quick['ours']):.2f}")


def all_different(segments: int, rounds: int) -> None:
    own, profiles = modes(), {"equal": equal(segments), "irregular": irregular(segments)}
    rows = {name: rm.simulate(own, each, SPEED).time.size for name, each in profiles.items()}
    run = {name: partial(rm.simulate, own, each, SPEED) for name, each in profiles.items()}
    turns = take_turns(rounds, **run, alone=partial(on_one_thread, run["irregular"]))
    whole = ratio(turns["irregular"], turns["equal"])
    row = whole * rows["equal"] / rows["irregular"]
    print(f"\n{segments:.0e} segments of all different lengths, {rows['irregular']} rows")
    line("equal", milliseconds(turns["equal"]))
    line("irregular (nose and main gears' knots apart)", milliseconds(turns["irregular"]))
    line("the same on one thread", milliseconds(turns["alone"]))
    line("irregular / equal, per segment of the profile", f"{whole:.2f}", "≤ 6", whole <= 6)
    line("irregular / equal, per row", f"{row:.2f}", "≤ 6", row <= 6)
    line("on one thread / equal, per segment", f"{ratio(turns['alone'], turns['equal']):.2f}")


def on_one_thread(call: Callable[[], rm.Response]) -> rm.Response:
    os.environ["RAYON_NUM_THREADS"] = "1"
    response = call()
    del os.environ["RAYON_NUM_THREADS"]
    return response


def flatness(sizes: list[int], rounds: int) -> None:
    own = modes()
    wheelbase = lag() * SPACING
    for name, build in (("equal", equal), ("irregular", irregular)):
        print(f"\n{name} segments, cost a row (a knot of any gear; the run ends at the last one)")
        costs = []
        for size in sizes:
            profile = build(size)
            end = (profile.x[-1] + wheelbase) / SPEED
            call = partial(rm.simulate, own, profile, SPEED, duration=end)
            rows = call().time.size
            inner = max(1, 200_000 // rows)
            costs.append(np.median(take_turns(rounds, inner, ours=call)["ours"]) / rows)
            line(f"{size:.0e} segments", f"{1e9 * costs[-1]:.1f} ns")
        line("dearest / cheapest", f"{max(costs) / min(costs):.2f}", "want 1")


def milliseconds(seconds: np.ndarray) -> str:
    return f"{1e3 * np.median(seconds):.1f} ms"


if __name__ == "__main__":
    quick = options(__doc__)
    machine("runway_modal", "numpy", "numba", "pyyeti", "scipy")
    against_peers(2_000 if quick else 1_000_000, 1 if quick else 12)
    all_different(2_000 if quick else 1_000_000, 1 if quick else 12)
    flatness([1_000] if quick else [10**n for n in range(3, 8)], 1 if quick else 9)
