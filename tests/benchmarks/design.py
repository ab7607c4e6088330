"""Design dampers by the DAE of a road class, and by simulated DAFs; compare them on fresh roads.

Run ``python tests/benchmarks/design.py [--classes A] [--pairs N] [--plot FIGURE.png]`` from the
top of the repository: some minutes a class. The paper's truck starts in equilibrium 60 m before the
paper's bridge; c is from 1 to 30 kN s/m. Three dampers are tuned at 5 speeds for roads of class A,
and again for B:

- a program c(x) of 12 knots, from 7 kN s/m, by exact gradients and L-BFGS-B;
- clipped linear: c = F / v within its bounds, F = g_d d + g_b y_s' + g_a y_t' with the travel d,
  from the passive F = 7 kN s/m (y_s' - y_t');
- bridgehook with factors on its terms, sigma = s(x) + g_b b(x) y_s' + g_a a(x) y_t', from
  g_b = g_a = 0; g_b = g_a = 1 is bridgehook as it was derived.

DIRECT seeks the gains of the last two around the start, Nelder-Mead goes on from its best.

Each is tuned on the mean of the second-order DAE over the class, and on the mean DAF of many and of
few training roads. Judge is the mean DAF of other roads at 13 speeds, of which 8 are new. All roads
come with their mirror images; times are processor times of one core.
"""

from __future__ import annotations

import timing  # isort: skip  # noqa: F401  # before numpy, for it limits the threads

import argparse
import time
from functools import cache, partial
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import direct, minimize

import bridgectl as bc
from bridgectl._progress import track
from bridgectl.dampers import clipped_lqr, passive, program, program_sensitivity, simulate_loop
from bridgectl.dampers.bridgehook import Bridgehook, _feedback_law
from bridgectl.dampers.peak_value import peak_value
from bridgectl.plots.style import (
    BLUE,
    BRIDGE_TINT,
    GREY,
    SKY,
    SPEED_LABEL,
    STATION_LABEL,
    VERMILLION,
    styled,
)
from bridgectl.road import iso8608_elevations
from bridgectl.scoring.agreement import paired

BEAM, TRUCK = bc.li2006.beam(), bc.li2006.car()
SOFT, STIFF = 1e3, 30e3
TUNED, JUDGED = np.arange(60, 121, 15) / 3.6, np.arange(60, 121, 5) / 3.6
X = -60 + 0.1 * np.arange(851)
EVERY = 10
KNOTS = np.array([-30.0, -20, -12, -6, -2, 1, 4, 7, 10, 13, 16, 20])
PAIRS = {"program": (85, 5), "clipped linear": (40, 5), "bridgehook": (40, 5)}
"""Pairs of training roads: so many that an evaluation costs what one of the DAE does; and few.

171 ramps a speed, with a gradient, cost as much as 75 pairs; of a law, as 20 to 30, for most of the
time then goes into the steps themselves.
"""
EVALUATIONS = 50
SEEDS = {"A": 30_001, "B": 30_002}
"""Of the training roads; the fresh ones have 10 000 more."""


class Weighted(Bridgehook):
    """Bridgehook with factors on the terms of body and axle velocity."""

    def __init__(self, body, axle):
        self.factors = {"body": body, "axle": axle}
        super().__init__(BEAM, TRUCK, SOFT, STIFF)

    def _made(self, speed):
        found = worth(speed)
        terms = {name: factor * getattr(found, name) for name, factor in self.factors.items()}
        return _feedback_law(found._replace(**terms), self)


@cache
def worth(speed):
    return peak_value(BEAM, TRUCK, speed, SOFT, STIFF)


def mirrored(n_pairs, iso_class, seed):
    """Elevations of roads, and after them of their mirror images."""
    roads = iso8608_elevations(n_pairs, iso_class, 85, seed=seed)
    return np.vstack([roads, -roads])


def clipped_linear(travel, body, axle):
    """The clipped regulator with gains of one's own, on the travel, body and axle velocities."""
    return clipped_lqr(TRUCK, SOFT, STIFF).with_gains(
        travel_gain=-1e5 * travel, deflection_gain=0.0, body_gain=-1e4 * body,
        axle_gain=-1e4 * axle,
    )  # fmt: skip


LAWS = {
    "clipped linear": (clipped_linear, TRUCK.damping / 1e4 * np.array([0.0, 1.0, -1.0]), 20.0),
    "bridgehook": (Weighted, np.zeros(2), 4.0),
}
"""Laws of some gains, where their tuning starts, and how far from there it looks.

Of the first in 100 kN/m and 10 kN s/m.
"""


class Design(NamedTuple):
    """A damper, what it was tuned on, and how that went."""

    kind: str
    tuned_on: str
    law: object
    values: np.ndarray = np.zeros(0)
    promised: float = np.nan
    evaluations: int = 0
    seconds: float = np.nan


def tune(kind, tuned_on, objective, search, law):
    """Let a search minimise an objective, and make a law of the best; the start comes first."""
    found = []

    def noted(values):
        result = objective(values)
        found.append(result[0] if isinstance(result, tuple) else result)
        return result

    began = time.process_time()
    best = search(noted)
    took = (time.process_time() - began) / len(found)
    return Design(kind, tuned_on, law(best.x), best.x, best.fun - found[0], len(found), took)


def tune_program(tuned_on, stations, elevations, shares):
    """A program by the exact gradient of a mean DAF, in which each road has its share."""

    def objective(logarithms):
        dampings = np.exp(logarithms)
        every = [
            program_sensitivity(BEAM, TRUCK, c, KNOTS, dampings, stations, elevations)
            for c in TUNED
        ]
        mean = np.mean([shares @ found.daf for found in every])
        return mean, np.mean([shares @ found.gradient for found in every], axis=0) * dampings

    def search(noted):
        start, bounds = np.full(KNOTS.size, np.log(TRUCK.damping)), np.log([SOFT, STIFF])
        return minimize(
            noted, start, jac=True, method="L-BFGS-B", bounds=[bounds] * KNOTS.size,
            options={"maxfun": EVALUATIONS},
        )  # fmt: skip

    def law(logarithms):
        return program(KNOTS, np.exp(logarithms), shape="lines")

    return tune("program", tuned_on, objective, search, law)


def tune_law(kind, tuned_on, objective):
    """Gains of a law, without gradients."""
    law, start, reach = LAWS[kind]

    def search(noted):
        around = [(gain - reach, gain + reach) for gain in start]
        best = direct(noted, around, maxfun=EVALUATIONS // 2).x
        simplex = best + reach / 6 * np.eye(len(start) + 1, len(start), -1)
        options = {"maxfev": EVALUATIONS // 2, "initial_simplex": simplex, "fatol": 1e-5}
        return minimize(noted, best, method="Nelder-Mead", options=options)

    return tune(kind, tuned_on, lambda gains: objective(law(*gains)), search, lambda g: law(*g))


def ramps(iso_class):
    """Ramps as roads: stations, elevations, and the share that each DAF has in the class DAE.

    With e = (u+ + u-) / 2 - smooth at N places, most on straight lines between those computed, and
    h = sigma sqrt(N), the mean smooth + (sigma / h)^2 sum(e) is the mean of all u+ and u-.
    """
    level = bc.ramp_surface(BEAM, TRUCK, TUNED[0], approach=60, ramp_height=iso_class)
    n = len(level.positions)
    starts = np.arange(0, n, EVERY)
    kept = np.unique([*starts, *(starts + 1), n])
    drops = level.ramp_height * (np.arange(kept.size) > np.searchsorted(kept, starts)[:, None])
    shares = [np.interp(np.arange(n), starts, one).mean() / 2 for one in np.eye(starts.size)]
    return X[kept], np.vstack([-drops, drops]), np.tile(shares, 2)


def class_dae(law, iso_class):
    """Mean of the second-order DAE over a class, and over the speeds."""
    surface = bc.ramp_surface(
        BEAM, TRUCK, TUNED, approach=60, ramp_height=iso_class, both_ways=True, every=EVERY,
        damper=law,
    )  # fmt: skip
    return surface.class_dae(iso_class).mean.mean()


def mean_daf(law, roads):
    return simulate_loop(BEAM, TRUCK, law, TUNED, X, roads).daf.mean()


def tunings(iso_class, seed):
    """The tunings of a class, calls that return designs."""
    yield partial(tune_program, "class DAE", *ramps(iso_class))
    for n in PAIRS["program"]:
        roads = mirrored(n, iso_class, seed)
        yield partial(tune_program, f"DAF, {n} pairs", X, roads, np.full(2 * n, 0.5 / n))
    for kind in LAWS:
        yield partial(tune_law, kind, "class DAE", partial(class_dae, iso_class=iso_class))
        for n in PAIRS[kind]:
            roads = mirrored(n, iso_class, seed)
            yield partial(tune_law, kind, f"DAF, {n} pairs", partial(mean_daf, roads=roads))


def measure(iso_class, n_pairs, seed):
    """All designs, the untuned ones first; the class DAE of each; DAFs (designs, speeds, pairs)."""
    designs = [
        Design("program", "start: passive", passive(TRUCK.damping)),
        Design("clipped linear", "start: as passive", clipped_linear(*LAWS["clipped linear"][1])),
        Design("bridgehook", "start: g = 0, 0", Weighted(0.0, 0.0)),
        Design("bridgehook", "as derived: g = 1, 1", Weighted(1.0, 1.0)),
    ]
    calls = list(tunings(iso_class, SEEDS[iso_class] + seed))
    designs += [call() for call in track(calls, f"Tuning, class {iso_class}", len(calls))]
    roads = mirrored(n_pairs, iso_class, SEEDS[iso_class] + 10_000)
    daes, dafs = [], []
    for design in track(designs, f"Judging, class {iso_class}", len(designs)):
        daes.append(class_dae(design.law, iso_class))
        dafs.append(simulate_loop(BEAM, TRUCK, design.law, JUDGED, X, roads).daf)
    return designs, daes, np.reshape(dafs, (len(designs), JUDGED.size, 2, n_pairs)).mean(axis=2)


def starts(designs):
    """Number of the start of each design."""
    kinds = [design.kind for design in designs]
    return [kinds.index(kind) for kind in kinds]


def interval(differences):
    found = paired(differences)
    return f"{found.mean:+.4f} ({found.low:+.4f} to {found.high:+.4f})"


def report(iso_class, designs, daes, dafs):
    """Print a class."""
    per_pair, own = dafs.mean(axis=1), starts(designs)
    print(f"\nclass {iso_class}: mean DAF of {dafs.shape[2]} mirror pairs of fresh roads")
    print(
        f"{'damper':14}  {'tuned on':20}  s each  evaluations  promised  class DAE  mean DAF  "
        f"{'change from the start (95 %)':30}  change from passive (95 %)"
    )
    for k in sorted(range(len(designs)), key=lambda k: [*PAIRS].index(designs[k].kind)):
        design = designs[k]
        how = f"{'':6}  {'':11}  {'':8}"
        if design.evaluations:
            how = f"{design.seconds:6.2f}  {design.evaluations:11}  {design.promised:+8.4f}"
        from_start = interval(per_pair[k] - per_pair[own[k]]) if k != own[k] else ""
        from_passive = interval(per_pair[k] - per_pair[0]) if k else ""
        print(
            f"{design.kind:14}  {design.tuned_on:20}  {how}  {daes[k]:9.4f}  "
            f"{per_pair[k].mean():8.4f}  "
            f"{from_start:30}  {from_passive}"
        )
    for kind, pairs in PAIRS.items():
        by = {d.tuned_on: k for k, d in enumerate(designs) if d.kind == kind}
        first, dae = own[by["class DAE"]], by["class DAE"]
        for n in pairs:
            other = by[f"DAF, {n} pairs"]
            gains = [(per_pair[first] - per_pair[k]).mean() for k in (dae, other)]
            print(
                f"{kind}, tuned on DAE less on DAF of {n} pairs: "
                f"{interval(per_pair[dae] - per_pair[other])}, gains {gains[0]:.4f} and "
                f"{gains[1]:.4f}"
            )
    for design in designs:
        if design.evaluations and design.kind == "program":
            knots = " ".join(f"{c / 1e3:.1f}" for c in np.exp(design.values))
            print(f"program by {design.tuned_on}, kN s/m: {knots}")
        elif design.evaluations:
            gains = ", ".join(f"{gain:.2f}" for gain in design.values)
            print(f"{design.kind} by {design.tuned_on}: gains {gains}")


def look(design):
    """Line of a design in the figure."""
    for words, colour, line, label in (
        ("start", GREY, "-", "untuned"),
        ("derived", GREY, "--", "bridgehook as derived"),
        ("class DAE", BLUE, "-", "tuned on the class DAE"),
        (" 5 pairs", SKY, "-", "on the DAF of 5 mirror pairs"),
        ("DAF", VERMILLION, "-", "on the DAF of as many pairs as cost the same"),
    ):
        if words in design.tuned_on:
            return {"color": colour, "linestyle": line, "label": label}
    raise ValueError(design.tuned_on)


@styled
def draw(found, path):
    """Draw a row for each class: programs, and what tuning does to the mean DAF, over speed.

    With 95 % intervals, of changes from the untuned damper of the same kind.
    """
    figure = Figure(figsize=(14, 3.3 * len(found)), layout="constrained")
    panels = figure.subplots(len(found), 4, sharex="col", squeeze=False)
    for row, (iso_class, (designs, _, dafs)) in zip(panels, found.items(), strict=True):
        columns = dict(zip(PAIRS, row[1:], strict=True))
        row[0].set(ylabel="damping c [kN s/m]", title=f"class {iso_class}: programs c(x)")
        row[0].axvspan(0, BEAM.length, color=BRIDGE_TINT, zorder=0)
        row[0].axhline(TRUCK.damping / 1e3, **look(designs[0]))
        row[1].set_ylabel("change of the mean DAF [-]")
        for kind, axes in columns.items():
            axes.set_title(f"class {iso_class}: {kind}")
        for design, change in zip(designs, dafs - dafs[starts(designs)], strict=True):
            mean, low, high = np.transpose([paired(at_speed) for at_speed in change])
            line, axes = look(design), columns[design.kind]
            axes.plot(JUDGED * 3.6, mean, **line)
            axes.fill_between(JUDGED * 3.6, low, high, color=line["color"], alpha=0.15, linewidth=0)
            if design.kind == "program" and design.evaluations:
                row[0].plot(KNOTS, np.exp(design.values) / 1e3, marker="o", markersize=4, **line)
    panels[-1, 0].set(xlabel=STATION_LABEL, xlim=(KNOTS[0], BEAM.length))
    for axes in panels[-1, 1:]:
        axes.set(xlabel=SPEED_LABEL, xlim=JUDGED[[0, -1]] * 3.6)
    figure.legend(*panels[0, -1].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    figure.savefig(path)


def main():
    """Print the tables; draw them into the file named, if any."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pairs", type=int, default=100, help="pairs of fresh roads")
    parser.add_argument("--classes", default="AB", choices=("A", "B", "AB"), help="ISO classes")
    parser.add_argument("--seed", type=int, default=0, help="other training roads")
    parser.add_argument("--plot", help="file of the figure")
    given = parser.parse_args()
    found = {}
    for iso_class in given.classes:
        found[iso_class] = measure(iso_class, given.pairs, given.seed)
        report(iso_class, *found[iso_class])
    if given.plot:
        draw(found, given.plot)


if __name__ == "__main__":
    main()
