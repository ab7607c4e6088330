"""What the benchmarks share: one thread, and a stopwatch. Import it before numpy."""

from __future__ import annotations

import os
import time

for library in ("OPENBLAS", "OMP", "MKL"):  # before numpy starts its threads
    os.environ[f"{library}_NUM_THREADS"] = "1"


def timed(call, repeats=3):
    """Best wall time of some calls [s]."""
    best = float("inf")
    for _ in range(repeats):
        start = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - start)
    return best
