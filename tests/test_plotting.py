"""Figures show the response's own numbers in the units they name."""

import io
import sys

import numpy as np
import pytest
from matplotlib.figure import Figure

import runway_modal as rm
from runway_modal import nonlinear
from runway_modal.plotting import loads_over_profile

INCHES = rm.Units("in", "lbf")
RESPONSE = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))


NONLINEAR = nonlinear.simulate(nonlinear.f4e(), rm.Profile.full_mat(), rm.knots(20), duration=2.0)


@pytest.mark.parametrize("response", [RESPONSE, NONLINEAR], ids=["linear", "nonlinear"])
def test_loads_and_static_loads_into_given_axes(
    response: rm.Response | nonlinear.Response,
) -> None:
    axes = Figure().subplots()
    assert response.plot(["nose"], ax=axes, units=INCHES) is axes
    load, static = axes.get_lines()
    np.testing.assert_array_equal(load.get_xdata(), response.time)
    np.testing.assert_array_equal(load.get_ydata(), response.load[:, 0] / 1e3)
    assert static.get_ydata()[0] == response.static_load[0] / 1e3
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time [s]", "load [kip]")
    low, high = axes.get_ylim()
    assert low < load.get_ydata().min()
    assert load.get_ydata().max() < high


@pytest.mark.parametrize("response", [RESPONSE, NONLINEAR], ids=["linear", "nonlinear"])
def test_accelerations_in_g_against_distance(
    response: rm.Response | nonlinear.Response,
) -> None:
    axes = Figure().subplots()
    assert response.plot_acceleration(["cg"], against="distance", ax=axes, units=INCHES) is axes
    curve, *limits = axes.get_lines()
    np.testing.assert_array_equal(curve.get_xdata(), response.distance)
    expected = response.acceleration["cg"] / INCHES.standard_gravity
    np.testing.assert_array_equal(curve.get_ydata(), expected)
    (bare, *_) = response.plot_acceleration(ax=Figure().subplots()).get_lines()
    expected = response.acceleration["cg"] / response.aircraft.gravity
    np.testing.assert_array_equal(bare.get_ydata(), expected)
    assert [line.get_ydata()[0] for line in limits] == [0.4, -0.4]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["cg", "±0.4 g"]
    assert axes.get_xlabel() == "distance of the foremost gear [in]"
    response.plot_acceleration(["cg"], against="distance", ax=axes)
    _, *again = axes.get_lines()
    assert [line.get_label() for line in again if line.get_label()[0] != "_"] == ["±0.4 g", "cg"]
    assert again[-1].get_color() != curve.get_color()
    loads = response.plot(["nose"], against="distance", ax=Figure().subplots())
    np.testing.assert_array_equal(loads.get_lines()[0].get_xdata(), response.distance)


def test_without_units_nothing_is_scaled_or_named() -> None:
    axes = RESPONSE.plot(ax=Figure().subplots())
    np.testing.assert_array_equal(axes.get_lines()[1].get_ydata(), RESPONSE.load[:, 1])
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time", "load")


def test_lines_that_coincide_can_be_told_apart_and_static_loads_come_once() -> None:
    nose, left, right, *static = RESPONSE.plot(ax=Figure().subplots()).get_lines()
    assert [line.get_linestyle() for line in (nose, left, right)] == ["-", "-", "--"]
    assert [line.get_ydata()[0] for line in static] == RESPONSE.static_load[:2].tolist()


def test_gears_over_the_same_track_share_a_line() -> None:
    gears = {name: f"{name} gear" for name in ("nose", "left", "right")}
    ground = loads_over_profile({"20 kt": RESPONSE}, gears).axes[-1]
    nose, mains = ground.get_lines()
    np.testing.assert_array_equal(nose.get_ydata(), RESPONSE.elevation[:, 0])
    np.testing.assert_array_equal(mains.get_ydata(), RESPONSE.elevation[:, 2])
    assert nose.get_linestyle() != mains.get_linestyle()
    told = [text.get_text() for text in ground.get_legend().get_texts()]
    assert told == ["under the nose gear", "under the left gear, right gear"]


def test_runs_over_other_ground_have_lines_of_their_own() -> None:
    modes, mat = rm.f4e().modes(0.01), rm.Profile.full_mat()
    fast = rm.simulate(modes, mat, rm.knots(60))
    spall = rm.simulate(modes, rm.Profile.spall(200.0, 1.5), rm.knots(20))

    def grounds(runs, against):
        figure = loads_over_profile(runs, {"nose": "nose"}, against=against)
        loads, ground = figure.axes
        told = [text.get_text() for text in ground.get_legend().get_texts()]
        assert told == ["under the nose"]
        names = {line.get_color(): line.get_label() for line in loads.get_lines()[: len(runs)]}
        return {names.get(line.get_color(), "all") for line in ground.get_lines()}

    speeds = {"20 kt": RESPONSE, "60 kt": fast}
    assert grounds(speeds, "time") == {"20 kt", "60 kt"}
    assert grounds(speeds, "distance") == {"all"}
    both = {"mat": RESPONSE, "spall": spall}
    assert grounds(both, "time") == {"mat", "spall"}
    # A short spall on a long way is other ground than none.
    level = rm.simulate(modes, rm.Profile([0, 1e6], [0, 0]), rm.knots(20), duration=1000.0)
    short = rm.simulate(modes, rm.Profile.two_foot_spall(), rm.knots(20), duration=1000.0)
    assert grounds({"level": level, "spall": short}, "time") == {"level", "spall"}
    other = rm.simulate(rm.f4e("equivalent").modes(0.01), mat, rm.knots(20))
    assert grounds({"Table 3": RESPONSE, "Table 4": other}, "time") == {"all"}
    with pytest.raises(rm.InputError, match=r"responses = .* is not a mapping"):
        loads_over_profile([RESPONSE], {"nose": ""})
    with pytest.raises(rm.InputError, match="against = 'load' is none of 'time', 'distance'"):
        loads_over_profile(speeds, {"nose": ""}, against="load")


def test_linear_and_nonlinear_runs_in_one_figure() -> None:
    runs = {"linear": RESPONSE, "nonlinear": NONLINEAR}
    figure = loads_over_profile(runs, {"left": "Main gear"}, units=INCHES)
    linear, other = figure.axes[0].get_lines()[:2]
    np.testing.assert_array_equal(linear.get_ydata(), RESPONSE.load[:, 1] / 1e3)
    np.testing.assert_array_equal(other.get_ydata(), NONLINEAR.load[:, 1] / 1e3)
    assert figure.axes[1].get_xlim() == (0.0, RESPONSE.time[-1])


def test_accelerations_below_the_loads() -> None:
    runs = {"linear": RESPONSE, "nonlinear": NONLINEAR}
    figure = loads_over_profile(runs, {"left": "Main gear"}, units=INCHES, stations=["cg"])
    loads, accelerations, ground = figure.axes
    for i, run in enumerate(runs.values()):
        load, acceleration = loads.lines[i], accelerations.lines[i]
        assert load.get_color() == acceleration.get_color()
        expected = run.acceleration["cg"] / INCHES.standard_gravity
        np.testing.assert_array_equal(acceleration.get_ydata(), expected)
    assert accelerations.get_ylabel() == "cg\nvertical acceleration [g]"
    assert ground.get_xlabel() == "time [s]"
    with pytest.raises(rm.InputError, match=r"stations\[1\] = 'pilot': no such station"):
        loads_over_profile(runs, {"left": ""}, stations=["cg", "pilot"])


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
    with pytest.raises(rm.InputError, match=r"gears\[1\] = 'tail': no such gear"):
        loads_over_profile({"": NONLINEAR}, {"nose": "", "tail": ""})
    with pytest.raises(rm.InputError, match=r"gears = 'nose' is a single name; give a list"):
        RESPONSE.plot("nose")
    with pytest.raises(rm.InputError, match="gears is empty"):
        RESPONSE.plot([])
    with pytest.raises(rm.InputError, match=r"stations\[0\] = 'tail': no such station"):
        RESPONSE.plot_acceleration(["tail"])
    for plot in (RESPONSE.plot, RESPONSE.plot_acceleration):
        with pytest.raises(rm.InputError, match="against = 'load' is none of 'time', 'distance'"):
            plot(against="load")
    with pytest.raises(rm.InputError, match="responses is empty"):
        loads_over_profile({}, {"nose": ""})
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match=r"runway_modal\[plot\]"):
        RESPONSE.plot()


def test_runs_on_one_axes_are_all_in_sight() -> None:
    from matplotlib.figure import Figure

    modes, mat = rm.f4e().modes(0.01), rm.Profile.full_mat()
    axes = Figure().subplots()
    for speed in (20.0, 60.0, 20.0):
        rm.simulate(modes, mat, rm.knots(speed)).plot(["left"], ax=axes)
    low, high = axes.get_ylim()
    curves = [line for line in axes.lines if line.get_label() == "left"]
    assert len({line.get_color() for line in curves}) == len(curves) == 3
    assert low < min(line.get_ydata().min() for line in curves)
    assert high > max(line.get_ydata().max() for line in curves)
    assert axes.get_legend_handles_labels()[1].count("static") == 1
    # However often it is drawn, room for the legend is left once.
    alone = Figure().subplots()
    rm.simulate(modes, mat, rm.knots(60.0)).plot(["left"], ax=alone)
    assert high - low < 1.5 * np.ptp(alone.get_ylim())


def test_a_track_under_each_of_many_gears_has_its_own_dashes() -> None:
    gears = [rm.Gear(str(i), 60.0 - 30.0 * i, 0.0, 8000.0) for i in range(5)]
    gears += [rm.Gear(side, -5.0, y, 8000.0) for side, y in (("left", 90.0), ("right", -90.0))]
    aircraft = rm.Aircraft(mass=1e3, pitch_inertia=2e7, roll_inertia=2e7, gears=gears)
    names = aircraft.gear_names
    tracks = {name: rm.Profile.mat(100.0 + 50.0 * i) for i, name in enumerate(names)}
    run = rm.simulate(aircraft.modes(0.01), tracks, 400.0)
    ground = loads_over_profile({"run": run}, {name: name for name in names}).axes[-1]
    # As drawn: matplotlib calls all dashes of one's own "--".
    assert len({str(line._dash_pattern) for line in ground.get_lines()}) == len(names)
    assert len({str(key._dash_pattern) for key in ground.get_legend().get_lines()}) == len(names)


def test_labels_tell_runs_apart() -> None:
    axes = Figure().subplots()
    sweep = rm.sweep(rm.f4e().modes(0.01), rm.Profile.full_mat(), [300.0, 400.0])
    RESPONSE.plot(["left"], label="Table 3", ax=axes)
    sweep.plot(["nose"], label="sweep", ax=axes)
    named = axes.get_legend_handles_labels()[1]
    assert [name for name in named if name != "static"] == ["Table 3: left", "sweep: nose"]
    axes = Figure().subplots()
    RESPONSE.plot_acceleration(["cg"], label="a", ax=axes)
    sweep.plot_acceleration(["cg"], label="b", ax=axes)
    assert axes.get_legend_handles_labels()[1] == ["a: cg", "±0.4 g", "b: cg"]
    for plot in (RESPONSE.plot, RESPONSE.plot_acceleration, sweep.plot, sweep.plot_acceleration):
        with pytest.raises(rm.InputError, match="label = 3 is not text"):
            plot(label=3)


def test_the_legend_of_elevations_stays_inside() -> None:
    names = [f"{side} {where} gear" for where in ("wing", "body") for side in ("left", "right")]
    gears = [rm.Gear("nose gear", 234.9, 0.0, 1502.0)]
    gears += [
        rm.Gear(name, -44.35 - 9.0 * (i // 2), (-1) ** i * 100.0, 4500.0)
        for i, name in enumerate(names)
    ]
    aircraft = rm.Aircraft(mass=145.5, pitch_inertia=1.92e6, roll_inertia=6.56e5, gears=gears)
    run = rm.simulate(aircraft.modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    figure = loads_over_profile({"run": run}, {name: name for name in aircraft.gear_names})
    figure.savefig(io.BytesIO())  # lays it out
    ground = figure.axes[-1]
    inside, legend = ground.get_window_extent(), ground.get_legend().get_window_extent()
    assert inside.x0 < legend.x0
    assert legend.x1 < inside.x1
    assert inside.width > 0.8 * figure.bbox.width


def test_sweeps_on_one_axes_differ() -> None:
    modes, speeds = rm.f4e().modes(0.01), [200.0, 400.0]
    loads, accelerations = Figure().subplots(2, 1)
    for mat in (rm.Profile.full_mat(), rm.Profile.half_mat()):
        sweep = rm.sweep(modes, mat, speeds)
        sweep.plot(["left"], ax=loads)
        sweep.plot_acceleration(["cg"], ax=accelerations)
    for ax in (loads, accelerations):
        lines = [line for line in ax.lines if line.get_label() in ("left", "cg")]
        assert len({line.get_color() for line in lines}) == len(lines) == 2
    assert accelerations.get_legend_handles_labels()[1] == ["cg", "±0.4 g", "cg"]


def test_a_single_point_is_to_be_seen() -> None:
    modes, mat = rm.f4e().modes(0.01), rm.Profile.full_mat()
    at_once, sweep = rm.simulate(modes, mat, 400.0, times=[1.0]), rm.sweep(modes, mat, 400.0)
    figure = loads_over_profile({"run": at_once}, {"left": "Main gear"})
    plots = at_once.plot, at_once.plot_acceleration, sweep.plot, sweep.plot_acceleration
    for ax in (*(plot() for plot in plots), *figure.axes):
        markers = [line.get_marker() for line in ax.lines if len(line.get_xdata()) == 1]
        assert set(markers) == {"o"}
    assert all(line.get_marker() != "o" for line in rm.simulate(modes, mat, 400.0).plot().lines)


def test_the_legend_of_many_gears_stays_inside() -> None:
    gears = [
        rm.Gear(f"{side} {place}", x, y, 8000.0, 50.0)
        for side, y in (("left wing", 100.0), ("right wing", -100.0), ("body", 0.0))
        for place, x in (("forward", 60.0), ("centre", -5.0), ("aft", -60.0))
    ]
    aircraft = rm.Aircraft(mass=1e3, pitch_inertia=2e7, roll_inertia=2e7, gears=gears)
    modes, mat = aircraft.modes(), rm.Profile.full_mat()
    for shown in (rm.simulate(modes, mat, 400.0), rm.sweep(modes, mat, [300.0, 400.0])):
        figure = Figure(layout="constrained")
        axes = shown.plot(ax=figure.subplots())
        figure.canvas.draw()
        legend, box = axes.get_legend().get_window_extent(), axes.get_window_extent()
        assert box.x0 <= legend.x0
        assert legend.x1 <= box.x1
        assert box.y0 <= legend.y0
        named = [line for line in axes.lines if line.get_label() in aircraft.gear_names]
        assert len({(line.get_color(), line.get_linestyle()) for line in named}) == 9
        assert axes.get_legend_handles_labels()[1][-1] == "static"
