"""Figures show the response's own numbers in the units they name."""

import sys

import numpy as np
import pytest
from matplotlib.figure import Figure

import runway_modal as rm
from runway_modal.plotting import loads_over_profile
from runway_modal.units import Units

INCHES = Units("in", "lbf")
RESPONSE = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))


def test_response_draws_loads_and_static_loads_into_given_axes() -> None:
    axes = Figure().subplots()
    assert RESPONSE.plot(["nose"], ax=axes, units=INCHES) is axes
    load, static = axes.get_lines()
    np.testing.assert_array_equal(load.get_ydata(), RESPONSE.load[:, 0] / 1e3)
    assert static.get_ydata()[0] == RESPONSE.static_load[0] / 1e3
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time [s]", "load [kip]")
    low, high = axes.get_ylim()
    assert low < load.get_ydata().min()
    assert load.get_ydata().max() < high


def test_without_units_nothing_is_scaled_or_named() -> None:
    axes = RESPONSE.plot(ax=Figure().subplots())
    np.testing.assert_array_equal(axes.get_lines()[2].get_ydata(), RESPONSE.load[:, 1])
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time", "load")


def test_profile() -> None:
    axes = rm.Profile.full_mat().plot(ax=Figure().subplots(), units=INCHES)
    np.testing.assert_array_equal(axes.get_lines()[0].get_xdata(), [-93, 0, 12, 918, 930, 1023])
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("station [in]", "elevation [in]")


def test_no_run_is_dropped_from_the_figure() -> None:
    runs = {f"{i}": RESPONSE for i in range(9)}
    figure = loads_over_profile(runs, {"left": "Main gear"}, units=INCHES, against="distance")
    assert len(figure.axes[0].get_lines()) == 9 + 1
    assert figure.axes[1].get_xlabel() == "distance of the foremost gear [in]"


def test_unknown_gear_and_missing_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(rm.InputError, match=r"gears\[0\] = 'tail': no such gear"):
        RESPONSE.plot(["tail"])
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r"runway_modal\[plot\]"):
        RESPONSE.plot()
