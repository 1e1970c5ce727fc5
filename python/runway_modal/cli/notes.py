"""What to know about a case before trusting its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from runway_modal.case import Case
    from runway_modal.profile import Profile

#: Damping ratio beyond which it matters whether the ground acts on the dampers.
_DAMPED = 0.03

#: Frequencies of rigid aircraft on their gears lie between these [Hz].
_SLOW, _FAST = 0.1, 20.0

#: Breakpoints that make a track a survey rather than a shape.
_SURVEY = 50

#: Jumps of a damper's force from breakpoint to breakpoint, as a share of the static load.
_JUMPS = 0.05

#: Grade from end to end beyond which the kinks at both ends matter.
_GRADE = 1e-3


def notes(case: Case) -> Iterator[str]:
    """Tell what the model infers, leaves out or adds, one line each."""
    tracks = case.tracks or {}
    for note in case.notes:
        yield f"Inferred, not published: {note}"
    yield from on_modes(case)
    if case.reference is None:
        yield from on_dampers(case, tracks)
        yield from _on_noise(case, tracks)
    yield from _on_grades(case, tracks)


def ignored(case: Case, command: str, *keys: str) -> Iterator[str]:
    """Tell which of these tables and keys a file has, although the command does not use them."""
    there = [
        key
        for key in keys
        if (case.root.table("run", {}).values if key == "duration" else case.root.values).get(key)
    ]
    names = {"track": "[[track]]", "duration": "duration"}
    if there:
        named = ", ".join(names.get(key, f"[{key}]") for key in there)
        yield f"Not used by `runway-modal {command}`: {named}"


def on_modes(case: Case) -> Iterator[str]:
    """Tell where the modes suggest a slip in the units."""
    slow, fast = case.modes.frequency_hz.min(), case.modes.frequency_hz.max()
    if slow < _SLOW or fast > _FAST:
        yield (
            f"NOTE: modes of {slow:.3g} to {fast:.3g} Hz are unusual for an aircraft on its gears; "
            "check the units of masses, inertias and stiffnesses"
        )
    most = case.modes.damping_ratio.max()
    if most >= 1.0:
        yield (
            f"NOTE: a damping ratio of {most:.3g} is beyond critical: the aircraft does not swing "
            "(5 % is 0.05)"
        )


def on_dampers(case: Case, tracks: Mapping[str, Profile]) -> Iterator[str]:
    """Tell which effects of the dampers a linear run over these tracks leaves out."""
    damped = [gear.name for gear in case.modes.aircraft.gears if gear.damping]
    most = case.modes.damping_ratio.max()
    if not damped:
        if case.damping_input:
            yield "NOTE: damping_input has no effect: no gear has a damping of its own"
        elif most > _DAMPED:
            yield (
                f"NOTE: damping ratios up to {most:.2g} act on the aircraft's motion only; the "
                "ground acts on dampers that gears have (damping under [[aircraft.gears]], and "
                "damping_input = true under [run])"
            )
        return
    if not case.damping_input:
        steep = _on_slopes(case, tracks)
        if most > _DAMPED or steep > _JUMPS:
            slopes = f" and slopes worth {100.0 * steep:.0f} % of static loads" if steep else ""
            yield (
                f"WARNING: damping ratios up to {most:.2g}{slopes}, but the dampers do not feel "
                "the ground's motion, as in the 1980 report; loads may be "
                f"{'far ' if most > _DAMPED else ''}too low (set damping_input = true under [run])"
            )
        return
    struck = [name for name in damped if name in tracks and (np.diff(tracks[name].x) == 0.0).any()]
    if struck:
        yield (
            f"WARNING: vertical steps strike the dampers of {', '.join(struck)}; the results leave "
            "out that impulse (model the edge as a ramp, or use [footprint])"
        )


def _on_slopes(case: Case, tracks: Mapping[str, Profile]) -> float:
    """Force of dampers on the steepest slope of a shape, at most, as a share of the static load."""
    aircraft, speed = case.modes.aircraft, max(case.speeds.values(), default=0.0)
    most = 0.0
    for gear, static in zip(aircraft.gears, aircraft.static_load.tolist(), strict=True):
        track = tracks.get(gear.name)
        if static > 0.0 and track is not None and track.x.size < _SURVEY:
            length = np.diff(track.x)
            slopes = np.diff(track.z)[length > 0.0] / length[length > 0.0]
            most = max(most, gear.damping * speed * float(abs(slopes).max(initial=0.0)) / static)
    return most


def _on_noise(case: Case, tracks: Mapping[str, Profile]) -> Iterator[str]:
    """Tell where a survey's own roughness shakes the dampers."""
    if not (case.damping_input and case.speeds):
        return
    aircraft, speed = case.modes.aircraft, max(case.speeds.values())
    shaken = {}
    for gear, static in zip(aircraft.gears, aircraft.static_load, strict=True):
        track = tracks.get(gear.name)
        if gear.damping and static > 0.0 and track is not None and track.x.size >= _SURVEY:
            length = np.diff(track.x)
            slope = np.diff(track.z)[length > 0.0] / length[length > 0.0]
            jumps = gear.damping * speed * float(np.sqrt(np.mean(np.diff(slope) ** 2)))
            shaken[gear.name] = jumps / float(static)
    most = max(shaken.values(), default=0.0)
    if most > _JUMPS:
        names = ", ".join(name for name, share in shaken.items() if share > _JUMPS)
        yield (
            "NOTE: slopes change so much from one breakpoint to the next that the dampers of "
            f"{names} push by up to {100.0 * most:.0f} % of the static load more or less (RMS); "
            "if that is rounding or noise of the survey, apply [footprint]"
        )


def _on_grades(case: Case, tracks: Mapping[str, Profile]) -> Iterator[str]:
    by_grade: dict[str, list[str]] = {}
    for name, track in tracks.items():
        rise, length = track.z[-1] - track.z[0], track.x[-1] - track.x[0]
        if abs(rise) > _GRADE * length:
            by_grade.setdefault(f"{rise:+.4g} {case.units.length}", []).append(name)
    for rise, names in by_grade.items():
        yield (
            f"NOTE: from end to end the track under {', '.join(names)} rises by {rise}. The runway "
            "is level before and after it, and loads at these kinks count (in a track read from a "
            "file, detrend = true removes the grade)"
        )
