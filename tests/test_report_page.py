"""The page: everything in it, nothing outside it, the same bytes every time."""

from __future__ import annotations

import base64
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

import runway_modal as rm
from runway_modal import report1980
from runway_modal.report1980 import figures, markup
from runway_modal.report1980.inputs import INPUTS
from runway_modal.report1980.statements import STATEMENTS

VOID = {"meta", "img", "br", "hr", "link"}


class Document(HTMLParser):
    """Elements, ids, links and pictures; fails on tags that do not nest."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.ids: list[str] = []
        self.links: list[str] = []
        self.pictures: list[dict[str, str | None]] = []
        self.text = ""
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        values = dict(attributes)
        self.tags.append(tag)
        if tag not in VOID:
            self.open.append(tag)
        if values.get("id"):
            self.ids.append(str(values["id"]))
        if "href" in values:
            self.links.append(str(values["href"]))
        if tag == "img":
            self.pictures.append(values)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return report1980.write_page(tmp_path_factory.mktemp("page") / "made" / "here")


@pytest.fixture(scope="module")
def document(file: Path) -> Document:
    return Document(file.read_text(encoding="utf-8"))


def test_needs_nothing_else(file: Path, document: Document) -> None:
    text = file.read_text(encoding="utf-8")
    assert not {"script", "link", "iframe", "object"} & set(document.tags)
    assert "http" not in re.sub(r"base64,[\w+/=]+", "", text)
    assert "url(" not in text
    assert "@import" not in text
    assert all(link.startswith("#") for link in document.links)
    assert all(str(each["src"]).startswith("data:image/svg+xml") for each in document.pictures)


def test_links_lead_somewhere(document: Document) -> None:
    assert len(set(document.ids)) == len(document.ids)
    assert {link[1:] for link in document.links} <= set(document.ids)


def test_holds_every_figure_with_words_for_it(document: Document) -> None:
    assert [each.number for each in figures.FIGURES] == list(range(3, 20))
    assert [i for i in document.ids if i.startswith("figure-")] == [
        f"figure-{n}" for n in range(3, 20)
    ]
    assert len(document.pictures) == 17
    for picture in document.pictures:
        assert len(str(picture["alt"])) > 40
        svg = base64.b64decode(str(picture["src"]).partition("base64,")[2])
        root = ET.fromstring(svg)
        assert root.tag.endswith("svg")
        assert b"<dc:date>" not in svg


def test_shows_every_statement_and_its_verdict(document: Document) -> None:
    assert {statement.key for statement in STATEMENTS} <= set(document.ids)
    findings = [statement.check() for statement in STATEMENTS]
    count = {key: sum(finding.holds is key for finding in findings) for key in (True, False)}
    # Found: 44 hold, 11 do not, one cannot be tested.
    assert count == {True: 44, False: 11}
    assert f"Of {len(STATEMENTS)} statements" in document.text
    assert "44 hold" in document.text
    assert "11 do not" in document.text
    # In the table and under each figure that should show it; and twice in the text.
    shown = sum(
        1 + len(statement.figures)
        for statement, finding in zip(STATEMENTS, findings, strict=True)
        if finding.holds is False
    )
    assert document.text.count("does not hold") == shown + 2


def test_what_does_not_hold_is_in_the_documentation() -> None:
    text = (Path(__file__).parents[1] / "docs" / "report1980.md").read_text(encoding="utf-8")
    words = " ".join(text.split())
    assert f"Of {len(STATEMENTS)} statements" in words
    assert "44 hold, 11 do not and 1 cannot be tested" in words
    listed = [line for line in text.splitlines() if line.startswith("- **")]
    failing = [each for each in STATEMENTS if each.check().holds is False]
    assert len(listed) == len(failing)
    for statement in failing:
        said = f"- **{statement.section}** {statement.text} — {statement.check().text}"
        assert said in words


def test_names_the_origin_of_every_input(document: Document) -> None:
    assert {each.origin for each in INPUTS} == {"printed", "published", "inferred"}
    for each in INPUTS:
        assert each.what in document.text


def test_shows_tables_as_printed_and_as_computed(document: Document) -> None:
    for number in ("12.016", "12.01632", "−0.078743", "−0.07874273", "11.328", "11.32783"):
        assert number in document.text
    for number in ("145.5", "1,920,000", "9,102", "9,101.71", "8,081", "8,079", "2,662", "2,479"):
        assert number in document.text


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("-37.83 in to +2.0 %", "−37.83\u00a0in to +2.0\u00a0%"),
        ("within 3e-16", "within 3 × 10<sup>−16</sup>"),
        ("D_L < I_P of F-4E, twelve-in", "D<sub>L</sub> &lt; I<sub>P</sub> of F-4E, twelve-in"),
    ],
)
def test_typesetting(text: str, shown: str) -> None:
    assert markup.typeset(text) == shown


def test_alternative_text_tells_the_loads() -> None:
    tenth = next(each for each in figures.FIGURES if each.number == 10).draw()
    # test_report.py: the static load; the README: the extremes.
    assert "main gear between 3.5 and 43.7 kip, static 23.6" in tenth.alt


def test_the_bounce_models_load_is_not_called_a_gears() -> None:
    # Eq. 16 has the whole weight: 56.2 kip on a panel named for a main gear would mislead.
    for number in (5, 9, 11):
        alt = figures.FIGURES[number - 3].draw().alt
        assert "whole aircraft between" in alt
        assert "static 56.2" in alt
        assert "main gear" not in alt


def test_same_bytes_every_time(file: Path, tmp_path: Path) -> None:
    # In a process of its own: nothing is remembered, and hashes are salted anew.
    main = "import sys; from runway_modal.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", main, "report", "--out", str(tmp_path)]
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    again = tmp_path / "report1980.html"
    assert printed == f"{again}\n"
    assert again.read_bytes() == file.read_bytes()


def test_bad_directory(tmp_path: Path) -> None:
    with pytest.raises(rm.InputError, match=r"directory = 3 is not a path"):
        report1980.write_page(3)  # type: ignore[arg-type]
    taken = tmp_path / "file"
    taken.write_text("")
    with pytest.raises(FileExistsError, match="file"):
        report1980.write_page(taken)


def test_missing_extras_are_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "scipy", None)
    with pytest.raises(ImportError, match=r"scipy: pip install 'runway_modal\[plot,taxi\]'"):
        report1980.write_page(tmp_path)
    assert not list(tmp_path.iterdir())


def test_importing_needs_numpy_alone() -> None:
    code = (
        "import sys, runway_modal.report1980\n"
        "print([n for n in ('scipy', 'matplotlib') if n in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert run.stdout == "[]\n"
