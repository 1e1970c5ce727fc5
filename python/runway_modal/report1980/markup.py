"""The little HTML that the page is made of."""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


def tag(kind: str, text: str) -> str:
    """Set a word in a frame."""
    return f'<span class="tag {kind}">{text}</span>'


def typeset(text: str) -> str:
    """Escape; set subscripts (D_N), powers of ten (3e-16), minus signs; keep units by numbers."""
    text = re.sub(r"_(\w+)", r"<sub>\1</sub>", escape(text))
    text = re.sub(r"(\d)e([+-])0?(\d+)", r"\1 × 10<sup>\2\3</sup>", text)
    text = re.sub(r"(?<=\d) (?=%|kip|Hz|in\b|s\b|ms\b|lbf)", "\u00a0", text)
    return re.sub(r"(?<![\w-])-(?=\d)|(?<=<sup>)-", "−", text).replace("<sup>+", "<sup>")


def number(text: str) -> str:
    """Make a cell of a number."""
    return f'<td class="n">{text.replace("-", "−")}</td>'


def row(*cells: str) -> str:
    """Make a row of cells; `number` makes those of numbers."""
    marked = (cell if cell.startswith("<td") else f"<td>{cell}</td>" for cell in cells)
    return f"<tr>{''.join(marked)}</tr>"


def table(heads: Iterable[str], rows: Iterable[str], kind: str = "") -> Iterator[str]:
    """Make a table of rows; heads that begin with > stand over numbers."""
    cells = "".join(
        f'<th scope="col" class="n">{typeset(head[1:])}</th>'
        if head.startswith(">")
        else f'<th scope="col">{typeset(head)}</th>'
        for head in heads
    )
    yield f'<div class="wide"><table class="{kind}"><thead><tr>{cells}</tr></thead><tbody>'
    yield from rows
    yield "</tbody></table></div>"
