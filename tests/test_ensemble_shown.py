"""Figures and tables of ensembles show the ensemble's own numbers in the units they name."""

import io
import sys

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from scipy import stats

import runway_modal as rm
from runway_modal import plotting_ensemble, tables, tables_ensemble
from runway_modal._axes import COLORS

INCHES = rm.Units("in", "lbf")
RUNWAY = {"length": 6000.0, "spacing": 12.0, "speed": rm.knots(60), "seed": 7, "first_run": 40}


def aircraft() -> rm.Aircraft:
    bare = rm.f4e()
    return rm.Aircraft(
        mass=bare.mass,
        pitch_inertia=bare.pitch_inertia,
        roll_inertia=bare.roll_inertia,
        gears=bare.gears,
        stations={"pilot": (200.0, 0.0)},
    )


ENSEMBLE = rm.monte_carlo(
    aircraft().modes(0.01),
    rm.Roughness.iso8608("B", "in"),
    tracks="isotropic",
    runs=400,
    **RUNWAY,
)


def test_histogram_holds_all_runs_and_the_static_load() -> None:
    axes = ENSEMBLE.plot("max_load", ["nose", "left"], ax=Figure().subplots(), units=INCHES)
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        "largest load [kip]",
        "density of runs [1/kip]",
    )
    *static, named = axes.get_lines()
    colors = {line.get_color(): line.get_xdata()[0] for line in static}
    assert colors == {
        COLORS[0]: ENSEMBLE.static_load[0, 0] / 1e3,
        COLORS[1]: ENSEMBLE.static_load[0, 1] / 1e3,
    }
    assert named.get_label() == "static"
    # Filled and outlined, gear by gear: an area of 1 from the smallest value to the largest.
    for i, column in ((0, 0), (2, 1)):
        corners = axes.patches[i].get_xy()
        loads = ENSEMBLE.max_load[:, column] / 1e3
        np.testing.assert_allclose(corners[:, 0].min(), loads.min(), rtol=1e-12)
        np.testing.assert_allclose(corners[:, 0].max(), loads.max(), rtol=1e-12)
        x, y = corners.T
        area = 0.5 * abs(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1)))
        assert area == pytest.approx(1.0, rel=1e-9)


def test_gears_of_one_static_load_share_its_line_and_mixed_aircraft_have_none() -> None:
    axes = ENSEMBLE.plot("min_load", ax=Figure().subplots())
    nose, mains, _, zero = axes.get_lines()
    assert [line.get_xdata()[0] for line in (nose, mains)] == ENSEMBLE.static_load[0, :2].tolist()
    assert zero.get_xdata()[0] == 0.0
    low, high = axes.get_ylim()
    tallest = max(patch.get_xy()[:, 1].max() for patch in axes.patches)
    assert low == 0.0
    assert tallest < 0.9 * high  # room for the legend
    assert axes.get_xlabel() == "smallest load"
    heavier = rm.Aircraft(
        mass=150.0, pitch_inertia=1.92e6, roll_inertia=6.56e5, gears=rm.f4e().gears
    )
    modes = [one.modes(0.01) for one in (rm.f4e(), heavier)]
    mixed = rm.simulate_many(modes, np.tile([0.0, 1.0, 0.0, 1.0], (2, 1, 1)), 12.0, 400.0)
    assert mixed.plot("max_load", ax=Figure().subplots()).get_lines()[:] == []


@pytest.mark.parametrize("quantity", ["max_load", "min_load"])
def test_exceedance_curve_is_the_share_of_runs_beyond(quantity: str) -> None:
    axes = ENSEMBLE.plot_exceedance(quantity, ["left"], ax=Figure().subplots(), units=INCHES)
    (curve,) = axes.get_lines()
    levels, shares = curve.get_xdata()[:-1] * 1e3, curve.get_ydata()[:-1]
    loads = getattr(ENSEMBLE, quantity)[:, 1]
    for level, share in zip(levels, shares, strict=True):
        # A thousandth of a pound: levels are loads, divided and multiplied again.
        beyond = loads > level + 1e-3 if quantity == "max_load" else loads < level + 1e-3
        assert share == pytest.approx(beyond.mean(), abs=1e-12)
    # The curve goes from all runs to the last one.
    assert sorted({shares.min(), shares.max()}) == [
        pytest.approx(1 / 400),
        1.0 if quantity == "min_load" else pytest.approx(399 / 400),
    ]
    assert curve.get_xdata()[[0, -1]].tolist() == [loads.min() / 1e3, loads.max() / 1e3]
    band = axes.collections[0].get_paths()[0].vertices
    assert band[:, 1].min() < 1 / 400 < 1.5 / 400 < band[:, 1].max()
    word = "above" if quantity == "max_load" else "at or below"
    assert (axes.get_yscale(), axes.get_ylabel()) == ("log", f"share of runs {word}")


def test_accelerations_are_drawn_in_g() -> None:
    axes = ENSEMBLE.plot_exceedance(
        "max_acceleration", ["pilot"], ax=Figure().subplots(), units=rm.Units("in", "lbf")
    )
    largest = axes.get_lines()[0].get_xdata()[-1]
    assert largest == pytest.approx(ENSEMBLE.max_acceleration["pilot"].max() / 386.08858, rel=1e-7)
    assert axes.get_xlabel() == "largest |vertical acceleration| [g]"


def test_rows_of_several_quantities() -> None:
    quantities = ["min_load", "max_acceleration"]
    figure = plotting_ensemble.histograms_and_exceedances(
        {"a": ENSEMBLE, "b": ENSEMBLE}, units=INCHES, quantities=quantities
    )
    assert [ax.get_xlabel() for ax in figure.axes[::2]] == [
        "smallest load [kip]",
        "largest |vertical acceleration| [g]",
    ] * 2
    for wrong in ("max_load", []):
        with pytest.raises(rm.InputError, match="is not a list of quantities"):
            plotting_ensemble.histograms_and_exceedances({"": ENSEMBLE}, quantities=wrong)
    with pytest.raises(rm.InputError, match="quantity = 'load' is none of 'max_load', "):
        plotting_ensemble.histograms_and_exceedances({"": ENSEMBLE}, quantities=["load"])


def test_figure_has_one_row_per_ensemble() -> None:
    figure = plotting_ensemble.histograms_and_exceedances(
        {"60 kt": ENSEMBLE, "again": ENSEMBLE}, "F-4E", units=INCHES
    )
    assert [axes.get_title(loc="left") for axes in figure.axes] == [
        "60 kt, 400 runs", "", "again, 400 runs", "",
    ]  # fmt: skip


def test_one_run_alone_is_drawn() -> None:
    one = rm.monte_carlo(rm.f4e().modes(0.01), rm.Roughness.iso8608("B", "in"), runs=1, **RUNWAY)
    one.plot(ax=Figure().subplots())
    curve = one.plot_exceedance(ax=Figure().subplots()).get_lines()[0]
    assert curve.get_xdata()[-1] == one.max_load[0, 0]


@pytest.mark.parametrize(
    ("quantity", "names", "said"),
    [
        ("max_lode", None, "quantity = 'max_lode' is none of 'max_load', "),
        ("max_load", ["nose", "tail"], r"names\[1\] = 'tail': no such gear; there are"),
        ("rms_acceleration", ["nose"], r"names\[0\] = 'nose': no such station; there are"),
    ],
)
def test_what_is_not_there_cannot_be_drawn(
    quantity: str, names: list[str] | None, said: str
) -> None:
    for draw in (ENSEMBLE.plot, ENSEMBLE.plot_exceedance):
        with pytest.raises(rm.InputError, match=said):
            draw(quantity, names)


def test_mean_and_its_interval() -> None:
    mean = ENSEMBLE.mean("max_load", confidence=0.95)
    loads = ENSEMBLE.max_load
    np.testing.assert_allclose(mean.value[0], loads.mean(axis=0), rtol=1e-12)
    half = stats.t.isf(0.025, 399) * np.sqrt(loads.var(axis=0, ddof=1) / 400)
    np.testing.assert_allclose(mean.high[0] - mean.value[0], half, rtol=1e-7)
    np.testing.assert_allclose(mean.value[0] - mean.low[0], half, rtol=1e-7)


def test_mean_holds_in_19_of_20_draws() -> None:
    """Intervals from 200 sets of 100 runs against the mean of all 20,000."""
    modes, surface = rm.f4e().modes(0.05), rm.Roughness.iso8608("B", "in")
    runway = RUNWAY | {"length": 2400.0, "first_run": 0}
    every = rm.monte_carlo(modes, surface, runs=20_000, **runway)
    truth = every.max_load.mean(axis=0)[0]
    held = 0
    for first in range(0, 20_000, 100):
        part = rm.monte_carlo(modes, surface, runs=100, **(runway | {"first_run": first}))
        mean = part.mean("max_load")
        held += mean.low[0, 0] <= truth <= mean.high[0, 0]
    # Binomial(200, 0.95): 3 standard deviations are 9.
    assert 181 <= held <= 199


def test_pandas_and_xarray_hold_every_quantity_with_its_unit() -> None:
    table, data = ENSEMBLE.to_pandas(INCHES), ENSEMBLE.to_xarray(INCHES)
    assert table.attrs["units"].keys() == set(table.columns)
    assert data["run"].to_numpy().tolist() == table.index.tolist() == list(range(40, 440))
    for quantity in ("max_load", "min_load", "rms_load"):
        for i, gear in enumerate(("nose", "left", "right")):
            expected = getattr(ENSEMBLE, quantity)[:, i]
            np.testing.assert_array_equal(data[quantity].sel(gear=gear), expected)
            np.testing.assert_array_equal(table[f"{quantity}_{gear}"], expected)
        assert data[quantity].attrs["units"] == "lbf"
        assert table.attrs["units"][f"{quantity}_nose"] == "lbf"
    for quantity in ("max_acceleration", "rms_acceleration"):
        for station in ("cg", "pilot"):
            expected = getattr(ENSEMBLE, quantity)[station]
            np.testing.assert_array_equal(data[quantity].sel(station=station), expected)
            np.testing.assert_array_equal(table[f"{quantity}_{station}"], expected)
        assert data[quantity].attrs["units"] == "in/s²"
    np.testing.assert_array_equal(data["static_load"], ENSEMBLE.static_load)
    np.testing.assert_array_equal(data["speed"], ENSEMBLE.speed)
    assert data["speed"].attrs["units"] == table.attrs["units"]["speed"] == "in/s"
    assert data["max_load"].dims == ("run", "gear")
    assert all(one.attrs == {} for one in ENSEMBLE.to_xarray().variables.values())
    assert ENSEMBLE.to_pandas().attrs == {}


def test_csv_and_parquet_keep_every_digit(tmp_path) -> None:
    text, twice = io.StringIO(), [tables_ensemble.quantities(ENSEMBLE)] * 2
    tables.write_csv(twice, INCHES, text)
    lines = text.getvalue().splitlines()
    assert len(lines) == 801
    head, row = (line.split(",") for line in (lines[0], lines[401]))
    assert head[:3] == ["run", "speed [in/s]", "static_load_nose [lbf]"]
    assert head[-1] == "rms_acceleration_pilot [in/s²]"
    assert (row[0], float(row[2])) == ("40", ENSEMBLE.static_load[0, 0])
    assert float(row[head.index("max_load_nose [lbf]")]) == ENSEMBLE.max_load[0, 0]
    tables.write_parquet(twice, INCHES, tmp_path / "runs.parquet", index="run")
    again = pd.read_parquet(tmp_path / "runs.parquet")
    np.testing.assert_array_equal(again["max_load_left"][400:], ENSEMBLE.max_load[:, 1])
    assert again.attrs["units"]["max_load_left"] == "lbf"
    assert again.index.tolist() == 2 * list(range(40, 440))


@pytest.mark.parametrize(
    ("module", "extra", "do"),
    [
        ("pandas", "tables", lambda: ENSEMBLE.to_pandas()),
        ("xarray", "tables", lambda: ENSEMBLE.to_xarray()),
        ("matplotlib", "plot", lambda: ENSEMBLE.plot()),
        ("matplotlib", "plot", lambda: ENSEMBLE.plot_exceedance()),
        ("matplotlib", "plot", lambda: plotting_ensemble.histograms_and_exceedances({})),
    ],
)
def test_missing_extra_is_named(monkeypatch: pytest.MonkeyPatch, module, extra, do) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=rf"runway_modal\[{extra}\]"):
        do()


def test_progress_is_told_and_changes_no_bit() -> None:
    modes, surface = rm.f4e().modes(0.01), rm.Roughness.iso8608("B", "in")
    runway = RUNWAY | {"length": 1200.0, "speed": rm.knots(1) * np.linspace(20, 90, 9000)}
    steps = []
    told = rm.monte_carlo(
        modes, surface, runs=9000, progress=lambda *step: steps.append(step), **runway
    )
    silent = rm.monte_carlo(modes, surface, runs=9000, **runway)
    assert steps == [(0, 9000), (4096, 9000), (8192, 9000), (9000, 9000)]
    for key in ("run", "speed", "static_load", "max_load", "min_load", "rms_load"):
        np.testing.assert_array_equal(getattr(told, key), getattr(silent, key), err_msg=key)
    for key in ("max_acceleration", "rms_acceleration"):
        np.testing.assert_array_equal(getattr(told, key)["cg"], getattr(silent, key)["cg"])
    assert told.setup == silent.setup
    with pytest.raises(rm.InputError, match="progress = True cannot be called"):
        rm.monte_carlo(modes, surface, runs=9000, progress=True, **runway)


def test_estimates_name_their_rows_and_columns() -> None:
    levels = [30_000.0, 35_000.0]
    found = ENSEMBLE.exceedance("max_load", levels)
    assert found.names == ENSEMBLE.gear_names
    np.testing.assert_array_equal(found.asked, levels)
    head, *rows = (line.split() for line in repr(found).splitlines())
    assert head == ["nose", "left", "right"]
    assert [row[0] for row in rows] == ["30000", "from", "to", "35000", "from", "to"]
    np.testing.assert_allclose([float(v) for v in rows[3][1:]], found.value[1], rtol=1e-5)
    np.testing.assert_allclose([float(v) for v in rows[5][1:]], found.high[1], rtol=1e-5)
    mean = ENSEMBLE.mean("rms_acceleration")
    assert mean.names == ("cg", "pilot")
    assert np.isnan(mean.asked).all()
    assert repr(mean).splitlines()[1].split()[0] == "mean"
    np.testing.assert_array_equal(ENSEMBLE.quantile("min_load", 0.5).asked, [0.5])
