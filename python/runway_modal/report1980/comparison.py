"""The full mat with Table 3 and with Table 4, as text beside what the report prints."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .runs import FULL_MAT, after_over_on
from .tables import TABLE_3, TABLE_4

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from runway_modal.modes import Modes
    from runway_modal.response import Response

    from .tables import PrintedModes, Stiffness


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
    ratios = after_over_on(response, FULL_MAT)
    yield "  gear    static [lbf]   largest [lbf] at [s]    smallest [lbf] at [s]   after/on mat"
    for g, name in enumerate(response.gear_names):
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
