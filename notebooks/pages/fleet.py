"""Pictures and checks of the page on random and weighed traffic."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import bridgectl as bc
from bridgectl.plots import style
from pages.claims import hold

CODE = 1.33
"""Static load and dynamic load allowance of AASHTO LRFD, over the static load."""


def write_station(path: str, fleet: bc.Fleet) -> None:
    """Write weighed trucks as a station has them: km/h, t and cm, with decimal commas."""
    rows = [
        [f"{each.time:.3f}", f"{3.6 * each.speed:.1f}", each.vehicle.static_loads / 9.81e3,
         np.diff(each.vehicle.tire_offsets) * 100]
        for each in map(fleet.passing, range(len(fleet)))
    ]  # fmt: skip
    most = max(len(row[2]) for row in rows)
    names = [f"load_{k + 1}" for k in range(most)] + [f"spacing_{k + 1}" for k in range(most - 1)]
    with open(path, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, delimiter=";", lineterminator="\n")
        table.writerow(["time_s", "speed", *names])
        for time, speed, loads, spacings in rows:
            cells = [f"{load:.3f}" for load in loads] + [""] * (most - len(loads))
            cells += [f"{gap:.0f}" for gap in spacings] + [""] * (most - len(loads))
            table.writerow([cell.replace(".", ",") for cell in (time, speed, *cells)])


def first_lines(path: str, count: int) -> str:
    """The first lines of a text file."""
    return "\n".join(Path(path).read_text(encoding="utf-8").splitlines()[:count])


@style.styled
def trucks_of(fleet: bc.Fleet, weighed: bc.Fleet) -> Figure:
    """Weights and speeds of the trucks of a fleet, by kind, and of those that were weighed."""
    figure = Figure(figsize=(9, 3), layout="constrained")
    ax = figure.subplots()
    drawn = [fleet.passing(i) for i in range(400)]
    shown = [(kind, ".", [t for t in drawn if t.kind == kind]) for kind in fleet.kinds]
    shown.append(("weighed", "x", [weighed.passing(i) for i in range(len(weighed))]))
    for (name, marker, trucks), color in zip(shown, (*style.TRACKS[:2], style.BLACK), strict=True):
        weights = [truck.vehicle.static_loads.sum() / 1e3 for truck in trucks]
        ax.plot(weights, [3.6 * truck.speed for truck in trucks], marker, color=color, ms=5,
                label=name)  # fmt: skip
    ax.set(xlabel="weight of the truck [kN]", ylabel=style.SPEED_LABEL)
    figure.legend(loc="outside right upper")
    return figure


@style.styled
def daf_over_static(bins: Mapping[str, Any]) -> Figure:
    """Mean and spread of the DAF in bins of static moment, on each class of road."""
    figure = Figure(figsize=(10.5, 3.8), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    for ax, (quality, each) in zip(axes, bins.items(), strict=True):
        middle = (each.low + each.high) / 2e3
        low, _, high = each.quantiles
        ax.fill_between(middle, low, high, color=style.SKY, alpha=0.4, label="5 to 95 %")
        ax.plot(middle, each.mean, "o-", color=style.BLUE, label="mean")
        ax.axhline(CODE, color=style.GREY, ls="--", label="AASHTO LRFD: 1.33")
        ax.set(title=f"class {quality}", xlabel="static moment [kN m]")
    axes[0].set_ylabel("DAF [-]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


@style.styled
def changes(found: Mapping[str, Any]) -> Figure:
    """Changes of the mean DAF with their intervals."""
    figure = Figure(figsize=(8.5, 0.6 + 0.55 * len(found)), layout="constrained")
    ax = figure.subplots()
    for i, each in enumerate(found.values()):
        ends = [[each.value - each.low], [each.high - each.value]]
        ax.errorbar(each.value, -i, xerr=ends, fmt="o", color=style.BLUE, capsize=3)
    ax.axvline(0, color=style.GREY, lw=1)
    ax.set_yticks(-np.arange(len(found)), list(found))
    ax.set(ylim=(0.5 - len(found), 0.5), xlabel="change of the mean DAF, with 95 % interval [-]")
    return figure


def check(names: dict[str, Any]) -> None:
    """Assert what the page claims, by its variables."""
    n = SimpleNamespace(**names)
    row = n.found.to_pandas().iloc[7]
    truck = n.fleet.passing(row["truck"])
    own_road = n.roads["A"][int(row["road"].split()[-1]) - 1]
    alone = bc.daf(n.bridge, truck.vehicle, truck.speed, own_road, start=-100)[0]
    example = bc.Fleet.from_table("example")
    with open("crossings.csv", encoding="utf-8", newline="") as file:
        command = [float(each["total moment [N m]"]) for each in csv.DictReader(file)]
    off = np.abs(np.array(command) / n.table["total moment"] - 1).max()
    stress = n.table["total stress"] * 1.1 / n.table["total moment"]
    assert all(ratio.value < CODE for ratio in n.ratios.values())
    assert 2 * n.change["twice the damping, class B"].value > n.change["class A instead of B"].value
    assert n.ratios["A"].high < CODE < n.ratios["B"].high
    hold([
        ("row 7: DAF in the table and alone", row["daf moment"], alone, 1e-6),
        ("row 7: total over static moment", row["total moment"] / row["static moment"],
         row["daf moment"], 1e-12),
        ("weighed truck 3: first axle [kN]", n.weighed.passing(2).vehicle.static_loads[0] / 1e3,
         52.5, 0.01),
        ("trucks a day", n.weighed.per_day, example.per_day, 0.01),
        ("the command and Python: total moments", off, 0, 1e-6),
        ("modulus times stress over moment", np.abs(stress - 1).max(), 0, 1e-9),
        ("heaviest weighed truck: DAF", n.heaviest["daf moment"], 1.001, 2e-3),
        ("class B: mean DAF, lightest less heaviest bin",
         n.bins["B"].mean[0] - n.bins["B"].mean[-1], 0.123, 0.01),
        ("ADR of class A", n.ratios["A"].value, 1.05, 0.02),
        ("ADR of class B", n.ratios["B"].value, 1.15, 0.02),
        ("class A instead of B", n.change["class A instead of B"].value, -0.074, 0.002),
        ("bridgehook", n.change["bridgehook, class B"].value, -0.08, 0.02),
        ("twice the damping", n.change["twice the damping, class B"].value, -0.03, 0.01),
    ])  # fmt: skip
