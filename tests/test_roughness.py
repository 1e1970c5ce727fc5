"""Spectra and random profiles, against closed forms, SciPy and statistics."""

import dataclasses
import os
import pickle
import re
import subprocess
import sys

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import trapezoid
from scipy.special import gamma as special_gamma
from scipy.special import kv

import runway_modal as rm
from ctrl_c import ctrl_c

LENGTH, SPACING = 400.0, 0.5
BAND = (0.01, 0.8)
GRID = {"length": LENGTH, "spacing": SPACING}


def rough(waviness: float = 2.0) -> rm.Roughness:
    return rm.Roughness(coefficient=64e-6, waviness=waviness, reference=0.1, band=BAND)


# Spectra


def test_class_a_at_both_of_its_reference_frequencies() -> None:
    # One public generator is 1600 times too small at the first.
    a = rm.Roughness.iso8608("A")
    assert a.psd(0.1) == pytest.approx(16e-6, rel=1e-14)
    # 1 rad/m; G per radian is G per cycle over 2π. The standard's 1e-6 is rounded.
    assert a.psd(1 / (2 * np.pi)) / (2 * np.pi) == pytest.approx(1.0e-6, rel=0.01)


def test_classes_are_a_factor_of_four_apart() -> None:
    n = np.geomspace(0.006, 0.4, 7)
    densities = np.array([rm.Roughness.iso8608(name).psd(n) for name in "ABCDEFGH"])
    assert (densities == densities[0] * 4.0 ** np.arange(8)[:, None]).all()


@pytest.mark.parametrize(("unit", "metre"), [("in", 1 / 0.0254), ("ft", 1 / 0.3048), ("m", 1.0)])
def test_classes_in_other_units(unit: str, metre: float) -> None:
    theirs, ours = rm.Roughness.iso8608("C", unit=unit), rm.Roughness.iso8608("C")
    n = np.geomspace(0.0051, 0.49, 9)
    assert theirs.psd(n / metre) == pytest.approx(ours.psd(n) * metre**3, rel=1e-14)
    assert theirs.variance == pytest.approx(ours.variance * metre**2, rel=1e-14)
    assert theirs.band == pytest.approx((1 / (200 * metre), 1 / (2 * metre)), rel=1e-15)
    # The same runway, measured in another unit.
    here = ours.elevations(length=100.0, spacing=0.5, runs=2, seed=5)
    there = theirs.elevations(length=100.0 * metre, spacing=0.5 * metre, runs=2, seed=5)
    assert there == pytest.approx(here * metre, rel=1e-11, abs=1e-13)


def test_density_and_variance_of_a_power_law() -> None:
    law = rm.Roughness(coefficient=3.0, waviness=2.5, reference=2.0, band=(1.0, 4.0))
    assert law.psd([0.999, 1.0, 2.0, 4.0, 4.001]) == pytest.approx(
        [0.0, 3 * 2**2.5, 3.0, 3 * 2**-2.5, 0.0]
    )
    assert law.psd([[1.0], [2.0]]).shape == (2, 1)
    n = np.linspace(1.0, 4.0, 100_001)
    assert law.variance == pytest.approx(trapezoid(law.psd(n), n), rel=1e-8)


def test_table_is_straight_in_logarithms() -> None:
    n, density = np.array([0.01, 0.05, 0.2, 1.0]), np.array([1e-3, 2e-4, 3e-6, 1e-7])
    table = rm.Roughness.from_table(n, density)
    between = np.geomspace(0.01, 1.0, 57)[1:-1]
    expected = np.exp(np.interp(np.log(between), np.log(n), np.log(density)))
    assert table.psd(between) == pytest.approx(expected, rel=1e-13)
    assert table.psd(n) == pytest.approx(density, rel=1e-13)
    assert (table.psd([0.0099, 1.001]) == 0.0).all()
    fine = np.geomspace(0.01, 1.0, 200_001)
    assert table.variance == pytest.approx(trapezoid(table.psd(fine), fine), rel=1e-7)


# Profiles: their statistics


def periodogram(z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Windowed transforms of profiles, frequencies, and what one wave of unit variance gives."""
    window = stats.norm.pdf(np.linspace(-4, 4, z.shape[-1]))
    frequency = np.fft.rfftfreq(z.shape[-1], SPACING)
    return np.fft.rfft(z * window), frequency, window


def expected_power(rough: rm.Roughness, frequency: np.ndarray, window: np.ndarray) -> np.ndarray:
    """∫ G/2 |W|² over both signs of n, by quadrature."""
    x = SPACING * np.arange(window.size)
    step = 1 / (8 * LENGTH)
    n = np.arange(BAND[0], BAND[1], step) + step / 2
    n = n[n < BAND[1]]
    power = np.zeros_like(frequency)
    for sign in (1.0, -1.0):
        shift = frequency[:, None] - sign * n
        # |W| depends on the shift alone, a multiple of a fine grid's step: by a zoomed transform.
        grid = np.linspace(shift.min(), shift.max(), 40_001)
        w = np.abs(np.exp(-2j * np.pi * np.outer(grid, x)) @ window) ** 2
        power += np.interp(shift, grid, w) @ rough.psd(n) * step / 2
    return power


@pytest.fixture(scope="module")
def three_tracks() -> np.ndarray:
    return rough().elevations(**GRID, runs=4000, seed=2, y=[0.0, 2.0, -2.0])


def test_spectrum_within_its_confidence_interval(three_tracks: np.ndarray) -> None:
    z = three_tracks[:, 0]
    transform, frequency, window = periodogram(z)
    power = (np.abs(transform) ** 2).mean(axis=0)
    expected = expected_power(rough(), frequency, window)
    # Away from zero frequency 2 runs · power / expected has χ² of 2 runs degrees of freedom; the
    # window's side lobes outside the band are far below it.
    inside = (frequency > 0.02) & (frequency < BAND[1] - 0.01)
    share = power[inside] / expected[inside]
    runs = z.shape[0]
    low, high = stats.chi2.ppf([1e-5, 1 - 1e-5], 2 * runs) / (2 * runs)
    assert ((low < share) & (share < high)).all()
    # Of intervals of 95 % about that many hold; neighbours under the window are not independent.
    low, high = stats.chi2.ppf([0.025, 0.975], 2 * runs) / (2 * runs)
    assert 0.9 < ((low < share) & (share < high)).mean() <= 1.0
    assert abs(share.mean() - 1) < 0.005
    outside = frequency > BAND[1] + 0.02
    assert power[outside].max() < 1e-6 * power[inside].min()


@pytest.mark.parametrize(("pair", "distance"), [((0, 1), 2.0), ((0, 2), 2.0), ((1, 2), 4.0)])
def test_coherency_of_tracks(
    three_tracks: np.ndarray, pair: tuple[int, int], distance: float
) -> None:
    transform, frequency, _ = periodogram(three_tracks)
    one, two = (transform[:, track] for track in pair)
    cross = (one * two.conj()).mean(axis=0)
    found = cross / np.sqrt((np.abs(one) ** 2).mean(axis=0) * (np.abs(two) ** 2).mean(axis=0))
    inside = (frequency > 0.03) & (frequency < BAND[1] - 0.01)
    x = 2 * np.pi * frequency[inside] * distance
    gamma = x * kv(1, x)
    # Standard errors of the real and imaginary part over independent runs.
    runs = three_tracks.shape[0]
    real = (found[inside].real - gamma) / ((1 - gamma**2) / np.sqrt(2 * runs))
    imaginary = found[inside].imag / np.sqrt((1 - gamma**2) / (2 * runs))
    for errors in (real, imaginary):
        assert np.abs(errors).max() < 5.0
        assert 0.8 < np.sqrt((errors**2).mean()) < 1.25


@pytest.mark.parametrize("waviness", [1.5, 2.2, 3.0])
def test_covariance_of_tracks_of_any_waviness(waviness: float) -> None:
    surface = rough(waviness)
    z = surface.elevations(**GRID, runs=2000, seed=4, y=[0.0, 3.0])
    n = np.linspace(*BAND, 20_001)
    order = waviness / 2
    x = 2 * np.pi * n * 3.0
    gamma = np.asarray(2 * (x / 2) ** order * kv(order, x))
    gamma /= special_gamma(order)
    expected = trapezoid(gamma * surface.psd(n), n)
    products = (z[:, 0] * z[:, 1]).mean(axis=1)
    error = products.std(ddof=1) / np.sqrt(products.size)
    assert abs(products.mean() - expected) < 4 * error
    squares = (z**2).mean(axis=(1, 2))
    error = squares.std(ddof=1) / np.sqrt(squares.size)
    assert abs(squares.mean() - surface.variance) < 4 * error


@pytest.mark.parametrize(
    ("waviness", "band", "length"), [(3.3, (0.01, 0.4), 300.0), (2.0, (0.005, 0.5), 600.0)]
)
def test_short_profiles_hold_the_longest_waves(
    waviness: float, band: tuple[float, float], length: float
) -> None:
    """Mean squares of Fourier sums over three waves, near the end of the band."""
    surface = rm.Roughness(coefficient=1e-5, waviness=waviness, reference=0.1, band=band)
    z = surface.elevations(length=length, spacing=1.0, runs=20_000, seed=3)[:, 0]
    x, at = np.arange(z.shape[1]), 1.05 * band[0]
    powers = np.abs(z @ np.exp(-2j * np.pi * at * x)) ** 2
    n = np.geomspace(*band, 20_001)
    window = sum(
        np.abs(np.exp(2j * np.pi * np.outer(apart, x)).sum(axis=1)) ** 2
        for apart in (n - at, n + at)
    )
    expected = trapezoid(0.5 * surface.psd(n) * window, n)
    error = powers.std() / np.sqrt(powers.size)
    assert abs(powers.mean() - expected) < 4 * error + 0.015 * expected


def test_a_narrow_band_keeps_its_waves_and_its_beats() -> None:
    """Its covariance, on a runway shorter than a beat; waves half a line off would miss it."""
    low, high = 0.1, 0.102
    rough = rm.Roughness(coefficient=1.0, reference=0.1, band=(low, high))
    z = rough.elevations(length=400.0, spacing=2.0, runs=8000, seed=3)[:, 0]
    n = np.linspace(low, high, 2001)
    for lag in (0, 15, 50, 125, 200):
        wanted = trapezoid(rough.psd(n) * np.cos(2 * np.pi * n * 2.0 * lag), n)
        products = z[:, 0] * z[:, lag]
        error = products.std() / np.sqrt(z.shape[0])
        # Two lines and a part of a third stand for the whole band.
        assert abs(products.mean() - wanted) < 4 * error + 0.02 * rough.variance, lag


def test_stations_are_normal() -> None:
    short = rough().elevations(length=2.0, spacing=0.5, runs=40_000, seed=8)
    score = short[:, 0, 0] / np.sqrt(rough().variance)
    assert stats.kstest(score, "norm").pvalue > 1e-3
    for power, moment, variance in [(2, 1, 2), (3, 0, 15), (4, 3, 96)]:
        error = (score**power).mean() - moment
        assert abs(error) < 4 * np.sqrt(variance / score.size)
    # Runs have nothing to do with each other.
    lagged = (score[1:] * score[:-1]).mean()
    assert abs(lagged) < 4 / np.sqrt(score.size)


def test_covariance_along_the_track() -> None:
    z = rough().elevations(length=2000.0, spacing=0.5, runs=400, seed=12)[:, 0]
    n = np.linspace(*BAND, 100_001)
    for lag in (0, 1, 7, 40, 150, 400):
        products = (z[:, : z.shape[1] - lag] * z[:, lag:]).mean(axis=1)
        error = products.std(ddof=1) / np.sqrt(products.size)
        expected = trapezoid(rough().psd(n) * np.cos(2 * np.pi * n * lag * 0.5), n)
        assert abs(products.mean() - expected) < 4 * error


# Responses


def stationary(
    modes: rm.Modes, rough: rm.Roughness, spacing: float, speed: float, tracks: str
) -> tuple[np.ndarray, np.ndarray]:
    """
    Mean squares of dynamic loads and accelerations, ∫|H|²S, in physical coordinates.

    M q" + C q' + K q = Gᵀk u, C with the modes' damping ratios; every gear follows the elevation
    by its lag. Straight lines between stations turn a wave n into waves n + m/spacing of
    amplitude sinc²: the first few of these matter.
    """
    aircraft = modes.aircraft
    geometry, mass, stiffness = aircraft.geometry, aircraft.mass_matrix, aircraft.stiffness_matrix
    k = np.array([gear.stiffness for gear in aircraft.gears])
    decay = mass @ modes.shapes * (2 * modes.damping_ratio * modes.omega) @ modes.shapes.T @ mass
    x, y = geometry[:, 1], geometry[:, 2]
    points = np.array([[1.0, *point] for point in aircraft.stations.values()])
    low, high = rough.band
    step = (high - low) / 20_000
    base = low + step * (np.arange(20_000) + 0.5)
    distance = 2 * np.pi * base[:, None, None] * np.abs(y[:, None] - y)
    alike = np.ones_like(distance)
    if tracks == "isotropic":
        apart = distance > 0
        alike[apart] = distance[apart] * kv(1, distance[apart])
    loads, accelerations = np.zeros(x.size), np.zeros(len(points))
    for image in range(-3, 4):
        n = base + image / spacing
        omega = (2 * np.pi * speed * n)[:, None, None]
        dynamic = stiffness - omega**2 * mass + 1j * omega * decay
        motion = np.linalg.solve(dynamic, np.broadcast_to(geometry.T * k, (n.size, 3, x.size)))
        lag = np.exp(-2j * np.pi * n[:, None] * (x.max() - x))[:, None, :]
        to_load = k[:, None] * (np.eye(x.size) - geometry @ motion) * lag
        to_acceleration = -(omega**2) * (points @ motion) * lag
        weight = rough.psd(base) * np.sinc(n * spacing) ** 4 * step
        for total, to in ((loads, to_load), (accelerations, to_acceleration)):
            total += np.einsum("n,nai,nij,naj->a", weight, to, alike, to.conj()).real
    return loads, accelerations


@pytest.mark.parametrize("tracks", ["one", "isotropic"])
def test_stationary_mean_squares(tracks: str) -> None:
    aircraft = dataclasses.replace(rm.f4e(), stations={"pilot": (220.0, 10.0)})
    modes = aircraft.modes(0.2)
    surface = rm.Roughness.iso8608("B", unit="in")
    grid = {"spacing": 9.0, "speed": rm.knots(45)}
    expected = stationary(modes, surface, **grid, tracks=tracks)
    # 658 s, of which the growth from rest, about 1/(2ζω) = 0.3 s, takes 0.05 %.
    ensemble = rm.monte_carlo(
        modes, surface, length=600_000.0, runs=300, seed=44, tracks=tracks, **grid
    )
    found = ensemble.rms_load, np.stack(list(ensemble.rms_acceleration.values()), axis=1)
    assert list(ensemble.rms_acceleration) == ["cg", "pilot"]
    for rms, mean_square in zip(found, expected, strict=True):
        squares = rms**2
        error = squares.std(axis=0, ddof=1) / np.sqrt(len(ensemble))
        assert (error < 0.005 * mean_square).all()
        assert (np.abs(squares.mean(axis=0) - mean_square) < 4 * error).all()


def test_monte_carlo_is_simulate_many_of_its_profiles() -> None:
    modes, surface = rm.f4e().modes(0.03), rm.Roughness.iso8608("C", unit="in")
    grid = {"length": 3000.0, "spacing": 7.0, "seed": 11}
    y = [gear.y for gear in modes.aircraft.gears]
    z = surface.elevations(**grid, runs=21, first_run=720, y=y)
    for tracks, elevations in (("one", z[:, :1]), ("isotropic", z)):
        ensemble = rm.monte_carlo(
            modes, surface, **grid, speed=700.0, runs=21, first_run=720, tracks=tracks
        )
        same = rm.simulate_many(modes, elevations, grid["spacing"], 700.0)
        assert same_numbers(ensemble, same)
        assert ensemble.run.tolist() == list(range(720, 741))
        alone = rm.monte_carlo(
            modes, surface, **grid, speed=700.0, runs=1, first_run=731, tracks=tracks
        )
        assert np.array_equal(alone.max_load[0], ensemble.max_load[11])
        # In full: its own extremes, to rounding.
        profiles = surface.profiles(modes, 731, **grid, tracks=tracks)
        aircraft = modes.aircraft
        arms = [gear.x for gear in aircraft.gears]
        end = (grid["spacing"] * (z.shape[2] - 1) + max(arms) - min(arms)) / 700.0
        full = rm.simulate(modes, profiles, 700.0, duration=end).extremes()
        assert ensemble.max_load[11] == pytest.approx(full.max_load, rel=1e-10)
        assert ensemble.min_load[11] == pytest.approx(full.min_load, rel=1e-10)
        found = ensemble.max_acceleration["cg"][11]
        assert found == pytest.approx(full.max_acceleration["cg"], rel=1e-10)


def same_numbers(one: rm.Ensemble, other: rm.Ensemble) -> bool:
    loads = ("max_load", "min_load", "rms_load")
    accelerations = ("max_acceleration", "rms_acceleration")
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in loads) and all(
        np.array_equal(values, getattr(other, name)[station])
        for name in accelerations
        for station, values in getattr(one, name).items()
    )


def test_a_speed_a_run() -> None:
    modes, surface = rm.f4e().modes(0.03), rm.Roughness.iso8608("C", unit="in")
    grid = {"length": 3000.0, "spacing": 7.0, "seed": 11}
    speeds = np.linspace(300.0, 900.0, 11)
    ensemble = rm.monte_carlo(modes, surface, **grid, speed=speeds, runs=11)
    for run in (0, 4, 10):
        alone = rm.monte_carlo(modes, surface, **grid, speed=speeds[run], runs=1, first_run=run)
        assert np.array_equal(alone.rms_load[0], ensemble.rms_load[run])


# An aircraft of 1e99 on waves of 1e46: forces whose squares are at the end of double precision.
HUGE = {
    "modes": rm.single_dof(mass=1e99, omega=9500.0, damping_ratio=0.01),
    "roughness": rm.Roughness(coefficient=1e95, reference=0.05, band=(0.01, 0.05)),
    "length": 240.0,
    "spacing": 5.0,
    "speed": 475_000.0,
    "seed": 1,
}


def test_runs_that_overflow_are_named_or_masked() -> None:
    with pytest.raises(rm.NumericalError, match=r"^run\[700\]: a result left the range"):
        rm.monte_carlo(**HUGE, runs=20, first_run=700, on_error="raise")
    masked = rm.monte_carlo(**HUGE, runs=20, first_run=700, on_error="mask")
    assert 0 < len(masked.failures) < 20
    assert list(masked.failures) == masked.run[~masked.valid].tolist()
    assert masked.failures[700] == "run[700]: a result left the range of double precision"
    assert np.isnan(masked.max_acceleration["cg"]).tolist() == (~masked.valid).tolist()
    assert np.isfinite(masked.rms_load[masked.valid]).all()
    # The surface's size is known: nothing but the range of numbers sets the masked runs apart.
    small = rm.Roughness(coefficient=1e-5, reference=0.05, band=(0.01, 0.05))
    same = rm.monte_carlo(**(HUGE | {"roughness": small}), runs=20, first_run=700)
    dynamic = same.rms_load * 1e50
    assert masked.rms_load[masked.valid] == pytest.approx(dynamic[masked.valid], rel=1e-12)
    assert dynamic[~masked.valid].min() > dynamic[masked.valid].max()
    with pytest.raises(rm.InputError, match="on_error = 'ignore' is none of 'raise', 'mask'"):
        rm.monte_carlo(**HUGE, runs=1, on_error="ignore")


@pytest.mark.parametrize("on_error", ["raise", "mask"])
@pytest.mark.parametrize("speed", [-1.0, np.nan, 1e120, 1e-12])
def test_a_bad_speed_is_refused_by_its_run(speed: float, on_error: str) -> None:
    surface = rm.Roughness.iso8608("C", unit="in")
    grid = {"length": 3000.0, "spacing": 7.0, "seed": 11}
    speeds = np.full(20, 500.0)
    speeds[13] = speed
    with pytest.raises(rm.InputError, match=r"^speed\[13\] = "):
        rm.monte_carlo(
            rm.f4e().modes(0.03), surface, **grid, speed=speeds, runs=20, on_error=on_error
        )


def million(call: str) -> None:
    """Five seconds or more on two processors: three tracks of a million stations."""
    surface = rm.Roughness.iso8608("A", unit="in")
    runway = {"length": 12e6, "spacing": 12.0, "seed": 1}
    if call == "monte_carlo":
        modes = rm.f4e().modes(0.01)
        rm.monte_carlo(
            modes, surface, **runway, runs=10_000, speed=rm.knots(60), tracks="isotropic"
        )
    else:
        # Again and again: one call of so many runs would take much memory.
        for _ in range(5):
            surface.elevations(**runway, runs=64, y=[0.0, 109.25, -109.25])


# While waves are made ready, drawn, summed; later, among runs.
@pytest.mark.parametrize("moment", [0.03, 0.1, 0.3, 0.8, 2.0])
@pytest.mark.parametrize("call", ["monte_carlo", "elevations"])
def test_ctrl_c_within_a_second(call: str, moment: float) -> None:
    with ctrl_c(after=moment):
        million(call)


# Profiles: which run is which


def test_a_run_is_the_same_in_any_batch() -> None:
    y = [0.0, 2.0, -2.0]
    many = rough().elevations(**GRID, runs=40, seed=9, first_run=700, y=y)
    for first, runs in [(731, 1), (731, 2), (725, 15), (730, 8)]:
        some = rough().elevations(**GRID, runs=runs, seed=9, first_run=first, y=y)
        assert np.array_equal(some, many[first - 700 : first - 700 + runs])


def test_a_run_is_the_same_on_any_number_of_threads() -> None:
    program = (
        "import hashlib, runway_modal as rm\n"
        "rough = rm.Roughness.iso8608('A')\n"
        "z = rough.elevations(length=900, spacing=0.5, runs=70, seed=3, y=[0, 2, -2])\n"
        "print(hashlib.sha256(z.tobytes()).hexdigest())"
    )
    digests = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "RAYON_NUM_THREADS": threads},
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        for threads in ("1", "2", "5")
    }
    assert len(digests) == 1


def test_seeds_and_runs_differ() -> None:
    z = np.array([rough().elevations(**GRID, runs=9, seed=s)[:, 0] for s in (0, 1, 2**64 - 1)])
    assert np.unique(z[:, :, 3]).size == 27
    last = rough().elevations(**GRID, runs=1, seed=0, first_run=2**64 - 1)
    assert np.isfinite(last).all()
    # Words of the seed and of the run are not mixed up.
    low = rough().elevations(**GRID, runs=1, seed=1 << 32)
    high = rough().elevations(**GRID, runs=1, seed=0, first_run=1 << 32)
    assert not np.array_equal(low, high)


def test_the_first_track_is_the_one_track() -> None:
    one = rough().elevations(**GRID, runs=3, seed=9)
    four = rough().elevations(**GRID, runs=3, seed=9, y=[7.0, 2.0, 7.0, -2.0])
    assert np.array_equal(four[:, 0], one[:, 0])
    assert np.array_equal(four[:, 2], four[:, 0])
    assert not np.array_equal(four[:, 1], four[:, 3])


def test_roughness_scales_a_profile() -> None:
    double = rm.Roughness(coefficient=4 * 64e-6, reference=0.1, band=BAND)
    z = [each.elevations(**GRID, runs=3, seed=9) for each in (rough(), double)]
    assert np.array_equal(z[1], 2 * z[0])


def test_length_that_is_no_whole_number_of_spacings() -> None:
    for length, spacing, stations in [(1.0, 0.3, 5), (0.3, 0.1, 4), (0.7, 0.1, 8), (0.1, 0.5, 2)]:
        z = rough().elevations(length=length, spacing=spacing, runs=1, seed=1)
        assert z.shape == (1, 1, stations)


def test_profiles_to_replay_a_run() -> None:
    modes = rm.f4e().modes(0.01)
    surface = rm.Roughness.iso8608("A", unit="in")
    grid = {"length": 2000.0, "spacing": 10.0, "seed": 6}
    y = [gear.y for gear in modes.aircraft.gears]
    z = surface.elevations(**grid, runs=4, y=y)
    profiles = surface.profiles(modes, 3, **grid, tracks="isotropic")
    for gear, (name, profile) in enumerate(profiles.items()):
        assert name == modes.aircraft.gears[gear].name
        assert np.array_equal(profile.z, z[3, gear])
        assert np.array_equal(profile.x, 10.0 * np.arange(201))
    one = surface.profiles(modes, 3, **grid)
    assert all(np.array_equal(profile.z, z[3, 0]) for profile in one.values())


def test_pickle() -> None:
    for each in (rough(2.2), rm.Roughness.from_table([0.01, 0.1, 0.4], [1e-3, 1e-5, 1e-6])):
        again = pickle.loads(pickle.dumps(each))
        assert again == each
        assert hash(again) == hash(each)
        assert again != rm.Roughness.iso8608("H")
        assert repr(again) == repr(each)
        z = [same.elevations(**GRID, runs=1, seed=1) for same in (each, again)]
        assert np.array_equal(*z)


# Bad input

GOOD = {"coefficient": 1.0, "reference": 0.1, "band": (0.1, 1.0)}


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"coefficient": 0.0}, "coefficient = 0.0 is not positive"),
        ({"coefficient": np.nan}, "coefficient = NaN is not finite"),
        ({"coefficient": "rough"}, "coefficient = 'rough' is not a real number"),
        ({"waviness": np.inf}, "waviness = inf is not finite"),
        ({"waviness": 500.0}, "out of range"),
        ({"reference": -1.0}, "reference = -1.0 is not positive"),
        ({"band": (0.0, 1.0)}, "band[0] = 0.0 is not positive"),
        ({"band": (1.0, 1.0)}, "band[1] = 1.0 is out of range"),
        ({"band": (1.0, np.nan)}, "band[1] = NaN is not finite"),
        ({"band": (1.0,)}, "band has 1 entry"),
        ({"band": 1.0}, "band has shape ()"),
    ],
)
def test_bad_power_law(wrong: dict[str, object], message: str) -> None:
    with pytest.raises(rm.InputError, match=re.escape(message)):
        rm.Roughness(**(GOOD | wrong))


@pytest.mark.parametrize(
    ("n", "psd", "message"),
    [
        ([0.1], [1.0], "n has 1 entry, at least 2 needed"),
        ([0.1, 0.2], [1.0], "psd has 1 entry, 2 expected"),
        ([0.1, 0.1], [1.0, 1.0], "n[1] = 0.1 is out of range"),
        ([0.0, 0.1], [1.0, 1.0], "n[0] = 0.0 is not positive"),
        ([0.1, 0.2], [1.0, 0.0], "psd[1] = 0.0 is not positive"),
        ([0.1, np.nan], [1.0, 1.0], "n[1] = NaN is not finite"),
        ([0.1, 0.2], [np.inf, 1.0], "psd[0] = inf is not finite"),
    ],
)
def test_bad_table(n: list[float], psd: list[float], message: str) -> None:
    with pytest.raises(rm.InputError, match=re.escape(message)):
        rm.Roughness.from_table(n, psd)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"roughness": 1.0}, "roughness = 1.0 is not a Roughness"),
        ({"modes": 1.0}, "modes = 1.0 is not a Modes"),
        (
            {"modes": [rm.f4e().modes(0.01)] * 2},
            "modes has 2 entries, a single Modes expected; simulate_many",
        ),
        ({"tracks": "both"}, "tracks = 'both' is none of 'one', 'isotropic'"),
        ({"damping_input": 1}, "damping_input = 1 is not True or False"),
        ({"speed": 0.0}, "speed = 0.0 is not positive"),
        ({"speed": [1.0, 2.0]}, "speed has 2 entries, 3 expected"),
        ({"speed": [1.0]}, "speed has 1 entry, 3 expected"),
        ({"speed": [[1.0], [1.0, 2.0]]}, "speed is not a rectangular array"),
        ({"speed": [1.0, np.nan, 2.0]}, "speed[1] = NaN is not finite"),
        ({"runs": 0}, "runs = 0 must be at least 1"),
        ({"spacing": 0.7}, "spacing = 0.7 is too coarse"),
    ],
)
def test_bad_monte_carlo(wrong: dict[str, object], message: str) -> None:
    modes = rm.f4e().modes(0.01)
    good = {"modes": modes, "roughness": rough(), "speed": 9.0, "runs": 3, "seed": 1} | GRID
    with pytest.raises(rm.InputError, match=re.escape(message)):
        rm.monte_carlo(**(good | wrong))


@pytest.mark.parametrize("name", ["a", "I", "", "AB", 1, None])
def test_bad_class(name: object) -> None:
    with pytest.raises(rm.InputError, match="not a class of ISO 8608"):
        rm.Roughness.iso8608(name)


def test_a_class_in_lower_case_is_guessed() -> None:
    with pytest.raises(rm.InputError, match=r"'b' is not a class .* did you mean 'B'\?"):
        rm.Roughness.iso8608("b")


def test_bad_unit_and_frequency() -> None:
    with pytest.raises(rm.InputError, match="unit = 'mile'"):
        rm.Roughness.iso8608("A", unit="mile")
    with pytest.raises(rm.InputError, match=r"n\[1\] = nan"):
        rough().psd([0.1, np.nan])


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"length": 0.0}, "length = 0.0 is not positive"),
        ({"length": np.inf}, "length = inf is not finite"),
        ({"spacing": -0.5}, "spacing = -0.5 is not positive"),
        (
            {"spacing": 0.63},
            "spacing = 0.63 is too coarse: the band's shortest wave needs two stations, so 0.625",
        ),
        (
            {"spacing": 1e-6, "length": 900.0},
            "length = 900.0 is out of range: with four of the band's longest",
        ),
        ({"length": 1e12}, "length = 1000000000000.0 is out of range: with four of"),
        (
            {"spacing": 1e-6, "length": 1.0},
            "spacing = 1e-6 is out of range: more than 2^23 of it fit into",
        ),
        ({"runs": 0}, "runs = 0 must be at least 1"),
        ({"runs": 2.0}, "runs = 2.0 is not a whole number"),
        ({"seed": -1}, "seed = -1 must be at least 0"),
        ({"seed": 2**64}, "must be at least 0 and below 18446744073709551616"),
        ({"first_run": 2**64}, "first_run = 18446744073709551616"),
        ({"first_run": 2**64 - 1, "runs": 2}, "first_run = 18446744073709551615"),
        ({"y": []}, "y has 0 entries, at least 1 needed"),
        ({"y": [0.0, np.nan]}, "y[1] = NaN is not finite"),
        ({"y": 0.0}, "y has shape ()"),
    ],
)
def test_bad_profiles(wrong: dict[str, object], message: str) -> None:
    good = {"runs": 1, "seed": 1} | GRID
    with pytest.raises(rm.InputError, match=re.escape(message)):
        rough().elevations(**(good | wrong))


def test_a_band_too_narrow_for_its_beats() -> None:
    line = rm.Roughness(coefficient=1.0, reference=0.1, band=(0.125, 0.125 + 2.0**-30))
    with pytest.raises(rm.InputError, match=r"width of the band = 9\.31\S*e-10 is out of range"):
        line.elevations(**GRID, runs=1, seed=1)


def test_coherent_tracks_need_one_waviness() -> None:
    table = rm.Roughness.from_table([0.01, 0.1, 0.4], [1e-3, 1e-5, 1e-6])
    table.elevations(**GRID, runs=1, seed=1, y=[3.0, 3.0])
    with pytest.raises(rm.InputError, match="spectrum of one waviness"):
        table.elevations(**GRID, runs=1, seed=1, y=[3.0, 0.0])
    with pytest.raises(rm.InputError, match=r"waviness = -1\.0 is out of range"):
        rough(-1.0).elevations(**GRID, runs=1, seed=1, y=[3.0, 0.0])


def test_bad_replay() -> None:
    modes = rm.f4e().modes(0.01)
    with pytest.raises(rm.InputError, match="tracks = 'two' is none of 'one', "):
        rough().profiles(modes, 0, **GRID, seed=1, tracks="two")
    with pytest.raises(rm.InputError, match="is not a Modes"):
        rough().profiles(modes.aircraft, 0, **GRID, seed=1)
    with pytest.raises(rm.InputError, match=r"^run = -1 must be at least 0"):
        rough().profiles(modes, -1, **GRID, seed=1)
