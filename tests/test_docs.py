"""The pages in docs/ print what they show."""

import doctest
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[1] / "docs"


@pytest.mark.parametrize("name", ["guide", "method", "equivalent_stiffness"])
def test_pages_run_as_written(name: str) -> None:
    page = DOCS / f"{name}.md"
    failed, examples = doctest.testfile(str(page), module_relative=False)
    assert failed == 0
    assert examples == page.read_text(encoding="utf-8").count(">>> ")
