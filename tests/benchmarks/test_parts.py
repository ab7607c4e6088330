"""Times of the parts of a ramp surface, by pytest-benchmark.

Run ``pytest -n 0 tests/benchmarks/test_parts.py --benchmark-columns=min,median``
from the top of the repository; the relative column in brackets is the ratio to the fastest of each
group.
"""

from __future__ import annotations

import timing  # noqa: F401  # isort: skip  # before numpy, for it limits the threads

import numpy as np
import pytest

import bridgectl as bc
from bridgectl.linear.cells import build_cells
from bridgectl.linear.runs import prepare
from bridgectl.surface.histories import factor_histories

SPEEDS = np.arange(50, 151) / 3.6


@pytest.fixture(scope="module")
def surface():
    return bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), SPEEDS)


@pytest.fixture(scope="module")
def run(surface):
    level = bc.RoadProfile(surface.stations, np.zeros_like(surface.stations))
    return prepare(bc.Crossing(surface.beam, surface.vehicle), level, 0.0)


@pytest.mark.benchmark(group="surface")
def test_maps_of_the_cells(benchmark, run):
    nodes = run.nodes(float(SPEEDS.min()))
    benchmark(build_cells, run.crossing, SPEEDS, nodes, on_bridge=True)


@pytest.mark.benchmark(group="surface")
def test_factored_histories(benchmark, run):
    benchmark(factor_histories, run, SPEEDS, 0.1, 250)


@pytest.mark.benchmark(group="surface")
def test_peaks_of_every_ramp(benchmark, surface):
    benchmark(lambda: [surface.histories.peaks(i, 1e-3) for i in range(len(SPEEDS))])


@pytest.mark.benchmark(group="surface")
def test_bare_product(benchmark, surface):
    rng = np.random.default_rng(0)
    n_samples, n_states = surface.histories.smooth.shape[1], surface.histories.entry.shape[1]
    rows, states = rng.normal(size=(n_samples, n_states)), rng.normal(size=(n_states, 250))
    benchmark(lambda: [(rows @ states).max(axis=0) for _ in SPEEDS])
