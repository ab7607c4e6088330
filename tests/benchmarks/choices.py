"""Measure what docstrings tell of laws, constants and intervals, and no other benchmark prints.

Run ``python tests/benchmarks/choices.py NAME [...] [--roads N]`` from the top of the repository:
minutes each. NAME is one of

- laws: tire force and ride on a rigid road; lqr: a regulator of the truck beside those of its legs;
- hook: constants of bridgehook; others: one of them at a truck of five axles;
- deviation: bridgehook on another bridge than it was made for;
- rollout: the soft maximum of rollouts; clairvoyant: shorter steps of the optimum;
- bound: gap, time and splitting of proven bounds;
- steps: what a road loses that is measured at long steps;
- intervals: how often those of characteristic effects hold the true value; ratios: of a ratio.

The paper's truck and bridge, 60 m of approach, c from 1 to 30 kN s/m, unless said otherwise.
"""

from __future__ import annotations

import timing  # isort: skip  # noqa: F401  # before numpy, for it limits the threads

import argparse
import time
import warnings
from dataclasses import replace
from functools import partial
from unittest.mock import patch

import numpy as np
from scipy import stats
from scipy.optimize import brentq
from trucks import truck_of

import bridgectl as bc
from bridgectl import dampers
from bridgectl.dampers import Damper, bridgehook, clairvoyant, damper_bound, passive, simulate_loop
from bridgectl.dampers.each_leg import at_each_leg, corners
from bridgectl.dampers.lqr import equal_weights
from bridgectl.fleet.levels import Rule, ratio
from bridgectl.fleet.tails import METHODS
from bridgectl.road import iso8608_elevations

CASE = BEAM, TRUCK, SOFT, STIFF = bc.li2006.beam(), bc.li2006.car(), 1e3, 30e3
KMH = np.array([70, 90, 108])
X = -60 + 0.1 * np.arange(851)
ROADS = {
    "laws": 36, "lqr": 20, "hook": 50, "others": 50, "deviation": 40, "rollout": 16, "bound": 20,
    "clairvoyant": 3, "steps": 12, "intervals": 100, "ratios": 20,
}  # fmt: skip
"""How many; of `laws` each has 1 km, and intervals and ratios are of samples."""


def elevations(n, of_class, length=85, seed=70_000):
    """Random roads of a class."""
    return iso8608_elevations(n, of_class, length, seed=seed)


def dafs(law, roads, *, kmh=KMH, bridge=BEAM, truck=TRUCK):
    """DAF, (speeds, roads)."""
    return simulate_loop(bridge, truck, law, kmh / 3.6, X, roads).daf


def on_rock(law, roads):
    """Dynamic load coefficient and RMS body acceleration [m/s^2] before the bridge, at 25 m/s."""
    names = ["tire_force", "body_acceleration"]
    kept = simulate_loop(BEAM, TRUCK, law, 25.0, -1000 + 0.1 * np.arange(10_251), roads,
                         record=names).histories[0]  # fmt: skip
    force, body = (kept[name][..., 2000:-500] for name in names)  # samples of 2 ms
    return np.std(force) / TRUCK.linear.static_loads[0], np.sqrt(np.mean(body**2))


def laws(n):
    """Print DLC, RMS acceleration and J of laws for the road."""
    lqr = partial(dampers.clipped_lqr, TRUCK, SOFT, STIFF)
    weight = equal_weights(TRUCK)[1]
    every = [
        passive(7e3), passive(16.5e3), dampers.extended_groundhook(SOFT, STIFF, vehicle=TRUCK),
        dampers.selective_groundhook(SOFT, STIFF, vehicle=TRUCK),
        dampers.tire_groundhook(SOFT, STIFF), lqr(),
        lqr(tire_deflection=3 * weight).renamed("clipped LQR, 3 q_3"),
    ]  # fmt: skip
    for of_class in "AB":
        roads, first = elevations(n, of_class, 1025), None
        for law in every if of_class == "A" else every[:3]:
            found = np.array(on_rock(law, roads))
            first = found if first is None else first
            j = found / first @ [1, 0.5]
            print(
                f"class {of_class}, {law.name:26}  DLC {found[0]:.4f}  a {found[1]:.3f}  J {j:.3f}"
            )


def lqr(n):
    """Print J of clipped regulators of whole trucks over that of those of their legs, class B."""
    roads, names = elevations(n, "B"), ["body_acceleration", "suspension_travel", "tire_force"]
    for name in ("T2", "T5air", "T2A01"):
        truck, costs = truck_of(name), []
        weights = np.array([equal_weights(car) for car in corners(truck)]).T
        for law in (
            dampers.clipped_lqr(truck, SOFT, STIFF),
            at_each_leg(lambda car: dampers.clipped_lqr(car, SOFT, STIFF), truck),
        ):
            kept = simulate_loop(BEAM, truck, law, 25.0, X, roads, record=names).histories[0]
            loads, stiffness = truck.static_loads, truck.tire_stiffnesses
            pressed = (kept["tire_force"] - loads[:, None, None]) / stiffness[:, None, None]
            a, d, e = (np.mean(part**2, axis=(1, 2)) for part in (
                kept["body_acceleration"], kept["suspension_travel"], pressed))  # fmt: skip
            costs.append(float((a + 0.1 * weights[0] * d).sum() + (weights[1] * e).sum()))
        print(f"{name}: J of the whole over that of legs {costs[0] / costs[1]:.3f}")


def hook(n):
    """Print by how much the mean DAF over roads changes with constants of bridgehook."""
    module, values = "bridgectl.dampers.bridgehook", bridgehook.__globals__["peak_values"]
    compare(n, TRUCK, {
        **{f"beta {beta}": (f"{module}.peak_values", partial(values, sharpness=beta))
           for beta in (7.0, 14.0)},
        **{f"v_0 {v}": (f"{module}.peak_values", partial(values, yield_speed=v))
           for v in (0.25, 0.7)},
        "48 knots": (f"{module}.KNOTS", 48),
    })  # fmt: skip


def others(n):
    """Print the same of how fast other dampers of a truck of five axles are taken to move."""
    name = "bridgectl.dampers.peak_value.OTHERS_SPEED"
    compare(n, truck_of("T5air"), {f"v_m {v}": (name, v) for v in (0.05, 0.12)})


def compare(n, truck, changes):
    """Print what changes of a name (and to what) do to bridgehook, 60 to 120 km/h."""
    for of_class in "AB":
        run = partial(dafs, roads=elevations(n, of_class), kmh=np.arange(60, 121, 10), truck=truck)
        first = run(bridgehook(BEAM, truck, SOFT, STIFF))
        for title, (name, value) in changes.items():
            with patch(name, value):
                change = run(bridgehook(BEAM, truck, SOFT, STIFF)) - first
            error = 1.96 * change.mean(axis=0).std() / np.sqrt(n)
            print(f"class {of_class}, {title:9}  mean {change.mean():+.4f} +- {error:.4f}, of a "
                  f"speed at most {abs(change.mean(axis=1)).max():.4f}", flush=True)  # fmt: skip


def deviation(n):
    """Print what position_deviation does where nothing is wrong, and on a stiffer bridge."""
    stiffer = replace(BEAM, flexural_rigidity=1.2**2 * BEAM.flexural_rigidity)
    for bridge, title in ((BEAM, "as known"), (stiffer, "1.2 times the frequency")):
        for of_class in "AB":
            roads = elevations(n, of_class)
            own = dafs(passive(TRUCK.damping), roads, bridge=bridge)
            for d in (0.0, 0.5, 1.5):
                law = bridgehook(*CASE, position_deviation=d)
                change = (dafs(law, roads, bridge=bridge) - own).mean()
                print(f"{title}, class {of_class}, made for {d} m: {change:+.4f} from passive")


def rollout(n):
    """Print mean DAFs of soft maxima of 2^k-th powers."""
    roads = elevations(n, "A")
    for k in (3, 4, 5, 6):
        with patch("bridgectl.dampers.rollout.predict.SQUARINGS", k):
            for law in (dampers.rollout_hook(*CASE), dampers.preview_hook(*CASE)):
                means = dafs(Damper(law, 4e-3), roads).mean(axis=1).round(4)
                print(f"power {2**k}, {law.name}: mean DAF at {KMH} km/h {means}", flush=True)


def optimum(n):
    """Print by how much shorter steps change the DAF of the clairvoyant optimum."""
    for z in elevations(n, "A"):
        road = bc.RoadProfile(X, z)
        for kmh in KMH:
            found = []
            for divisor in (1, 2):
                steps = tuple(5e-3 / divisor / 2**k for k in range(3))
                with patch.dict(clairvoyant.__globals__, STEPS=steps):
                    found.append(clairvoyant(BEAM, TRUCK, kmh / 3.6, road, SOFT, STIFF, start=-60))
            print(f"{kmh} km/h: DAF {found[0].daf:.4f}, in half the steps {found[1].daf:.4f}")


def bound(n):
    """Print gaps of proven bounds, what they take, and how far closed loops are from the grid."""
    for held in (20e-3, 10e-3):
        for kmh in KMH:
            gaps, times, apart = [], [], []
            for z in elevations(n, "A"):
                start = time.process_time()
                found = damper_bound(*CASE[:2], kmh / 3.6, bc.RoadProfile(X, z), SOFT, STIFF,
                                     start=-60.0, step=held)  # fmt: skip
                times.append(time.process_time() - start)
                gaps.append(found.lowest - found.bound)
                apart.append(abs(found.splitting))
            print(
                f"held {held * 1e3:g} ms, {kmh} km/h: gap at most {max(gaps):.5f}, "
                f"{min(times):.1f} to {max(times):.1f} s, splitting {np.mean(apart):.4f}, "
                f"at most {max(apart):.4f}",
                flush=True,
            )


def steps(n):
    """Print how far IRI and DAF of class A are off by the step [m] that stations are apart."""
    fine = [
        bc.iso8608_profile("A", 230, step=0.05, seed=k, start=-200, band=(0.011, 10.0))
        for k in range(n)
    ]
    speeds = np.linspace(15.0, 35.0, 5)
    iris = np.array([road.iri() for road in fine])
    truth = [bc.daf(BEAM, TRUCK, speeds, road, start=-200) for road in fine]
    warnings.simplefilter("ignore")  # of steps that are too long, which is the point
    for step in (0.1, 0.25, 0.3, 0.5, 1.0, 2.0, 5.0):
        coarse = [road.resample(step) for road in fine]
        low = 1 - np.mean([road.iri() for road in coarse]) / iris.mean()
        errors = [
            bc.daf(BEAM, TRUCK, speeds, road, start=-200) - daf
            for road, daf in zip(coarse, truth, strict=True)
        ]
        print(f"step {step} m: IRI {low:.0%} too low, rms error of the DAF {np.std(errors):.3f}")


def intervals(n):
    """Print how many intervals of 1000 years hold the true value, of two degrees and of one."""
    parents = {
        "exponential": stats.expon(), "Gumbel": stats.gumbel_r(10, 2), "normal": stats.norm(10, 2),
        "Weibull 1.5": stats.weibull_min(1.5, scale=300.0), "Pareto": stats.genpareto(-0.2, 5, 2),
        "Weibull 2": stats.weibull_min(2, scale=300.0),
    }  # fmt: skip
    for rule, told in rules():
        for title, parent in parents.items():
            samples = [parent.rvs(10_000, random_state=np.random.default_rng(k)) for k in range(n)]
            found = [rule.reading(sample).estimate for sample in samples]
            held = np.mean([e.low <= parent.isf(1 / rule.crossings) <= e.high for e in found])
            print(f"{told}, {title}: {held:.0%} of {n}", flush=True)


def ratios(n):
    """Print the same of ratios: static effects of up to 1, times 1 and what is exponential."""
    static, more = stats.genpareto(-0.2, 0.0, 0.2), stats.expon(scale=0.05)
    s = np.linspace(0.2, 1.0, 20_001)
    for rule, told in rules():
        share, held = 1 / rule.crossings, 0

        def excess(total, share=share):
            return np.log(np.trapezoid(static.pdf(s) * more.sf(total / s - 1), s) / share)

        known = brentq(excess, 1.0, 3.0) / static.isf(share)
        for k in range(n):
            rng = np.random.default_rng(k)
            own = static.rvs(10_000, random_state=rng)
            total = own * (1 + more.rvs(10_000, random_state=rng))
            found = ratio(rule.reading(total), rule.reading(own))
            held += found.low <= known <= found.high
        print(f"{told}, ratio {known:.3f}: {held / n:.0%} of {n}", flush=True)


def rules():
    """Each way to find effects of 1000 years, 1000 trucks a working day, with what it is called."""
    for method in METHODS:
        for degrees in (2, 1):
            with (
                patch("bridgectl.fleet.tails.DEGREES", degrees),
                patch("bridgectl.fleet.levels.DEGREES", degrees),
            ):
                yield Rule(method, 1000.0, 1000.0, 250.0), f"{method}, {degrees} degrees"


MEASURED = {
    "laws": laws, "lqr": lqr, "hook": hook, "others": others, "deviation": deviation,
    "rollout": rollout, "clairvoyant": optimum, "bound": bound, "steps": steps,
    "intervals": intervals, "ratios": ratios,
}  # fmt: skip


def main():
    """Print what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="+", metavar="NAME", choices=MEASURED)
    parser.add_argument("--roads", type=int, help="roads, or samples, in place of the usual number")
    given = parser.parse_args()
    for name in given.names:
        MEASURED[name](given.roads or ROADS[name])


if __name__ == "__main__":
    main()
