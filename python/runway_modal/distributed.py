"""Monte Carlo on many machines: runs distributed over a dask cluster (extra ``dask``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._chunks import CHUNK, Chunk, chunks, joined, told
from ._core import InputError

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Unpack

    from distributed import Client

    from ._chunks import Options
    from .ensemble import Ensemble
    from .modes import Modes
    from .roughness import Roughness

__all__ = ["monte_carlo"]


def monte_carlo(
    client: Client,
    modes: Modes,
    roughness: Roughness,
    *,
    chunk: int = CHUNK,
    progress: Callable[[int, int], object] | None = None,
    **options: Unpack[Options],
) -> Ensemble:
    """
    Distribute the runs of `runway_modal.monte_carlo` over the workers of a cluster.

    A run, and so the result, is the same to the last bit whichever workers compute it and however
    many there are. The chunks of a worker that dies go to other workers.

    Parameters
    ----------
    client : distributed.Client
        Client of a cluster whose workers have this version of the package.
    modes : Modes
        As for `runway_modal.monte_carlo`.
    roughness : Roughness
        As for `runway_modal.monte_carlo`.
    chunk : int
        Runs per task.
    progress : callable, optional
        Called with the numbers of runs finished and wanted, before the first chunk and after
        each, in the order of the runs.
    **options
        The keyword arguments of `runway_modal.monte_carlo`.

    Returns
    -------
    Ensemble
        As returned by `runway_modal.monte_carlo`.

    Raises
    ------
    InputError
        If an argument is of the wrong kind or out of range.
    NumericalError
        If a result leaves the range of double precision, unless that run is to be masked.

    Examples
    --------
    A cluster of threads in this process; a client of any other cluster will do as well:

    >>> import runway_modal as rm
    >>> from distributed import Client
    >>> from runway_modal import distributed
    >>> modes, surface = rm.f4e().modes(0.01), rm.Roughness.iso8608("A", unit="in")
    >>> runway = dict(length=2400.0, spacing=12.0, seed=1980, speed=rm.knots(60), runs=100)
    >>> with Client(processes=False, dashboard_address=None) as client:
    ...     shared = distributed.monte_carlo(client, modes, surface, chunk=32, **runway)
    >>> alone = rm.monte_carlo(modes, surface, **runway)
    >>> bool((shared.max_load == alone.max_load).all())
    True
    """
    from distributed import Client

    if not isinstance(client, Client):
        raise InputError(f"client = {client!r} is not a distributed.Client")
    parts = list(chunks(modes, roughness, options, chunk))
    counted = told(parts, int(options["runs"]), progress)
    # Not pure: results that another call left in the cluster are not reused.
    futures = client.map(Chunk.compute, parts, pure=False)
    return joined(future.result() for _, future in zip(counted, futures, strict=True))
