"""Compare bridgehook at every axle of a truck with passive dampers and with every other law.

Run ``python tests/benchmarks/trucks.py [NAME ...] [--roads N] [--classes A] [--plot FIGURE.png]``
from the top of the repository: 100 roads of each class take some minutes a truck. The first axle
starts in equilibrium 60 m before the paper's bridge, at 60 to 120 km/h; c is from 2 to 30 kN s/m at
every axle, 0.2 to 3 times what the catalog's trucks have, sampled every 2 ms. Tires are springs
alone. Numbers are means over roads and speeds, with 95 % intervals of the mean over roads. With
--preset they have those of the law of that name, too, which knows each road, and takes far longer.
"""

from __future__ import annotations

import timing  # isort: skip  # noqa: F401  # before numpy, for it limits the threads

import argparse
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

import bridgectl as bc
from bridgectl._progress import track
from bridgectl.dampers import Damper, bridgehook, library, simulate_loop
from bridgectl.plots.style import BLACK, BLUE, SPEED_LABEL, VERMILLION, styled
from bridgectl.road import iso8608_elevations
from bridgectl.scoring.agreement import paired

BEAM = bc.li2006.beam()
TRUCKS = ("T2", "T2A01", "T5air")
SOFT, STIFF = 2e3, 30e3
KMH = np.arange(60, 121, 10)
X = -60 + 0.1 * np.arange(851)
SEEDS = {"A": 60_001, "B": 60_002}
DEVIATION = 1.0
"""What the position is wrong by, or is taken to be [m]."""


def truck_of(name):
    """A truck of the catalog without the damping of its tires, which closed loops do not have."""
    return replace(bc.trucks.load(name), tire_damping=0.0)


def dampers(truck, preset):
    """Every law by name, the truck's own dampers first, and bridgehook told of wrong places."""
    own, *others = library(BEAM, truck, SOFT, STIFF)
    hook = others.pop()
    careful = bridgehook(BEAM, truck, SOFT, STIFF, position_deviation=DEVIATION)
    found = {"passive": own, **{law.name: law for law in others[0 if preset else 1 :]}}
    found["without feedback"] = bridgehook(BEAM, truck, SOFT, STIFF, feedback=False)
    found["bridgehook"] = hook
    for law, made in ((hook, ""), (careful, f", made for {DEVIATION:g} m")):
        errors = (-DEVIATION, DEVIATION) if law is hook else (0.0, -DEVIATION, DEVIATION)
        for error in errors:
            places = f", places {error:+g} m" if error else ""
            found[f"bridgehook{made}{places}"] = Damper(law, position_error=error)
    return found


def told(change):
    """Mean of a change (speeds, roads), its interval, and the speed where it is largest."""
    found, by_speed = paired(change.mean(axis=0)), change.mean(axis=1)
    worst = f"{by_speed.max():+.3f} at {KMH[by_speed.argmax()]:3} km/h"
    return f"{found.mean:+.3f} ({found.low:+.3f} {found.high:+.3f})  {worst}"


def measure(name, iso_class, n_roads, preset):
    """DAF of each law, (speeds, roads)."""
    truck = truck_of(name)
    roads = iso8608_elevations(n_roads, iso_class, 85, seed=SEEDS[iso_class])
    every = dampers(truck, preset)
    return {
        law: simulate_loop(BEAM, truck, damper, KMH / 3.6, X, roads).daf
        for law, damper in track(every.items(), f"{name}, class {iso_class}", len(every))
    }


def report(name, iso_class, found):
    """Print how each law changes the DAF of passive dampers, and how bridgehook that of each."""
    own, hook = found["passive"], found["bridgehook"]
    print(f"\n{name}, class {iso_class}, {hook.shape[1]} roads: passive, by speed", end=" ")
    print(*(f"{daf:.3f}" for daf in own.mean(axis=1)))
    print(f"{'':38} DAF    less passive's (95 %), at worst              bridgehook less it")
    for law, daf in found.items():
        versus = "" if law.startswith("bridgehook") else told(hook - daf)
        against = "" if law == "passive" else told(daf - own)
        print(f"{law:38} {daf.mean():.3f}  {against:46}  {versus}".rstrip(), flush=True)


@styled
def draw(found, path):
    """Draw mean DAF over speed, a panel for each truck and class."""
    figure = Figure(figsize=(4.0 * len(found), 3.6), layout="constrained")
    panels = figure.subplots(1, len(found), squeeze=False)[0]
    lines = {
        "passive": (BLACK, "-"), "without feedback": (VERMILLION, ":"), "bridgehook": (BLUE, "-"),
    }  # fmt: skip
    for axes, ((name, iso_class), laws) in zip(panels, found.items(), strict=True):
        for law, (color, style) in lines.items():
            axes.plot(KMH, laws[law].mean(axis=1), color=color, linestyle=style, label=law)
        axes.set(xlabel=SPEED_LABEL, title=f"{name}, class {iso_class}", xlim=KMH[[0, -1]])
    panels[0].set_ylabel("mean DAF of the moment [-]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    figure.savefig(path)


def main():
    """Print the tables; draw them into the file named, if any."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("trucks", nargs="*", default=TRUCKS, help="names of the catalog")
    parser.add_argument("--roads", type=int, default=100, help="roads of each class")
    parser.add_argument("--classes", default="AB", choices=("A", "B", "AB"), help="ISO classes")
    parser.add_argument("--preset", action="store_true", help="with the law preset")
    parser.add_argument("--plot", help="file of the figure")
    given = parser.parse_args()
    found = {}
    for name in given.trucks:
        for iso_class in given.classes:
            found[name, iso_class] = measure(name, iso_class, given.roads, given.preset)
            report(name, iso_class, found[name, iso_class])
    if given.plot:
        draw(found, given.plot)


if __name__ == "__main__":
    main()
