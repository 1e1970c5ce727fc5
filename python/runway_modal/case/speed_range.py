"""Speeds that a case file sweeps over."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from runway_modal.units import ACCELERATION, FORCE, SPEED

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from runway_modal.units import Units

    from .toml import Table

#: More speeds than this are a slip in the units, not a wish.
_MOST = 1_000_000

#: Shares of a step by which the highest speed may miss it: rounding of units.
_ROUNDING = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class SpeedRange:
    """What [sweep] says, in the case's unit system."""

    low: float
    high: float
    step: float
    #: How much worse a load at another speed may be than the worst one told, if that is asked.
    tolerance: float | None
    #: The same for accelerations.
    acceleration_tolerance: float | None
    #: The table that error messages point to.
    place: Table

    def speeds(self) -> NDArray[np.float64]:
        """Every step from the lowest speed on, and the highest."""
        steps = np.floor((self.high - self.low) / self.step + _ROUNDING)
        speeds = self.low + self.step * np.arange(steps + 1.0)
        if self.high - speeds[-1] > _ROUNDING * self.step:
            return np.append(speeds, self.high)
        speeds[-1] = self.high
        return speeds


def read_speed_range(table: Table, units: Units) -> SpeedRange:
    """Read [sweep]."""
    table.only("from", "to", "step", "tolerance", "acceleration_tolerance")
    low, high, step = (table.positive(key, SPEED, units) for key in ("from", "to", "step"))
    if high < low:
        why = f"is less than from = {table.get('from')!r}"
        raise table.fault(f"to = {table.get('to')!r} {why}", "to")
    if (high - low) / step > _MOST:
        why = f"makes more than {_MOST:,} speeds"
        raise table.fault(f"step = {table.get('step')!r} {why}", "step")
    return SpeedRange(
        low=low,
        high=high,
        step=step,
        tolerance=table.positive("tolerance", FORCE, units, None),
        acceleration_tolerance=table.positive("acceleration_tolerance", ACCELERATION, units, None),
        place=table,
    )
