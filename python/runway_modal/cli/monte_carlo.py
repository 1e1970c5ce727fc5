"""``runway-modal mc``: rolls over random runways, prints statistics, writes every run."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from runway_modal import stored, tables_ensemble
from runway_modal._input import integer
from runway_modal._quantities import DIMENSIONS, DOWNWARD, LABELS
from runway_modal.case import read_case
from runway_modal.monte_carlo import monte_carlo
from runway_modal.plotting_ensemble import histograms_and_exceedances
from runway_modal.units import FORCE

from .documents import json_writer
from .notes import ignored, on_dampers, on_modes
from .output import Output, figure_writer, table_writers
from .progress import progress_bar
from .statistics import Statistics, document, exceedances, side, worst_runs
from .text import heading, load_digits, modes_table, name_width, stated_speed, unloading

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from matplotlib.figure import Figure

    from runway_modal.case import Case
    from runway_modal.case.random_runways import RandomRunways
    from runway_modal.ensemble import Ensemble


def run(
    path: Path,
    asked: Mapping[str, str | None],
    *,
    runs: int | None = None,
    out: Path | None = None,
    quiet: bool = False,
) -> None:
    """Run the Monte Carlo of a case file; `asked` names files by kind."""
    case = read_case(path)
    random = case.random_runways()
    if runs is not None:
        random = replace(random, runs=integer("--runs", runs, 1))
    case.need_linear("a Monte Carlo")
    # The tracks of the case have no part in this.
    title = f"{case.title}: random runways, {random.spectrum}"
    case = replace(case, title=title, tracks=None, track_notes=())
    output = Output.of(case, asked)
    ensembles = _compute(case, random, out, quiet=quiet)
    output.say(_summary(path, case, random, ensembles))
    if out is not None:
        output.say([f"runs kept in: {out}"])
    output.write(
        table_writers(
            lambda: map(tables_ensemble.quantities, ensembles.values()), case.units, index="run"
        )
        | figure_writer(lambda: _figure(case, ensembles))
        | json_writer(case, lambda: _document(case, random, ensembles))
    )


def _figure(case: Case, ensembles: Mapping[str, Ensemble]) -> Figure:
    quantities = ["max_load"]
    if len(case.aircraft.stations) > 1:  # the centre of gravity is always there
        quantities.append("max_acceleration")
    return histograms_and_exceedances(
        ensembles, case.title, units=case.units, quantities=quantities
    )


def _compute(
    case: Case, random: RandomRunways, out: Path | None, *, quiet: bool
) -> dict[str, Ensemble]:
    """Roll at every speed; if interrupted, say what is kept."""
    total, done = random.runs * len(case.speeds), 0
    found: dict[str, Ensemble] = {}
    try:
        with progress_bar(total, quiet=quiet) as show:
            for name, speed in case.speeds.items():

                def progress(finished: int, _: int) -> None:
                    nonlocal done
                    done = len(found) * random.runs + finished
                    show(done)

                options = random.options(speed, damping_input=case.damping_input)
                with random.place.located():
                    if out is None:
                        found[name] = monte_carlo(
                            case.modes, random.roughness, **options, progress=progress
                        )
                        continue
                    folder = out / _folder(name)
                    stored.monte_carlo(
                        folder, case.modes, random.roughness, **options, progress=progress
                    )
                    found[name] = stored.read(folder, runs=random.runs)
    except KeyboardInterrupt:
        kept = (
            "no runs are kept; --out DIR keeps finished ones"
            if out is None
            else f"{done} of {total} runs are kept in {out}; the same command resumes from there"
        )
        print(f"runway-modal: interrupted: {kept}", file=sys.stderr)
        raise
    return found


def _folder(speed: str) -> str:
    """Name of the directory for the runs at a speed, valid on any system."""
    return re.sub(r"[^\w.+ -]", "_", speed)


def _summary(
    path: Path, case: Case, random: RandomRunways, ensembles: Mapping[str, Ensemble]
) -> Iterator[str]:
    length = case.units.length
    yield from heading(case)
    yield from on_modes(case)
    yield from on_dampers(case, {})
    low, high = random.roughness.band
    yield (
        f"Runways {random.length:.6g} {length} long, a station every {random.spacing:.6g} "
        f"{length}, seed {random.seed}"
    )
    yield (
        f"  waves of {1 / low:.6g} to {1 / high:.6g} {length}, standard deviation of elevation "
        f"{random.roughness.variance**0.5:.4g} {length}"
    )
    yield (
        "  one track under all gears"
        if random.tracks == "one"
        else "  each gear on a track of its own, coherent as on an isotropic surface"
    )
    yield from ignored(case, "mc", "track", "footprint", "duration", "output")
    yield ""
    yield from modes_table(case)
    for name, ensemble in ensembles.items():
        yield ""
        yield from _of_speed(case, name, ensemble, random)
    worst = next(iter(ensembles.values())).worst(case.modes.aircraft.gear_names[0], 1)[0]
    yield ""
    yield f"Any run in full: runway-modal run {path} --runway {worst}"


def _document(
    case: Case, random: RandomRunways, ensembles: Mapping[str, Ensemble]
) -> dict[str, Any]:
    low, high = random.roughness.band
    return {
        "runways": {
            "spectrum": random.spectrum,
            "band": [low, high],
            "variance": random.roughness.variance,
            "length": random.length,
            "spacing": random.spacing,
            "tracks": random.tracks,
            "seed": random.seed,
        },
        "confidence": 0.95,
        "speeds": [
            {"speed": case.speeds[name], "stated_speed": name, **document(ensemble, random)}
            for name, ensemble in ensembles.items()
        ],
    }


def _of_speed(case: Case, name: str, ensemble: Ensemble, random: RandomRunways) -> Iterator[str]:
    units, gears = case.units, ensemble.gear_names
    width, digits = name_width(case), load_digits(case)
    first, last = ensemble.run[0], ensemble.run[-1]
    yield f"Speed {stated_speed(case, name)}: {len(ensemble)} runs, {first} to {last}"
    static = zip(gears, ensemble.static_load[0], strict=True)
    loads = (f"{gear} {load:.{digits}f}" for gear, load in static)
    yield f"  Static load [{units.force}]: {', '.join(loads)}"
    for quantity, dimension in DIMENSIONS.items():
        yield ""
        if dimension == FORCE:
            yield from _quantity(ensemble, quantity, 1.0, units.force, width, digits)
        else:
            yield from _quantity(ensemble, quantity, units.standard_gravity, "g", width, 4)
    yield ""
    yield from _shares(ensemble, random)
    yield ""
    yield f"  {'Largest loads':<{width + 6}} in runs, worst first"
    for gear, runs in worst_runs(ensemble).items():
        yield f"  {gear:<{width + 6}} {', '.join(map(str, runs))}"


def _quantity(
    ensemble: Ensemble, quantity: str, scale: float, unit: str, width: int, digits: int
) -> Iterator[str]:
    """Tabulate mean, quantiles and extreme of a quantity by gear or station, with intervals."""
    downward, found = quantity in DOWNWARD, Statistics.of(ensemble, quantity)
    mean, quantiles, shares = found.mean, found.quantiles, found.quantiles.asked
    bounded = np.isfinite(quantiles.low[:, 0]) & np.isfinite(quantiles.high[:, 0])
    heads = ["mean", *(f"{100 * share:g} %" for share in shares[bounded])]
    cells = "".join(f"{head:>12}" for head in [*heads, "smallest" if downward else "largest"])
    head = f"{LABELS[quantity]} [{unit}]"
    yield f"  {head[0].upper()}{head[1:]}, with 95 % intervals"
    yield f"  {'':<{width}}{cells}{'in run':>12}"

    def line(head: str, numbers: list[float], run: str = "") -> str:
        texts = "".join(f"{number / scale:12.{digits}f}" for number in numbers)
        return f"  {head:<{width}}{texts}{run}"

    for column, (name, worst) in enumerate(zip(found.names, found.worst, strict=True)):
        value, low, high = (
            [getattr(mean, part)[0, column], *getattr(quantiles, part)[bounded, column]]
            for part in ("value", "low", "high")
        )
        yield line(name, [*value, worst.value], f"{worst.run:>12}")
        if len(ensemble) > 1:
            yield line("  from", low)
            yield line("  to", high)
    few = shares[~bounded]
    if few.size:
        missing = ", ".join(f"{100 * share:g} %" for share in few)
        yield f"  {missing}: too few runs for an interval"


def _shares(ensemble: Ensemble, random: RandomRunways) -> Iterator[str]:
    """Tabulate the share of runs that unload a gear or exceed a level."""
    rows: list[tuple[str, float, float, float]] = []
    for quantity, levels, found in exceedances(ensemble, random):
        for i, text in enumerate(levels):
            for column, name in enumerate(found.names):
                parts = (part[i, column] for part in (found.value, found.low, found.high))
                value, low, high = (100.0 * float(part) for part in parts)
                rows.append(
                    (f"{name}: {LABELS[quantity]} {side(quantity)} {text}", value, low, high)
                )
    width = max(len(row[0]) for row in rows)
    head = "Share of runs [%], with 95 % intervals"
    yield f"  {head:<{width}}{'':>12}{'from':>12}{'to':>12}"
    for what, value, low, high in rows:
        yield f"  {what:<{width}}{value:12.4f}{low:12.4f}{high:12.4f}"
    lost = zip(ensemble.gear_names, ensemble.unloaded.T, strict=True)
    yield from unloading([gear for gear, runs in lost if runs.any()])
