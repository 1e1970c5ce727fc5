"""Long runs on disk: stopped anyhow and anywhere, they come to the same bits."""

import subprocess
import sys
import time

import numpy as np
import pytest

import runway_modal as rm
from runway_modal import stored

RUNWAY = {
    "length": 2400.0,
    "spacing": 12.0,
    "speed": rm.knots(60),
    "seed": 1980,
    "tracks": "isotropic",
}
SETUP = """
import runway_modal as rm
from runway_modal import stored
modes, surface = rm.f4e().modes(0.01), rm.Roughness.iso8608("B", unit="in")
"""


@pytest.fixture(scope="module")
def modes() -> rm.Modes:
    return rm.f4e().modes(0.01)


@pytest.fixture(scope="module")
def surface() -> rm.Roughness:
    return rm.Roughness.iso8608("B", unit="in")


def assert_same_bits(one: rm.Ensemble, other: rm.Ensemble) -> None:
    for key in ("run", "speed", "static_load", "max_load", "min_load", "rms_load"):
        np.testing.assert_array_equal(getattr(one, key), getattr(other, key), err_msg=key)
    for key in ("max_acceleration", "rms_acceleration"):
        np.testing.assert_array_equal(getattr(one, key)["cg"], getattr(other, key)["cg"])


def test_killed_run_goes_on_to_the_same_bits(tmp_path, modes, surface):
    runway = RUNWAY | {"runs": 6000}
    code = SETUP + f"stored.monte_carlo({str(tmp_path)!r}, modes, surface, chunk=100, **{runway})"
    process = subprocess.Popen([sys.executable, "-c", code])
    while len(list(tmp_path.glob("runs-*.parquet"))) < 3:
        assert process.poll() is None
        time.sleep(0.001)
    process.kill()
    process.wait()
    before = stored.read(tmp_path)
    assert 300 <= len(before) < 6000

    steps = []
    stored.monte_carlo(
        tmp_path,
        modes,
        surface,
        chunk=100,
        progress=lambda done, runs: steps.append((done, runs)),
        **runway,
    )
    assert_same_bits(stored.read(tmp_path), rm.monte_carlo(modes, surface, **runway))
    assert steps == [(100 * i, 6000) for i in range(61)]


def test_one_speed_a_run_is_shared_out(tmp_path, modes, surface):
    runway = RUNWAY | {"runs": 70, "speed": rm.knots(1) * np.linspace(20, 90, 70), "first_run": 5}
    stored.monte_carlo(tmp_path, modes, surface, chunk=32, **runway)
    found = stored.read(tmp_path)
    assert_same_bits(found, rm.monte_carlo(modes, surface, **runway))
    assert found.run.tolist() == list(range(5, 75))


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"seed": 3}, "seed = 1980 there, 3 here"),
        ({"speed": 1e3}, "speed"),
        ({"length": 6e3}, "length"),
    ],
)
def test_another_setup_is_refused(tmp_path, modes, surface, change, named):
    runway = RUNWAY | {"runs": 10}
    stored.monte_carlo(tmp_path, modes, surface, **runway)
    with pytest.raises(rm.InputError, match=named):
        stored.monte_carlo(tmp_path, modes, surface, **(runway | change))


def test_another_aircraft_is_refused(tmp_path, modes, surface):
    runway = RUNWAY | {"runs": 10}
    stored.monte_carlo(tmp_path, modes, surface, **runway)
    with pytest.raises(rm.InputError, match="damping_ratio"):
        stored.monte_carlo(tmp_path, rm.f4e().modes(0.02), surface, **runway)


def test_more_runs_are_added(tmp_path, modes, surface):
    """The last file of the first call is not full."""
    stored.monte_carlo(tmp_path, modes, surface, chunk=8, **RUNWAY, runs=12)
    stored.monte_carlo(tmp_path, modes, surface, chunk=8, **RUNWAY, runs=30)
    whole = rm.monte_carlo(modes, surface, **RUNWAY, runs=30)
    assert_same_bits(stored.read(tmp_path), whole)


def test_runs_from_disk_merge_with_their_like_alone(tmp_path, modes, surface):
    stored.monte_carlo(tmp_path, modes, surface, **RUNWAY, runs=10)
    read = stored.read(tmp_path)
    more = rm.monte_carlo(modes, surface, **RUNWAY, runs=5, first_run=10)
    whole = rm.monte_carlo(modes, surface, **RUNWAY, runs=15)
    assert_same_bits(read.merge(more), whole)
    stiffer = rm.f4e().with_stiffness({"left": 9500.0})
    measured = rm.Modes(
        stiffer, omega=modes.omega, damping_ratio=modes.damping_ratio, shapes=modes.shapes
    )
    given = (rm.f4e(), modes.omega, modes.damping_ratio, modes.shapes)
    for other, named in (
        (measured, r"gears\[1\]\.stiffness is \d+\.\d+ here and 9500\.0 there"),
        (rm.f4e().modes(0.02), "damping_ratio"),
        (rm.Modes(*given, static_correction=True), "static_correction"),
    ):
        apart = rm.monte_carlo(other, surface, **RUNWAY, runs=5, first_run=10)
        with pytest.raises(rm.InputError, match=named):
            read.merge(apart)


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"runs": 0}, "runs = 0"),
        ({"runs": 3, "chunk": 0}, "chunk = 0"),
        (
            {"runs": 3, "speed": [1.0, 2.0]},
            "speed has 2 entries, 3 expected",
        ),
        ({"runs": 3, "speed": -1.0}, r"speed = -1"),
        ({"runs": 5, "chunk": 2, "speed": [1e3, 1e3, 1e3, -1.0, 1e3]}, r"speed\[3\] = -1"),
        ({"runs": 3, "speed": "60 kt"}, "speed = '60 kt' is not a real number"),
        ({"runs": 3, "spacing": 100.0}, "spacing = 100"),
    ],
)
def test_bad_arguments_leave_no_files(tmp_path, modes, surface, options, named):
    with pytest.raises(rm.InputError, match=named):
        stored.monte_carlo(tmp_path / "new", modes, surface, **(RUNWAY | options))
    assert not (tmp_path / "new").exists()


def test_masked_runs_keep_their_reasons(tmp_path):
    """Squares of these forces are at the end of double precision."""
    huge = {
        "modes": rm.single_dof(mass=1e99, omega=9500.0, damping_ratio=0.01),
        "roughness": rm.Roughness(coefficient=1e95, reference=0.05, band=(0.01, 0.05)),
        "length": 240.0,
        "spacing": 5.0,
        "speed": 475_000.0,
        "seed": 1,
        "runs": 20,
    }
    with pytest.raises(rm.NumericalError, match="run"):
        stored.monte_carlo(tmp_path, **huge, chunk=8)
    # What has raised may go on otherwise: finished runs are none the less the same.
    stored.monte_carlo(tmp_path, **huge, chunk=8, on_error="mask")
    found, whole = stored.read(tmp_path), rm.monte_carlo(**huge, on_error="mask")
    assert_same_bits(found, whole)
    assert 0 < len(found.failures) < 20
    assert found.failures == whole.failures
    # Nor do masked runs pass for computed ones.
    with pytest.raises(rm.NumericalError, match="run"):
        stored.monte_carlo(tmp_path, **huge, chunk=8)


def test_bad_on_error_leaves_no_files(tmp_path, modes, surface):
    with pytest.raises(rm.InputError, match="on_error = 'ignore'"):
        stored.monte_carlo(tmp_path / "new", modes, surface, **RUNWAY, runs=3, on_error="ignore")
    assert not (tmp_path / "new").exists()


def test_a_damaged_file_is_named_and_made_again(tmp_path, modes, surface):
    stored.monte_carlo(tmp_path, modes, surface, chunk=8, **RUNWAY, runs=20)
    whole = stored.read(tmp_path)
    file = sorted(tmp_path.glob("runs-*.parquet"))[1]
    file.write_bytes(file.read_bytes()[:1000])
    with pytest.raises(rm.InputError, match=rf"{file.name} is damaged"):
        stored.read(tmp_path)
    stored.monte_carlo(tmp_path, modes, surface, chunk=8, **RUNWAY, runs=20)
    assert_same_bits(stored.read(tmp_path), whole)
    assert stored.read(tmp_path, runs=11).run.tolist() == whole.run.tolist()[:11]
    with pytest.raises(rm.InputError, match="runs = 0"):
        stored.read(tmp_path, runs=0)


@pytest.mark.parametrize(("lost", "run"), [(0, 0), (1, 8)])
def test_a_file_that_is_missing_among_others_is_named(tmp_path, modes, surface, lost, run):
    stored.monte_carlo(tmp_path, modes, surface, chunk=8, **RUNWAY, runs=20)
    whole = stored.read(tmp_path)
    files = sorted(tmp_path.glob("runs-*.parquet"))
    files[lost].unlink()
    for runs in (None, run + 1):
        with pytest.raises(rm.InputError, match=f"run {run} is missing, later ones are there"):
            stored.read(tmp_path, runs=runs)
    stored.monte_carlo(tmp_path, modes, surface, chunk=8, **RUNWAY, runs=20)
    assert_same_bits(stored.read(tmp_path), whole)
    # One that is missing at the end was perhaps never computed.
    files[-1].unlink()
    assert stored.read(tmp_path).run.tolist() == list(range(16))


def test_directories_inside_are_named(tmp_path, modes, surface):
    stored.monte_carlo(tmp_path / "60 kt", modes, surface, **RUNWAY, runs=3)
    with pytest.raises(rm.InputError, match="holds no runs; directories in it do: 60 kt"):
        stored.read(tmp_path)


def test_arguments_are_named_as_by_any_function(tmp_path, modes, surface):
    with pytest.raises(TypeError, match="missing keyword argument: 'runs'"):
        stored.monte_carlo(tmp_path / "new", modes, surface, **RUNWAY)
    with pytest.raises(TypeError, match="unexpected keyword argument: 'track'"):
        stored.monte_carlo(tmp_path / "new", modes, surface, **RUNWAY, runs=3, track="one")
    assert not (tmp_path / "new").exists()


def test_half_written_files_are_not_left(tmp_path, modes, surface, monkeypatch):
    stored.monte_carlo(tmp_path, modes, surface, chunk=8, **RUNWAY, runs=8)
    killed = tmp_path / "runs-000000000008.12345.tmp"
    killed.write_bytes(b"half")

    def stop(_: int) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("os.fsync", stop)
        with pytest.raises(KeyboardInterrupt):
            stored.monte_carlo(tmp_path, modes, surface, chunk=8, **RUNWAY, runs=16)
    assert not list(tmp_path.glob("*.tmp"))
    assert len(stored.read(tmp_path)) == 8
    stored.monte_carlo(tmp_path, modes, surface, chunk=8, **RUNWAY, runs=16)
    assert_same_bits(stored.read(tmp_path), rm.monte_carlo(modes, surface, **RUNWAY, runs=16))


@pytest.mark.parametrize("share", np.linspace(0.01, 0.99, 24))
def test_a_single_bit_that_flips_is_noticed(tmp_path, modes, surface, share):
    stored.monte_carlo(tmp_path, modes, surface, chunk=8, **RUNWAY, runs=16)
    whole = stored.read(tmp_path)
    file = sorted(tmp_path.glob("runs-*.parquet"))[1]
    flipped = bytearray(file.read_bytes())
    flipped[int(share * len(flipped))] ^= 4
    file.write_bytes(flipped)
    try:
        # Some bits are of no consequence: names of writers, statistics.
        assert_same_bits(stored.read(tmp_path), whole)
    except rm.InputError as error:
        assert f"{file.name} is damaged" in str(error)
    stored.monte_carlo(tmp_path, modes, surface, chunk=8, **RUNWAY, runs=16)
    assert_same_bits(stored.read(tmp_path), whole)


def test_a_set_up_that_is_not_as_written_is_refused(tmp_path, modes, surface):
    stored.monte_carlo(tmp_path, modes, surface, **RUNWAY, runs=3)
    whole = stored.read(tmp_path)
    file = tmp_path / "_setup.json"
    as_written = file.read_bytes()
    changes = [as_written[: len(as_written) // 2], b"", b"[]", b"null", b"{}", b"\xff\xfe"]
    for at in range(0, len(as_written), 37):
        flipped = bytearray(as_written)
        flipped[at] ^= 1 << at % 8
        changes.append(bytes(flipped))
    for changed in changes:
        file.write_bytes(changed)
        try:
            # 1e-05 and 1E-05 are the same.
            assert stored.read(tmp_path).setup == whole.setup
        except rm.InputError as error:
            assert "_setup.json is damaged" in str(error)
            with pytest.raises(rm.InputError, match=r"_setup\.json is damaged"):
                stored.monte_carlo(tmp_path, modes, surface, **RUNWAY, runs=3)
    file.write_bytes(as_written)
    assert len(stored.read(tmp_path)) == 3


def test_numbers_of_any_integer_kind(tmp_path, modes, surface):
    few = {"runs": np.int64(4), "first_run": np.int64(2)}
    stored.monte_carlo(tmp_path, modes, surface, **RUNWAY, **few, chunk=np.int64(2))
    assert stored.read(tmp_path).run.tolist() == [2, 3, 4, 5]


def test_a_speed_out_of_range_is_named_by_its_own_run(tmp_path, modes, surface):
    speed = np.full(20, 400.0)
    speed[17] = 1e-90
    runway = RUNWAY | {"speed": speed}
    for call in (
        lambda: stored.monte_carlo(tmp_path / "new", modes, surface, **runway, runs=20, chunk=8),
        lambda: rm.monte_carlo(modes, surface, **runway, runs=20, progress=print),
        lambda: rm.monte_carlo(modes, surface, **runway, runs=20),
    ):
        with pytest.raises(rm.InputError, match=r"^speed\[17\] = 1e-90 is out of range"):
            call()
    assert not (tmp_path / "new").exists()


def test_runs_without_their_set_up_are_refused(tmp_path, modes, surface):
    stored.monte_carlo(tmp_path, modes, surface, **RUNWAY, runs=3)
    (tmp_path / "_setup.json").unlink()
    for call in (
        lambda: stored.monte_carlo(tmp_path, modes, surface, **RUNWAY, runs=3),
        lambda: stored.read(tmp_path),
    ):
        with pytest.raises(rm.InputError, match=r"unknown set-up: _setup\.json is missing"):
            call()


def test_runs_with_speeds_of_their_own_are_added(tmp_path, modes, surface):
    speed = rm.knots(1) * np.linspace(20, 90, 30)
    few = RUNWAY | {"runs": 12, "speed": speed[:12]}
    all_ = RUNWAY | {"runs": 30, "speed": speed}
    stored.monte_carlo(tmp_path, modes, surface, chunk=8, **few)
    stored.monte_carlo(tmp_path, modes, surface, chunk=8, **all_)
    assert_same_bits(stored.read(tmp_path), rm.monte_carlo(modes, surface, **all_))
    others = all_ | {"speed": np.where(np.arange(30) == 9, 500.0, speed)}
    with pytest.raises(rm.InputError, match=r"run 9 has speed \d+\.\d+ there, 500\.0 here"):
        stored.monte_carlo(tmp_path, modes, surface, chunk=8, **others)
