"""Time roads made and measured at once against plain loops over samples.

Run ``python tests/benchmarks/roads.py`` from the top of the repository. Everything runs on one
thread in one process; ratios are what to quote, machines differ.
"""

from __future__ import annotations

from timing import timed  # isort: skip  # before numpy, for it limits the threads

import tempfile
from pathlib import Path

import numpy as np

import bridgectl as bc
from bridgectl.road import iso8608_elevations
from bridgectl.road.iri import SPEED, golden_car, rectified_slope

SAMPLE = 3
"""Roads that the loop over waves is timed for."""


def loop_iri(z, step):
    """IRI as the published programs have it: one matrix product for each sample."""
    car = golden_car().sample(step / SPEED, "zoh")
    base, first = int(0.25 / step + 0.5), int(11 / step + 0.5)
    slope = (z[first] - z[0]) / (first * step)
    state, total = np.array([slope, 0, slope, 0]), 0.0
    for i in range(len(z) - base):
        state = car.A @ state + car.B[:, 0] * (z[i + base] - z[i]) / (base * step)
        total += abs(state[2] - state[0])
    return 1e3 * total / (len(z) - base)


def loop_road(rng, length, step):
    """A class A road as a sum of cosines, one at a time."""
    x = step * np.arange(round(length / step) + 1)
    spacing = 1 / (2 * length)
    z = np.zeros_like(x)
    for n in np.arange(0.01, 4, spacing):
        amplitude = np.sqrt(2 * 16e-6 * (n / 0.1) ** -2 * spacing)
        z += amplitude * np.cos(2 * np.pi * n * x + rng.uniform(0, 2 * np.pi))
    return z


def main():
    """Print times and ratios."""
    rows = []
    road = iso8608_elevations(1, "A", 12_000, 0.075, seed=0)[0]
    iri, loop = timed(lambda: rectified_slope(road, 0.075).mean()), loop_iri(road, 0.075)
    assert abs(rectified_slope(road, 0.075).mean() - loop) < 1e-9
    plain = timed(lambda: loop_iri(road, 0.075), 1)
    rows.append(("IRI of 12 km at 75 mm", iri, "a loop over its samples", plain))

    rng = np.random.default_rng(0)
    plain = timed(lambda: [loop_road(rng, 235, 0.1) for _ in range(SAMPLE)], 1) / SAMPLE * 1000
    for method in ("spectral", "filter"):
        batch = timed(lambda m=method: iso8608_elevations(1000, "A", 235, seed=0, method=m))
        what = f"1000 ISO roads of 235 m at 0.1 m, {method}"
        rows.append((what, batch, f"a loop over waves ({SAMPLE} roads, extrapolated)", plain))

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "long.csv")
        bc.write_profile(path, bc.iso8608_profile("A", 100_000, seed=0))
        read = timed(lambda: bc.read_profile(path), 2)
        plain = timed(lambda: np.genfromtxt(path, delimiter=",", skip_header=1), 1)
    rows.append(("reading 10^6 lines of csv", read, "numpy.genfromtxt", plain))
    for what, seconds, baseline, other in rows:
        print(f"{what}: {seconds:.3f} s, {other / seconds:.0f} times faster than {baseline}")


if __name__ == "__main__":
    main()
