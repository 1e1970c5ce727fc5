"""Responses as tables hold the response's own numbers, with names and units."""

import sys

import numpy as np
import pytest

import runway_modal as rm
from runway_modal.units import Units

RESPONSE = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))


def test_pandas() -> None:
    table = RESPONSE.to_pandas(Units("in", "lbf"))
    np.testing.assert_array_equal(table[["load_nose", "load_left", "load_right"]], RESPONSE.load)
    np.testing.assert_array_equal(table[["bounce", "pitch", "roll"]], RESPONSE.cg)
    np.testing.assert_array_equal(table["acceleration_cg"], RESPONSE.acceleration["cg"])
    units = table.attrs["units"]
    assert (units["time"], units["load_left"], units["elevation_nose"]) == ("s", "lbf", "in")
    assert (units["pitch"], units["acceleration_cg"]) == ("rad", "in/s²")
    assert RESPONSE.to_pandas().attrs == {}


def test_xarray() -> None:
    data = RESPONSE.to_xarray(Units("in", "lbf"))
    np.testing.assert_array_equal(data["load"].sel(gear="right"), RESPONSE.load[:, 2])
    np.testing.assert_array_equal(data["static_load"], RESPONSE.static_load)
    assert data["static_load"].attrs["units"] == "lbf"
    np.testing.assert_array_equal(
        data["acceleration"].sel(station="cg"), RESPONSE.acceleration["cg"]
    )
    assert data["acceleration"].attrs["units"] == "in/s²"


@pytest.mark.parametrize(("module", "method"), [("pandas", "to_pandas"), ("xarray", "to_xarray")])
def test_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch, module: str, method: str) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=r"runway_modal\[tables\]"):
        getattr(RESPONSE, method)()
