"""The pages in docs/ print what they show."""

import doctest
from pathlib import Path

DOCS = Path(__file__).parents[1] / "docs"


def test_the_way_to_revised_modes_runs_as_written() -> None:
    page = DOCS / "equivalent_stiffness.md"
    failed, examples = doctest.testfile(str(page), module_relative=False)
    assert failed == 0
    assert examples == page.read_text(encoding="utf-8").count(">>> ")
