"""Work for the engine of studies that its workers can import; as a program, a cluster to kill."""

from __future__ import annotations

import os
import signal
import sys
import time

import numpy as np


def numbers(seed: int) -> np.ndarray:
    """Sums that threads of a linear-algebra library would round otherwise."""
    matrix = np.random.default_rng(seed).normal(size=(120, 120))
    return (matrix @ matrix).sum(axis=0)


def told(seed: int, wait: float = 0.0) -> tuple[np.ndarray, int]:
    """The numbers, and the process that computed them."""
    time.sleep(wait)
    return numbers(seed), os.getpid()


def dies_once(seed: int, mark: str) -> np.ndarray:
    """The numbers, but of seed 3 the first time the end of the process."""
    if seed == 3:
        try:
            os.close(os.open(mark, os.O_CREAT | os.O_EXCL))
        except FileExistsError:
            pass
        else:
            os.kill(os.getpid(), signal.SIGKILL)
    return numbers(seed)


def dies(seed: int) -> np.ndarray:
    """End the process."""
    os.kill(os.getpid(), signal.SIGKILL)
    return numbers(seed)


def fails(seed: int) -> np.ndarray:
    """Fail of itself."""
    raise OSError(f"no share {seed}")


def main() -> None:
    """Start a cluster, print its address, and wait to be ended."""
    from distributed import LocalCluster

    with LocalCluster(
        n_workers=int(sys.argv[1]), threads_per_worker=1, memory_limit=None, dashboard_address=":0"
    ) as cluster:
        print(cluster.scheduler_address, flush=True)
        sys.stdin.read()


if __name__ == "__main__":
    main()
