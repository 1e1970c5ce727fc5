"""Tables of sweeps over speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import tables
from ._quantities import EXTREMES_OF_GEARS, EXTREMES_OF_STATIONS
from .tables import Quantity, at_stations
from .units import FORCE, SPEED

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from .sweep import Sweep
    from .units import Units


def quantities(sweep: Sweep) -> list[Quantity]:
    """All quantities in the order of the columns, speed first."""
    gears = sweep.gear_names
    return [
        Quantity("speed", SPEED, sweep.speed),
        *(
            Quantity(name, dimension, getattr(sweep, name), "gear", gears)
            for name, dimension in EXTREMES_OF_GEARS.items()
        ),
        *(
            at_stations(name, dimension, getattr(sweep, name))
            for name, dimension in EXTREMES_OF_STATIONS.items()
        ),
    ]


def to_pandas(sweep: Sweep, units: Units | None) -> pd.DataFrame:
    """Make the table that `Sweep.to_pandas` documents."""
    return tables.to_pandas(quantities(sweep), units)


def to_xarray(sweep: Sweep, units: Units | None) -> xr.Dataset:
    """Make the data set that `Sweep.to_xarray` documents."""
    speed, *others = quantities(sweep)
    gears = sweep.gear_names
    static = Quantity("static_load", FORCE, sweep.static_load, "gear", gears)
    return tables.to_xarray(speed, [*others, static], units)
