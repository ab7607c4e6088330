"""What is left of a strategy's gain behind sensors, and what bridgehook bears of a wrong position.

Run ``python tests/benchmarks/sensors.py [--roads N] [--position-roads N] [--classes A]`` from the
top of the repository: a few minutes. The paper's truck starts in equilibrium 60 m before the
paper's bridge; c is from 1 to 30 kN s/m, sampled every 2 ms; 70, 90 and 108 km/h. Noise of each
sample is 0.05 m/s^2 of the accelerometers and 0.5 mm of the travel; late are all measurements by
4 ms, and the command by another 4 ms. Numbers are mean changes of the DAF from passive 7 kN s/m
over roads and speeds, with 95 % intervals of the mean over roads.
"""

from __future__ import annotations

import timing  # isort: skip  # noqa: F401  # before numpy, for it limits the threads

import argparse

import numpy as np

import bridgectl as bc
from bridgectl._progress import track
from bridgectl.dampers import Damper, Sensors, bridgehook, library, measured, passive, simulate_loop
from bridgectl.road import iso8608_elevations
from bridgectl.scoring.agreement import paired

BEAM, TRUCK = bc.li2006.beam(), bc.li2006.car()
SOFT, STIFF = 1e3, 30e3
SPEEDS = np.array([70, 90, 108]) / 3.6
X = -60 + 0.1 * np.arange(851)
SEEDS = {"A": 40_001, "B": 40_002}
NOISE = {"acceleration_noise": 0.05, "travel_noise": 0.5e-3}
LATE = {"body_acceleration": 2, "axle_acceleration": 2, "suspension_travel": 2, "command": 2}
FILTERS = {
    "accelerometers": Sensors.accelerometers(),
    "complementary": Sensors.complementary(),
    "Kalman": Sensors.kalman(TRUCK),
}
ERRORS = [0.0, -0.3, 0.3, -1.0, 1.0, -3.0, 3.0]
DEVIATIONS = [0.0, 0.3, 1.0, 3.0]


def dafs(damper, roads):
    """DAF, (speeds, roads)."""
    return simulate_loop(BEAM, TRUCK, damper, SPEEDS, X, roads).daf


def told(change):
    """Mean over speeds and roads of a change of the DAF, with its interval."""
    found = paired(change.mean(axis=0))
    return f"{found.mean:+.4f} ({found.low:+.4f} {found.high:+.4f})"


def ways(law):
    """The law, ideal and behind sensors, with what cannot be measured left out."""
    yield "ideal", law
    for name, sensors in FILTERS.items():
        delays = {key: n for key, n in LATE.items() if key in (*sensors.inputs, "command")}
        for title, options in ((name, {}), (f"{name}, late", {"delays": delays})):
            try:
                behind = measured(law, sensors, **options)
                behind.for_speed(SPEEDS[0])
            except ValueError:  # what it needs is not measured
                continue
            yield title, Damper(behind, **NOISE)


def behind_sensors(iso_class, n_roads):
    """Print what sensors leave of every strategy's change of the DAF."""
    roads = iso8608_elevations(n_roads, iso_class, 85, seed=SEEDS[iso_class])
    own = dafs(passive(TRUCK.damping), roads)
    print(f"\nclass {iso_class}, {n_roads} roads: passive {own.mean():.4f}; change from it (95 %)")
    laws = library(BEAM, TRUCK, SOFT, STIFF)[2:]  # but passive and preset, which measure nothing
    for law in track(laws, f"Strategies, class {iso_class}", len(laws)):
        first = None
        for title, damper in ways(law):
            change = dafs(damper, roads) - own
            first = change if first is None else first
            by_speed = " ".join(f"{value:+.4f}" for value in change.mean(axis=1))
            lost = "" if change is first else f"  from ideal {told(change - first)}"
            print(f"{law.name:20}  {title:20}  {told(change)}  by speed {by_speed}{lost}")


def wrong_positions(iso_class, n_roads):
    """Print what bridgehook does that is told of places with an error, and made for one."""
    roads = iso8608_elevations(n_roads, iso_class, 85, seed=SEEDS[iso_class] + 1000)
    own = dafs(passive(TRUCK.damping), roads)
    cases = [{"position_error": error} for error in ERRORS]
    cases += [{"position_deviation": deviation} for deviation in DEVIATIONS[1:]]
    laws = [bridgehook(BEAM, TRUCK, SOFT, STIFF, position_deviation=d) for d in DEVIATIONS]
    found = [
        [dafs(Damper(law, **case), roads) - own for case in cases]
        for law in track(laws, f"Positions, class {iso_class}", len(laws))
    ]
    print(f"\nclass {iso_class}, {n_roads} roads: passive {own.mean():.4f}; change from it (95 %)")
    print("error of the position".ljust(24), *(f"for {d:g} m".ljust(28) for d in DEVIATIONS))
    for k, case in enumerate(cases):
        ((name, value),) = case.items()
        title = f"{value:+g} m" if name == "position_error" else f"drawn, {value:g} m"
        print(title.ljust(24), *(told(of_law[k]).ljust(28) for of_law in found))
    for size in DEVIATIONS[1:]:
        sides = [k for k, case in enumerate(cases) if abs(case.get("position_error", 0)) == size]
        both = [np.mean([of_law[k] for k in sides], axis=0) for of_law in found]
        print(f"+-{size:g} m".ljust(24), *(told(change).ljust(28) for change in both))


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--roads", type=int, default=40, help="roads of each class, for sensors")
    parser.add_argument("--position-roads", type=int, default=120, help="and for positions")
    parser.add_argument("--classes", default="AB", choices=("A", "B", "AB"), help="ISO classes")
    given = parser.parse_args()
    for iso_class in given.classes:
        if given.roads:
            behind_sensors(iso_class, given.roads)
        if given.position_roads:
            wrong_positions(iso_class, given.position_roads)


if __name__ == "__main__":
    main()
