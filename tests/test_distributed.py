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
        told = []
        shared = distributed.monte_carlo(
            client, modes, surface, chunk=500, progress=lambda *now: told.append(now), **RUNWAY
        )
        assert told == [(done, 40_000) for done in range(0, 40_001, 500)]
        assert killed not in client.run(os.getpid).values()
    alone = rm.monte_carlo(modes, surface, **RUNWAY)
    for key in ("run", "max_load", "min_load", "rms_load"):
        np.testing.assert_array_equal(getattr(shared, key), getattr(alone, key))


def test_clients_are_clients():
    with pytest.raises(rm.InputError, match=r"client = None is not a distributed\.Client"):
        distributed.monte_carlo(
            None, rm.f4e().modes(0.01), rm.Roughness.iso8608("B", unit="in"), **RUNWAY
        )


def test_masked_runs_come_home_with_their_reasons():
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
    with dask.Client(processes=False, dashboard_address=None) as client:
        with pytest.raises(rm.NumericalError, match="run"):
            distributed.monte_carlo(client, **huge, chunk=8)
        shared = distributed.monte_carlo(client, **huge, chunk=8, on_error="mask")
    assert shared.failures == rm.monte_carlo(**huge, on_error="mask").failures
    assert 0 < len(shared.failures) < 20
