"""All of the report as one page that needs nothing else: no network, no scripts."""

from __future__ import annotations

import base64
import os
from html import escape
from importlib.metadata import version
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from runway_modal._core import InputError
from runway_modal._extras import need

from .figures import FIGURES
from .inputs import INPUTS
from .markup import row, table, tag, typeset
from .page_tables import tables, velocity_terms
from .statements import STATEMENTS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from .figures import Figure
    from .statements import Finding, Statement

    Judged = Sequence[tuple[Statement, Finding]]

_CLASS = {True: "holds", False: "fails", None: "open"}


def write_page(directory: str | os.PathLike[str]) -> Path:
    """
    Write the report's tables and figures, recomputed, as one HTML page.

    Tables 1 to 4 beside what is printed, Figures 3 to 19 drawn anew, every statement of the text
    that can be checked with the numbers found and whether it holds, every input with its origin.
    The page holds its pictures; the same installation writes the same bytes every time.

    Parameters
    ----------
    directory : str or path-like
        Where to write ``report1980.html``; made if it is not there.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    InputError
        If `directory` is not a path.
    ImportError
        If matplotlib or scipy is not installed.

    Examples
    --------
    >>> from runway_modal import report1980
    >>> report1980.write_page("out").name  # doctest: +SKIP
    'report1980.html'
    """
    if not isinstance(directory, str | os.PathLike):
        raise InputError(f"directory = {directory!r} is not a path")
    need("report pages", "plot,taxi", "matplotlib", "scipy")
    folder = Path(directory)
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "report1980.html"
    # Bytes: the same on every system, whatever its line ends.
    file.write_bytes("\n".join(_page()).encode())
    return file


def _page() -> Iterator[str]:
    judged = [(statement, statement.check()) for statement in STATEMENTS]
    style = Path(__file__).with_name("page.css").read_text(encoding="utf-8")
    yield '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">'
    yield '<meta name="viewport" content="width=device-width, initial-scale=1">'
    yield f"<title>The 1980 report, recomputed</title>\n<style>\n{style}</style>\n</head>\n<body>"
    yield from _head(judged)
    yield "<main>"
    yield from _statements(judged)
    yield from _inputs()
    yield from tables()
    yield from velocity_terms()
    yield from _figures(judged)
    yield "</main>"
    yield (
        f'<footer class="soft">Computed by runway_modal {escape(version("runway_modal"))}. Loads '
        "are compression, static load included; 1 kip = 1000 lbf. Linear gears may pull on the "
        "runway: a load below zero means that the gear has left it and the linear model no longer "
        "holds.</footer>\n</body>\n</html>\n"
    )


def _head(judged: Judged) -> Iterator[str]:
    count = {key: sum(finding.holds is key for _, finding in judged) for key in _CLASS}
    yield "<header>\n<h1>The 1980 report, recomputed</h1>"
    yield (
        '<p class="soft">R. R. Gajewski, <cite>Modal analysis for aircraft response to runway '
        "surface roughness</cite>, USAF Academy, 1980: F-4E over repair mats and spalls.</p>"
    )
    yield (
        f"<p>Of {len(judged)} statements of the report that can be put to a number, "
        f"<strong>{count[True]} hold</strong>, <strong>{count[False]} do not</strong> and "
        f"{count[None]} cannot be tested. Every verdict is computed when this page is "
        "written. The report's figures are lost: those below are drawn from its text. A dimension "
        f"that had to be guessed is marked {tag('inferred', 'inferred')}, and so is every verdict "
        "that rests on it.</p>"
    )
    links = {
        "statements": "Statements",
        "inputs": "Inputs",
        "tables": "Tables 1–4",
        "velocity": "Velocity terms",
        "figures": "Figures 3–19",
    }
    items = "".join(f'<a href="#{key}">{text}</a>' for key, text in links.items())
    yield f'<nav aria-label="Contents">{items}</nav>'
    yield "<p>What does not hold:</p>\n<ul>"
    for statement, finding in judged:
        if finding.holds is False:
            yield (
                f'<li><a href="#{statement.key}">{typeset(statement.text)}</a> '
                f'<span class="soft">{statement.section}</span>'
                f"{' ' + tag('inferred', 'inferred') if statement.rests_on else ''}</li>"
            )
    yield "</ul>\n</header>"


def _statements(judged: Judged) -> Iterator[str]:
    yield '<section id="statements">\n<h2>What the report says, and whether it holds</h2>'
    yield (
        "<p>The report in our words, what was found, and the verdict with the bar it was held "
        "against. TAXI itself is not public: a nonlinear reference stands for it, and "
        f"{tag('fails', 'does not hold')} then means that the reference does not show it.</p>"
    )
    yield from table(("The report", "Found", "Verdict", "Figures"), _judged(judged), "statement")
    yield "</section>"


def _judged(judged: Judged) -> Iterator[str]:
    for section, group in groupby(judged, key=lambda each: each[0].section):
        yield f'<tr class="section"><th colspan="4" scope="rowgroup">Section {section}</th></tr>'
        for statement, finding in group:
            rests = (
                f'<p class="note">{tag("inferred", "inferred")} {escape(statement.rests_on)}</p>'
                if statement.rests_on
                else ""
            )
            figures = " ".join(f'<a href="#figure-{n}">{n}</a>' for n in statement.figures)
            yield (
                f'<tr id="{statement.key}"><td>{typeset(statement.text)}</td>'
                f"<td>{typeset(finding.text)}{rests}</td>"
                f"<td>{_verdict(finding)}</td><td>{figures}</td></tr>"
            )


def _inputs() -> Iterator[str]:
    yield '<section id="inputs">\n<h2>What went in</h2>'
    yield (
        f"<p>{tag('printed', 'printed')} in the report; {tag('published', 'published')} in a "
        f"public source, named; {tag('inferred', 'inferred')} deduced here, not data.</p>"
    )
    rows = (
        row(
            typeset(each.what),
            typeset(each.value),
            tag(each.origin, each.origin),
            typeset(each.source),
        )
        for each in INPUTS
    )
    yield from table(("Input", "Value", "Origin", "Source"), rows)
    yield "</section>"


def _figures(judged: Judged) -> Iterator[str]:
    yield '<section id="figures">\n<h2>Figures 3 to 19</h2>'
    yield (
        '<p class="soft">Figure 1 (a sketch of axes) and Figure 2 (an example of a '
        "piecewise linear profile) hold no result.</p>"
    )
    for figure in FIGURES:
        yield from _figure(figure, judged)
    yield "</section>"


def _figure(figure: Figure, judged: Judged) -> Iterator[str]:
    picture = figure.draw()
    data = base64.b64encode(picture.svg).decode()
    yield f'<figure id="figure-{figure.number}">'
    yield (
        f"<figcaption><b>Figure {figure.number}. {escape(figure.caption)}</b>"
        f'<p class="note">{typeset(figure.note)}</p></figcaption>'
    )
    yield f'<img alt="{escape(picture.alt)}" src="data:image/svg+xml;base64,{data}">'
    about = [each for each in judged if figure.number in each[0].figures]
    if about:
        items = "".join(
            f'<li>{_verdict(finding)} <a href="#{statement.key}">{typeset(statement.text)}</a></li>'
            for statement, finding in about
        )
        yield f"<ul>{items}</ul>"
    yield "</figure>"


def _verdict(finding: Finding) -> str:
    return tag(_CLASS[finding.holds], finding.verdict)
