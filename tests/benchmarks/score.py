"""Time the full score of one strategy against simulating each crossing with the control library.

Run ``python tests/benchmarks/score.py [NAME]`` from the top of the repository: 101 speeds of 50 to
150 km/h, a unit ramp at each of 250 places, and 20 roads. Quote ratios: machines differ.
"""

from __future__ import annotations

from timing import timed  # isort: skip  # before numpy, for it limits the threads

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))  # the tests' helpers
from helpers import loop_of_the_control_library

import bridgectl as bc
from bridgectl.dampers import Damper, library
from bridgectl.road import iso8608_elevations

SPEEDS = np.arange(50, 151) / 3.6
N_ROADS = 20
SAMPLE = (60, 90, 130)
"""Speeds at which the control library is timed [km/h]."""


def roads(approach):
    x = -approach + 0.1 * np.arange(round((approach + 25) / 0.1) + 1)
    elevations = iso8608_elevations(N_ROADS, "A", approach + 25, seed=0)
    return [bc.RoadProfile(x, z) for z in elevations]


def main(name="skyhook"):
    beam, car = bc.li2006.beam(), bc.li2006.car()
    law = next(law for law in library(beam, car, 1e3, 30e3) if law.name == name)
    level = bc.RoadProfile(0.1 * np.arange(251), np.zeros(251))
    one = np.mean(
        [
            timed(
                lambda c=c: loop_of_the_control_library(beam, car, Damper(law), c / 3.6, level), 1
            )
            for c in SAMPLE
        ]
    )
    print(f"{name}: {one:.2f} s a crossing of a level bridge by the control library")
    for approach in (0, 60):
        n_ramps = round((approach + 25) / 0.1)
        crossings = len(SPEEDS) * (1 + n_ramps + N_ROADS)
        own = roads(approach)
        for workers in (1, 2):
            took = timed(
                lambda workers=workers, approach=approach, own=own: bc.score(
                    [law], beam, car, own, SPEEDS, approach=approach, workers=workers
                ),
                1,
            )
            longer = (approach + 25) / 25
            print(
                f"{approach:2d} m of approach, {n_ramps} ramps and {N_ROADS} roads x "
                f"{len(SPEEDS)} speeds, {workers} process{'es' if workers > 1 else ''}: "
                f"{took:.1f} s, {one * longer * crossings / took:,.0f} times faster"
            )


if __name__ == "__main__":
    main(*sys.argv[1:])
