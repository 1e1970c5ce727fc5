"""Which profile each gear rolls over."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from . import _core
from ._core import InputError
from .profile import Profile

if TYPE_CHECKING:
    from ._results import Aircraft

#: The runway under gears that are not named.
_LEVEL = Profile._wrap(_core.Profile.level())


def lags(aircraft: Aircraft) -> list[float]:
    """Distance of each gear behind the foremost one."""
    return [lag(aircraft, gear.x) for gear in aircraft.gears]


def lag(aircraft: Aircraft, x: float) -> float:
    """Distance of a point of the aircraft behind the foremost gear, negative ahead of it."""
    return max(gear.x for gear in aircraft.gears) - x


def by_gear(names: tuple[str, ...], tracks: Profile | Mapping[str, Profile]) -> list[Profile]:
    """One profile per gear, from one for all gears or from profiles by gear name."""
    if isinstance(tracks, Profile):
        return [tracks] * len(names)
    if not isinstance(tracks, Mapping):
        raise InputError(f"tracks = {tracks!r} is neither a Profile nor profiles by gear name")
    for name, profile in tracks.items():
        if name not in names:
            raise InputError(f"tracks[{name!r}]: no such gear; there are {names}")
        if not isinstance(profile, Profile):
            raise InputError(f"tracks[{name!r}] = {profile!r} is not a Profile")
    # Equal profiles become one track: gears that share one take less work.
    alike: list[Profile] = []
    for name in names:
        profile = tracks.get(name, _LEVEL)
        alike.append(
            next((other for other in alike if other is profile or other == profile), profile)
        )
    return alike
