"""Long Monte Carlo runs that keep finished parts on disk (extra ``tables``)."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ._chunks import CHUNK, Chunk, chunks, joined, setup, told
from ._core import InputError, __version__
from ._extras import need
from ._input import integer, read_only
from ._quantities import DIMENSIONS
from ._setups import difference
from .ensemble import Ensemble, masks
from .units import FORCE

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Unpack

    import pandas as pd
    from numpy.typing import ArrayLike

    from ._chunks import Options
    from .modes import Modes
    from .roughness import Roughness

__all__ = ["monte_carlo", "read"]

_SETUP = "_setup.json"
_CHECKSUM = "sha256"

_OF_GEARS = [key for key, dimension in DIMENSIONS.items() if dimension == FORCE]
_OF_STATIONS = [key for key in DIMENSIONS if key not in _OF_GEARS]


def monte_carlo(
    directory: str | os.PathLike[str],
    modes: Modes,
    roughness: Roughness,
    *,
    chunk: int = CHUNK,
    progress: Callable[[int, int], object] | None = None,
    **options: Unpack[Options],
) -> None:
    """
    Run `runway_modal.monte_carlo`, keeping each finished chunk in a Parquet file.

    However a call ends, another with the same arguments resumes where it stopped, to the same
    bits. Memory holds one chunk, however many runs there are. `read` returns the results.

    Parameters
    ----------
    directory : path
        Directory of the files; created if missing.
    modes : Modes
        As for `runway_modal.monte_carlo`.
    roughness : Roughness
        As for `runway_modal.monte_carlo`.
    chunk : int
        Runs per file.
    progress : callable, optional
        Called with the numbers of runs finished and wanted, before the first chunk and after
        each.
    **options
        The keyword arguments of `runway_modal.monte_carlo`.

    Raises
    ------
    InputError
        If an argument is of the wrong kind or out of range, or the directory holds runs of
        another set-up or version.
    ImportError
        If pandas or pyarrow is not installed.
    NumericalError
        If a result leaves the range of double precision, unless that run is to be masked.

    Examples
    --------
    >>> import tempfile
    >>> import runway_modal as rm
    >>> from runway_modal import stored
    >>> modes, surface = rm.f4e().modes(0.01), rm.Roughness.iso8608("A", unit="in")
    >>> runway = dict(length=2400.0, spacing=12.0, seed=1980, speed=rm.knots(60), runs=100)
    >>> with tempfile.TemporaryDirectory() as directory:
    ...     stored.monte_carlo(directory, modes, surface, **runway, chunk=32)
    ...     print(stored.read(directory))
    <Ensemble: 100 runs, gears nose, left, right, none failed>
    """
    need("runs on disk", "tables", "pandas", "pyarrow")
    parts = chunks(modes, roughness, options, chunk)
    folder = Path(directory)
    folder.mkdir(parents=True, exist_ok=True)
    common = setup(
        modes,
        roughness,
        length=options["length"],
        spacing=options["spacing"],
        seed=options["seed"],
        tracks=options.get("tracks", "one"),
        damping_input=options.get("damping_input", False),
    )
    about = {
        "runway_modal": __version__,
        "chunk": int(chunk),
        "first_run": int(options.get("first_run", 0)),
        "speed": _shared_speed(options["speed"]),
        "setup": common,
    }
    _finished(folder)
    _agree(folder / _SETUP, about)
    for part in told(parts, int(options["runs"]), progress):
        file = folder / f"runs-{part.first_run:012d}.parquet"
        if not _holds(file, part, common):
            _write(file, part)


def read(directory: str | os.PathLike[str], *, runs: int | None = None) -> Ensemble:
    """
    Read the runs that `monte_carlo` has finished in a directory.

    Parameters
    ----------
    directory : path
        Directory of the files.
    runs : int, optional
        Largest number of runs to read, from the first. Default: all.

    Returns
    -------
    Ensemble
        The runs finished so far.

    Raises
    ------
    InputError
        If there are none, their set-up is missing, a file is damaged or missing among others, or
        `runs` is not a whole number > 0.
    ImportError
        If pandas or pyarrow is not installed.

    Examples
    --------
    >>> from runway_modal import stored
    >>> stored.read("/nowhere")
    Traceback (most recent call last):
    runway_modal.InputError: directory = '/nowhere' holds no runs
    """
    need("runs on disk", "tables", "pandas", "pyarrow")
    folder = Path(directory)
    files = _finished(folder)
    if not files:
        inside = ", ".join(sorted(file.parent.name for file in folder.glob(f"*/{_SETUP}")))
        hint = f"; directories in it do: {inside}" if inside else ""
        raise InputError(f"directory = {os.fspath(directory)!r} holds no runs{hint}")
    about = _about(folder / _SETUP)
    first = about["first_run"]
    last = None if runs is None else first + integer("runs", runs, 1) - 1
    parts = [part for file in files if len(part := _read(file, about["setup"], last))]
    there = np.concatenate([np.empty(0, np.int64), *(part.run for part in parts)])
    gaps = np.flatnonzero(there != first + np.arange(there.size))
    missing = first + int(gaps[0] if gaps.size else there.size)
    # Those at the end were perhaps never computed.
    if missing < int(files[-1].stem.removeprefix("runs-")) and (last is None or missing <= last):
        raise InputError(
            f"{folder}: run {missing} is missing, later ones are there; `monte_carlo` computes it "
            "again"
        )
    return joined(parts)


def _agree(file: Path, about: dict[str, Any]) -> None:
    """Write the set-up, or compare it with the one that is there."""
    if not file.exists():
        text = json.dumps({**about, _CHECKSUM: _checksum(about)}, indent=1)
        _replace(file, lambda path: path.write_text(text, encoding="utf-8"))
        return
    differ = difference(_flat(_about(file)), _flat(about))
    if differ:
        key, there, here = differ
        raise InputError(
            f"{file} holds another set-up: {key} = {_brief(there)} there, {_brief(here)} here"
        )


def _about(file: Path) -> dict[str, Any]:
    """Read a set-up as it was written."""
    try:
        about: dict[str, Any] = json.loads(file.read_bytes())
        as_written = about.pop(_CHECKSUM) == _checksum(about)
    # Whatever the bytes happen to say.
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
        as_written = False
    if not as_written:
        raise InputError(
            f"{file} is damaged: nothing else tells which runs {file.parent} holds; delete both to "
            "begin anew"
        )
    return about


def _checksum(about: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(about, sort_keys=True).encode()).hexdigest()


def _brief(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


def _shared_speed(speed: ArrayLike) -> object:
    """Speed of all runs; those of single runs are compared run by run."""
    return "one per run" if np.ndim(speed) else float(np.asarray(speed))


def _finished(folder: Path) -> list[Path]:
    """Files of finished chunks, in order; refused without what says what they are runs of."""
    files = sorted(folder.glob("runs-*.parquet"))
    if files and not (folder / _SETUP).exists():
        raise InputError(f"{folder} holds runs of an unknown set-up: {_SETUP} is missing")
    return files


def _flat(about: dict[str, Any]) -> dict[str, Any]:
    return {**about["setup"], **{key: about[key] for key in about if key != "setup"}}


def _replace(file: Path, write: Callable[[Path], object]) -> None:
    """Write a file so that it exists whole or not at all, whatever happens."""
    half = file.with_suffix(f".{os.getpid()}.tmp")
    try:
        write(half)
        with half.open("rb+") as handle:
            os.fsync(handle.fileno())
        half.replace(file)
    finally:
        # Its own after an error, and those of processes that were killed.
        for left in file.parent.glob(f"{file.stem}.*.tmp"):
            left.unlink(missing_ok=True)


def _holds(file: Path, part: Chunk, common: dict[str, Any]) -> bool:
    """Whether a file has a chunk's runs: the last one of an earlier call may have fewer."""
    if not file.exists():
        return False
    try:
        frame = _frame(file, common)
    except _Damaged:
        return False  # computed again
    speeds = frame["speed"].to_numpy()
    here = np.broadcast_to(part.options["speed"], part.options["runs"])
    for i in np.flatnonzero(speeds[: len(here)] != here[: len(speeds)])[:1]:
        run = part.first_run + i
        raise InputError(f"{file}: run {run} has speed {speeds[i]} there, {here[i]} here")
    # Masked runs are computed again where they are to be raised for.
    masked = frame["failure"][: len(here)].notna().any()
    usable = masks(part.options.get("on_error", "raise")) or not masked
    return bool(usable) and len(speeds) >= len(here)


def _write(file: Path, part: Chunk) -> None:
    import pandas as pd

    found = part.compute()
    frame = found.to_pandas()
    # Text even where no run has failed: a column has the same type in all files.
    frame["failure"] = pd.Series(found.failures, index=frame.index, dtype="string")
    _replace(file, lambda path: frame.to_parquet(path, engine="pyarrow", write_page_checksum=True))


class _Damaged(InputError):
    """A file that cannot be what was written."""


def _frame(file: Path, common: dict[str, Any]) -> pd.DataFrame:
    """Read a file as it was written."""
    from pyarrow.parquet import read_table

    of_gears = [f"{key}_{gear['name']}" for key in _OF_GEARS for gear in common["gears"]]
    of_stations = [f"{key}_{name}" for key in _OF_STATIONS for name, *_ in common["stations"]]
    try:
        frame: pd.DataFrame = read_table(file, page_checksum_verification=True).to_pandas()
        missing = {"speed", "failure", *of_gears, *of_stations} - set(frame.columns)
        why = f"no column {min(missing)!r}" if missing else ""
    except (FileNotFoundError, PermissionError):
        raise
    # Whatever the bytes happen to say: pyarrow's own errors are some of these.
    except (OSError, ValueError, LookupError, TypeError, NotImplementedError) as error:
        why = str(error)
    if why:
        raise _Damaged(f"{file} is damaged; `monte_carlo` computes it again: {why}")
    return frame


def _read(file: Path, common: dict[str, Any], last: int | None) -> Ensemble:
    frame = _frame(file, common).loc[:last]

    def named(quantity: str) -> dict[str, Any]:
        start = f"{quantity}_"
        names = [column for column in frame.columns if column.startswith(start)]
        return {name.removeprefix(start): read_only(frame[name].to_numpy()) for name in names}

    gears = {quantity: named(quantity) for quantity in _OF_GEARS}
    columns: dict[str, Any] = {key: np.column_stack([*one.values()]) for key, one in gears.items()}
    columns |= {"run": frame.index.to_numpy(), "speed": frame["speed"].to_numpy()}
    values: dict[str, Any] = {key: read_only(column) for key, column in columns.items()}
    values |= {key: named(key) for key in _OF_STATIONS}
    failures: dict[Any, str] = frame["failure"].dropna().to_dict()
    return Ensemble(
        gear_names=tuple(gears["max_load"]),
        setup=common,
        failures=failures,
        static_load=np.broadcast_to(common["static_load"], values["max_load"].shape),
        **values,
    )
