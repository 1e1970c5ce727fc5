"""A progress bar on a terminal (extra ``cli``)."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


@contextmanager
def progress_bar(total: int, *, quiet: bool) -> Iterator[Callable[[int], None]]:
    """Show progress on a terminal; call the result with the number of runs done so far."""
    if quiet or not sys.stderr.isatty():
        yield lambda _: None
        return
    try:
        from tqdm import tqdm
    except ImportError:
        print("no progress bar: pip install 'runway_modal[cli]'", file=sys.stderr)
        yield lambda _: None
        return
    with tqdm(total=total, unit=" runs", unit_scale=True, dynamic_ncols=True, leave=False) as bar:

        def show(done: int) -> None:
            bar.update(done - bar.n)

        yield show
