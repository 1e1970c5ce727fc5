"""The command as its users run it."""

import csv
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import runway_modal as rm
from runway_modal.cli import main


@pytest.fixture
def case(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    assert main(["example"]) == 0
    path = tmp_path / "case.toml"
    path.write_text(capsys.readouterr().out, encoding="utf-8")
    return path


def test_example_prints_the_demo_numbers(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(case)]) == 0
    printed = capsys.readouterr().out
    # The README's, from report1980.
    for number in ("12.0163", "8921.8", "12939.7", "43685.9", "3.2662", "3516.1"):
        assert number in printed
    assert "WARNING" not in printed
    assert "Inferred, not published: track[0]: ramps of 12 in" in printed


def test_unloading_is_said(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = case.read_text(encoding="utf-8")
    case.write_text(text.replace('"full_mat"', '"mat"\nlength = 930\nheight = 4', 1), "utf-8")
    assert main(["run", str(case)]) == 0
    assert "WARNING: nose, left, right unloads" in capsys.readouterr().out


def test_files_hold_the_response(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = case.parent
    text = case.read_text(encoding="utf-8").replace('["20 kt"]', '["10 kt", "20 kt"]')
    case.write_text(text + '\n[output]\nfigure = "loads.png"\n', encoding="utf-8")
    paths = {kind: str(out / f"a.{kind}") for kind in ("csv", "json", "parquet")}
    assert main(["run", str(case), *(a for k, p in paths.items() for a in (f"--{k}", p))]) == 0
    response = rm.simulate(rm.f4e().modes(0.01), rm.Profile.full_mat(), rm.knots(20))
    frame = pd.read_parquet(paths["parquet"])
    assert frame.attrs["units"]["load_left"] == "lbf"
    last = frame[np.isclose(frame["speed"], rm.knots(20))]
    np.testing.assert_allclose(last["load_left"], response.load[:, 1], rtol=1e-12)
    table = pd.read_csv(paths["csv"])
    np.testing.assert_allclose(table["load_left [lbf]"], frame["load_left"], rtol=1e-15)
    runs = json.loads(Path(paths["json"]).read_text())["runs"]
    assert [run["stated_speed"] for run in runs] == ["10 kt", "20 kt"]
    assert runs[1]["max_load"]["left"] == pytest.approx(43685.9, abs=0.05)
    assert (out / "loads.png").read_bytes().startswith(b"\x89PNG")


def test_standard_output_is_the_table_alone(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(case), "--csv", "-"]) == 0
    rows = list(csv.reader(capsys.readouterr().out.splitlines()))
    assert rows[0][:3] == ["speed [in/s]", "time [s]", "distance [in]"]
    assert {len(row) for row in rows} == {14}


def test_bad_input_exits_with_2(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(case.with_name("none.toml"))]) == 2
    case.write_text("speed = 3\n", encoding="utf-8")
    assert main(["run", str(case)]) == 2
    error = capsys.readouterr().err
    assert "none.toml" in error
    assert "case.toml:1: unknown key 'speed'" in error
