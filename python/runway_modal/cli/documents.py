"""Results of a case as JSON, for other programs: what the documents of all commands share."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from runway_modal._core import __version__
from runway_modal._setups import describe_body

from .output import opened

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import NDArray

    from runway_modal.case import Case

#: What a body's motion depends on, besides its gears.
_BODY = ("mass", "pitch_inertia", "roll_inertia", "gravity")


def json_writer(
    case: Case, results: Callable[[], dict[str, Any]]
) -> dict[str, Callable[[str], None]]:
    """Make the writer of a document: the case, then the results of a command."""

    def write(to: str) -> None:
        document = _of_case(case) | results()
        with opened(to) as file:
            json.dump(document, file, indent=1, allow_nan=False)
            file.write("\n")

    return {"json": write}


def _of_case(case: Case) -> dict[str, Any]:
    return {
        "title": case.title,
        "units": {"length": case.units.length, "force": case.units.force, "time": "s"},
        "runway_modal": __version__,
        "nonlinear": case.reference is not None,
        "damping_input": case.damping_input,
        "inferred": case.notes,
        "aircraft": {
            **{key: getattr(case.modes.aircraft, key) for key in _BODY},
            **describe_body(case.modes.aircraft),
        },
        "modes": {
            "omega": case.modes.omega.tolist(),
            "damping_ratio": case.modes.damping_ratio.tolist(),
            "shapes": case.modes.shapes.tolist(),
            "static_correction": case.modes.static_correction,
        },
    }


def by_name(names: Iterable[str], values: NDArray[Any]) -> dict[str, Any]:
    """Name the values of gears or stations, which are counted by the first axis."""
    return dict(zip(names, values.tolist(), strict=True))


def bound(value: float) -> float | None:
    """Give a bound, or null where there is none: JSON has no infinity."""
    return value if math.isfinite(value) else None
