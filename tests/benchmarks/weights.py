"""Print the front of bridgehook's weights: mean DAF against ride, travel and tire forces.

Run ``python tests/benchmarks/weights.py [--roads N] [--plot FIGURE.png]`` from the top of the
repository: 50 roads of class A and 50 of B (a minute or two) at 70, 90 and 108 km/h, the paper's
bridge and truck from 60 m before it, c from 1 to 30 kN s/m. Ride is the W_k-weighted RMS
acceleration, travel the largest one, load the RMS of the tire force's deviation, each in its mean
over roads and speeds, and over that of the passive truck. DAFs have the 95 % interval of their
difference from passive, by road.
"""

from __future__ import annotations

import timing  # isort: skip  # noqa: F401  # before numpy, for it limits the threads

import argparse
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

import bridgectl as bc
from bridgectl.dampers import bridgehook, passive, simulate_loop
from bridgectl.measures import dynamic_load_coefficient, weighted_rms
from bridgectl.measures.history import largest, rms
from bridgectl.plots.style import BLACK, BLUE, GREY, VERMILLION, styled
from bridgectl.road import iso8608_elevations

BEAM, TRUCK = bc.li2006.beam(), bc.li2006.car()
SPEEDS = np.array([70, 90, 108]) / 3.6
SOFT, STIFF = 1e3, 30e3
STATIONS = -60 + 0.1 * np.arange(851)
SEEDS = {"A": 20_011, "B": 20_012}
SAMPLE_TIME = 2e-3
RIDES = [0.0, *(0.05 * 2.0 ** np.arange(8))]
TIRES = [0.0, 8.0]
LIMITS = [1.1, 1.3, 1.5, 2.0]
OTHERS = [
    *({"ride": r, "travel": t} for r in (0.0, 0.2, 0.8) for t in (0.003, 0.01, 0.03)),
    *({"tire_force": f} for f in (1.0, 5.0, 25.0)),
]
CONSTANTS = [1e3, 2e3, 3e3, 5e3, 7e3, 10e3, 15e3, 20e3, 30e3]
SHORT = 0.002
"""Of the ratio by which the limit is kept clear of, for ratios between those tried."""
STYLES = [
    {"color": GREY, "marker": "."},
    {"color": BLUE, "marker": "o", "ms": 4},
    {"color": BLACK, "marker": "s", "ms": 4},
    {"color": VERMILLION, "marker": "x", "ls": ""},
]
RECORDED = ("body_acceleration", "suspension_travel", "tire_force")


class Found(NamedTuple):
    """Of roads and speeds (R, S): DAF, and weighted and plain RMS acceleration, travel and DLC."""

    daf: np.ndarray
    ride: np.ndarray
    plain: np.ndarray
    travel: np.ndarray
    load: np.ndarray

    def means(self, base):
        """Mean DAF, and the other means over those of a base."""
        return [
            self.daf.mean(),
            *(a.mean() / b.mean() for a, b in zip(self[1:], base[1:], strict=True)),
        ]


def run(damper, roads):
    """Simulate a damper."""
    found = simulate_loop(BEAM, TRUCK, damper, SPEEDS, STATIONS, roads, record=RECORDED)
    each = []
    for daf, history in zip(found.daf, found.histories, strict=True):
        ride, travel, force = (history[name] for name in RECORDED)
        load = dynamic_load_coefficient(force, TRUCK.linear.static_loads[0])
        each.append([daf, weighted_rms(ride, SAMPLE_TIME), rms(ride), largest(travel), load])
    return Found(*np.transpose(each, (1, 2, 0)))


def hook(roads, **weights):
    """Simulate bridgehook with weights."""
    return run(bridgehook(BEAM, TRUCK, SOFT, STIFF, **weights), roads)


def row(told, found, base):
    """Print a row."""
    daf, *ratios = found.means(base)
    gains = (found.daf - base.daf).mean(axis=1)
    error = 1.96 * gains.std(ddof=1) / np.sqrt(len(gains))
    speeds = "  ".join(f"{each:.3f}" for each in found.daf.mean(axis=0))
    numbers = "  ".join(f"{each:6.2f}" for each in ratios)
    print(f"{told:34}  {daf:.4f} +- {error:.4f}  {speeds}  {numbers}", flush=True)


def within(limit, base, rides):
    """Weight of the ride that brings the W_k ride to a limit, between those tried."""
    ratios = [found.means(base)[1] for found in rides.values()]
    return float(np.interp(-limit + SHORT, -np.array(ratios), list(rides)))


def study(name, n_roads):
    """Print one class; return its points by kind."""
    roads = iso8608_elevations(n_roads, name, 85, seed=SEEDS[name])
    base = run(passive(TRUCK.damping), roads)
    print(f"\n{n_roads} roads of class {name}".ljust(37), "mean DAF         ", end="  ")
    print(*(f"{3.6 * c:.0f}".ljust(5) for c in SPEEDS), "  ride   plain  travel    load", sep="  ")
    constants = {c: run(passive(c), roads) for c in CONSTANTS}
    for c, found in constants.items():
        row(f"passive {c / 1e3:g} kN s/m", found, base)
    fronts = {}
    for ratio in TIRES:
        front = f"ride, tire_force = {ratio:g} ride" if ratio else "ride alone"
        print(front)
        rides = {ride: hook(roads, ride=ride, tire_force=ratio * ride) for ride in RIDES}
        for ride, found in rides.items():
            row(f"ride={ride:.3g}", found, base)
        for limit in LIMITS:
            ride = within(limit, base, rides)
            found = hook(roads, ride=ride, tire_force=ratio * ride)
            row(f"within {limit:g} x passive: ride={ride:.3g}", found, base)
        fronts[front] = rides.values()
    others = [hook(roads, **weights) for weights in OTHERS]
    for weights, found in zip(OTHERS, others, strict=True):
        row(", ".join(f"{key}={value:g}" for key, value in weights.items()), found, base)
    kinds = {"constant dampers": constants.values(), **fronts, "other weights": others}
    return {kind: np.array([f.means(base) for f in runs]) for kind, runs in kinds.items()}


@styled
def draw(points, n_roads, path):
    """Draw ride and travel over the mean DAF, a row for each class."""
    figure = Figure(figsize=(10, 7.6), layout="constrained")
    for axes, (name, kinds) in zip(figure.subplots(2, 2), points.items(), strict=True):
        for ax, column, label in zip(
            axes, (1, 3), ("W_k-weighted ride", "largest travel"), strict=True
        ):
            for (kind, at), style in zip(kinds.items(), STYLES, strict=True):
                ax.plot(at[:, 0], at[:, column], label=kind, **style)
            ax.axhline(1.0, color=BLACK, lw=0.8, ls=":")
            ax.set(xlabel="mean DAF [-]", ylabel=f"{label}, over passive's [-]", ylim=(0.4, 2.6),
                   title=f"{n_roads} roads of class {name}")  # fmt: skip
    figure.axes[0].legend(loc="upper right", fontsize=9)
    figure.savefig(path)


def main():
    """Print the tables; draw them into the file named, if any."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--roads", type=int, default=50, help="roads of each class")
    parser.add_argument("--plot", help="file of the figure")
    given = parser.parse_args()
    points = {name: study(name, given.roads) for name in SEEDS}
    if given.plot:
        draw(points, given.roads, given.plot)


if __name__ == "__main__":
    main()
