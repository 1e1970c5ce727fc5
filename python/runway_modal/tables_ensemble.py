"""Tables of ensembles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import tables
from ._quantities import DIMENSIONS
from .tables import Quantity, at_stations
from .units import FORCE, SPEED

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from .ensemble import Ensemble, Estimate
    from .units import Units


def quantities(ensemble: Ensemble) -> list[Quantity]:
    """All quantities in the order of the columns, the run number first."""
    gears = ensemble.gear_names
    found = [
        Quantity("run", None, ensemble.run),
        Quantity("speed", SPEED, ensemble.speed),
        Quantity("static_load", FORCE, ensemble.static_load, "gear", gears),
    ]
    for name, dimension in DIMENSIONS.items():
        values = getattr(ensemble, name)
        if dimension == FORCE:
            found.append(Quantity(name, dimension, values, "gear", gears))
        else:
            found.append(at_stations(name, dimension, values))
    return found


def to_pandas(ensemble: Ensemble, units: Units | None) -> pd.DataFrame:
    """Make the table that `Ensemble.to_pandas` documents."""
    return tables.to_pandas(quantities(ensemble), units, index="run")


def to_xarray(ensemble: Ensemble, units: Units | None) -> xr.Dataset:
    """Make the data set that `Ensemble.to_xarray` documents."""
    run, *others = quantities(ensemble)
    return tables.to_xarray(run, others, units)


def estimate_to_pandas(estimate: Estimate) -> pd.DataFrame:
    """Make the table that `Estimate.to_pandas` documents."""
    rows, columns = estimate.value.shape
    found = [
        Quantity("asked", None, np.repeat(estimate.asked, columns)),
        Quantity("at", None, np.tile(np.array(estimate.names), rows)),
        *(
            Quantity(part, None, getattr(estimate, part).ravel())
            for part in ("value", "low", "high")
        ),
    ]
    return tables.to_pandas(found, None)
