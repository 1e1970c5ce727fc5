"""Timing side by side: calls take turns, medians and pairwise ratios are printed."""

import argparse
import gc
import importlib.metadata
import os
import platform
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

#: Whether figures are held against their bars.
_judge = True


def options(description: str) -> bool:
    """Whether only to try that everything runs."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--quick", action="store_true", help="tiny sizes: does it run?")
    global _judge
    _judge = not parser.parse_args().quick
    return not _judge


def machine(*packages: str) -> None:
    """Print where and with what."""
    model = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        model = names[0].split(":")[1].strip() if names else model
    versions = [f"{name} {importlib.metadata.version(name)}" for name in packages]
    print(f"{model}, {os.cpu_count()} cores; Python {platform.python_version()}")
    print(", ".join(versions))
    if not _judge:
        print("tiny sizes, few runs: the figures mean nothing")


def take_turns(rounds: int, inner: int = 1, **calls: Callable[[], object]) -> dict[str, np.ndarray]:
    """
    Time calls in turns, so that what slows the machine down slows all of them.

    Every turn starts with one call that is not counted. Short calls are repeated `inner` times
    within a turn, to be long against the clock. Results are dropped outside the clock where
    there is one, as their size then matters.
    """
    seconds: dict[str, list[float]] = {name: [] for name in calls}
    gc.collect()
    gc.disable()
    for _ in range(rounds):
        for name, call in calls.items():
            call()
            begin = time.perf_counter()
            for _ in range(inner):
                result = call()
            end = time.perf_counter()
            del result
            seconds[name].append((end - begin) / inner)
    gc.enable()
    return {name: np.array(each) for name, each in seconds.items()}


def ratio(slow: np.ndarray, fast: np.ndarray) -> float:
    """Median of the ratios of neighbours in time."""
    return float(np.median(slow / fast))


def line(what: str, value: str, bar: str = "", met: bool | None = None) -> None:
    """One row of a table: what, how much, how much is asked."""
    verdict = {None: "", True: "met", False: "MISSED"}[met if _judge else None]
    print(f"  {what:<58}{value:>14}  {bar:<8}{verdict}".rstrip())
