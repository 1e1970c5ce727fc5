"""Responses as tables hold the response's own numbers, with names and units."""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import runway_modal as rm
from runway_modal import nonlinear

MAT, SPEED = rm.Profile.full_mat(), rm.knots(20)
LINEAR = rm.simulate(rm.f4e().modes(0.01), MAT, SPEED)
NONLINEAR = nonlinear.simulate(nonlinear.f4e(), MAT, SPEED, duration=2.0)
INCHES = rm.Units("in", "lbf")

both = pytest.mark.parametrize("response", [LINEAR, NONLINEAR], ids=["linear", "nonlinear"])


@both
def test_pandas(response: rm.Response | nonlinear.Response) -> None:
    table = response.to_pandas(INCHES)
    np.testing.assert_array_equal(table[["load_nose", "load_left", "load_right"]], response.load)
    np.testing.assert_array_equal(table[["bounce", "pitch", "roll"]], response.cg)
    np.testing.assert_array_equal(table["acceleration_cg"], response.acceleration["cg"])
    units = table.attrs["units"]
    assert units.keys() == set(table.columns)
    assert (units["time"], units["load_left"], units["elevation_nose"]) == ("s", "lbf", "in")
    assert (units["pitch"], units["acceleration_cg"]) == ("rad", "in/s²")
    assert response.to_pandas().attrs == {}


@both
def test_xarray(response: rm.Response | nonlinear.Response) -> None:
    data = response.to_xarray(INCHES)
    np.testing.assert_array_equal(data["time"], response.time)
    np.testing.assert_array_equal(data["load"].sel(gear="right"), response.load[:, 2])
    np.testing.assert_array_equal(data["static_load"], response.static_load)
    np.testing.assert_array_equal(
        data["acceleration"].sel(station="cg"), response.acceleration["cg"]
    )
    units = {name: data[name].attrs["units"] for name in ("time", *data.data_vars)}
    assert units["load"] == units["static_load"] == "lbf"
    assert (units["time"], units["roll"], units["acceleration"]) == ("s", "rad", "in/s²")
    assert all(variable.attrs == {} for variable in response.to_xarray().variables.values())


def test_a_nonlinear_run_shows_its_stiffness() -> None:
    table, data = NONLINEAR.to_pandas(INCHES), NONLINEAR.to_xarray(INCHES)
    np.testing.assert_array_equal(table["stiffness_left"], NONLINEAR.stiffness[:, 1])
    np.testing.assert_array_equal(data["stiffness"], NONLINEAR.stiffness)
    assert table.attrs["units"]["stiffness_left"] == data["stiffness"].attrs["units"] == "lbf/in"
    assert "stiffness" not in LINEAR.to_xarray()


def test_parquet_keeps_numbers_and_units(tmp_path: Path) -> None:
    table = LINEAR.to_pandas(rm.Units("m", "kN"))
    table.to_parquet(tmp_path / "run.parquet")
    again = pd.read_parquet(tmp_path / "run.parquet")
    pd.testing.assert_frame_equal(again, table, check_exact=True)
    assert again.attrs == table.attrs
    assert again.attrs["units"]["load_nose"] == "kN"


@both
@pytest.mark.parametrize(("module", "method"), [("pandas", "to_pandas"), ("xarray", "to_xarray")])
def test_missing_extra_is_named(
    monkeypatch: pytest.MonkeyPatch,
    response: rm.Response | nonlinear.Response,
    module: str,
    method: str,
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=r"runway_modal\[tables\]"):
        getattr(response, method)()
