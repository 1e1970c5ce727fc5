"""
The 1980 report's full-mat comparison, as a command: ``python -m runway_modal.report1980``.

R. R. Gajewski, *Modal analysis for aircraft response to runway surface roughness*, USAF Academy,
1980. Printed values stand here as data, beside which the computed ones are shown.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from .aircraft import f4e
from .profile import Profile
from .simulate import simulate
from .units import knots

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from .modes import Modes
    from .response import Response

#: Damping ratio of every mode (Sections IV.5 and IV.6).
DAMPING_RATIO = 0.01

#: Speed over the mats [in/s]: 20 kt.
MAT_SPEED = knots(20.0)


Stiffness = Literal["static", "equivalent"]


@dataclass(frozen=True, slots=True)
class PrintedModes:
    """Modes as a table of the report prints them: bounce and pitch modes, then roll."""

    title: str
    stiffness: Stiffness
    #: Circular frequencies [rad/s].
    omega: tuple[float, float, float]
    #: Shapes {bounce, pitch, roll}, one a mode; Mode 2 has the opposite sign to ours.
    shapes: tuple[tuple[float, float, float], ...]


TABLE_3 = PrintedModes(
    "Table 3: slope of the air curve at static equilibrium",
    "static",
    (7.271, 12.016, 18.198),
    ((0.025931, 0.000685, 0.0), (-0.078743, 0.000226, 0.0), (0.0, 0.0, 0.001235)),
)
TABLE_4 = PrintedModes(
    "Table 4: equivalent stiffness, Eq. 22",
    "equivalent",
    (7.282, 11.328, 17.148),
    ((0.025052, 0.000688, 0.0), (-0.079027, 0.000218, 0.0), (0.0, 0.0, 0.001235)),
)


def after_over_on(response: Response, profile: Profile) -> NDArray[np.float64]:
    """
    Range of each gear's load after the mat ÷ its range on the mat.

    Above 1 the trailing edge amplified the motion, below 1 it cancelled it. "On" is from the end
    of the up ramp to the beginning of the down ramp, for each gear; "after" from the last gear's
    end of the mat on.

    Parameters
    ----------
    response : Response
        Run over the mat with every gear.
    profile : Profile
        The mat, four breakpoints.

    Returns
    -------
    ndarray, shape (g,)
        The ratio of true ranges [-].

    Examples
    --------
    >>> from runway_modal import report1980
    >>> mat = report1980.full_mat("static")
    >>> report1980.after_over_on(mat, report1980.Profile.full_mat())[1].round(2)
    np.float64(1.53)
    """
    arms = response.modes.aircraft.geometry[:, 1]
    lag = arms.max() - arms
    on = (profile.x[1:3, None] + lag) / MAT_SPEED
    off = (profile.x[3] + lag.max()) / MAT_SPEED

    def load_range(gear: int, begin: float, end: float) -> float:
        extremes = response.at([begin, end]).extremes()
        return float(extremes.max_load[gear] - extremes.min_load[gear])

    end = float(response.time[-1])
    return np.array([load_range(g, off, end) / load_range(g, *on[:, g]) for g in range(arms.size)])


def full_mat(stiffness: Stiffness) -> Response:
    """
    Run the full mat at 20 knots (Figures 10 and 12).

    Parameters
    ----------
    stiffness : {"static", "equivalent"}
        As for `f4e`.

    Returns
    -------
    Response
        All three gears over the mat, 1 % damping in every mode.

    Examples
    --------
    >>> from runway_modal import report1980
    >>> report1980.full_mat("static").extremes().max_load.round(0)
    array([12940., 43686., 43686.])
    """
    return simulate(f4e(stiffness).modes(DAMPING_RATIO), Profile.full_mat(), MAT_SPEED)


def _modes_beside_printed(printed: PrintedModes, modes: Modes) -> Iterator[str]:
    yield printed.title
    yield "  mode          omega [rad/s]         bounce            pitch             roll"
    for i, (omega, shape) in enumerate(zip(printed.omega, printed.shapes, strict=True)):
        # A mode's sign is free: show the printed one with ours.
        sign = 1.0 if np.dot(shape, modes.shapes[:, i]) > 0 else -1.0
        flipped = "  (printed with the opposite sign)" if sign < 0 else ""
        row = "".join(f"  {sign * v + 0.0:16.6f}" for v in shape)
        yield f"  {i + 1}  printed    {omega:10.3f}  {row}{flipped}"
        row = "".join(f"  {v + 0.0:16.9f}" for v in modes.shapes[:, i])
        yield f"     computed   {modes.omega[i]:10.5f}  {row}"


def _extremes(response: Response) -> Iterator[str]:
    extremes = response.extremes()
    ratios = after_over_on(response, Profile.full_mat())
    yield "  gear    static [lbf]   largest [lbf] at [s]    smallest [lbf] at [s]   after/on mat"
    for g, name in enumerate(response.modes.aircraft.gear_names):
        word = "amplified" if ratios[g] > 1 else "cancelled"
        yield (
            f"  {name:<6} {response.static_load[g]:12.1f} {extremes.max_load[g]:14.1f}"
            f" {extremes.time_of_max[g]:8.4f} {extremes.min_load[g]:16.1f}"
            f" {extremes.time_of_min[g]:8.4f} {ratios[g]:10.2f} {word}"
        )


def lines(responses: Mapping[Stiffness, Response]) -> Iterator[str]:
    """
    Text of the comparison, line by line.

    Parameters
    ----------
    responses : mapping of str to Response
        Runs by stiffness, "static" and "equivalent".

    Yields
    ------
    str
        A line.

    Examples
    --------
    >>> from runway_modal import report1980
    >>> runs = {key: report1980.full_mat(key) for key in ("static", "equivalent")}
    >>> print(next(report1980.lines(runs)))
    F-4E over the full AM-2 mat at 20 kt, 1 % damping in every mode
    """
    yield "F-4E over the full AM-2 mat at 20 kt, 1 % damping in every mode"
    yield "Mat: 77.5 ft by 1.5 in (published: UFC 3-270-07); 12 in ramps (inferred)."
    for printed in (TABLE_3, TABLE_4):
        response = responses[printed.stiffness]
        yield ""
        yield from _modes_beside_printed(printed, response.modes)
        yield ""
        yield from _extremes(response)


def main(arguments: list[str] | None = None) -> None:
    """
    Print the comparison and draw its figure.

    Parameters
    ----------
    arguments : list of str, optional
        Command line. Default: that of the process.

    Examples
    --------
    >>> from runway_modal import report1980
    >>> report1980.main(["--figure", ""])  # doctest: +ELLIPSIS
    F-4E over the full AM-2 mat at 20 kt, 1 % damping in every mode
    ...
    """
    parser = argparse.ArgumentParser(prog="python -m runway_modal.report1980", description=__doc__)
    parser.add_argument(
        "--figure", default="full_mat.png", help="where to draw (default %(default)s; '' for none)"
    )
    figure = parser.parse_args(arguments).figure
    responses = {table.stiffness: full_mat(table.stiffness) for table in (TABLE_3, TABLE_4)}
    print("\n".join(lines(responses)))
    if figure:
        from .plotting import loads_over_profile

        loads_over_profile(
            {
                "Table 3 (static slope)": responses["static"],
                "Table 4 (equivalent)": responses["equivalent"],
            },
            {"nose": "Nose gear", "left": "Main gear"},
            "F-4E, full AM-2 mat, 20 kt: gear loads over the profile",
        ).savefig(figure, dpi=110)
        print(f"\nFigure: {figure}")


if __name__ == "__main__":
    main()
