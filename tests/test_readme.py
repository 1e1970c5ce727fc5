"""The README shows what the commands print."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from runway_modal import report1980

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    found = re.search(rf"```{language}\n(.*?)```", README, re.DOTALL)
    assert found, f"no {language} block in the README"
    return found.group(1)


def test_shows_the_demo_as_printed(capsys: pytest.CaptureFixture[str]) -> None:
    report1980.main(["--figure", ""])
    assert block("text") == capsys.readouterr().out


def test_python_example_runs(capsys: pytest.CaptureFixture[str]) -> None:
    exec(compile(block("python"), "README.md", "exec"), {})
    printed = capsys.readouterr().out
    assert "43686" in printed
    assert "unloads: False" in printed


def test_demo_draws_its_figure(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    figure = tmp_path / "full_mat.png"
    report1980.main(["--figure", str(figure)])
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert str(figure) in capsys.readouterr().out
