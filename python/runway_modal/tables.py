"""Responses, linear or not, as tables."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING, Any

from .units import ACCELERATION, FORCE, LENGTH, TIME, Units

if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import TextIO

    import numpy as np
    import pandas as pd
    import xarray as xr
    from numpy.typing import NDArray

    from .aircraft import Aircraft
    from .response import Response
    from .units import Dimension

_CG = ("bounce", "pitch", "roll")
_MISSING = "tables need pandas and xarray: pip install runway_modal[tables]"


def aircraft_of(response: Any) -> Aircraft:
    """Aircraft of a response: a linear one has it from its modes."""
    found: Aircraft = response.modes.aircraft if hasattr(response, "modes") else response.aircraft
    return found


def columns(response: Response) -> dict[str, NDArray[np.float64]]:
    """Columns of a response by name."""
    names = aircraft_of(response).gear_names
    return {
        "time": response.time,
        "distance": response.distance,
        **{f"load_{name}": response.load[:, i] for i, name in enumerate(names)},
        **{f"elevation_{name}": response.elevation[:, i] for i, name in enumerate(names)},
        **{name: response.cg[:, i] for i, name in enumerate(_CG)},
        **{f"acceleration_{name}": values for name, values in response.acceleration.items()},
    }


_KINDS: dict[str, Dimension] = {
    "time": TIME,
    "distance": LENGTH,
    "load": FORCE,
    "static_load": FORCE,
    "elevation": LENGTH,
    "bounce": LENGTH,
    "acceleration": ACCELERATION,
}


def unit_of(column: str, units: Units) -> str:
    """Name the unit of a column."""
    kind = _KINDS.get(column) or _KINDS.get(column.split("_", 1)[0])
    return units.name(kind) if kind else "rad"


def to_pandas(response: Response, units: Units | None = None) -> pd.DataFrame:
    """Make the table that `Response.to_pandas` documents."""
    try:
        import pandas as pd
    except ImportError:
        raise ImportError(_MISSING) from None
    table = pd.DataFrame(columns(response))
    if units is not None:
        table.attrs["units"] = {name: unit_of(name, units) for name in table.columns}
    return table


def to_xarray(response: Response, units: Units | None = None) -> xr.Dataset:
    """Make the data set that `Response.to_xarray` documents."""
    try:
        import xarray as xr
    except ImportError:
        raise ImportError(_MISSING) from None
    acceleration = response.acceleration
    data = xr.Dataset(
        {
            "distance": ("time", response.distance),
            "load": (("time", "gear"), response.load),
            "static_load": ("gear", response.static_load),
            "elevation": (("time", "gear"), response.elevation),
            **{name: ("time", response.cg[:, i]) for i, name in enumerate(_CG)},
            "acceleration": (("station", "time"), list(acceleration.values())),
        },
        coords={
            "time": response.time,
            "gear": list(aircraft_of(response).gear_names),
            "station": list(acceleration),
        },
    )
    if units is not None:
        for name in ("time", *data.data_vars):
            data[name].attrs["units"] = unit_of(str(name), units)
    return data


def write_csv(responses: Mapping[float, Response], units: Units, file: TextIO) -> None:
    """Write time histories by speed, each row with its speed, every digit kept."""
    writer = csv.writer(file, lineterminator="\n")
    for i, (speed, response) in enumerate(responses.items()):
        table = columns(response)
        if i == 0:
            heads = (f"{name} [{unit_of(name, units)}]" for name in table)
            writer.writerow([f"speed [{units.length}/s]", *heads])
        rows = zip(*(values.tolist() for values in table.values()), strict=True)
        writer.writerows([speed, *row] for row in rows)
