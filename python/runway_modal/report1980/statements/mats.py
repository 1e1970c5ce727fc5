"""Half mat and full mat, beside the nonlinear reference: mostly Sections IV.5, IV.6 and V."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from runway_modal.aircraft import f4e
from runway_modal.report1980 import runs
from runway_modal.report1980.tables import DAMPING_RATIO, MAT_KNOTS, TAXI_STIFFNESS
from runway_modal.simulate import simulate
from runway_modal.units import knots

from .measures import (
    after,
    difference,
    frequency,
    largest_and_smallest,
    main,
    minima,
    nose,
    on,
    rises,
    run,
    trailing_edge,
)
from .statement import Finding, Statements

if TYPE_CHECKING:
    from runway_modal.report1980.runs import Run

    from .measures import Model

MATS = Statements()

_HALF = "length and sharp edges of the half mat"
_FULL = "ramps of the full mat"
_TAXI = "reference for TAXI"
_SHARED = "bounce model's load shared by two main gears"

#: "Similar" and "very similar": root mean square of the difference ÷ that of the dynamic load.
_SIMILAR, _VERY_SIMILAR = 0.5, 0.25


@MATS.add(
    "III.4",
    "The aircraft responds in a dominant bounce mode.",
    figures=(10,),
    rests_on=_FULL,
)
def _bounce_mode_dominates() -> Finding:
    response = runs.full_mat("static")
    free = response.time >= (runs.FULL_MAT.x[-1] + runs.WHEELBASE) / runs.MAT_SPEED
    # Off the mat a load is the stiffness times the modes' shares of the gear's motion.
    left = response.aircraft.geometry[1] @ response.modes.shapes
    pitch, bounce, roll = np.std(response.modal[free] * left, axis=0)
    return Finding(
        bounce > 0.5 * (pitch + bounce + roll),
        "Root mean square of the left main load after the full mat, by mode: pitch {pitch:.1f}, "
        "bounce {bounce:.1f}, roll {roll:.1f} % of their sum (asked: over half).",
        pitch=100 * pitch / (pitch + bounce + roll),
        bounce=100 * bounce / (pitch + bounce + roll),
        roll=100 * roll / (pitch + bounce + roll),
    )


@MATS.add(
    "III.4",
    "So the bounce model alone gives good estimates of main gear loads.",
    figures=(5, 6, 9, 10),
    rests_on=f"{_HALF}, {_FULL}",
)
def _bounce_model_estimates_main_loads() -> Finding:
    half, full = (
        float(main(sdof).max() / main(three).max())
        for sdof, three in (_half_mat("sdof 1.91", "3dof 3"), _full_mat("sdof 1.91", "3dof 3"))
    )
    return Finding(
        max(abs(half - 1), abs(full - 1)) < 0.05,
        "Its largest load over static is {half:.3f} (half mat) and {full:.3f} (full mat) of the "
        "three-degree-of-freedom model's (asked: within 5 %).",
        half=half,
        full=full,
    )


@MATS.add(
    "IV.5",
    "TAXI: after the half mat the aircraft vibrates at 1.80 Hz.",
    figures=(4,),
    rests_on=f"{_HALF}; {_TAXI}",
)
def _taxi_frequency_after_half_mat() -> Finding:
    hertz, _ = _free_vibration()
    return Finding(
        abs(hertz - 1.80) < 0.05,
        "{hertz:.2f} Hz, the mean of the main gear's cycles after the mat (asked: within 0.05 Hz).",
        hertz=hertz,
    )


@MATS.add(
    "IV.5",
    "TAXI: the damping ratio of that vibration is about 1 %.",
    figures=(4,),
    rests_on=f"{_HALF}; {_TAXI}, which was given 1 %",
)
def _taxi_damping_after_half_mat() -> Finding:
    _, ratio = _free_vibration()
    return Finding(
        0.005 < ratio < 0.015,
        "{percent:.2f} %, from the decrement of the main gear's peaks (asked: 0.5 to 1.5 %).",
        percent=100 * ratio,
    )


def _half_mat(*models: Model) -> list[Run]:
    return [run(model, runs.HALF_MAT) for model in models]


def _full_mat(*models: Model) -> list[Run]:
    return [run(model, runs.FULL_MAT) for model in models]


def _free_vibration() -> tuple[float, float]:
    """Frequency [Hz] and damping ratio of the main gears' load after the half mat."""
    free = after(runs.HALF_MAT)
    load = main(run("taxi", runs.HALF_MAT))[free]
    peaks = np.array([load[a:b].max() - 1.0 for a, b in pairwise(rises(load))])
    decrement = -np.polyfit(np.arange(peaks.size), np.log(peaks), 1)[0]
    ratio = float(decrement / np.hypot(2 * np.pi, decrement))
    return frequency(load, runs.TIMES[free]), ratio


@MATS.add(
    "IV.5",
    "Half mat: the bounce model's largest load is slightly larger than TAXI's.",
    figures=(4, 5),
    rests_on=f"{_HALF}; {_SHARED}; {_TAXI}",
)
def _half_mat_sdof_maximum() -> Finding:
    models = _half_mat("sdof 1.91", "taxi")
    sdof, taxi = (largest_and_smallest(each)[0] for each in models)
    sdof_static, taxi_static = (main(each).max() for each in models)
    return Finding(
        1.0 < sdof / taxi < 1.25,
        "{sdof:.1f} against {taxi:.1f} kip a main gear (asked: larger by less than a quarter); "
        "{sdof_static:.2f} against {taxi_static:.2f} times the static load.",
        sdof=sdof,
        taxi=taxi,
        sdof_static=sdof_static,
        taxi_static=taxi_static,
    )


@MATS.add(
    "IV.5",
    "Half mat: the bounce model's minima are much smaller than TAXI's.",
    figures=(4, 5),
    rests_on=f"{_HALF}; {_SHARED}; {_TAXI}",
)
def _half_mat_sdof_minimum() -> Finding:
    sdof, taxi = (largest_and_smallest(each)[1] for each in _half_mat("sdof 1.91", "taxi"))
    return Finding(
        sdof < 0.5 * taxi,
        "Smallest {sdof:.1f} against {taxi:.1f} kip a main gear (asked: less than half).",
        sdof=sdof,
        taxi=taxi,
    )


@MATS.add(
    "IV.5",
    "Half mat: the bounce model unloads at the fourth minimum.",
    figures=(5,),
    rests_on=f"{_HALF}, chosen for this",
)
def _half_mat_unloads_at_the_fourth_minimum() -> Finding:
    # The mat's trailing edge is a vertical drop: its far side must be among the samples.
    edge = (runs.HALF_MAT.x[-1] + runs.WHEELBASE) / runs.MAT_SPEED
    bounce = runs.one_dof("static", runs.HALF_MAT)
    times = np.union1d(runs.TIMES, [edge, edge + 1e-9])
    first, second, third, fourth = minima(bounce.at(times).load[:, 0])[:4] / 1e3
    return Finding(
        min(first, second, third) > 0 >= fourth,
        "First four minima of the whole aircraft's load: {first:.1f}, {second:.1f}, {third:.1f} "
        "and {fourth:.1f} kip.",
        first=first,
        second=second,
        third=third,
        fourth=fourth,
    )


@MATS.add(
    "IV.5",
    "Half mat: the three-degree-of-freedom model's largest main gear load is slightly smaller "
    "than TAXI's and the bounce model's.",
    figures=(4, 5, 6),
    rests_on=f"{_HALF}; {_SHARED}; {_TAXI}",
)
def _half_mat_3dof_maximum() -> Finding:
    models = _half_mat("3dof 3", "sdof 1.91", "taxi")
    three, sdof, taxi = (largest_and_smallest(each)[0] for each in models)
    return Finding(
        0.75 * max(sdof, taxi) < three < min(sdof, taxi),
        "{three:.1f} against {taxi:.1f} (TAXI) and {sdof:.1f} kip (bounce model) a main gear "
        "(asked: smaller than both by less than a quarter).",
        three=three,
        sdof=sdof,
        taxi=taxi,
    )


@MATS.add(
    "IV.5",
    "Half mat: its smallest main gear load lies between the other two.",
    figures=(4, 5, 6),
    rests_on=f"{_HALF}; {_SHARED}; {_TAXI}",
)
def _half_mat_3dof_minimum() -> Finding:
    models = _half_mat("3dof 3", "sdof 1.91", "taxi")
    three, sdof, taxi = (largest_and_smallest(each)[1] for each in models)
    return Finding(
        min(sdof, taxi) < three < max(sdof, taxi),
        "{three:.2f} kip a main gear; TAXI {taxi:.2f}, bounce model {sdof:.2f} kip: outside by "
        "{gap:.2f} kip.",
        three=three,
        sdof=sdof,
        taxi=taxi,
        gap=max(min(sdof, taxi) - three, three - max(sdof, taxi), 0.0),
    )


@MATS.add(
    "IV.5",
    "Half mat: its nose gear load is similar to TAXI's.",
    figures=(4, 6),
    rests_on=f"{_HALF}; {_TAXI}",
)
def _half_mat_nose() -> Finding:
    return _similar(nose(run("3dof 3", runs.HALF_MAT)), nose(run("taxi", runs.HALF_MAT)), _SIMILAR)


def _similar(one: np.ndarray, other: np.ndarray, asked: float) -> Finding:
    share = difference(one, other)
    low, high = one.min() / other.min(), one.max() / other.max()
    return Finding(
        share < asked,
        "The difference's root mean square is {share:.0f} % of the dynamic load's (asked: under "
        "{asked:.0f} %); largest loads are as {high:.2f} to 1, smallest as {low:.2f} to 1.",
        share=100 * share,
        asked=100 * asked,
        high=high,
        low=low,
    )


@MATS.add(
    "IV.5",
    "Half mat: the linear nose gear load lacks the highest frequency in TAXI's.",
    figures=(4, 6),
)
def _half_mat_nose_lacks_the_highest_frequency() -> Finding:
    return Finding(
        None,
        "The nonlinear reference has massless wheels: what vibrates fastest in TAXI is in neither.",
    )


@MATS.add(
    "IV.6",
    "Full mat: the main gears come off the mat at three seconds.",
    figures=(8,),
)
def _mains_leave_at_three_seconds() -> Finding:
    time = (runs.FULL_MAT.x[-1] + runs.WHEELBASE) / knots(MAT_KNOTS)
    return Finding(
        abs(time - 3.0) < 0.05,
        "{time:.3f} s after the nose gear met it: 77.5 ft (published) and the wheelbase at 20 kt.",
        time=time,
    )


def _cancelled(ratio: float) -> Finding:
    return Finding(
        ratio < 1,
        "Main gear load range after the mat ÷ on it: {ratio:.2f}.",
        ratio=ratio,
    )


def _amplified(ratio: float) -> Finding:
    return Finding(
        ratio > 1,
        "Main gear load range after the mat ÷ on it: {ratio:.2f}.",
        ratio=ratio,
    )


@MATS.add(
    "IV.6",
    "TAXI, full mat: coming off the mat reduces the main gears' vibration.",
    figures=(8,),
    rests_on=f"{_FULL}; {_TAXI}",
)
def _full_mat_taxi_cancels() -> Finding:
    return _cancelled(trailing_edge(run("taxi", runs.FULL_MAT), runs.FULL_MAT))


@MATS.add(
    "IV.6",
    "TAXI: the trailing edge can reinforce or cancel the motion, as half and full mat show.",
    figures=(4, 8),
    rests_on=f"{_HALF}, {_FULL}; {_TAXI}",
)
def _taxi_reinforces_or_cancels() -> Finding:
    half, full = (trailing_edge(run("taxi", mat), mat) for mat in (runs.HALF_MAT, runs.FULL_MAT))
    return Finding(
        (half - 1) * (full - 1) < 0,
        "Main gear load range after the mat ÷ on it: half mat {half:.2f}, full mat {full:.2f}.",
        half=half,
        full=full,
    )


@MATS.add(
    "IV.6",
    "Full mat, bounce model at 1.91 Hz: coming on the mat is similar to TAXI.",
    figures=(8, 9),
    rests_on=f"{_FULL}; {_TAXI}",
)
def _full_mat_sdof_begins_like_taxi() -> Finding:
    begin = runs.WHEELBASE / runs.MAT_SPEED
    first, last = np.searchsorted(runs.TIMES, (begin, begin + 1 / 1.91))
    sdof, taxi = (main(each)[first:last] for each in _full_mat("sdof 1.91", "taxi"))
    return _similar(sdof, taxi, _SIMILAR)


@MATS.add(
    "IV.6",
    "Full mat, bounce model at 1.91 Hz: the trailing edge amplifies the motion.",
    figures=(9,),
    rests_on=_FULL,
)
def _full_mat_sdof_amplifies() -> Finding:
    return _amplified(trailing_edge(run("sdof 1.91", runs.FULL_MAT), runs.FULL_MAT))


@MATS.add(
    "IV.6",
    "Full mat, three degrees of freedom, Table 3: the motion is amplified at the mat's end.",
    figures=(10,),
    rests_on=_FULL,
)
def _full_mat_3dof_amplifies() -> Finding:
    return _amplified(trailing_edge(run("3dof 3", runs.FULL_MAT), runs.FULL_MAT))


@MATS.add(
    "IV.6",
    "Full mat: that main gear load is very similar to the bounce model's.",
    figures=(9, 10),
    rests_on=_FULL,
)
def _full_mat_3dof_is_like_sdof() -> Finding:
    return _similar(
        main(run("3dof 3", runs.FULL_MAT)), main(run("sdof 1.91", runs.FULL_MAT)), _VERY_SIMILAR
    )


@MATS.add(
    "IV.6",
    "Full mat: that nose gear load is very similar to TAXI's.",
    figures=(8, 10),
    rests_on=f"{_FULL}; {_TAXI}",
)
def _full_mat_nose() -> Finding:
    return _similar(
        nose(run("3dof 3", runs.FULL_MAT)), nose(run("taxi", runs.FULL_MAT)), _VERY_SIMILAR
    )


@MATS.add(
    "IV.6",
    "To show the reinforcement or cancellation of the aircraft, a linear model must have its "
    "period of vibration.",
    figures=(8, 10, 12),
    rests_on=f"{_FULL}; {_TAXI}",
)
def _the_period_decides() -> Finding:
    table_3, table_4, taxi = (
        trailing_edge(each, runs.FULL_MAT) for each in _full_mat("3dof 3", "3dof 4", "taxi")
    )
    hertz, tuned = _tuned()
    ratio = trailing_edge(tuned, runs.FULL_MAT)
    return Finding(
        abs(ratio - taxi) < 0.5 * min(abs(table_3 - taxi), abs(table_4 - taxi)),
        "Range after ÷ on the full mat: the reference, which goes at {hertz:.2f} Hz there, "
        "{taxi:.2f}; the linear model of that frequency {ratio:.2f}, with Table 3 (1.91 Hz) "
        "{table_3:.2f} and with Table 4 (1.80 Hz) {table_4:.2f} (asked: less than half as far off "
        "as either).",
        hertz=hertz,
        taxi=taxi,
        ratio=ratio,
        table_3=table_3,
        table_4=table_4,
    )


def _tuned() -> tuple[float, Run]:
    """Find the reference's frequency on the full mat [Hz] and run a linear model of it."""
    level = on(runs.FULL_MAT)
    hertz = frequency(main(run("taxi", runs.FULL_MAT))[level], runs.TIMES[level])
    aircraft = f4e("static")
    factor = (hertz / aircraft.modes(DAMPING_RATIO).frequency_hz[1]) ** 2
    scaled = aircraft.with_stiffness({g.name: factor * g.stiffness for g in aircraft.gears})
    modes = scaled.modes(DAMPING_RATIO)
    return hertz, simulate(modes, runs.FULL_MAT, runs.MAT_SPEED, times=runs.TIMES)


def _stiffness(row: int, gear: str) -> Finding:
    printed = TAXI_STIFFNESS[row]
    low, high, _ = runs.taxi_stiffness(gear)
    return Finding(
        abs(low / printed.low - 1) < 0.02 and abs(high / printed.high - 1) < 0.02,
        "{low:,.0f} to {high:,.0f} lbf/in (asked: within 2 %; off by {low_off:+.1f} and "
        "{high_off:+.1f} %).",
        low=low,
        high=high,
        low_off=100 * (low / printed.low - 1),
        high_off=100 * (high / printed.high - 1),
    )


@MATS.add(
    "IV.6",
    "TAXI, full mat: main gear stiffness ranges from 4733 to 11,362 lbf/in.",
    figures=(8,),
    rests_on=f"{_TAXI}, calibrated on this",
)
def _main_stiffness_range() -> Finding:
    return _stiffness(0, "left")


@MATS.add(
    "IV.6",
    "TAXI, full mat: nose gear stiffness ranges from 965 to 2662 lbf/in.",
    figures=(8,),
    rests_on=_TAXI,
)
def _nose_stiffness_range() -> Finding:
    return _stiffness(1, "nose")


def _equivalent(row: int, gear: str) -> Finding:
    printed = TAXI_STIFFNESS[row]
    _, _, equivalent = runs.taxi_stiffness(gear)
    return Finding(
        abs(equivalent / printed.equivalent - 1) < 0.01,
        "{equivalent:,.0f} lbf/in (asked: within 1 %; off by {off:+.2f} %).",
        equivalent=equivalent,
        off=100 * (equivalent / printed.equivalent - 1),
    )


@MATS.add(
    "IV.6",
    "Eq. 22 over that run gives 8081 lbf/in for a main gear.",
    figures=(8, 12),
    rests_on=f"{_TAXI}, calibrated on this",
)
def _main_equivalent_stiffness() -> Finding:
    return _equivalent(0, "left")


@MATS.add(
    "IV.6",
    "Eq. 22 over that run gives 1508 lbf/in for the nose gear.",
    figures=(8, 12),
    rests_on=_TAXI,
)
def _nose_equivalent_stiffness() -> Finding:
    return _equivalent(1, "nose")


@MATS.add(
    "IV.6",
    "The stiffness averaged by Eq. 22 gives the period of free vibration while on the mat.",
    figures=(8, 12),
    rests_on=f"{_FULL}; {_TAXI}",
)
def _equivalent_stiffness_gives_the_period() -> Finding:
    nose_gear, main_gear = (runs.taxi_stiffness(gear)[2] for gear in ("nose", "left"))
    equal = {"nose": nose_gear, "left": main_gear, "right": main_gear}
    linear = float(f4e().with_stiffness(equal).modes(DAMPING_RATIO).frequency_hz[1])
    taxi, _ = _tuned()
    return Finding(
        abs(linear / taxi - 1) < 0.02,
        "The reference's main gear load goes at {taxi:.2f} Hz on the mat; with its own Eq. 22 "
        "stiffnesses the linear bounce mode has {linear:.2f} Hz, off by {off:+.1f} % (asked: "
        "within 2 %).",
        taxi=taxi,
        linear=linear,
        off=100 * (linear / taxi - 1),
    )


@MATS.add(
    "IV.6",
    "Full mat, bounce model at 1.80 Hz: the trailing edge cancels motion.",
    figures=(11,),
    rests_on=_FULL,
)
def _full_mat_sdof_cancels() -> Finding:
    return _cancelled(trailing_edge(run("sdof 1.80", runs.FULL_MAT), runs.FULL_MAT))


@MATS.add(
    "IV.6",
    "Full mat, three degrees of freedom, Table 4: the trailing edge cancels motion.",
    figures=(12,),
    rests_on=_FULL,
)
def _full_mat_3dof_cancels() -> Finding:
    return _cancelled(trailing_edge(run("3dof 4", runs.FULL_MAT), runs.FULL_MAT))


@MATS.add(
    "IV.6",
    "Full mat: with the revised frequencies both linear models agree much better with TAXI.",
    figures=(8, 11, 12),
    rests_on=f"{_FULL}; {_TAXI}",
)
def _revised_models_agree_better() -> Finding:
    taxi = main(run("taxi", runs.FULL_MAT))
    sdof, revised_sdof, three, revised_three = (
        100 * difference(main(each), taxi)
        for each in _full_mat("sdof 1.91", "sdof 1.80", "3dof 3", "3dof 4")
    )
    return Finding(
        revised_sdof < 0.5 * sdof and revised_three < 0.5 * three,
        "Root mean square of the difference in main gear load, of TAXI's dynamic load: bounce "
        "model {sdof:.0f} % before, {revised_sdof:.0f} % after; three degrees of freedom "
        "{three:.0f} % before, {revised_three:.0f} % after (asked: halved).",
        sdof=sdof,
        revised_sdof=revised_sdof,
        three=three,
        revised_three=revised_three,
    )


@MATS.add(
    "V",
    "Linear models can reproduce the response of the nonlinear aircraft, given its period.",
    figures=(8, 11, 12),
    rests_on=f"{_FULL}; {_TAXI}",
)
def _linear_models_reproduce_the_nonlinear() -> Finding:
    taxi, table_4 = (main(each) for each in _full_mat("taxi", "3dof 4"))
    hertz, response = _tuned()
    tuned = main(response)
    share = difference(tuned, taxi)
    return Finding(
        share < _SIMILAR,
        "Full mat, three degrees of freedom: with the reference's own {hertz:.2f} Hz the largest "
        "main gear load is {high:.2f} and the smallest {low:.2f} of the reference's, the "
        "difference's root mean square {share:.0f} % of the dynamic load's (asked: under "
        "{asked:.0f} %); with Table 4 it is {revised:.0f} %.",
        hertz=hertz,
        high=tuned.max() / taxi.max(),
        low=tuned.min() / taxi.min(),
        share=100 * share,
        asked=100 * _SIMILAR,
        revised=100 * difference(table_4, taxi),
    )
