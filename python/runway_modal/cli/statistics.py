"""What ``runway-modal mc`` tells of an ensemble, in numbers: for its summary and its JSON."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from runway_modal._quantities import DIMENSIONS, DOWNWARD

from .documents import bound, by_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from runway_modal.case.random_runways import RandomRunways
    from runway_modal.ensemble import Ensemble, Estimate

#: Probabilities of the quantiles, on the dangerous side.
_PROBABILITIES = np.array([0.5, 0.95, 0.99, 0.999])

#: Number of worst runs that are listed.
_WORST = 5


@dataclass(frozen=True, slots=True)
class Worst:
    """The largest or smallest value of a gear or station, and its run."""

    value: float
    run: int


@dataclass(frozen=True, slots=True)
class Statistics:
    """Mean, quantiles and worst value of a quantity, at each gear or station."""

    names: tuple[str, ...]
    mean: Estimate
    quantiles: Estimate
    worst: tuple[Worst, ...]

    @classmethod
    def of(cls, ensemble: Ensemble, quantity: str) -> Statistics:
        """Estimate them, with 95 % intervals."""
        downward = quantity in DOWNWARD
        probabilities = 1.0 - _PROBABILITIES if downward else _PROBABILITIES
        mean = ensemble.mean(quantity)
        values = dict(zip(ensemble.run.tolist(), ensemble._of(quantity), strict=True))
        runs = [int(ensemble.worst(name, 1, quantity=quantity)[0]) for name in mean.names]
        return cls(
            mean.names,
            mean,
            ensemble.quantile(quantity, probabilities),
            tuple(Worst(float(values[run][i]), run) for i, run in enumerate(runs)),
        )


def exceedances(
    ensemble: Ensemble, random: RandomRunways
) -> Iterator[tuple[str, list[str], Estimate]]:
    """Estimate what share of runs unloads a gear or exceeds a level: quantity, levels, shares."""
    asked = {"min_load": {"0 (unloads)": 0.0}}
    for quantity, levels in random.levels.items():
        asked[quantity] = asked.get(quantity, {}) | dict(levels)
    for quantity, levels in asked.items():
        yield quantity, list(levels), ensemble.exceedance(quantity, list(levels.values()))


def side(quantity: str) -> str:
    """Tell which values of a quantity are beyond a level."""
    return "at or below" if quantity in DOWNWARD else "above"


def worst_runs(ensemble: Ensemble) -> dict[str, list[int]]:
    """List the runs with the largest loads, by gear, worst first."""
    return {gear: ensemble.worst(gear, _WORST).tolist() for gear in ensemble.gear_names}


def document(ensemble: Ensemble, random: RandomRunways) -> dict[str, Any]:
    """Give everything above in plain values."""
    return {
        "runs": len(ensemble),
        "first_run": int(ensemble.run[0]),
        "static_load": by_name(ensemble.gear_names, ensemble.static_load[0]),
        **{quantity: _of_quantity(Statistics.of(ensemble, quantity)) for quantity in DIMENSIONS},
        "exceedance": [
            {
                "quantity": quantity,
                "at": name,
                "side": side(quantity),
                "level": level,
                "stated_level": stated,
                **share,
            }
            for quantity, texts, found in exceedances(ensemble, random)
            for row, (stated, level) in enumerate(zip(texts, found.asked.tolist(), strict=True))
            for name, share in zip(found.names, _row(found, row), strict=True)
        ],
        "worst_runs": worst_runs(ensemble),
    }


def _of_quantity(found: Statistics) -> dict[str, Any]:
    means = _row(found.mean, 0)
    quantiles = [_row(found.quantiles, row) for row in range(found.quantiles.asked.size)]
    return {
        name: {
            "mean": means[i],
            "quantiles": [
                {"probability": probability} | row[i]
                for probability, row in zip(found.quantiles.asked.tolist(), quantiles, strict=True)
            ],
            "worst": {"value": found.worst[i].value, "run": found.worst[i].run},
        }
        for i, name in enumerate(found.names)
    }


def _row(found: Estimate, row: int) -> list[dict[str, float | None]]:
    """Give the estimates of a row with their intervals, at each gear or station."""
    parts = (found.value[row], found.low[row], found.high[row])
    return [
        {"value": float(value), "low": bound(float(low)), "high": bound(float(high))}
        for value, low, high in zip(*parts, strict=True)
    ]
