"""Responses as tables hold the response's own numbers, with names and units."""

import copy
import dataclasses
import pickle
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest

import runway_modal as rm
from runway_modal import nonlinear

MAT, SPEED = rm.Profile.full_mat(), rm.knots(20)
LINEAR = rm.simulate(rm.f4e().modes(0.01), MAT, SPEED)
NONLINEAR = nonlinear.simulate(nonlinear.f4e(), MAT, SPEED, duration=2.0)
INCHES = rm.Units("in", "lbf")
RANDOM = rm.simulate_many(LINEAR.modes, np.zeros((2, 1, 9)), 12.0, SPEED)

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


@both
def test_extremes(response: rm.Response | nonlinear.Response) -> None:
    extremes = response.extremes()
    table = extremes.to_pandas(INCHES)
    assert list(table.index) == ["nose", "left", "right"]
    for name in table.columns:
        np.testing.assert_array_equal(table[name], getattr(extremes, name))
    units = table.attrs["units"]
    assert units.keys() == set(table.columns)
    assert (units["min_load"], units["time_of_max"], units["position_of_min"]) == ("lbf", "s", "in")


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


def test_a_sweep_shows_every_result() -> None:
    modes = dataclasses.replace(rm.f4e(), stations={"pilot": (250.0, 10.0)}).modes(0.01)
    sweep = rm.sweep(modes, MAT, rm.knots([60.0, 20.0]))
    table, data = sweep.to_pandas(INCHES), sweep.to_xarray(INCHES)
    assert table.columns[0] == "speed"
    assert len(table.columns) == 1 + 6 * 3 + 3 * 2
    np.testing.assert_array_equal(table["speed"], sweep.speed)
    for name, unit in (
        ("max_load", "lbf"), ("min_load", "lbf"), ("time_of_max", "s"), ("time_of_min", "s"),
        ("position_of_max", "in"), ("position_of_min", "in"),
    ):  # fmt: skip
        np.testing.assert_array_equal(data[name].sel(gear="left"), getattr(sweep, name)[:, 1])
        np.testing.assert_array_equal(table[f"{name}_left"], getattr(sweep, name)[:, 1])
        assert data[name].attrs["units"] == table.attrs["units"][f"{name}_left"] == unit
    for name, unit in (
        ("max_acceleration", "in/s²"), ("time_of_max_acceleration", "s"),
        ("position_of_max_acceleration", "in"),
    ):  # fmt: skip
        expected = getattr(sweep, name)["pilot"]
        np.testing.assert_array_equal(data[name].sel(station="pilot"), expected)
        np.testing.assert_array_equal(table[f"{name}_pilot"], expected)
        assert data[name].attrs["units"] == table.attrs["units"][f"{name}_pilot"] == unit
    assert data["static_load"].dims == ("gear",)
    assert data["speed"].attrs["units"] == table.attrs["units"]["speed"] == "in/s"
    assert sweep.to_pandas().attrs == sweep.to_xarray()["max_load"].attrs == {}


@pytest.mark.parametrize("again", [copy.deepcopy, lambda r: pickle.loads(pickle.dumps(r))])
def test_copied_results_are_the_same_and_read_only(again: Callable[[Any], Any]) -> None:
    modes, surface = LINEAR.modes, rm.Roughness.iso8608("A", "in")
    runway = {"length": 2400.0, "spacing": 12.0, "speed": SPEED, "runs": 9, "seed": 1}
    many = rm.monte_carlo(modes, surface, **runway)
    sweep = rm.sweep(modes, MAT, [SPEED, 2 * SPEED])
    for result in (LINEAR.extremes(), sweep, many, many.quantile("max_load", 0.5)):
        copied = again(result)
        assert repr(copied) == repr(result)
        for field in dataclasses.fields(result):
            before, after = (getattr(each, field.name) for each in (result, copied))
            for one, other in zip(
                *(each.values() if isinstance(each, dict) else [each] for each in (before, after)),
                strict=True,
            ):
                if isinstance(one, np.ndarray):
                    np.testing.assert_array_equal(other, one)
                    assert not other.flags.writeable


@pytest.mark.parametrize(
    "use",
    [
        lambda units: LINEAR.to_pandas(units),
        lambda units: NONLINEAR.to_xarray(units),
        lambda units: LINEAR.extremes().to_pandas(units),
        lambda units: LINEAR.plot(units=units),
        lambda units: MAT.plot(units=units),
        lambda units: rm.sweep(LINEAR.modes, MAT, SPEED).to_pandas(units),
        lambda units: rm.sweep(LINEAR.modes, MAT, SPEED).plot(units=units),
        lambda units: rm.sweep(LINEAR.modes, MAT, SPEED).plot_acceleration(units=units),
        lambda units: RANDOM.to_pandas(units),
        lambda units: RANDOM.to_xarray(units),
        lambda units: RANDOM.plot(units=units),
        lambda units: RANDOM.plot_exceedance("rms_acceleration", units=units),
    ],
)
@pytest.mark.parametrize("units", ["in", ("in", "lbf"), 0], ids=repr)
def test_units_that_are_none_are_refused(use, units) -> None:
    with pytest.raises(rm.InputError, match=re.escape(f"units = {units!r} is not a Units")):
        use(units)
    plt.close("all")


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


def test_estimates_as_a_table() -> None:
    estimate = RANDOM.quantile("max_load", [0.3, 0.7])
    table = estimate.to_pandas()
    assert table["asked"].tolist() == [0.3] * 3 + [0.7] * 3
    assert table["at"].tolist() == ["nose", "left", "right"] * 2
    for part in ("value", "low", "high"):
        assert table[part].tolist() == getattr(estimate, part).ravel().tolist()
    assert np.isnan(RANDOM.mean("rms_load").to_pandas()["asked"]).all()
