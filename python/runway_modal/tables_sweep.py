"""Tables of sweeps over speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import tables
from .tables import Quantity, at_stations
from .units import ACCELERATION, FORCE, LENGTH, SPEED, TIME

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from .sweep import Sweep
    from .units import Units

_OF_GEARS = {
    "max_load": FORCE,
    "time_of_max": TIME,
    "position_of_max": LENGTH,
    "min_load": FORCE,
    "time_of_min": TIME,
    "position_of_min": LENGTH,
}

_OF_STATIONS = {
    "max_acceleration": ACCELERATION,
    "time_of_max_acceleration": TIME,
    "position_of_max_acceleration": LENGTH,
}


def quantities(sweep: Sweep) -> list[Quantity]:
    """All quantities in the order of the columns, speed first."""
    gears = sweep.modes.aircraft.gear_names
    return [
        Quantity("speed", SPEED, sweep.speed),
        *(
            Quantity(name, dimension, getattr(sweep, name), "gear", gears)
            for name, dimension in _OF_GEARS.items()
        ),
        *(
            at_stations(name, dimension, getattr(sweep, name))
            for name, dimension in _OF_STATIONS.items()
        ),
    ]


def to_pandas(sweep: Sweep, units: Units | None) -> pd.DataFrame:
    """Make the table that `Sweep.to_pandas` documents."""
    return tables.to_pandas(quantities(sweep), units)


def to_xarray(sweep: Sweep, units: Units | None) -> xr.Dataset:
    """Make the data set that `Sweep.to_xarray` documents."""
    speed, *others = quantities(sweep)
    gears = sweep.modes.aircraft.gear_names
    static = Quantity("static_load", FORCE, sweep.static_load, "gear", gears)
    return tables.to_xarray(speed, [*others, static], units)
