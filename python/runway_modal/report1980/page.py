"""All of the report as one page that needs nothing else: no network, no scripts."""

from __future__ import annotations

import base64
import os
import re
from html import escape
from importlib.metadata import version
from importlib.util import find_spec
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from runway_modal._core import InputError
from runway_modal.aircraft import Gear, f4e

from . import runs, velocity_term
from .figures import FIGURES
from .inputs import INPUTS
from .statements import STATEMENTS
from .tables import DAMPING_RATIO, TABLE_1, TABLE_2, TABLE_3, TABLE_4, TAXI_STIFFNESS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from .figures import Figure
    from .statements import Finding, Statement
    from .tables import PrintedModes

    Judged = Sequence[tuple[Statement, Finding]]

#: What the page needs, by the extra that brings it.
_NEEDS = {"matplotlib": "plot", "scipy": "taxi"}

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
    missing = [name for name in _NEEDS if find_spec(name) is None]
    if missing:
        extras = ",".join(_NEEDS[name] for name in missing)
        raise ImportError(
            f"the page needs {' and '.join(missing)}: pip install 'runway_modal[{extras}]'"
        )
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
    yield from _tables()
    yield from _velocity()
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
        f"that had to be guessed is marked {_tag('inferred', 'inferred')}, and so is every verdict "
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
                f'<li><a href="#{statement.key}">{_typeset(statement.text)}</a> '
                f'<span class="soft">{statement.section}</span>'
                f"{' ' + _tag('inferred', 'inferred') if statement.rests_on else ''}</li>"
            )
    yield "</ul>\n</header>"


def _statements(judged: Judged) -> Iterator[str]:
    yield '<section id="statements">\n<h2>What the report says, and whether it holds</h2>'
    yield (
        "<p>The report in our words, what was found, and the verdict with the bar it was held "
        "against. TAXI itself is not public: a nonlinear reference stands for it, and "
        f"{_tag('fails', 'does not hold')} then means that the reference does not show it.</p>"
    )
    yield from _table(("The report", "Found", "Verdict", "Figures"), _judged(judged), "statement")
    yield "</section>"


def _judged(judged: Judged) -> Iterator[str]:
    for section, group in groupby(judged, key=lambda each: each[0].section):
        yield f'<tr class="section"><th colspan="4" scope="rowgroup">Section {section}</th></tr>'
        for statement, finding in group:
            rests = (
                f'<p class="note">{_tag("inferred", "inferred")} {escape(statement.rests_on)}</p>'
                if statement.rests_on
                else ""
            )
            figures = " ".join(f'<a href="#figure-{n}">{n}</a>' for n in statement.figures)
            yield (
                f'<tr id="{statement.key}"><td>{_typeset(statement.text)}</td>'
                f"<td>{_typeset(finding.text)}{rests}</td>"
                f"<td>{_verdict(finding)}</td><td>{figures}</td></tr>"
            )


def _inputs() -> Iterator[str]:
    yield '<section id="inputs">\n<h2>What went in</h2>'
    yield (
        f"<p>{_tag('printed', 'printed')} in the report; {_tag('published', 'published')} in a "
        f"public source, named; {_tag('inferred', 'inferred')} deduced here, not data.</p>"
    )
    rows = (
        _row(
            _typeset(each.what),
            _typeset(each.value),
            _tag(each.origin, each.origin),
            _typeset(each.source),
        )
        for each in INPUTS
    )
    yield from _table(("Input", "Value", "Origin", "Source"), rows)
    yield "</section>"


def _tables() -> Iterator[str]:
    yield '<section id="tables">\n<h2>Tables 1 to 4</h2>'
    yield "<h3>Table 1. Aircraft model data</h3>"
    printed = _tag("printed", "printed")
    rows = [
        _row(_typeset(symbol), _number(f"{value:,.10g}"), unit, printed)
        for symbol, value, unit in TABLE_1
    ]
    aircraft = f4e()
    nose, main, _ = aircraft.static_load
    rows += [
        _row("Weight", _number(f"{aircraft.mass * aircraft.gravity:,.1f}"), "lbf", "computed"),
        _row("Static load, nose gear", _number(f"{nose:,.1f}"), "lbf", "computed"),
        _row("Static load, each main gear", _number(f"{main:,.1f}"), "lbf", "computed"),
    ]
    yield from _table(("", ">Value", "Unit", "Origin"), rows)

    yield "<h3>Table 2. Equivalent spring stiffness [lbf/in]</h3>"
    rows = [
        _row(
            f"{gear.name.capitalize()} gear",
            _number(f"{gear.strut:,.0f}"),
            _number(f"{gear.tire:,.0f}"),
            _number(f"{gear.series:,.0f}"),
            _number(
                f"{Gear.from_series('g', 0, 0, strut=gear.strut, tire=gear.tire).stiffness:,.2f}"
            ),
        )
        for gear in TABLE_2
    ]
    yield from _table(
        ("", ">Strut, printed", ">Tire, printed", ">Series, printed", ">Series, computed"), rows
    )

    yield from _modes(TABLE_3, "Table 3. Mode shapes and frequencies")
    yield "<h3>Stiffness over TAXI's full-mat run [lbf/in] (Section IV.6)</h3>"
    rows = []
    for printed_range, column in zip(TAXI_STIFFNESS, (1, 0), strict=True):
        low, high, equivalent = runs.taxi_stiffness(column)
        rows.append(
            _row(
                f"{printed_range.name.capitalize()} gear",
                *(
                    _number(f"{value:,.0f}")
                    for pair in (
                        (printed_range.low, low),
                        (printed_range.high, high),
                        (printed_range.equivalent, equivalent),
                    )
                    for value in pair
                ),
            )
        )
    yield from _table(("", ">Smallest", ">here", ">Largest", ">here", ">Eq. 22", ">here"), rows)
    yield (
        '<p class="note">"Here" is the nonlinear reference, calibrated on the main gear\'s row: '
        "not a prediction.</p>"
    )
    yield from _modes(TABLE_4, "Table 4. Revised mode shapes and frequencies")
    yield "</section>"


def _modes(printed: PrintedModes, title: str) -> Iterator[str]:
    yield f"<h3>{title}</h3>"
    modes = f4e(printed.stiffness).modes(DAMPING_RATIO)
    rows = []
    for i, (omega, shape) in enumerate(zip(printed.omega, printed.shapes, strict=True)):
        # A mode's sign is free: ours is shown with the report's.
        sign = 1.0 if np.dot(shape, modes.shapes[:, i]) > 0 else -1.0
        computed = (modes.omega[i], *(sign * modes.shapes[:, i]))
        formats = ("{:.5f}", *["{:.8f}"] * 3)
        for label, values in (("printed", (omega, *shape)), ("computed", computed)):
            shown = [f"{omega:.3f}", *(f"{v:.6f}" for v in shape)] if label == "printed" else []
            shown = shown or [form.format(v + 0.0) for form, v in zip(formats, values, strict=True)]
            rows.append(
                _row(f"Mode {i + 1}" if label == "printed" else "", label, *map(_number, shown))
            )
    heads = ("", "", ">ω [rad/s]", ">x_g (bounce)", ">θ (pitch)", ">φ (roll)")
    yield from _table(heads, rows)


def _velocity() -> Iterator[str]:
    yield '<section id="velocity">\n<h2>Leaving out the velocity terms</h2>'
    yield (
        "<p>Section III.4 drops 2ζω u̇<sub>M</sub> from the bounce model's excitation (Eq. 15) and "
        "2ζωM (u̇<sub>M</sub> − u̇) from its load (Eq. 16), the latter as an estimate on the safe "
        "side. The change of the largest load shows what that does: below zero is unsafe. At a "
        "sharp edge the damper's load is infinite for no time; that blow moves the mass but is not "
        "counted.</p>"
    )
    rows = []
    for name, (profile, speed) in velocity_term.CASES.items():
        for ratio in velocity_term.RATIOS:
            peaks = velocity_term.peaks(profile, speed, ratio)
            changes = (peaks.without_input, peaks.without_load, peaks.without_both)
            rows.append(
                _row(
                    name if ratio == velocity_term.RATIOS[0] else "",
                    _number(f"{100 * ratio:g} %"),
                    _number(f"{peaks.full / 1e3:.2f}"),
                    *(_number(f"{100 * (change / peaks.full - 1):+.3f} %") for change in changes),
                )
            )
    heads = (
        "Profile",
        ">ζ",
        ">Both kept [kip]",
        ">Excitation dropped",
        ">Load dropped",
        ">Both dropped (report)",
    )
    yield from _table(heads, rows)
    yield f'<p class="note">1.91 Hz; {_tag("inferred", "inferred")} mat edges, half mat length, '
    yield "spall depth and spacing.</p>\n</section>"


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
        f'<p class="note">{_typeset(figure.note)}</p></figcaption>'
    )
    yield f'<img alt="{escape(picture.alt)}" src="data:image/svg+xml;base64,{data}">'
    about = [each for each in judged if figure.number in each[0].figures]
    if about:
        items = "".join(
            f'<li>{_verdict(finding)} <a href="#{statement.key}">{_typeset(statement.text)}</a>'
            "</li>"
            for statement, finding in about
        )
        yield f"<ul>{items}</ul>"
    yield "</figure>"


def _tag(kind: str, text: str) -> str:
    return f'<span class="tag {kind}">{text}</span>'


def _verdict(finding: Finding) -> str:
    return _tag(_CLASS[finding.holds], finding.verdict)


def _typeset(text: str) -> str:
    """Escape; set subscripts (D_N), powers of ten (3e-16), minus signs; keep units by numbers."""
    text = re.sub(r"_(\w+)", r"<sub>\1</sub>", escape(text))
    text = re.sub(r"(\d)e([+-])0?(\d+)", r"\1 × 10<sup>\2\3</sup>", text)
    text = re.sub(r"(?<=\d) (?=%|kip|Hz|in\b|s\b|ms\b|lbf)", "\u00a0", text)
    return re.sub(r"(?<![\w-])-(?=\d)|(?<=<sup>)-", "−", text).replace("<sup>+", "<sup>")


def _number(text: str) -> str:
    return f'<td class="n">{text.replace("-", "−")}</td>'


def _row(*cells: str) -> str:
    marked = (cell if cell.startswith("<td") else f"<td>{cell}</td>" for cell in cells)
    return f"<tr>{''.join(marked)}</tr>"


def _table(heads: Iterable[str], rows: Iterable[str], kind: str = "") -> Iterator[str]:
    """Heads that begin with > stand over numbers."""
    cells = "".join(
        f'<th scope="col" class="n">{_typeset(head[1:])}</th>'
        if head.startswith(">")
        else f'<th scope="col">{_typeset(head)}</th>'
        for head in heads
    )
    yield f'<div class="wide"><table class="{kind}"><thead><tr>{cells}</tr></thead><tbody>'
    yield from rows
    yield "</tbody></table></div>"
