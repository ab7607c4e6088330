"""What the benchmarks share: one thread, and a stopwatch. Import it before numpy."""

from __future__ import annotations

import os
import time

for library in ("OPENBLAS", "OMP", "MKL"):  # before numpy starts its threads
    os.environ[f"{library}_NUM_THREADS"] = "1"


def timed(call, repeats=3, clock=time.perf_counter, warm=False):
    """Best time of some calls by a clock [s], after one more if it is to be warm."""
    best = float("inf")
    if warm:
        call()
    for _ in range(repeats):
        start = clock()
        call()
        best = min(best, clock() - start)
    return best
