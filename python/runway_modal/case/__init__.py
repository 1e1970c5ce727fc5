"""Case files of the command line: TOML to modes, runways and speeds in one unit system."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from runway_modal._core import InputError
from runway_modal._tracks import lags
from runway_modal.simulate import simulate
from runway_modal.units import SPEED, TIME, Units

from . import aircraft
from .random_runways import read_random_runways
from .speed_range import read_speed_range
from .toml import Table, read_toml
from .tracks import read_tracks

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from runway_modal import nonlinear
    from runway_modal.aircraft import Aircraft
    from runway_modal.modes import Modes
    from runway_modal.profile import Profile
    from runway_modal.response import Response

    from .random_runways import RandomRunways
    from .speed_range import SpeedRange


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """Contents of a case file, in its unit system."""

    title: str
    units: Units
    #: Modes of the linear model; of a nonlinear aircraft, those it has near rest.
    modes: Modes
    #: The nonlinear aircraft that runs instead of the linear model, if the case asks for it.
    reference: nonlinear.Aircraft | None
    #: None if the file has no [[track]].
    tracks: Mapping[str, Profile] | None
    #: None if the file has no [sweep].
    sweep: SpeedRange | None
    #: None if the file has neither [roughness] nor [monte_carlo].
    random: RandomRunways | None
    #: Speeds [length/s] by the text that states them.
    speeds: Mapping[str, float]
    duration: float | None
    #: How far the foremost gear rolls, where that instead of `duration` ends a run.
    distance: float | None = None
    damping_input: bool
    #: Files to write, by kind.
    output: Mapping[str, Path]
    #: Inferred data that the aircraft and the tracks rest on.
    aircraft_notes: tuple[str, ...]
    track_notes: tuple[str, ...]
    #: The table that error messages point to.
    root: Table

    @property
    def aircraft(self) -> Aircraft | nonlinear.Aircraft:
        """The aircraft that runs."""
        return self.modes.aircraft if self.reference is None else self.reference

    @property
    def notes(self) -> tuple[str, ...]:
        """Inferred data that a run over the tracks rests on."""
        return self.aircraft_notes + self.track_notes

    @property
    def sources(self) -> tuple[Path, ...]:
        """Files that the case was read from, the case file first."""
        tracks = self.root.tables("track") if "track" in self.root.values else []
        files = [
            table.path.parent / table.text("file") for table in tracks if "file" in table.values
        ]
        return (self.root.path, *files)

    def random_runways(self) -> RandomRunways:
        """Random runways; an error if the file has none."""
        if self.random is None:
            raise self.root.fault("[monte_carlo] is missing")
        return self.random

    def need_linear(self, what: str) -> None:
        """Refuse a nonlinear aircraft."""
        if self.reference is not None:
            why = f"nonlinear: {what} needs the linear model"
            raise self.root.table("aircraft").fault(why, "nonlinear")

    def speed_range(self) -> SpeedRange:
        """Speeds of a sweep; an error if the file has none."""
        if self.sweep is None:
            raise self.root.fault("[sweep] is missing")
        return self.sweep

    def given_tracks(self) -> Mapping[str, Profile]:
        """Tracks; an error if the file has none."""
        if self.tracks is None:
            raise self.root.fault("[[track]] is missing")
        return self.tracks

    def over_random_runway(self, run: int) -> Case:
        """Take one of the random runways as tracks; a run lasts as long as in the Monte Carlo."""
        tracks = self.random_runways().profiles(self.modes, run)
        end = max(float(track.x[-1]) for track in tracks.values())
        return replace(
            self,
            title=f"{self.title}: random runway {run}",
            tracks=tracks,
            track_notes=(),
            output={},  # [output] is for results over the tracks
            distance=end + max(lags(self.modes.aircraft)),
        )

    def run(self) -> dict[str, Response | nonlinear.Response]:
        """Simulate the case at every speed."""
        tracks = self.given_tracks()
        with self.root.table("run").located():
            return {name: self._simulate(tracks, speed) for name, speed in self.speeds.items()}

    def _simulate(
        self, tracks: Mapping[str, Profile], speed: float
    ) -> Response | nonlinear.Response:
        duration = self.duration if self.distance is None else self.distance / speed
        if self.reference is not None:
            from runway_modal.nonlinear import simulate as simulate_nonlinear

            return simulate_nonlinear(self.reference, tracks, speed, duration=duration)
        return simulate(
            self.modes,
            tracks,
            speed,
            duration=duration,
            damping_input=self.damping_input,
        )


_SECTIONS = (
    "title", "units", "aircraft", "single_dof", "track", "footprint", "roughness", "monte_carlo",
    "sweep", "run", "output",
)  # fmt: skip


def read_case(path: Path) -> Case:
    """Read a case file; `InputError` names file, line and key."""
    root = read_toml(path)
    root.only(*_SECTIONS)
    system = root.table("units")
    system.only("length", "force")
    with system.located():
        units = Units(system.get("length"), system.get("force"))
    if ("aircraft" in root.values) == ("single_dof" in root.values):
        raise root.fault("exactly one of [aircraft] and [single_dof] is needed", "single_dof")
    notes: list[str] = []
    reference = None
    if "single_dof" in root.values:
        modes = aircraft.one_degree_of_freedom(root.table("single_dof"), units)
    elif root.table("aircraft").flag("nonlinear"):
        reference, modes = aircraft.nonlinear_and_modes(root.table("aircraft"), units, notes)
    else:
        modes = aircraft.linear(root.table("aircraft"), units)
    tracks, track_notes = None, list[str]()
    if "track" in root.values:
        tracks = read_tracks(root, modes.aircraft.gear_names, units, track_notes)
    random = None
    if {"roughness", "monte_carlo"} & root.values.keys():
        random = read_random_runways(root, units)
    span = read_speed_range(root.table("sweep"), units) if "sweep" in root.values else None
    # A sweep has speeds of its own.
    run = root.table("run", {}) if span else root.table("run")
    run.only("speeds", "duration", "damping_input")
    if reference is not None and "damping_input" in run.values:
        raise run.fault("damping_input: a nonlinear run always includes it", "damping_input")
    output = root.table("output", {})
    output.only("csv", "json", "parquet", "figure")
    for kind in output.values:
        if output.text(kind) == "-":
            raise output.fault(f"{kind} = '-': standard output is only for the command line", kind)
    return Case(
        title=root.text("title", path.stem),
        units=units,
        modes=modes,
        reference=reference,
        tracks=tracks,
        sweep=span,
        random=random,
        speeds=_speeds(run, units) if "run" in root.values else {},
        duration=run.quantity("duration", TIME, units, None),
        damping_input=run.flag("damping_input"),
        output={kind: path.parent / output.text(kind) for kind in output.values},
        aircraft_notes=tuple(notes),
        track_notes=tuple(track_notes),
        root=root,
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
            raise run.fault(f"speeds[{i}] = {value!r} is given twice", "speeds")
        speeds[name] = speed
    if not speeds:
        raise run.fault("speeds is empty", "speeds")
    return speeds
