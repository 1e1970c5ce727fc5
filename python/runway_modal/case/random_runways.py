"""Random runways of a case file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, cast

from runway_modal._core import InputError
from runway_modal._quantities import DIMENSIONS
from runway_modal.roughness import Roughness
from runway_modal.units import LENGTH, PSD

if TYPE_CHECKING:
    from collections.abc import Mapping

    from runway_modal._chunks import Options
    from runway_modal.modes import Modes
    from runway_modal.profile import Profile
    from runway_modal.units import Units

    from .toml import Table


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomRunways:
    """What [roughness] and [monte_carlo] say, in the case's unit system."""

    #: The spectrum in words.
    spectrum: str
    roughness: Roughness
    length: float
    spacing: float
    runs: int
    seed: int
    first_run: int
    tracks: Literal["one", "isotropic"]
    #: Levels whose exceedance is wanted: by quantity, then by the text that states them.
    levels: Mapping[str, Mapping[str, float]]
    #: The table that error messages point to.
    place: Table

    def options(self, speed: float, *, damping_input: bool) -> Options:
        """Give the keyword arguments of `monte_carlo`."""
        return {
            "length": self.length,
            "spacing": self.spacing,
            "speed": speed,
            "runs": self.runs,
            "seed": self.seed,
            "first_run": self.first_run,
            "tracks": self.tracks,
            "damping_input": damping_input,
        }

    def profiles(self, modes: Modes, run: int) -> dict[str, Profile]:
        """Make the profiles of one runway."""
        with self.place.located():
            return self.roughness.profiles(
                modes,
                run,
                length=self.length,
                spacing=self.spacing,
                seed=self.seed,
                tracks=self.tracks,
            )


def read_random_runways(root: Table, units: Units) -> RandomRunways:
    """Read [roughness] and [monte_carlo]."""
    spectrum, roughness = _roughness(root.table("roughness"), units)
    table = root.table("monte_carlo")
    table.only("length", "spacing", "runs", "seed", "first_run", "tracks", "levels")
    return RandomRunways(
        spectrum=spectrum,
        roughness=roughness,
        length=table.quantity("length", LENGTH, units),
        spacing=table.quantity("spacing", LENGTH, units),
        runs=table.whole("runs", 1),
        seed=table.whole("seed", 0),
        first_run=table.whole("first_run", 0, 0),
        tracks=cast("Any", table.choice("tracks", ("one", "isotropic"), "one")),
        levels=_levels(table.table("levels", {}), units),
        place=table,
    )


def _roughness(table: Table, units: Units) -> tuple[str, Roughness]:
    """Spectrum in words, and as a `Roughness`."""

    def frequencies(key: str) -> list[float]:
        values = table.get(key)
        if not isinstance(values, list):
            raise table.fault(f"{key} = {values!r} is not a list", key)
        return [units.spatial_frequency(f"{key}[{i}]", value) for i, value in enumerate(values)]

    with table.located():
        if "iso8608" in table.values:
            table.only("iso8608", "band")
            name = table.choice("iso8608", tuple("ABCDEFGH"))
            band = frequencies("band") if "band" in table.values else None
            made = Roughness.iso8608(name, cast("Any", units.length), cast("Any", band))
            return f"ISO 8608 class {name}", made
        if "n" in table.values:
            table.only("n", "psd")
            n, psd = frequencies("n"), table.quantities("psd", PSD, units)
            return f"spectrum through {len(n)} points", Roughness.from_table(n, psd)
        if "coefficient" not in table.values:
            raise InputError("one of iso8608, coefficient and n is needed")
        table.only("coefficient", "waviness", "reference", "band")
        waviness = table.get("waviness", 2.0)
        return f"power law of waviness {waviness}", Roughness(
            coefficient=table.quantity("coefficient", PSD, units),
            waviness=waviness,
            reference=units.spatial_frequency("reference", table.get("reference")),
            band=cast("Any", frequencies("band")),
        )


def _levels(table: Table, units: Units) -> dict[str, dict[str, float]]:
    table.only(*DIMENSIONS)
    levels: dict[str, dict[str, float]] = {}
    for quantity in table.values:
        dimension = DIMENSIONS[quantity]
        values = table.quantities(quantity, dimension, units)
        texts = (
            text if isinstance(text, str) else f"{text} {units.name(dimension)}"
            for text in table.values[quantity]
        )
        levels[quantity] = dict(zip(texts, values, strict=True))
    return levels
