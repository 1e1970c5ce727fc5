"""Section IV.7: spalls."""

from __future__ import annotations

from typing import TYPE_CHECKING

from runway_modal.aircraft import f4e
from runway_modal.report1980 import runs

from .statement import Finding, Statements

if TYPE_CHECKING:
    from runway_modal.profile import Profile

SPALLS = Statements()

#: Contact length of a main gear tire, for the footprint's trend [in].
CONTACT = 12.0

_RESTS_ON = "depth, edges and spacing of the spalls; gear stiffness, which the report does not name"


def _largest(profile: Profile) -> dict[str, list[float]]:
    """Largest left main load by stiffness, for the inputs of three figures in their order."""
    return {
        stiffness: [
            float(runs.spall(stiffness, profile, gears).extremes().max_load[1])
            for gears in runs.SPALL_INPUTS
        ]
        for stiffness in ("static", "equivalent")
    }


def _asymmetric_is_larger(profile: Profile) -> Finding:
    found = _largest(profile)
    (_, two, three), (_, two_4, three_4) = found["static"], found["equivalent"]
    return Finding(
        two > three and two_4 > three_4,
        "Nose and left {two:.1f} kip, all three {three:.1f} kip with Table 3's stiffness; "
        "{two_4:.1f} and {three_4:.1f} kip with Table 4's.",
        two=two / 1e3,
        three=three / 1e3,
        two_4=two_4 / 1e3,
        three_4=three_4 / 1e3,
    )


@SPALLS.add(
    "IV.7",
    "Main gear loads over the two-foot spall are about as large as over the mats.",
    figures=(14, 15, 16),
    rests_on=_RESTS_ON,
)
def _spall_loads_are_like_mat_loads() -> Finding:
    spall = _largest(runs.TWO_FOOT_SPALL)["static"]
    half, full = (
        float(runs.three_dof("static", mat).extremes().max_load[1])
        for mat in (runs.HALF_MAT, runs.FULL_MAT)
    )
    return Finding(
        max(half, full) < 1.25 * min(spall) and max(spall) < 1.25 * min(half, full),
        "Largest left main load: {low:.1f} to {high:.1f} kip over the spall, {full:.1f} kip over "
        "the full and {half:.1f} kip over the half mat (asked: within a quarter).",
        low=min(spall) / 1e3,
        high=max(spall) / 1e3,
        full=full / 1e3,
        half=half / 1e3,
    )


@SPALLS.add(
    "IV.7",
    "Over the two-foot spall the left main's largest load is larger with nose and left main in "
    "it than with all three gears.",
    figures=(15, 16),
    rests_on=_RESTS_ON,
)
def _two_foot_spall_loads_more_asymmetrically() -> Finding:
    return _asymmetric_is_larger(runs.TWO_FOOT_SPALL)


@SPALLS.add(
    "IV.7",
    "The load's sharp plunge in a spall comes from the gear following the profile; a tire "
    "footprint can be put into the profile.",
    figures=(17, 18, 19),
    rests_on=_RESTS_ON + "; contact length 12 in",
)
def _plunge_softens_with_a_footprint() -> Finding:
    gears = ("nose", "left", "right")
    sharp, soft = (
        runs.spall("static", profile, gears)
        for profile in (runs.DOUBLE_SPALL, runs.DOUBLE_SPALL.footprint(CONTACT))
    )
    step = float(f4e("static").gears[1].stiffness * -runs.DOUBLE_SPALL.z.min())
    static = float(sharp.static_load[1])
    low, eased = (float(run.extremes().min_load[1]) for run in (sharp, soft))
    return Finding(
        low < eased and abs((static - low) - step) < 0.25 * step,
        "Smallest left main load over the double spall: {low:.1f} kip, {drop:.1f} kip below static "
        "where the spall's depth times the stiffness is {step:.1f} kip; {eased:.1f} kip under a "
        "tire of {contact:g} in contact.",
        low=low / 1e3,
        drop=(static - low) / 1e3,
        step=step / 1e3,
        eased=eased / 1e3,
        contact=CONTACT,
    )


@SPALLS.add(
    "IV.7",
    "Over the double spall, too, the main gear load is larger with nose and left main in it than "
    "with all three gears.",
    figures=(18, 19),
    rests_on=_RESTS_ON,
)
def _double_spall_loads_more_asymmetrically() -> Finding:
    return _asymmetric_is_larger(runs.DOUBLE_SPALL)
