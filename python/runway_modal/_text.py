"""Results as text, as the interactive prompt shows them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


def table(rows: Sequence[Sequence[str | float]]) -> str:
    """Align rows: the first column left, the others right, numbers to six digits."""
    texts = [[cell if isinstance(cell, str) else f"{cell:.6g}" for cell in row] for row in rows]
    first = max(len(row[0]) for row in texts)
    width = 2 + max(len(cell) for row in texts for cell in row[1:])
    return "\n".join(
        row[0].ljust(first) + "".join(cell.rjust(width) for cell in row[1:]) for row in texts
    )
