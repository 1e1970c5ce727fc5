"""Named quantities as tables (extra ``tables``, except for CSV)."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ._extras import need
from .units import check_units

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path
    from typing import Any, TextIO

    import pandas as pd
    import xarray as xr
    from numpy.typing import NDArray

    from .units import Dimension, Units


class Quantity(NamedTuple):
    """What a table shows under one name."""

    name: str
    #: None for a plain number.
    dimension: Dimension | None
    #: One value per row, or one column for each of `labels`.
    values: NDArray[Any]
    #: What the columns stand for, and their names.
    axis: str = ""
    labels: tuple[str, ...] = ()

    def columns(self) -> Iterator[tuple[str, NDArray[Any]]]:
        """Name each column."""
        if not self.axis:
            yield self.name, self.values
        for i, label in enumerate(self.labels):
            yield f"{self.name}_{label}", self.values[:, i]


def at_stations(
    name: str, dimension: Dimension, values: Mapping[str, NDArray[np.float64]]
) -> Quantity:
    """Make a quantity of one array per station."""
    return Quantity(
        name, dimension, np.column_stack(list(values.values())), "station", tuple(values)
    )


def columns(quantities: Iterable[Quantity]) -> dict[str, NDArray[Any]]:
    """All columns by name, in order."""
    return {name: values for quantity in quantities for name, values in quantity.columns()}


def to_pandas(
    quantities: Sequence[Quantity], units: Units | None, index: str | None = None
) -> pd.DataFrame:
    """Make a table with one column per name, except for `index`; `attrs` keeps the units."""
    need("tables", "tables", "pandas")
    import pandas as pd

    table = pd.DataFrame(columns(quantities))
    units = check_units(units)
    if units is not None:
        table.attrs["units"] = _units(quantities, units)
    return table if index is None else table.set_index(index)


def to_xarray(along: Quantity, quantities: Sequence[Quantity], units: Units | None) -> xr.Dataset:
    """Make a data set along one quantity; quantities of a single row are constant along it."""
    need("data sets", "tables", "xarray")
    import xarray as xr

    units = check_units(units)

    def variable(one: Quantity) -> tuple[tuple[str, ...], NDArray[Any], dict[str, str]]:
        dims: tuple[str, ...] = (one.axis,) if one.axis else ()
        if not one.axis or one.values.ndim == 2:
            dims = (along.name, *dims)
        attributes = {}
        if units is not None and one.dimension is not None:
            attributes["units"] = units.name(one.dimension)
        return dims, one.values, attributes

    return xr.Dataset(
        {one.name: variable(one) for one in quantities},
        {
            **{one.axis: list(one.labels) for one in quantities if one.axis},
            along.name: variable(along),
        },
    )


def write_csv(tables: Iterable[Sequence[Quantity]], units: Units, file: TextIO) -> None:
    """Write tables with the same columns one after another, with all digits."""
    writer = csv.writer(file, lineterminator="\n")
    for i, quantities in enumerate(tables):
        found = columns(quantities)
        if i == 0:
            named = _units(quantities, units)
            writer.writerow(f"{name} [{named[name]}]" if name in named else name for name in found)
        writer.writerows(zip(*(values.tolist() for values in found.values()), strict=True))


def write_parquet(
    tables: Iterable[Sequence[Quantity]], units: Units, path: Path, index: str | None = None
) -> None:
    """Write the same as Parquet, with the units as `to_pandas` keeps them."""
    need("Parquet files", "tables", "pandas", "pyarrow")
    frames = [to_pandas(quantities, units, index) for quantities in tables]
    import pandas as pd

    table = pd.concat(frames, ignore_index=index is None)
    table.attrs = frames[0].attrs
    table.to_parquet(path)


def _units(quantities: Iterable[Quantity], units: Units) -> dict[str, str]:
    """Name the unit of each column that has one."""
    return {
        name: units.name(one.dimension)
        for one in quantities
        if one.dimension is not None
        for name, _ in one.columns()
    }
