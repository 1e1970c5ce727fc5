"""Ensembles as tables (extra ``tables``, but for CSV)."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ._quantities import DIMENSIONS
from .units import FORCE, SPEED

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path
    from typing import TextIO

    import pandas as pd
    import xarray as xr
    from numpy.typing import NDArray

    from .ensemble import Ensemble
    from .units import Dimension, Units

_MISSING = "pandas, pyarrow and xarray: pip install 'runway_modal[tables]'"


class _Quantity(NamedTuple):
    """A quantity of every run, by gear or by station."""

    name: str
    dimension: Dimension
    #: Shape (n, g), or (n, stations).
    values: NDArray[np.float64]
    axis: str
    labels: tuple[str, ...]


def _quantities(ensemble: Ensemble) -> Iterator[_Quantity]:
    """Everything that tables show, in the order of their columns."""
    for name, dimension in DIMENSIONS.items():
        values = getattr(ensemble, name)
        if dimension == FORCE:
            yield _Quantity(name, dimension, values, "gear", ensemble.gear_names)
        else:
            by_station = np.column_stack(list(values.values()))
            yield _Quantity(name, dimension, by_station, "station", tuple(values))


def _columns(ensemble: Ensemble) -> dict[str, tuple[NDArray[np.float64], Dimension]]:
    """Columns of an ensemble and their dimensions, by name."""
    found = {"speed": (ensemble.speed, SPEED)}
    for name, dimension, values, _, labels in _quantities(ensemble):
        for i, label in enumerate(labels):
            found[f"{name} {label}"] = values[:, i], dimension
    return found


def to_pandas(ensemble: Ensemble, units: Units | None = None) -> pd.DataFrame:
    """Make the table that `Ensemble.to_pandas` documents."""
    try:
        import pandas as pd
    except ImportError as error:
        raise ImportError(f"to_pandas needs {_MISSING}") from error
    found = _columns(ensemble)
    table = pd.DataFrame(
        {name: values for name, (values, _) in found.items()},
        index=pd.Index(ensemble.run, name="run"),
    )
    if units is not None:
        table.attrs["units"] = {name: units.name(kind) for name, (_, kind) in found.items()}
    return table


def to_xarray(ensemble: Ensemble, units: Units | None = None) -> xr.Dataset:
    """Make the data set that `Ensemble.to_xarray` documents."""
    try:
        import xarray as xr
    except ImportError as error:
        raise ImportError(f"to_xarray needs {_MISSING}") from error

    def attributes(dimension: Dimension) -> dict[str, str]:
        return {} if units is None else {"units": units.name(dimension)}

    quantities = list(_quantities(ensemble))
    return xr.Dataset(
        {
            "speed": ("run", ensemble.speed, attributes(SPEED)),
            "static_load": (("run", "gear"), ensemble.static_load, attributes(FORCE)),
            **{
                name: (("run", axis), values, attributes(dimension))
                for name, dimension, values, axis, _ in quantities
            },
        },
        {"run": ensemble.run, **{one.axis: list(one.labels) for one in quantities}},
    )


def write_csv(ensembles: Iterable[Ensemble], units: Units, file: TextIO) -> None:
    """Write runs, a row each with its number and speed, every digit kept."""
    writer = csv.writer(file, lineterminator="\n")
    for i, ensemble in enumerate(ensembles):
        found = _columns(ensemble)
        if i == 0:
            heads = (f"{name} [{units.name(kind)}]" for name, (_, kind) in found.items())
            writer.writerow(["run", *heads])
        columns = (values.tolist() for values, _ in found.values())
        writer.writerows(zip(ensemble.run.tolist(), *columns, strict=True))


def write_parquet(ensembles: Iterable[Ensemble], units: Units, path: Path) -> None:
    """Write the same as Parquet; the units go with it as `to_pandas` keeps them."""
    frames = [to_pandas(ensemble, units) for ensemble in ensembles]
    import pandas as pd

    table = pd.concat(frames)
    table.attrs = frames[0].attrs
    try:
        table.to_parquet(path)
    except ImportError as error:  # pandas does without pyarrow until now
        raise ImportError(f"Parquet files need {_MISSING}") from error
