"""A statement of the report, with what was measured for it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, SupportsFloat

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np


class Finding:
    """
    What was measured, and whether the statement holds by it.

    `holds` is None where this package has nothing to test it with. `template` takes `values` by
    name: a number that is shown is the number that was judged.
    """

    __slots__ = ("holds", "text", "values")

    def __init__(
        self, holds: bool | np.bool_ | None, template: str, **values: SupportsFloat
    ) -> None:
        self.holds = None if holds is None else bool(holds)
        self.values = {name: float(value) for name, value in values.items()}
        # A zero has no sign.
        self.text = template.format(**{k: v + 0.0 for k, v in self.values.items()})

    @property
    def verdict(self) -> str:
        """The verdict in words."""
        return {True: "holds", False: "does not hold", None: "cannot be tested"}[self.holds]


def at_most(error: SupportsFloat) -> float:
    """Bound an error by 1e-12: how much less rounding leaves differs between machines."""
    return max(float(error), 1e-12)


@dataclass(frozen=True, slots=True)
class Statement:
    """What the report says, in our words, and how to measure it."""

    key: str
    section: str
    text: str
    check: Callable[[], Finding]
    #: Figures of the report in which it should be seen.
    figures: tuple[int, ...] = ()
    #: Inferred inputs the verdict rests on; empty if none.
    rests_on: str = ""


class Statements(list[Statement]):
    """Statements of a part of the report, in its order."""

    def add(
        self, section: str, text: str, *, figures: tuple[int, ...] = (), rests_on: str = ""
    ) -> Callable[[Callable[[], Finding]], Callable[[], Finding]]:
        """Register the function that measures a statement; its name becomes the key."""

        def register(check: Callable[[], Finding]) -> Callable[[], Finding]:
            self.append(
                Statement(check.__name__.strip("_"), section, text, check, figures, rests_on)
            )
            return check

        return register
