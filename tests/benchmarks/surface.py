"""Time the paper's ramp surface against simulating each ramp with the control library.

Run ``python tests/benchmarks/surface.py`` from the top of the repository. Everything runs on
one thread in one process; ratios are what to quote, machines differ.
"""

from __future__ import annotations

from timing import timed  # isort: skip  # before numpy, for it limits the threads

import resource
import time
import warnings

import control
import numpy as np

import bridgectl as bc

SPEEDS = np.arange(50, 151) / 3.6
SAMPLE = 20


def one_ramp(speed, place):
    """One ramp with `control.input_output_response` at rtol 1e-8, 1001 samples."""
    system = bc.crossing_system(bc.li2006.beam(), bc.li2006.car(), speed, recovery="li2006")
    x = np.linspace(0, 25, 1001)
    road = 1e-3 * np.clip((x - place) / 0.1, 0, 1)
    return control.input_output_response(
        system,
        x / speed,
        np.vstack([road, 0 * x]),
        0,
        solve_ivp_method="DOP853",
        solve_ivp_kwargs={"rtol": 1e-8, "atol": 1e-12},
    )


def main():
    """Print times, ratios and peak memory."""
    warnings.simplefilter("error")
    beam, truck = bc.li2006.beam(), bc.li2006.car()
    rows = []
    surface = timed(lambda: bc.ramp_surface(beam, truck, SPEEDS, recovery="li2006"))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    rng = np.random.default_rng(0)
    cases = list(zip(rng.choice(SPEEDS, SAMPLE), rng.uniform(0, 12.5, SAMPLE), strict=True))
    start = time.perf_counter()
    for speed, place in cases:
        one_ramp(speed, place)
    each = (time.perf_counter() - start) / SAMPLE
    rows.append(("paper surface, 101 speeds x 250 ramps", surface, 1.0))
    rows.append((f"one ramp, control library (mean of {SAMPLE})", each, each / surface))
    every = each * len(SPEEDS) * 251
    rows.append(("every ramp, control library (extrapolated)", every, every / surface))
    approach = timed(lambda: bc.ramp_surface(beam, truck, SPEEDS, approach=200.0), repeats=1)
    rows.append(("surface with 200 m of approach, 2250 ramps", approach, approach / surface))
    road = bc.utia_road().place_bridge(678).crop(-200, 25).detrend().resample(0.1)
    simulated = timed(lambda: bc.daf(beam, truck, SPEEDS, road, start=-200))
    rows.append(("DAF of the measured road, 101 speeds", simulated, simulated / surface))
    print(f"{'what':46} {'seconds':>10} {'ratio to the paper surface':>27}")
    for what, seconds, ratio in rows:
        print(f"{what:46} {seconds:10.3g} {ratio:27.3g}")
    print(f"peak memory of the process after the paper surface: {peak:.0f} MB")


if __name__ == "__main__":
    main()
