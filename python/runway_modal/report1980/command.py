"""The full-mat comparison as a command."""

from __future__ import annotations

import argparse

from .comparison import lines
from .runs import full_mat
from .tables import TABLE_3, TABLE_4


def main(arguments: list[str] | None = None) -> None:
    """
    Print the comparison and draw its figure.

    Parameters
    ----------
    arguments : list of str, optional
        Command line. Default: that of the process.

    Raises
    ------
    ImportError
        If a figure is wanted and matplotlib is not installed.

    Examples
    --------
    >>> from runway_modal import report1980
    >>> report1980.main(["--figure", ""])  # doctest: +ELLIPSIS
    F-4E over the full AM-2 mat at 20 kt, 1 % damping in every mode
    ...
    """
    parser = argparse.ArgumentParser(
        prog="python -m runway_modal.report1980",
        description="The 1980 report's full-mat comparison.",
    )
    parser.add_argument(
        "--figure", default="full_mat.png", help="where to draw (default %(default)s; '' for none)"
    )
    options = parser.parse_args(arguments)
    responses = {table.stiffness: full_mat(table.stiffness) for table in (TABLE_3, TABLE_4)}
    print("\n".join(lines(responses)))
    if options.figure:
        from runway_modal.plotting import loads_over_profile
        from runway_modal.units import Units

        loads_over_profile(
            {
                "Table 3 (static slope)": responses["static"],
                "Table 4 (equivalent)": responses["equivalent"],
            },
            {"nose": "Nose gear", "left": "Main gear"},
            "F-4E, full AM-2 mat, 20 kt: gear loads over the profile",
            units=Units("in", "lbf"),
        ).savefig(options.figure, dpi=110)
        print(f"\nFigure: {options.figure}")
