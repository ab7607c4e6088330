"""Compare bridgehook with passive dampers over speeds, on random roads of ISO classes A and B.

Run ``python tests/benchmarks/bridgehook.py [--roads N] [--plot FIGURE.png]`` from the top of the
repository: 200 roads of each class take some minutes. The paper's truck starts in equilibrium 60 m
before the paper's bridge; c is from 1 to 30 kN s/m, sampled every 2 ms.
"""

from __future__ import annotations

import timing  # isort: skip  # noqa: F401  # before numpy, for it limits the threads

import argparse
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

import bridgectl as bc
from bridgectl.dampers import Damper, bridgehook, passive, simulate_loop
from bridgectl.plots.style import BLACK, BLUE, GREY, SPEED_LABEL, VERMILLION, styled
from bridgectl.road import iso8608_elevations

BEAM, TRUCK = bc.li2006.beam(), bc.li2006.car()
SOFT, STIFF = 1e3, 30e3
CONSTANTS = [1e3, 2e3, 4e3, 7e3, 12e3, 20e3, 30e3]
KMH = np.arange(60, 121, 2)
SPEEDS = KMH / 3.6
X = -60 + 0.1 * np.arange(851)
SEEDS = {"A": 20_001, "B": 20_002}
LAG, NOISE = 0.01, 0.05


def constant_dampers(roads):
    """Mean DAF over roads of each constant damper, (constants, speeds)."""
    dampings = [*CONSTANTS, TRUCK.damping]
    surfaces = (
        bc.ramp_surface(BEAM, replace(TRUCK, damping=c), SPEEDS, approach=60) for c in dampings
    )
    return np.array([surface.superposed_daf(roads).mean(axis=0) for surface in surfaces])


def closed_loops(damper, roads):
    """DAF, (speeds, roads)."""
    return simulate_loop(BEAM, TRUCK, damper, SPEEDS, X, roads).daf


def disturbed(law, roads):
    """The law with lag and with noise, a share of the RMS velocity of body and axle."""
    names = ("body_velocity", "axle_velocity")
    run = simulate_loop(
        BEAM, TRUCK, passive(TRUCK.damping), SPEEDS[::10], X, roads[:20], record=names
    )
    rms = np.sqrt(np.mean([(h[name] ** 2).mean() for h in run.histories for name in names]))
    return Damper(law, sample_time=2e-3, lag=LAG, velocity_noise=NOISE * rms)


def measure(n_roads):
    """Mean DAFs of each class by name, (speeds,), and of bridgehook its standard error."""
    simple, law, early = (
        bridgehook(BEAM, TRUCK, SOFT, STIFF, **options)
        for options in ({"feedback": False}, {}, {"lag": LAG})
    )
    found = {}
    for name, seed in SEEDS.items():
        roads = iso8608_elevations(n_roads, name, 85, seed=seed)
        *constants, own = constant_dampers(roads)
        every = closed_loops(law, roads)
        found[name] = {
            "passive": own,
            "constant": np.min(constants, axis=0),
            "c": np.array(CONSTANTS)[np.argmin(constants, axis=0)],
            "simple": closed_loops(simple, roads).mean(axis=1),
            "bridgehook": every.mean(axis=1),
            "disturbed": closed_loops(disturbed(law, roads), roads).mean(axis=1),
            "early": closed_loops(disturbed(early, roads), roads).mean(axis=1),
            "error": every.std(axis=1) / np.sqrt(n_roads),
        }
    return found


def report(name, means):
    """Print one class."""
    print(f"\nclass {name}, mean DAF (* worse than passive)")
    columns = ("best constant  c [kN s/m]", "without feedback", "bridgehook", "lag and noise")
    print("km/h  passive", *columns, "made up for", sep="  ")
    own = means["passive"]
    for i, speed in enumerate(KMH):
        marks = [
            f"{means[key][i]:.3f}{'*' if means[key][i] > own[i] else ' '}"
            for key in ("simple", "bridgehook", "disturbed", "early")
        ]
        print(
            f"{speed:4}  {own[i]:7.3f}  {means['constant'][i]:13.3f}  {means['c'][i] / 1e3:10.0f}  "
            f"{marks[0]:>16}  {marks[1]:>10}  {marks[2]:>13}  {marks[3]:>11}"
        )
    worst = own.max() - 1
    print(f"passive: largest {own.max():.3f}, at {KMH[own.argmax()]} km/h")
    for key in ("constant", "simple", "bridgehook", "disturbed", "early"):
        top, over = means[key].max(), means[key] - own
        harm = f"at most {over.max():.3f} worse than passive, at {KMH[over.argmax()]} km/h"
        print(
            f"{key}: largest {top:.3f}, at {KMH[means[key].argmax()]} km/h, increment "
            f"{(top - 1) / worst:.2f} of passive; mean over speeds {means[key].mean():.3f} "
            f"({own.mean():.3f}); {harm if over.max() > 0 else 'nowhere worse than passive'}"
        )
    for key, what in (("disturbed", ""), ("early", ", the lag made up for,")):
        top = (own.max() - means[key].max()) / (own.max() - means["bridgehook"].max())
        mean = (own - means[key]).mean() / (own - means["bridgehook"]).mean()
        print(
            f"lag of {LAG} s and noise of {NOISE:.0%}{what} leave {top:.2f} of the gain in the "
            f"largest mean DAF, {mean:.2f} of that over all speeds"
        )
    print(f"standard error of bridgehook's means: at most {means['error'].max():.4f}")


@styled
def draw(found, n_roads, path):
    """Draw mean DAF over speed, a panel for each class."""
    figure = Figure(figsize=(9, 3.8), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    lines = [
        ("passive", {"color": BLACK}, "passive, 7 kN s/m"),
        ("constant", {"color": GREY, "linestyle": "--"}, "best constant of each speed"),
        ("simple", {"color": BLUE, "linestyle": ":"}, "bridgehook without feedback"),
        ("bridgehook", {"color": BLUE, "linewidth": 2.2}, "bridgehook"),
        ("disturbed", {"color": VERMILLION}, "bridgehook, with lag and noise"),
        ("early", {"color": VERMILLION, "linestyle": "--"}, "the same, lag made up for"),
    ]
    for axes, (name, means) in zip(panels, found.items(), strict=True):
        for key, style, label in lines:
            axes.plot(KMH, means[key], label=label, **style)
        half = (1 + means["passive"].max()) / 2
        axes.axhline(half, color=GREY, linewidth=0.8)
        label = "half of passive's largest"
        axes.text(84, half + 0.003, label, ha="center", fontsize=8, color=GREY)
        axes.set(xlabel=SPEED_LABEL, title=f"{n_roads} roads of class {name}", xlim=KMH[[0, -1]])
    panels[0].set_ylabel("mean DAF of the moment [-]")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    figure.savefig(path)


def main():
    """Print the tables; draw them into the file named, if any."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--roads", type=int, default=200, help="roads of each class")
    parser.add_argument("--plot", help="file of the figure")
    given = parser.parse_args()
    found = measure(given.roads)
    for name, means in found.items():
        report(name, means)
    if given.plot:
        draw(found, given.roads, given.plot)


if __name__ == "__main__":
    main()
