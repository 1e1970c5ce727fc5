"""Measured modes that follow the runway by the aircraft's own static position."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import runway_modal as rm

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Four gears, all apart, one of them more than three displacements hold.
GEARS = [
    rm.Gear("nose", 234.9, 3.0, 1502.0, 12.0),
    rm.Gear("left", -44.35, 109.25, 9102.0, 60.0),
    rm.Gear("right", -57.1, -109.25, 8102.0, 45.0),
    rm.Gear("centre", -70.0, 5.0, 3000.0, 30.0),
]
CRAFT = rm.Aircraft(mass=145.5, pitch_inertia=1.92e6, roll_inertia=6.56e5, gears=GEARS)

#: Different ground under each, none beginning at zero.
TRACKS = {
    "nose": rm.Profile([0, 100, 400, 400, 900], [5, 7, 6, 8, 20]),
    "left": rm.Profile([0, 100, 500, 900], [6, 6.5, 9, 19]),
    "right": rm.Profile([50, 300, 700], [4, 9, 17]),
    "centre": rm.Profile([0, 250, 900], [5.5, 8, 18]),
}


def measured(which: list[int], off: float = 1.0, **options: Any) -> rm.Modes:
    own = CRAFT.modes(0.05)
    return rm.Modes(CRAFT, own.omega[which] * off, 0.05, own.shapes[:, which], **options)


@pytest.mark.parametrize("which", [[0, 1, 2], [0, 2], [1]])
@pytest.mark.parametrize("damping_input", [False, True])
def test_displacements_and_loads_are_those_of_the_formula(
    which: list[int], damping_input: bool
) -> None:
    modes = measured(which, 1.04, static_correction=True)
    response = rm.simulate(modes, TRACKS, 300.0, damping_input=damping_input)
    stiffness, damping = (
        np.array([getattr(g, of) for g in GEARS]) for of in ("stiffness", "damping")
    )
    push = CRAFT.geometry.T * stiffness
    # y = K⁻¹K₁u + Φ (p − ω⁻²ΦᵀK₁u)
    static = np.linalg.solve(CRAFT.stiffness_matrix, push)
    followed = modes.shapes @ (modes.shapes.T @ push / modes.omega[:, None] ** 2)

    def body(ground: NDArray[np.float64], modal: NDArray[np.float64]) -> NDArray[np.float64]:
        return ground @ (static - followed).T + modal @ modes.shapes.T

    # It begins at rest, where the modes alone would have it elsewhere.
    begin = np.array([TRACKS[name].z[0] for name in CRAFT.gear_names])
    start = response.modal[0] - modes.shapes.T @ (push @ begin) / modes.omega**2
    np.testing.assert_allclose(start, 0.0, atol=1e-12)
    cg = body(response.elevation, response.modal)
    np.testing.assert_allclose(response.cg, cg, rtol=0, atol=1e-13 * abs(cg).max())
    gears = cg @ CRAFT.geometry.T
    np.testing.assert_allclose(response.gear_displacement, gears, atol=1e-13 * abs(gears).max())
    load = response.static_load + stiffness * (response.elevation - gears)

    ahead, climb = 1e-3, np.empty_like(response.elevation)
    clear = np.ones(response.time.size, dtype=bool)
    for i, gear in enumerate(GEARS):
        track, x = TRACKS[gear.name], response.distance + gear.x - GEARS[0].x
        climb[:, i] = (track.elevation(x + ahead) - track.elevation(x)) / ahead * 300.0
        # The quotient is right away from breakpoints.
        clear &= (abs(x[:, None] - track.x) > 2.0 * ahead).all(axis=1)
    rate = body(climb, response.modal_rate)
    np.testing.assert_allclose(response.cg_rate[clear], rate[clear], atol=1e-9 * abs(rate).max())
    if damping_input:
        load = load + damping * (climb - rate @ CRAFT.geometry.T)
    np.testing.assert_allclose(response.load[clear], load[clear], atol=1e-9 * abs(load).max())


def test_on_a_plateau_loads_are_static() -> None:
    aircraft = rm.f4e()
    own = aircraft.modes(0.05)
    climb = rm.Profile([0.0, 60_000.0, 120_000.0], [0.0, 600.0, 600.0])
    for which, off in (([0, 1, 2], 1.01), ([1], 1.0)):
        given = (aircraft, own.omega[which] * off, 0.05, own.shapes[:, which])
        plain, corrected = (rm.Modes(*given, static_correction=on) for on in (False, True))
        wrong, right = (rm.simulate(m, climb, 1000.0, times=[119.0]) for m in (plain, corrected))
        np.testing.assert_allclose(right.load[0], right.static_load, rtol=1e-9)
        assert abs(wrong.load[0] - wrong.static_load).max() > 50_000.0


def test_a_mode_that_is_fast_may_be_left_to_it() -> None:
    """On gears far out roll is three times as fast as the others; the ground has long waves."""
    gears = [
        rm.Gear("nose", 234.9, 0.0, 1502.0),
        rm.Gear("left", -44.35, 250.0, 9102.0),
        rm.Gear("right", -44.35, -250.0, 9102.0),
    ]
    aircraft = rm.Aircraft(mass=145.5, pitch_inertia=1.92e6, roll_inertia=6.56e5, gears=gears)
    own = aircraft.modes(0.05)
    assert own.omega[2] > 3.4 * own.omega[1]
    wave = rm.Profile.one_minus_cosine(2000.0, 4.0, segments=200)
    tracks = {"left": wave, "right": rm.Profile(wave.x, -0.5 * wave.z)}

    def loads(modes: rm.Modes) -> NDArray[np.float64]:
        return rm.simulate(modes, tracks, 400.0, times=np.linspace(0.0, 8.0, 400)).load

    given = (aircraft, own.omega[:2], 0.05, own.shapes[:, :2])
    wrong, error = (
        abs(loads(rm.Modes(*given, static_correction=on)) - loads(own)).max()
        for on in (False, True)
    )
    assert error < 0.05 * wrong


def test_own_modes_need_none() -> None:
    own = CRAFT.modes(0.05)
    assert not own.static_correction
    given = rm.Modes(CRAFT, own.omega, 0.05, own.shapes, static_correction=True)
    for one, other in zip(*(rm.simulate(m, TRACKS, 300.0).load for m in (own, given)), strict=True):
        np.testing.assert_array_equal(one, other)
