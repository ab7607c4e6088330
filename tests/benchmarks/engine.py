"""What shares of a study cost beside their work: joblib's processes, Dask, and one process.

``python tests/benchmarks/engine.py`` does shares of 0.2 s in two processes each way, alternating,
and prints the ratios; Dask's with and without starting and ending its cluster. Shares wait, so that
what else a machine does counts little; with ``--busy`` they work, which takes two idle cores.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import numpy as np
import timing  # noqa: F401 - one thread, before numpy
from distributed import Client, LocalCluster
from joblib import parallel_config

from bridgectl._workers import in_processes

SHARES, SECONDS, REPEATS = 60, 0.2, 5


def work(seed: int, seconds: float, busy: bool) -> np.ndarray:
    """Return 15 results of 500 crossings, after so much time."""
    numbers = np.random.default_rng(seed).normal(size=(15, 500))
    if not busy:
        time.sleep(seconds)
    end = time.process_time() + seconds * busy
    while time.process_time() < end:
        np.sort(numbers)
    return numbers


def jobs() -> Iterator[tuple[int, float, bool]]:
    return ((seed, SECONDS, "--busy" in sys.argv) for seed in range(SHARES))


def timed(workers: int, scheduler: str | None = None) -> tuple[float, float]:
    """Return the time it takes, and that of this process' processor [s]."""
    begin, own = time.perf_counter(), time.process_time()
    assert len(dict(in_processes(work, jobs(), workers, scheduler))) == SHARES
    return time.perf_counter() - begin, time.process_time() - own


def running(cluster: LocalCluster) -> tuple[float, float]:
    with (
        Client(cluster, set_as_default=False) as client,
        parallel_config(backend="dask", client=client),
    ):
        return timed(2)


def main() -> None:
    times: dict[str, list[tuple[float, float]]] = {}
    with LocalCluster(
        n_workers=2, threads_per_worker=1, memory_limit=None, dashboard_address=":0"
    ) as cluster:
        for _ in range(REPEATS):
            for name, call in (
                ("one process", lambda: timed(1)),
                ("two of joblib", lambda: timed(2)),
                ("two of a running cluster", lambda: running(cluster)),
                ("two of a cluster that is started", lambda: timed(2, "local")),
            ):
                times.setdefault(name, []).append(call())
    print(f"{SHARES} shares of {SECONDS} s, best of {REPEATS}:")
    best = {name: min(wall for wall, _ in each) for name, each in times.items()}
    for name, each in times.items():
        print(
            f"  {name}: {best[name]:.2f} s, of this processor {min(own for _, own in each):.2f} s"
        )
    one, joblib, runs, starts = best.values()
    print(f"two processes against one: {one / joblib:.2f} (at least 1.7 asked)")
    print(f"Dask against joblib: {runs / joblib:.2f} (at most 1.3 asked)")
    print(f"with start and end of the cluster: {starts / joblib:.2f}")


if __name__ == "__main__":
    main()
