"""Runs shared out over processes, one of which is killed: the same bits as at home."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import runway_modal as rm
from runway_modal import distributed

dask = pytest.importorskip("distributed")

RUNWAY = {
    "length": 2400.0,
    "spacing": 12.0,
    "speed": rm.knots(60),
    "seed": 1980,
    "tracks": "isotropic",
    "runs": 40_000,
}


# The killed process leaves its half of a connection to whoever was talking to it.
@pytest.mark.filterwarnings("default")
def test_a_killed_worker_changes_no_bit():
    modes, surface = rm.f4e().modes(0.01), rm.Roughness.iso8608("B", unit="in")
    with (
        dask.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        dask.Client(cluster) as client,
    ):
        workers = client.run(os.getpid)
        killed = next(iter(workers.values()))

        def kill_once_at_work() -> None:
            def kill() -> None:
                while not any(client.processing().values()):
                    time.sleep(0.001)
                os.kill(killed, signal.SIGKILL)

            threading.Thread(target=kill, daemon=True).start()

        kill_once_at_work()
        shared = distributed.monte_carlo(client, modes, surface, chunk=500, **RUNWAY)
        assert killed not in client.run(os.getpid).values()
    alone = rm.monte_carlo(modes, surface, **RUNWAY)
    for key in ("run", "max_load", "min_load", "rms_load"):
        np.testing.assert_array_equal(getattr(shared, key), getattr(alone, key))
