"""Force laws of the nonlinear gears, one by one, against quadrature, roots and differences."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import runway_modal as rm
from runway_modal import nonlinear

MAIN = {"load": 23627.07, "column": 23627.07 / 27809.0}
TIRE = 13530.0


def gear(strut: object, **changes: float) -> nonlinear.Gear:
    return nonlinear.Gear("a", 0.0, 0.0, strut, **{"tire": TIRE, **changes})  # type: ignore[arg-type]


def law(strut: object, static: float = MAIN["load"]) -> object:
    return gear(strut)._law(static)


@pytest.mark.parametrize("n", [1.0, 1.1, 1.4])
def test_gas_keeps_pressure_times_volume_to_the_nth(n: float) -> None:
    gas = nonlinear.GasSpring(load=1000.0, column=8.0, polytropic=n)
    s = np.array([-20.0, -3.0, 0.0, 4.0, 7.9])
    np.testing.assert_allclose(gas.force(s) * (8.0 - s) ** n, 1000.0 * 8.0**n, rtol=1e-13)
    np.testing.assert_allclose(gas.compression(gas.force(s)), s, rtol=0, atol=1e-12)


@pytest.mark.parametrize("n", [1.0, 1.1, 1.4])
def test_slope_of_the_air_curve(n: float) -> None:
    gas = nonlinear.GasSpring.from_stiffness(1000.0, 250.0, n)
    assert gas.stiffness(1000.0) == pytest.approx(250.0, rel=1e-14)
    for s in (-5.0, 1.0, 3.0):
        slope = (gas.force(s + 1e-5) - gas.force(s - 1e-5)) / 2e-5
        assert gas.stiffness(gas.force(s)) == pytest.approx(slope, rel=1e-8)


def test_chamber_of_a_drawing_and_of_static_equilibrium_are_one_law() -> None:
    drawing = nonlinear.GasSpring(load=500.0, column=12.0, polytropic=1.1, extension=0.0)
    static = nonlinear.GasSpring(load=drawing.force(5.0), column=7.0, polytropic=1.1, extension=5.0)
    assert static.preload == pytest.approx(500.0, rel=1e-14)
    assert static.force(2.0) == pytest.approx(drawing.force(7.0), rel=1e-14)


def test_orifice_is_quadratic_and_different_each_way() -> None:
    orifice = nonlinear.Orifice(compression=2.0, rebound=8.0)
    np.testing.assert_array_equal(orifice.force(np.array([-10.0, 0.0, 10.0])), [-800.0, 0.0, 200.0])


STRUTS = {
    "isothermal": [nonlinear.GasSpring(**MAIN)],
    "polytropic": [nonlinear.GasSpring(**MAIN, polytropic=1.4)],
    "on a stop": [nonlinear.GasSpring(**MAIN, extension=3.0)],
    "two stages": [
        nonlinear.GasSpring(**MAIN, polytropic=1.1, extension=3.0),
        nonlinear.GasSpring(load=40e3, column=2.0, polytropic=1.3, extension=0.0),
    ],
    "linear": nonlinear.LinearSpring(27809.0),
}


@pytest.mark.parametrize("name", STRUTS)
def test_strut_force_equals_tire_force(name: str) -> None:
    """The series' load against a root of compression(F) = s, each spring with its stop."""
    strut = STRUTS[name]
    series = law(strut)
    chambers = strut if isinstance(strut, list) else []

    def compression(load: float) -> float:
        total = load / TIRE if chambers else load / TIRE + load / 27809.0
        return total + sum(
            chamber.compression(load) if load > chamber.preload else -chamber.extension
            for chamber in chambers
        )

    zero = compression(MAIN["load"])
    for s in np.linspace(-6.0, 12.0, 37).tolist():
        piece = series.piece(s)
        if compression(1e-6) - zero > s:
            assert piece == 0
            assert series.load(piece, s) == 0.0
            assert series.stiffness(piece, 0.0) == 0.0
            continue
        load = brentq(lambda f, s=s: compression(f) - zero - s, 1e-6, 1e7, xtol=1e-9, rtol=1e-15)
        assert series.load(piece, s) == pytest.approx(load, rel=1e-11)
        # One number and many go different ways in the code.
        assert series.load(piece, np.array([s]))[0] == pytest.approx(load, rel=1e-11)
        h = 1e-5
        if series.piece(s - h) == series.piece(s + h):
            slope = (series.load(piece, s + h) - series.load(piece, s - h)) / (2.0 * h)
            assert series.stiffness(piece, load) == pytest.approx(slope, rel=1e-7)


@pytest.mark.parametrize("name", STRUTS)
@pytest.mark.parametrize("tire", [True, False])
def test_trial_steps_may_go_anywhere(name: str, tire: bool) -> None:
    series = gear(STRUTS[name])._law(MAIN["load"], tire=tire)
    for s in (-1e80, -1e20, -1e3, 1e3, 1e20, 1e80):
        for piece in range(1, len(series.kinks) + 1):
            for load in (series.load(piece, s), series.load(piece, np.array([s]))[0]):
                assert np.isfinite(load)
                assert (load > 1e4) == (s > 0)


def test_series_slope_at_static_is_table_2() -> None:
    nose, left, _ = nonlinear.f4e(polytropic=1.3).linearised().gears
    # 1/k = 1/k_strut + 1/k_tire of the printed values.
    assert nose.stiffness == pytest.approx(1.0 / (1.0 / 1662.0 + 1.0 / 15600.0), rel=1e-13)
    assert left.stiffness == pytest.approx(1.0 / (1.0 / 27809.0 + 1.0 / 13530.0), rel=1e-13)
    assert (round(nose.stiffness), round(left.stiffness)) == (1502, 9102)


def test_table_3_from_the_linearised_aircraft() -> None:
    modes = nonlinear.f4e().linearised().modes(0.01)
    # Unrounded stiffnesses: ω₁ now as printed, 7.270 or 7.271; the others within one digit.
    np.testing.assert_allclose(modes.omega, [7.271, 12.016, 18.198], rtol=0, atol=1.1e-3)


def test_work_of_the_series_is_the_integral_of_its_load() -> None:
    """Energies used elsewhere to judge runs: closed forms against quadrature."""
    gas = nonlinear.GasSpring(**MAIN, polytropic=1.2)
    work, _ = quad(gas.force, 0.0, 0.5, epsabs=0.0, epsrel=1e-12)
    n, column, load = 1.2, MAIN["column"], MAIN["load"]
    closed = load * column / (n - 1.0) * ((column / (column - 0.5)) ** (n - 1.0) - 1.0)
    assert closed == pytest.approx(work, rel=1e-11)


def aircraft(*gears: nonlinear.Gear, **changes: object) -> nonlinear.Aircraft:
    values = {"mass": 145.5, "pitch_inertia": 1.92e6, "roll_inertia": 6.56e5, "gears": gears}
    return nonlinear.Aircraft(**{**values, **changes})  # type: ignore[arg-type]


def test_static_loads_of_more_gears_than_equilibrium_determines() -> None:
    def four(**changes: object) -> nonlinear.Aircraft:
        places = {"nose": (240, 0), "left": (-40, 100), "right": (-40, -100), "aft": (-90, 0)}
        return aircraft(
            *(
                nonlinear.Gear(name, x, y, **{"tire": 12000.0, **changes})  # type: ignore[arg-type]
                for name, (x, y) in places.items()
            )
        )

    gas = nonlinear.GasSpring(load=15e3, column=3.0, polytropic=1.1, extension=4.0)
    nose, left, right, aft = four(strut=gas).static_load.tolist()
    # Equilibrium, and attachments in one plane: compressions linear in x and y.
    weight = 145.5 * four(strut=gas).gravity
    assert nose + left + right + aft == pytest.approx(weight, rel=1e-12)
    assert 240 * nose - 40 * (left + right) - 90 * aft == pytest.approx(0.0, abs=1e-7)
    assert left == pytest.approx(right, rel=1e-12)
    s = {x: gas.compression(f) + f / 12e3 for x, f in ((240, nose), (-40, left), (-90, aft))}
    slope = (s[240] - s[-40]) / 280.0
    assert s[-90] == pytest.approx(s[-40] - 50.0 * slope, rel=1e-11)
    # Linear springs share as they do in the linear model.
    springs = four(strut=nonlinear.LinearSpring(4e3))
    np.testing.assert_allclose(springs.static_load, springs.linearised().static_load, rtol=1e-12)


def test_unsprung_mass_rests_on_the_tires() -> None:
    light, heavy = (
        aircraft(gear(nonlinear.GasSpring(**MAIN), unsprung_mass=mass)) for mass in (0.0, 2.0)
    )
    extra = heavy.static_load - light.static_load
    np.testing.assert_allclose(extra, 2.0 * heavy.gravity, rtol=1e-10)
    assert light.linearised() == heavy.linearised()


def refused(expected: str, make: object) -> None:
    with pytest.raises(rm.InputError) as caught:
        make()  # type: ignore[operator]
    # "NaN" where the core checks.
    assert expected.lower() in str(caught.value).lower()


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf, "1", None, 1j])
def test_numbers_out_of_range(bad: object) -> None:
    shown = repr(bad) if isinstance(bad, str | complex | type(None)) else f"{bad}"
    good = nonlinear.GasSpring(**MAIN)
    for name, make in {
        "load": lambda: nonlinear.GasSpring(bad, 1.0),
        "column": lambda: nonlinear.GasSpring(1.0, bad),
        "polytropic": lambda: nonlinear.GasSpring(1.0, 1.0, bad),
        "stiffness": lambda: nonlinear.GasSpring.from_stiffness(1.0, bad),
        "tire": lambda: gear(good, tire=bad),
        "mass": lambda: aircraft(gear(good), mass=bad),
    }.items():
        refused(f"{name} = {shown}", make)
    refused(f"stiffness = {shown}", lambda: nonlinear.LinearSpring(bad))
    if bad == 0.0:
        return
    for name, make in {
        "compression": lambda: nonlinear.Orifice(bad, 1.0),
        "rebound": lambda: nonlinear.Orifice(1.0, bad),
        "damping": lambda: gear(good, damping=bad),
        "friction": lambda: gear(good, friction=bad, unsprung_mass=1.0),
        "unsprung_mass": lambda: gear(good, unsprung_mass=bad),
        "damping_ratio": lambda: nonlinear.f4e(damping_ratio=bad),
    }.items():
        refused(f"{name} = {shown}", make)
    if bad != math.inf:
        refused(f"extension = {shown}", lambda: nonlinear.GasSpring(1.0, 1.0, 1.0, bad))


def test_bad_gears_and_aircraft() -> None:
    good = nonlinear.GasSpring(**MAIN)
    refused("unsprung_mass = 0.0", lambda: gear(good, friction=1.0))
    refused("strut has 0 chambers", lambda: gear([]))
    refused("strut[1] = 3.0", lambda: gear([good, 3.0]))
    refused("strut = 3.0", lambda: gear(3.0))
    refused("orifice = 3.0", lambda: gear(good, orifice=3.0, unsprung_mass=1.0))
    refused("name = ''", lambda: nonlinear.Gear("", 0, 0, good, 1.0))
    refused("y = nan", lambda: nonlinear.Gear("a", 0, math.nan, good, 1.0))
    refused("gears[0] = 3.0", lambda: aircraft(3.0))  # type: ignore[arg-type]
    refused("gears[1].name = 'a' repeats", lambda: aircraft(gear(good), gear(good)))
    refused("gears has 0 entries", lambda: aircraft())
    # Both ahead of the centre of gravity: one would have to pull.
    ahead = [nonlinear.Gear(name, x, 0.0, good, 1.0) for name, x in (("a", 1.0), ("b", 2.0))]
    refused("gears[1] = 'b' would have to hold the aircraft down", lambda: aircraft(*ahead))
    refused("gravity = 0.0", lambda: aircraft(gear(good), gravity=0.0))


def test_gas_beyond_its_column_is_refused() -> None:
    gas = nonlinear.GasSpring(1000.0, 8.0, 1.1)
    for call, said in (
        (lambda: gas.force(8.0), "compression = 8.0 is not below"),
        (lambda: gas.force(np.array([1.0, 9.0])), "is not below the column"),
        (lambda: gas.compression(0.0), "load = 0.0 is not positive"),
        (lambda: gas.compression(np.array([5.0, -5.0])), "is not positive"),
        (lambda: gas.stiffness(-5.0), "load = -5.0 is not positive"),
    ):
        with pytest.raises(rm.InputError, match=said):
            call()
    with pytest.raises(rm.InputError, match="gravity = 1e-200 is out of range"):
        dataclasses.replace(nonlinear.f4e(), gravity=1e-200)
