"""Piecewise-linear runway profiles."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from . import _core
from ._core import InputError
from ._input import any_array, array, entries, finite, integer, number, read_only, refuse

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from ._core import Profile as CoreProfile
    from .units import Units


class Profile:
    """
    Elevation of a runway against station, as straight lines between breakpoints.

    The runway is level before the first breakpoint and after the last. A repeated station
    is a vertical step. A single point is a level runway. Profiles are immutable: every
    operation returns a new one.

    Parameters
    ----------
    x : array_like, shape (n,)
        Stations of the breakpoints, never decreasing [length].
    z : array_like, shape (n,)
        Elevations, positive up [length].

    Raises
    ------
    InputError
        If the arrays differ in length or are empty, a value is not finite, a station
        decreases, or an elevation or a slope exceeds 1e100.

    Notes
    -----
    The profile of the report's Section III.3 and Figure 2.

    Examples
    --------
    >>> import runway_modal as rm
    >>> ramp = rm.Profile([0, 100], [0, 2.5])
    >>> ramp.elevation([-10, 50, 200])
    array([0.  , 1.25, 2.5 ])
    """

    __slots__ = ("_core",)
    _core: CoreProfile

    def __init__(self, x: ArrayLike, z: ArrayLike) -> None:
        self._core = _core.Profile(array("x", x), array("z", z))

    @classmethod
    def _wrap(cls, core: CoreProfile) -> Profile:
        profile = cls.__new__(cls)
        profile._core = core
        return profile

    @property
    def x(self) -> NDArray[np.float64]:
        """Stations of the breakpoints, shape (n,) [length]; read-only."""
        return self._core.x()

    @property
    def z(self) -> NDArray[np.float64]:
        """Elevations of the breakpoints, shape (n,) [length]; read-only."""
        return self._core.z()

    def elevation(self, stations: ArrayLike) -> NDArray[np.float64]:
        """
        Elevation at stations; at a vertical step, after it.

        Parameters
        ----------
        stations : array_like
            Stations, an array of any shape [length].

        Returns
        -------
        ndarray
            Elevations, of the same shape [length].

        Raises
        ------
        InputError
            If `stations` is not an array of numbers or one is NaN.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rm.Profile.full_mat().elevation([6.0, 100.0])
        array([0.75, 1.5 ])
        """
        where = array("stations", stations, ndim=None)
        refuse("stations", where, np.isnan(where), "is not a number")
        return read_only(self._core.elevation(where.reshape(-1)).reshape(where.shape))

    @classmethod
    def mat(
        cls, length: float, height: float = 1.5, ramp: float = 12.0, start: float = 0.0
    ) -> Profile:
        """
        Repair mat: up a ramp, level, down a ramp.

        The defaults are in inches; with any other unit of length give both `height` and `ramp`.

        Parameters
        ----------
        length : float
            Overall length, ramps included [length].
        height : float
            Thickness [length]. Default: AM-2 matting, 1.5 in (published: UFC 3-270-07).
        ramp : float
            Length of each ramp, 0 for a sharp edge [length]. Default: 12 in (inferred; the
            report's figure is lost).
        start : float
            Station of the leading edge [length].

        Returns
        -------
        Profile
            The mat.

        Raises
        ------
        InputError
            If a value is not finite, `length` is not positive, `ramp` is negative or the two ramps
            are longer than the mat.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rm.Profile.mat(120.0).z
        array([0. , 1.5, 1.5, 0. ])
        """
        length, height = finite("length", length), finite("height", height)
        ramp, start = number("ramp", ramp), finite("start", start)
        if not length > 0:
            raise InputError(f"length = {length!r} is not positive")
        if not 0 <= 2 * ramp <= length:
            raise InputError(
                f"ramp = {ramp!r} is not between 0 and {length / 2!r}, half the length"
            )
        stations = [start, start + ramp, start + (length - ramp), start + length]
        return cls(stations, [0.0, height, height, 0.0])

    @classmethod
    def crater_repair(
        cls,
        length: float,
        upheaval: float,
        settlement: float,
        upheaval_length: float,
        height: float = 1.5,
        ramp: float = 12.0,
        start: float = 0.0,
    ) -> Profile:
        """
        Mat over a repaired crater: pavement heaved up around it, fill settled beneath it.

        From level runway the heaved pavement rises in a straight line to the mat's edge, the mat's
        own ramp is the second up-ramp, and the mat sags in a straight line to its middle; the
        other half is the mirror image. Make other shapes as sums, `mat` + `spall`, or with
        `Profile(x, z)`. The defaults are in inches; with any other unit of length give both
        `height` and `ramp`.

        Parameters
        ----------
        length : float
            Overall length of the mat, its ramps included [length].
        upheaval : float
            Height of the heaved pavement at the mat's edges [length].
        settlement : float
            How far the mat's middle lies below its ends, positive down [length].
        upheaval_length : float
            Length of the heaved pavement on each side of the mat; 0 for a vertical lip [length].
        height : float
            Thickness of the mat [length]. Default: as for `mat`.
        ramp : float
            Length of each of the mat's ramps [length]. Default: as for `mat`, inferred.
        start : float
            Station where the pavement begins to rise [length].

        Returns
        -------
        Profile
            The repair.

        Raises
        ------
        InputError
            If a value is not finite, `length` is not positive, `upheaval_length` or `ramp` is
            negative, or the two ramps leave no mat between them.

        Notes
        -----
        The report's Figure 2 is "a mat profile with upheaval and settlement" in straight segments,
        the "second up-ramp" among them. The figure is lost: this arrangement is inferred,
        which is why the amounts have no defaults.

        Examples
        --------
        >>> import runway_modal as rm
        >>> repair = rm.Profile.crater_repair(
        ...     930.0, upheaval=2.0, settlement=1.0, upheaval_length=120.0
        ... )
        >>> repair.x
        array([   0.,  120.,  132.,  585., 1038., 1050., 1170.])
        >>> repair.z
        array([0. , 2. , 3.5, 2.5, 3.5, 2. , 0. ])
        """
        cls.mat(length, height, ramp)  # refuses what a mat refuses
        length, height, ramp = float(length), float(height), float(ramp)
        upheaval, settlement = finite("upheaval", upheaval), finite("settlement", settlement)
        upheaval_length, start = finite("upheaval_length", upheaval_length), finite("start", start)
        if upheaval_length < 0:
            raise InputError(f"upheaval_length = {upheaval_length!r} is negative")
        if 2 * ramp == length:
            raise InputError(f"ramp = {ramp!r} is half the length {length!r}: no mat to settle")
        edge, top = start + upheaval_length, upheaval + height
        half = [start, edge, edge + ramp]
        mirrored = [edge + (length - ramp), edge + length, edge + length + upheaval_length]
        rise = [0.0, upheaval, top]
        return cls(
            [*half, edge + 0.5 * length, *mirrored], [*rise, top - settlement, *reversed(rise)]
        )

    @classmethod
    def spall(cls, length: float, depth: float, ramp: float = 0.0, start: float = 0.0) -> Profile:
        """
        Spall: a cut in the surface, down and up again.

        Parameters
        ----------
        length : float
            Overall length along the runway [length].
        depth : float
            Depth, positive down [length].
        ramp : float
            Length of each sloping edge, 0 for a sharp edge [length].
        start : float
            Station of the leading edge [length].

        Returns
        -------
        Profile
            The spall.

        Raises
        ------
        InputError
            As for `mat`.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rm.Profile.spall(24.0, 1.5).z
        array([ 0. , -1.5, -1.5,  0. ])
        """
        return cls.mat(length, -finite("depth", depth), ramp, start)

    @classmethod
    def one_minus_cosine(
        cls, length: float, height: float, segments: int = 64, start: float = 0.0
    ) -> Profile:
        """
        Smooth bump z = h/2 (1 - cos 2πx/L), as chords between equally spaced points.

        Parameters
        ----------
        length : float
            Length of the bump, L [length].
        height : float
            Height of the bump, h [length].
        segments : int
            Number of chords, at least 2; a chord departs from the curve by at most
            h π²/4 / segments² (0.06 % of h with 64). Under dampers with `damping_input`, which
            feel the slope, results err as 1/segments: on 20 m at 80 m/s, gears damped to 10 %,
            dynamic loads by 1.4 % with 64 and 0.1 % with 1024.
        start : float
            Station of the leading edge [length].

        Returns
        -------
        Profile
            The bump.

        Raises
        ------
        InputError
            If `length` is not positive, a value is not finite or `segments` is not a whole number,
            at least 2 and below 1e7.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rm.Profile.one_minus_cosine(100.0, 2.0, segments=4).z
        array([0., 1., 2., 1., 0.])
        """
        count = integer("segments", segments, 2, 10**7)
        length, height = number("length", length), number("height", height)
        core = _core.Profile.one_minus_cosine(length, height, count, number("start", start))
        return cls._wrap(core)

    @classmethod
    def full_mat(cls) -> Profile:
        """
        AM-2 mat of the report's Figure 7, in inches.

        77.5 ft overall, 1.5 in high (published: UFC 3-270-07, crater cover 54 ft × 77.5 ft);
        12 in ramps (inferred: the figure is lost).

        Returns
        -------
        Profile
            The mat [in].

        Examples
        --------
        >>> import runway_modal as rm
        >>> rm.Profile.full_mat().x
        array([  0.,  12., 918., 930.])
        """
        return cls.mat(930.0)

    @classmethod
    def half_mat(cls, length: float = 540.0) -> Profile:
        """
        Half mat of the report's Figure 3, in inches.

        Parameters
        ----------
        length : float
            Length [in]. Default: 45 ft, inferred. The figure is lost, and half of 77.5 ft
            contradicts the text; with 45 ft and sharp edges the one-degree-of-freedom run
            first unloads at the fourth minimum, as the report says.

        Returns
        -------
        Profile
            The mat, 1.5 in high with sharp edges [in].

        Raises
        ------
        InputError
            If `length` is not positive.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rm.Profile.half_mat().x
        array([  0.,   0., 540., 540.])
        """
        return cls.mat(length, ramp=0.0)

    @classmethod
    def two_foot_spall(cls, depth: float = 1.5, ramp: float = 0.0) -> Profile:
        """
        Two-foot spall of the report's Figure 13, in inches.

        Parameters
        ----------
        depth : float
            Depth [in]. Default inferred: the figure is lost.
        ramp : float
            Length of each sloping edge [in]. Default inferred: sharp edges.

        Returns
        -------
        Profile
            The spall, 24 in wide (printed) [in].

        Raises
        ------
        InputError
            If a value is not finite or `ramp` is not between 0 and 12.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rm.Profile.two_foot_spall().x
        array([ 0.,  0., 24., 24.])
        """
        return cls.spall(24.0, depth, ramp)

    @classmethod
    def double_spall(cls, depth: float = 1.5, ramp: float = 0.0, spacing: float = 48.0) -> Profile:
        """
        Two two-foot spalls in a row, the report's Figure 13, in inches.

        Parameters
        ----------
        depth : float
            Depth [in]. Default inferred: the figure is lost.
        ramp : float
            Length of each sloping edge [in]. Default inferred: sharp edges.
        spacing : float
            Distance between leading edges, at least 24 [in]. Default inferred: two feet of runway
            between them.

        Returns
        -------
        Profile
            The spalls, each 24 in wide [in].

        Raises
        ------
        InputError
            If a value is not finite, `ramp` is not between 0 and 12 or the spalls overlap.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rm.Profile.double_spall().x
        array([ 0.,  0., 24., 24., 48., 48., 72., 72.])
        """
        spacing = finite("spacing", spacing)
        if not spacing >= 24.0:
            raise InputError(f"spacing = {spacing!r} is less than a spall's width, 24")
        one = cls.two_foot_spall(depth, ramp)
        return one + one.shifted(spacing)

    @classmethod
    def sequence(cls, profiles: Sequence[Profile], gap: ArrayLike) -> Profile:
        """
        Put profiles one after another, with gaps of level runway between them.

        The first stays where it is. Each of the others is moved so that its first breakpoint comes
        `gap` after the last breakpoint of the one before, at the elevation where that ended. For
        repairs at known stations use a sum: ``a.shifted(500.0) + b.shifted(2000.0)``.

        Parameters
        ----------
        profiles : sequence of Profile, length n
            The profiles in order; at least one.
        gap : float or array_like, shape (n - 1,)
            Distance from the end of each to the start of the next, not negative [length].

        Returns
        -------
        Profile
            The sequence.

        Raises
        ------
        InputError
            If `profiles` is empty or holds anything but profiles, a gap is negative or not finite,
            or the number of gaps is not n - 1.

        Examples
        --------
        >>> import runway_modal as rm
        >>> mat, spall = rm.Profile.mat(120.0), rm.Profile.spall(24.0, 1.5, ramp=2.0)
        >>> rm.Profile.sequence([mat, spall, mat], gap=600.0).x
        array([   0.,   12.,  108.,  120.,  720.,  722.,  742.,  744., 1344.,
               1356., 1452., 1464.])
        """
        if isinstance(profiles, Profile) or not isinstance(profiles, Iterable):
            raise InputError(f"profiles = {profiles!r} is not a sequence of Profile")
        given = list(profiles)
        if not given:
            raise InputError("profiles is empty")
        for i, profile in enumerate(given):
            if not isinstance(profile, Profile):
                raise InputError(f"profiles[{i}] = {profile!r} is not a Profile")
        gaps = any_array("gap", gap)
        gaps = np.full(len(given) - 1, number("gap", gap)) if gaps.ndim == 0 else array("gap", gap)
        if gaps.size != len(given) - 1:
            raise InputError(
                f"gap has {entries(gaps.size)}, {len(given) - 1} expected (one fewer than profiles)"
            )
        for i, value in enumerate(gaps.tolist()):
            if not 0 <= value < np.inf:
                raise InputError(f"gap[{i}] = {value!r} is negative or not finite")
        x, z = [given[0].x], [given[0].z]
        end, level = x[0][-1], z[0][-1]
        for profile, distance in zip(given[1:], gaps.tolist(), strict=True):
            stations = profile.x - profile.x[0] + (end + distance)
            elevations = profile.z - profile.z[0] + level
            end, level = stations[-1], elevations[-1]
            shared = int(distance == 0)  # end and start are one breakpoint
            x.append(stations[shared:])
            z.append(elevations[shared:])
        return cls(np.concatenate(x), np.concatenate(z))

    def __add__(self, other: Profile) -> Profile:
        """Sum of two profiles, with the breakpoints of both; those equal to rounding become one."""
        if not isinstance(other, Profile):
            return NotImplemented
        return self._wrap(self._core.sum(other._core))

    def __radd__(self, other: object) -> Profile:
        """Begin a sum, ``sum(profiles)``, which starts at 0."""
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def shifted(self, dx: float) -> Profile:
        """
        Move the profile down the runway.

        Parameters
        ----------
        dx : float
            Distance, positive towards larger stations [length].

        Returns
        -------
        Profile
            The moved profile.

        Raises
        ------
        InputError
            If `dx` is not finite.

        Examples
        --------
        >>> import runway_modal as rm
        >>> rm.Profile([0, 1], [0, 1]).shifted(5).x
        array([5., 6.])
        """
        return self._wrap(self._core.shifted(number("dx", dx)))

    def detrended(self) -> Profile:
        """
        Remove the grade: the straight line through the first and the last breakpoint.

        A runway is level before and after its profile, so a survey on a grade begins and ends with
        a kink that no aircraft meets, whose loads may well be the largest of the run. The line that
        is removed would load gears only through their dampers.

        Returns
        -------
        Profile
            The profile relative to that line: it begins and ends at elevation 0. A profile without
            length is moved to begin there.

        Examples
        --------
        >>> import runway_modal as rm
        >>> survey = rm.Profile([0.0, 100.0, 200.0], [350.0, 351.5, 352.0])
        >>> survey.detrended().z
        array([0. , 0.5, 0. ])
        """
        x, z = self.x, self.z
        length = x[-1] - x[0]
        along = (x - x[0]) / length if length else np.zeros(x.size)
        return type(self)(x, z - (z[0] * (1.0 - along) + z[-1] * along))

    def footprint(self, length: float, tolerance: float | None = None) -> Profile:
        """
        Envelope the profile: the mean elevation under a tire of finite contact length.

        The mean over the contact length L,

            m(x) = 1/L ∫ z(s) ds, s from x − L/2 to x + L/2,

        has the slope m′(x) = [z(x + L/2) − z(x − L/2)]/L. For straight lines and vertical steps
        in z that slope is piecewise linear and m continuous and piecewise quadratic, with a
        breakpoint L/2 before and after each one of z. m is evaluated exactly there, and each
        quadratic piece between is replaced by equal chords through exact values. A chord of length
        Δx departs from a quadratic by at most |m″| Δx²/8, reached at its middle; so a piece of
        length Δ over which the slope changes by Δm′ gets ceil(√(Δ |Δm′| / (8 tolerance))) chords
        and is nowhere further from m than `tolerance`. Four times as many chords leave a
        sixteenth of the error.

        Parameters
        ----------
        length : float
            Contact length L, centred on the station [length].
        tolerance : float, optional
            Largest departure of a chord from the exact mean [length]. Default: 1e-4 of the
            profile's range of elevation.

        Returns
        -------
        Profile
            The enveloped profile; it begins L/2 before the profile and ends L/2 after it.

        Raises
        ------
        InputError
            If `length` or `tolerance` is not positive, `length` is below 1e-9 of the largest
            station, or `tolerance` asks for more than 1e7 chords.

        Notes
        -----
        The report leaves the footprint out and suggests it as a change of profile (Section IV.7).
        The contact is rigid and evenly loaded, an approximation of a tire. Rounding errors are a
        few units in the last place of the largest station relative to the contact length, (range
        of z) × spacing(x)/L, and of z, as measured for up to 1e5 breakpoints against exact
        arithmetic. Where the two ends of the contact pass two breakpoints at the same time except
        for rounding, there is one breakpoint: between two, the slope, which acts on dampers, would
        be rounding error.

        Examples
        --------
        >>> import runway_modal as rm
        >>> step = rm.Profile([0, 0], [0, 1])
        >>> step.footprint(10.0).elevation([-5.0, 0.0, 5.0])
        array([0. , 0.5, 1. ])

        A step becomes a ramp as long as the contact: no chords are needed.

        >>> step.footprint(10.0).x
        array([-5.,  5.])
        """
        length = number("length", length)
        if tolerance is None:
            tolerance = 1e-4 * (float(self.z.max()) - float(self.z.min())) or 1.0
        return self._wrap(self._core.footprint(length, number("tolerance", tolerance)))

    def plot(self, *, ax: Axes | None = None, units: Units | None = None) -> Axes:
        """
        Draw elevation against station.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw on. Default: those of a new figure.
        units : Units, optional
            Units of the profile, for the axis labels.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.

        Raises
        ------
        InputError
            If `units` is not a `Units`.
        ImportError
            If matplotlib is not installed.

        Examples
        --------
        >>> import runway_modal as rm
        >>> from matplotlib.figure import Figure
        >>> rm.Profile.full_mat().plot(ax=Figure().subplots()).get_xlabel()
        'station'
        """
        from .plotting import plot_profile

        return plot_profile(self, ax, units)

    def __eq__(self, other: object) -> bool:
        """Whether both have the same breakpoints."""
        if not isinstance(other, Profile):
            return NotImplemented
        # Bit by bit, like the hash; elevations first, as profiles often share their stations.
        mine, theirs = ([one.z.view(np.int64), one.x.view(np.int64)] for one in (self, other))
        return all(map(np.array_equal, mine, theirs))

    def __hash__(self) -> int:
        """Hash of the breakpoints."""
        return hash((self.x.tobytes(), self.z.tobytes()))

    def __reduce__(self) -> tuple[type[Profile], tuple[NDArray[np.float64], NDArray[np.float64]]]:
        """Pickle by breakpoints."""
        return Profile, (self.x, self.z)

    def __repr__(self) -> str:
        """Breakpoints, or their number and range."""
        x, z = self.x, self.z
        if x.size <= 8:
            return f"Profile(x={x.tolist()}, z={z.tolist()})"
        span = f"x {x[0]:g} to {x[-1]:g}, z {z.min():g} to {z.max():g}"
        return f"<Profile: {x.size} breakpoints, {span}>"
