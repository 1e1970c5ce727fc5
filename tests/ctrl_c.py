"""A user who presses Ctrl-C while the package computes."""

import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest


@contextmanager
def ctrl_c(after: float) -> Iterator[None]:
    """Ctrl-C `after` [s] ends what is done inside, and does so within a second."""
    sent = []

    def press() -> None:
        sent.append(time.perf_counter())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(after, press)
    # What ends before the time is a failure of its own, not an interrupt of some later test.
    try:
        with pytest.raises(KeyboardInterrupt):  # noqa: PT012 - it may come at once
            timer.start()
            yield
    finally:
        timer.cancel()
    assert time.perf_counter() - sent[0] < 1.0
