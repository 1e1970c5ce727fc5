"""Tables of responses, linear or nonlinear."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import tables
from ._quantities import EXTREMES_OF_GEARS
from .tables import Quantity, at_stations
from .units import ACCELERATION, ANGLE, FORCE, LENGTH, SPEED, STIFFNESS, TIME

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from ._results import Results
    from .extremes import Extremes
    from .units import Units

_CG = {"bounce": LENGTH, "pitch": ANGLE, "roll": ANGLE}

_OF_GEARS = {"load": FORCE, "elevation": LENGTH, "stiffness": STIFFNESS}


def quantities(response: Results) -> list[Quantity]:
    """All quantities in the order of the columns, time first."""
    gears = response.gear_names
    return [
        Quantity("time", TIME, response.time),
        Quantity("distance", LENGTH, response.distance),
        *(
            Quantity(name, _OF_GEARS[name], getattr(response, name), "gear", gears)
            for name in response._of_gears
        ),
        *(
            Quantity(name, dimension, response.cg[:, i])
            for i, (name, dimension) in enumerate(_CG.items())
        ),
        at_stations("acceleration", ACCELERATION, response.acceleration),
    ]


def with_speed(speed: float, response: Results) -> list[Quantity]:
    """Begin each row with the speed, to tell several runs apart."""
    return [
        Quantity("speed", SPEED, np.full(response.time.shape, speed)),
        *quantities(response),
    ]


def to_pandas(response: Results, units: Units | None) -> pd.DataFrame:
    """Make the table that `Response.to_pandas` documents."""
    return tables.to_pandas(quantities(response), units)


def extremes_to_pandas(extremes: Extremes, units: Units | None) -> pd.DataFrame:
    """Make the table that `Extremes.to_pandas` documents."""
    of_gears = {"static_load": FORCE, **EXTREMES_OF_GEARS}
    found = [
        Quantity("gear", None, np.array(extremes.gear_names)),
        *(
            Quantity(name, dimension, getattr(extremes, name))
            for name, dimension in of_gears.items()
        ),
    ]
    return tables.to_pandas(found, units, index="gear")


def to_xarray(response: Results, units: Units | None) -> xr.Dataset:
    """Make the data set that `Response.to_xarray` documents."""
    time, *others = quantities(response)
    gears = response.gear_names
    static = Quantity("static_load", FORCE, response.static_load, "gear", gears)
    return tables.to_xarray(time, [*others, static], units)
