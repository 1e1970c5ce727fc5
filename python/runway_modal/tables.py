"""Responses, linear or not, as tables (extra ``tables``, but for CSV)."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .units import ACCELERATION, ANGLE, FORCE, LENGTH, SPEED, STIFFNESS, TIME, Units

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path
    from typing import TextIO

    import pandas as pd
    import xarray as xr
    from numpy.typing import NDArray

    from ._results import Results
    from .units import Dimension

_MISSING = "tables need pandas, pyarrow and xarray: pip install runway_modal[tables]"

_CG = {"bounce": LENGTH, "pitch": ANGLE, "roll": ANGLE}

_OF_GEARS = {"load": FORCE, "elevation": LENGTH, "stiffness": STIFFNESS}


class _Quantity(NamedTuple):
    """A quantity over time."""

    name: str
    dimension: Dimension
    #: One value a time, or one column for each of `labels`.
    values: NDArray[np.float64]
    #: What the columns stand for, and their names.
    axis: str = ""
    labels: tuple[str, ...] = ()


def _quantities(response: Results) -> Iterator[_Quantity]:
    """Everything that tables show, in the order of their columns."""
    gears, stations = response.aircraft.gear_names, response.acceleration
    yield _Quantity("time", TIME, response.time)
    yield _Quantity("distance", LENGTH, response.distance)
    for name in response._of_gears:
        yield _Quantity(name, _OF_GEARS[name], getattr(response, name), "gear", gears)
    for i, (name, dimension) in enumerate(_CG.items()):
        yield _Quantity(name, dimension, response.cg[:, i])
    values = np.column_stack(list(stations.values()))
    yield _Quantity("acceleration", ACCELERATION, values, "station", tuple(stations))


def columns(response: Results) -> dict[str, tuple[NDArray[np.float64], Dimension]]:
    """Columns of a response and their dimensions, by name."""
    found = {}
    for name, dimension, values, axis, labels in _quantities(response):
        if axis:
            for i, label in enumerate(labels):
                found[f"{name}_{label}"] = values[:, i], dimension
        else:
            found[name] = values, dimension
    return found


def to_pandas(response: Results, units: Units | None = None) -> pd.DataFrame:
    """Make the table that `Response.to_pandas` documents."""
    try:
        import pandas as pd
    except ImportError:
        raise ImportError(_MISSING) from None
    found = columns(response)
    table = pd.DataFrame({name: values for name, (values, _) in found.items()})
    if units is not None:
        table.attrs["units"] = {name: units.name(kind) for name, (_, kind) in found.items()}
    return table


def to_xarray(response: Results, units: Units | None = None) -> xr.Dataset:
    """Make the data set that `Response.to_xarray` documents."""
    try:
        import xarray as xr
    except ImportError:
        raise ImportError(_MISSING) from None

    def attributes(dimension: Dimension) -> dict[str, str]:
        return {} if units is None else {"units": units.name(dimension)}

    time, *quantities = _quantities(response)
    coordinates = {quantity.axis: list(quantity.labels) for quantity in quantities if quantity.axis}
    variables = {
        name: (("time", axis) if axis else "time", values, attributes(dimension))
        for name, dimension, values, axis, _ in quantities
    }
    return xr.Dataset(
        {**variables, "static_load": ("gear", response.static_load, attributes(FORCE))},
        {**coordinates, "time": ("time", time.values, attributes(TIME))},
    )


def write_csv(runs: Iterable[tuple[float, Results]], units: Units, file: TextIO) -> None:
    """Write time histories one after another, each row with its speed, every digit kept."""
    writer = csv.writer(file, lineterminator="\n")
    for i, (speed, response) in enumerate(runs):
        found = columns(response)
        if i == 0:
            heads = (f"{name} [{units.name(kind)}]" for name, (_, kind) in found.items())
            writer.writerow([f"speed [{units.name(SPEED)}]", *heads])
        rows = zip(*(values.tolist() for values, _ in found.values()), strict=True)
        writer.writerows([speed, *row] for row in rows)


def write_parquet(runs: Iterable[tuple[float, Results]], units: Units, path: Path) -> None:
    """Write the same as Parquet; the units go with it as `to_pandas` keeps them."""
    try:
        import pandas as pd
    except ImportError:
        raise ImportError(_MISSING) from None
    frames = [to_pandas(response, units).assign(speed=speed) for speed, response in runs]
    table = pd.concat(frames, ignore_index=True)
    table.insert(0, "speed", table.pop("speed"))
    table.attrs["units"] = {"speed": units.name(SPEED), **frames[0].attrs["units"]}
    try:
        table.to_parquet(path)
    except ImportError:  # pandas does without pyarrow until now
        raise ImportError(_MISSING) from None
