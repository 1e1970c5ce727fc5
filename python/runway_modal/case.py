"""Case files of the command line: TOML to modes, tracks and speeds in one unit system."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import _case_aircraft
from ._case_tracks import read_tracks
from ._core import InputError
from ._toml import Table, read_toml
from .simulate import simulate
from .units import SPEED, TIME, Units

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from . import nonlinear
    from .modes import Modes
    from .profile import Profile
    from .response import Response


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """What a case file says, in its unit system."""

    title: str
    units: Units
    #: Those of the linear model; of a nonlinear aircraft those it has near rest.
    modes: Modes
    #: What runs instead of the linear model, if the case asks for it.
    reference: nonlinear.Aircraft | None
    tracks: Mapping[str, Profile]
    #: Speeds [length/s] by the text that names them.
    speeds: Mapping[str, float]
    duration: float | None
    damping_input: bool
    #: Files to write, by kind.
    output: Mapping[str, Path]
    #: Inferred data that the case rests on.
    notes: tuple[str, ...]
    #: Where faults of the run are to be sought.
    place: Table

    def run(self) -> dict[str, Response | nonlinear.Response]:
        """Simulate every speed."""
        with self.place.located():
            return {name: self._simulate(speed) for name, speed in self.speeds.items()}

    def _simulate(self, speed: float) -> Response | nonlinear.Response:
        if self.reference is not None:
            from .nonlinear import simulate as simulate_nonlinear

            return simulate_nonlinear(self.reference, self.tracks, speed, duration=self.duration)
        return simulate(
            self.modes,
            self.tracks,
            speed,
            duration=self.duration,
            damping_input=self.damping_input,
        )


def read_case(path: Path) -> Case:
    """Read a case file; `InputError` names file, line and key."""
    root = read_toml(path)
    root.only("title", "units", "aircraft", "single_dof", "track", "footprint", "run", "output")
    system = root.table("units")
    system.only("length", "force")
    with system.located():
        units = Units(system.get("length"), system.get("force"))
    if ("aircraft" in root.values) == ("single_dof" in root.values):
        raise root.fault("either [aircraft] or [single_dof] is needed", "single_dof")
    notes: list[str] = []
    reference = None
    if "single_dof" in root.values:
        modes = _case_aircraft.one_degree_of_freedom(root.table("single_dof"), units)
    elif root.table("aircraft").flag("nonlinear"):
        reference, modes = _case_aircraft.nonlinear_and_modes(root.table("aircraft"), units, notes)
    else:
        modes = _case_aircraft.linear(root.table("aircraft"), units)
    tracks = read_tracks(root, modes.aircraft.gear_names, units, notes)
    run = root.table("run")
    run.only("speeds", "duration", "damping_input")
    if reference is not None and "damping_input" in run.values:
        raise run.fault("damping_input: a nonlinear run always has it", "damping_input")
    output = root.table("output", {})
    output.only("csv", "json", "parquet", "figure")
    for kind in output.values:
        if output.text(kind) == "-":
            raise output.fault(f"{kind} = '-': standard output is for the command line", kind)
    return Case(
        title=root.text("title", path.stem),
        units=units,
        modes=modes,
        reference=reference,
        tracks=tracks,
        speeds=_speeds(run, units),
        duration=run.quantity("duration", TIME, units, None),
        damping_input=run.flag("damping_input"),
        output={kind: path.parent / output.text(kind) for kind in output.values},
        notes=tuple(notes),
        place=run,
    )


def _speeds(run: Table, units: Units) -> dict[str, float]:
    given = run.get("speeds")
    speeds = {}
    for i, value in enumerate(given if isinstance(given, list) else [given]):
        with run.located():
            speed = units.quantity(f"speeds[{i}]", value, SPEED)
            if not speed > 0:
                raise InputError(f"speeds[{i}] = {value!r} is not positive")
        name = value if isinstance(value, str) else f"{value} {units.name(SPEED)}"
        if name in speeds:
            raise run.fault(f"speeds[{i}] = {value!r} is there before", "speeds")
        speeds[name] = speed
    if not speeds:
        raise run.fault("speeds is empty", "speeds")
    return speeds
