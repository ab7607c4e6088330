"""Print how far dampers get towards the clairvoyant optimum, and how long that takes to find.

Run ``python tests/benchmarks/clairvoyant.py [N_ROADS]`` from the top of the repository: class A
roads (12 of them by default, then about 4 minutes) with 60 m of approach at 70, 90 and 108 km/h,
dampers of 1 to 30 kN s/m. Everything runs on one thread in one process.
"""

from __future__ import annotations

from timing import timed  # isort: skip  # before numpy, for it limits the threads

import sys

import numpy as np

import bridgectl as bc
from bridgectl.dampers import bridgehook, clairvoyant, simulate_loop
from bridgectl.road import iso8608_elevations

SPEEDS = np.array([70, 90, 108]) / 3.6
SOFT, STIFF = 1e3, 30e3
STATIONS = -60 + 0.1 * np.arange(851)


def optima(beam, truck, speed, roads):
    """Clairvoyant optimum of each road, and the time that each took [s]."""
    found, times = [], []
    for z in roads:
        road = bc.RoadProfile(STATIONS, z)

        def crossing(road=road):
            found.append(clairvoyant(beam, truck, speed, road, SOFT, STIFF, start=-60))

        times.append(timed(crossing, 1))
    return found, times


def main():
    """Print a row for each speed."""
    n_roads = int(sys.argv[1]) if len(sys.argv) > 1 else 12
    beam, truck = bc.li2006.beam(), bc.li2006.car()
    roads = iso8608_elevations(n_roads, "A", 85, seed=0)
    hook = simulate_loop(beam, truck, bridgehook(beam, truck, SOFT, STIFF), SPEEDS, STATIONS, roads)
    print(f"Mean DAF of {n_roads} class A roads")
    print(
        "km/h  passive  bridgehook  IPOPT alone  clairvoyant  closed by bridgehook"
        "  s/crossing (most)"
    )
    for speed, hooked in zip(SPEEDS, hook.daf.mean(axis=1), strict=True):
        found, times = optima(beam, truck, speed, roads)
        passive = np.mean([each.passive_daf for each in found])
        best = np.mean([each.daf for each in found])
        closed = (passive - hooked) / (passive - best)
        ipopt = np.mean([each.ipopt_daf for each in found])
        print(
            f"{3.6 * speed:4.0f}  {passive:7.4f}  {hooked:10.4f}  {ipopt:11.4f}  {best:11.4f}"
            f"  {closed:20.0%}  {np.mean(times):10.1f} ({max(times):4.1f})",
            flush=True,
        )


if __name__ == "__main__":
    main()
