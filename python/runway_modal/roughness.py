"""Random roughness: spectra, and profiles that have them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _core
from ._core import InputError
from ._input import array, entries, finite, integer, number, one_of, read_only, refuse
from .modes import Modes, check_modes
from .profile import Profile
from .units import convert_length, length_unit

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from ._core import Generator, Spectrum

#: Coefficient of ISO 8608's class A, at 0.1 cycles/m, waviness 2 [m³]; each class has four times
#: that of the class before.
_CLASS_A = 16e-6
_CLASSES = "ABCDEFGH"
_REFERENCE = 0.1

#: Longest and shortest wave that matter to aircraft, with a margin [m].
_WAVES = (200.0, 2.0)

#: Run numbers and seeds have 64 bits.
_NUMBERS = 2**64


class Roughness:
    """
    Roughness of a runway: a one-sided displacement spectrum, and Gaussian profiles that have it.

    ``G(n) = coefficient * (n / reference) ** -waviness`` inside the band and zero outside; n is
    in cycles per unit of length, and the integral of G is the variance of the elevation.

    Parameters
    ----------
    coefficient : float
        Density at the reference frequency, > 0 [length³].
    waviness : float
        Exponent w [-].
    reference : float
        Reference frequency, > 0 [cycles/length].
    band : (float, float)
        Lowest and highest frequency, 0 < lowest < highest [cycles/length].

    Raises
    ------
    InputError
        If a value is not finite or not positive, or the band is empty.

    See Also
    --------
    Roughness.iso8608 : The classes of ISO 8608.
    Roughness.from_table : Any spectrum, by its points.

    Notes
    -----
    The lower end of the band matters: with waviness 2 the variance is nearly the coefficient times
    reference² divided by it. Waves much longer than the distance rolled in one period of the
    slowest mode lift the aircraft without loading it.

    The convention is per cycle, not per radian: a density against Ω = 2πn is G/2π, so 16e-6 m³
    at 0.1 cycles/m is 1.0e-6 m³ at 1 rad/m.

    Examples
    --------
    >>> import runway_modal as rm
    >>> rough = rm.Roughness(coefficient=16e-6, reference=0.1, band=(0.005, 0.5))
    >>> rough.psd([0.1, 0.2, 1.0])
    array([1.6e-05, 4.0e-06, 0.0e+00])
    >>> round(rough.variance**0.5, 5)  # m
    0.00563
    """

    __slots__ = ("_core", "_rebuild")
    _core: Spectrum
    _rebuild: tuple[Callable[..., Roughness], tuple[Any, ...]]

    def __init__(
        self,
        *,
        coefficient: float,
        waviness: float = 2.0,
        reference: float,
        band: tuple[float, float],
    ) -> None:
        ends = array("band", band)
        if ends.size != 2:
            raise InputError(
                f"band has {entries(ends.size)}, lowest and highest frequency expected"
            )
        law = (
            number("coefficient", coefficient),
            number("waviness", waviness),
            number("reference", reference),
            (float(ends[0]), float(ends[1])),
        )
        self._core = _core.Spectrum.power_law(*law)
        self._rebuild = (_power_law, law)

    @classmethod
    def iso8608(
        cls,
        name: str,
        unit: Literal["m", "in", "ft", "cm", "mm", "km"] = "m",
        band: tuple[float, float] | None = None,
    ) -> Roughness:
        """
        One of the classes A (smooth) to H of ISO 8608, at its geometric mean; waviness 2.

        Parameters
        ----------
        name : {"A", "B", "C", "D", "E", "F", "G", "H"}
            The class. A has 16e-6 m³ at 0.1 cycles/m; each further class has four times as much.
        unit : {"m", "in", "ft", "cm", "mm", "km"}
            Unit of length of the result: the aircraft's, "in" for `f4e`.
        band : (float, float), optional
            Lowest and highest frequency, in cycles per that unit. Default: waves from 200 m
            down to 2 m, which is what matters to an aircraft, with some margin.

        Returns
        -------
        Roughness
            The spectrum.

        Raises
        ------
        InputError
            If there is no such class or unit, or the band is empty.

        Notes
        -----
        ISO 8608 as several public sources quote it, from two of its tables, which agree:
        16e-6 m³ at 0.1 cycles/m, and 1e-6 m³ at 1 rad/m. Generators that use the first density
        at the second frequency, or the reverse, are wrong by large factors; compare with `psd`.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rm.Roughness.iso8608("B").psd(0.1)
        array(6.4e-05)
        >>> rm.Roughness.iso8608("A", unit="in").psd(0.1 * 0.0254)  # in³
        array(0.976379)
        """
        if not isinstance(name, str) or len(name) != 1 or name not in _CLASSES:
            meant = isinstance(name, str) and name.upper() in tuple(_CLASSES)
            hint = f"; did you mean {name.upper()!r}?" if meant else ""
            raise InputError(f"name = {name!r} is not a class of ISO 8608, 'A' to 'H'{hint}")
        metre = float(convert_length(np.ones(1), "m", length_unit("unit", unit))[0])
        if band is None:
            band = (1.0 / (_WAVES[0] * metre), 1.0 / (_WAVES[1] * metre))
        coefficient = _CLASS_A * 4.0 ** _CLASSES.index(name) * metre**3
        return cls(coefficient=coefficient, reference=_REFERENCE / metre, band=band)

    @classmethod
    def from_table(cls, n: ArrayLike, psd: ArrayLike) -> Roughness:
        """
        Spectrum through measured points, with straight lines between them in log G against log n.

        Parameters
        ----------
        n : array_like, shape (k,)
            Frequencies, > 0, increasing; the first and the last are the band
            [cycles/length].
        psd : array_like, shape (k,)
            One-sided densities, > 0 [length³].

        Returns
        -------
        Roughness
            The spectrum.

        Raises
        ------
        InputError
            If there are fewer than two points, the arrays differ in length, a value is not
            finite or not positive, or a frequency does not increase.

        Notes
        -----
        Each piece is a power law of its own. Coherent tracks need a single power law:
        ``tracks="isotropic"`` takes only a table of two points.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rough = rm.Roughness.from_table([0.01, 0.1, 1.0], [1e-3, 1e-5, 1e-8])
        >>> rough.psd([0.01, 0.0316227766, 2.0])
        array([0.001 , 0.0001, 0.    ])
        """
        frequencies, densities = array("n", n), array("psd", psd)
        rough = cls.__new__(cls)
        rough._core = _core.Spectrum.table(frequencies, densities)
        points = (tuple(frequencies.tolist()), tuple(densities.tolist()))
        rough._rebuild = (Roughness.from_table, points)
        return rough

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency [cycles/length]."""
        return self._core.band()

    @property
    def variance(self) -> float:
        """Variance of the elevation, the integral of the spectrum over its band [length²]."""
        return self._core.variance()

    def psd(self, n: ArrayLike) -> NDArray[np.float64]:
        """
        One-sided power spectral density of the elevation.

        Parameters
        ----------
        n : array_like
            Spatial frequencies, of any shape [cycles/length].

        Returns
        -------
        ndarray
            Densities, of the same shape; zero outside the band [length³].

        Raises
        ------
        InputError
            If a frequency is NaN.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rm.Roughness.iso8608("A").psd([0.05, 0.1])
        array([6.4e-05, 1.6e-05])
        """
        where = array("n", n, ndim=None)
        refuse("n", where, np.isnan(where), "is not a number")
        return read_only(self._core.density(where.reshape(-1)).reshape(where.shape))

    def elevations(
        self,
        *,
        length: float,
        spacing: float,
        runs: int,
        seed: int,
        first_run: int = 0,
        y: ArrayLike = (0.0,),
    ) -> NDArray[np.float64]:
        """
        Make random profiles.

        A run is a pure function of this spectrum, length, spacing, y, seed and its number: run
        731 is the same to the last bit whichever runs are made with it, on any machine and any
        number of threads.

        Parameters
        ----------
        length : float
            Length of the profiles, > 0 [length]. If it is not a multiple of the spacing, they are
            slightly longer.
        spacing : float
            Spacing of the stations, at most half the shortest wave of the band [length].
        runs : int
            Number of runs, > 0.
        seed : int
            Which of the 2⁶⁴ sets of runs to make. All spectra of a band have the same random
            numbers: runs over two classes compare one by one, and are independent only with
            seeds of their own.
        first_run : int
            Number of the first run.
        y : array_like, shape (t,)
            Lateral positions of parallel tracks on an isotropic surface [length]. Equal
            positions share one track. The first track is the same as it is alone.

        Returns
        -------
        ndarray, shape (runs, t, s)
            Elevations at the s = ceil(length / spacing) + 1 stations [length].

        Raises
        ------
        InputError
            If a value is out of range, the spacing is too coarse for the band, or there are several
            tracks and the spectrum is a table of several power laws.

        Notes
        -----
        A profile is a piece of one period of a sum of waves with independent normal amplitudes,
        spaced evenly in frequency. Each carries the variance of the spectrum between the midpoints
        to its neighbours, shared where that keeps its mean frequency, so that every station has
        exactly the spectrum's variance. The period exceeds the length by at least 4 / lowest
        frequency, and by 4 / width of the band; a peak of a table that is narrower than 1 / period
        is as wide as that. On profiles of a few of the longest waves the mean square of a response
        is within 1.5 % of the spectrum's, even of a mode that the longest waves excite most.

        The random numbers come from Philox4x32-10, with the seed as key and run, wave and track as
        counter; no deviate exceeds 8.5 standard deviations.

        Two tracks a distance d apart have the coherency
        γ(n) = [2/Γ(w/2)] (πnd)^(w/2) K_{w/2}(2πnd) of an isotropic surface of waviness w (Dodds
        and Robson, 1973), for w = 2 simply 2πnd·K₁(2πnd); inside the band it is taken as if the
        power law had no ends.

        Between its stations a profile is straight, which removes the share 1 - sinc⁴(n·spacing) of
        the density at n: 6.4 % at 10 stations per wave, 1 % at 25. Its bends add short waves, the
        density G(n) sinc⁴(m·spacing) at m = k/spacing ± n, k = 1, 2, …; dampers may feel them
        (`damping_input`): by them the RMS load of a strongly damped gear was 5 % higher at 2
        stations per shortest wave, 2 % at 4.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rough = rm.Roughness.iso8608("A")
        >>> four = rough.elevations(length=100.0, spacing=0.5, runs=4, seed=1)
        >>> four.shape
        (4, 1, 201)
        >>> one = rough.elevations(length=100.0, spacing=0.5, runs=1, seed=1, first_run=2)
        >>> bool((one[0] == four[2]).all())
        True
        """
        runs, first_run = run_numbers(runs, first_run, _NUMBERS)
        generator = self._generator(length, spacing, seed, array("y", y))
        shape = (runs, np.size(y), generator.stations())
        try:
            out = np.empty(shape)
        except ValueError:
            raise MemoryError(f"runs = {runs}: no array is as large as {shape}") from None
        generator.elevations(first_run, out)
        return out

    def profiles(
        self,
        modes: Modes,
        run: int,
        *,
        length: float,
        spacing: float,
        seed: int,
        tracks: Literal["one", "isotropic"] = "one",
    ) -> dict[str, Profile]:
        """
        Make the profile under each gear for one run, to simulate that run in full.

        Parameters
        ----------
        modes : Modes
            Modes of the aircraft whose gears roll over the runway.
        run : int
            Number of the run.
        length, spacing : float
            As for `elevations` [length].
        seed : int
            As for `elevations`.
        tracks : {"one", "isotropic"}
            One track for all gears, or each gear's own on an isotropic surface; gears at the
            same y share one.

        Returns
        -------
        dict of str to Profile
            The profile under each gear, by gear name.

        Raises
        ------
        InputError
            As for `elevations`.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rough, modes = rm.Roughness.iso8608("A", unit="in"), rm.f4e().modes(0.01)
        >>> profiles = rough.profiles(modes, 731, length=3000.0, spacing=10.0, seed=1)
        >>> rm.simulate(modes, profiles, rm.knots(20)).load.shape[1]
        3
        """
        y = lateral_positions(modes, tracks)
        run = integer("run", run, 0, _NUMBERS)
        elevations = self.elevations(
            length=length, spacing=spacing, runs=1, seed=seed, first_run=run, y=y
        )[0]
        stations = finite("spacing", spacing) * np.arange(elevations.shape[1])
        made = [Profile(stations, elevation) for elevation in elevations]
        shared = made * len(modes.aircraft.gears) if tracks == "one" else made
        return dict(zip(modes.aircraft.gear_names, shared, strict=True))

    def _generator(
        self, length: float, spacing: float, seed: int, y: NDArray[np.float64]
    ) -> Generator:
        return _core.Generator(
            self._core,
            number("length", length),
            number("spacing", spacing),
            y,
            integer("seed", seed, 0, _NUMBERS),
        )

    def __eq__(self, other: object) -> bool:
        """Whether both are made of the same numbers in the same way."""
        return self._rebuild == other._rebuild if isinstance(other, Roughness) else NotImplemented

    def __hash__(self) -> int:
        """Hash of the arguments the spectrum was made from."""
        return hash(self._rebuild)

    def __reduce__(self) -> tuple[Callable[..., Roughness], tuple[Any, ...]]:
        """Pickle by the arguments the spectrum was made from."""
        return self._rebuild

    def __repr__(self) -> str:
        """Band and standard deviation."""
        low, high = self.band
        return (
            f"<Roughness: {low:.4g} to {high:.4g} cycles/length, "
            f"standard deviation {self.variance**0.5:.4g}>"
        )


def _power_law(
    coefficient: float, waviness: float, reference: float, band: tuple[float, float]
) -> Roughness:
    return Roughness(coefficient=coefficient, waviness=waviness, reference=reference, band=band)


def run_numbers(runs: int, first_run: int, below: int = _NUMBERS // 2) -> tuple[int, int]:
    """Check how many runs there are and the first one's number; ensembles' have 63 bits."""
    runs = integer("runs", runs, 1, below)
    return runs, integer("first_run", first_run, 0, below - runs + 1)


def lateral_positions(modes: Modes, tracks: str) -> NDArray[np.float64]:
    """Lateral positions of the tracks: one for all gears or one per gear."""
    check_modes("modes", modes)
    if one_of("tracks", tracks, ("one", "isotropic")) == "one":
        return np.zeros(1)
    return np.array([gear.y for gear in modes.aircraft.gears])
