"""Measure what docstrings tell of laws, constants and intervals, and no other benchmark prints.

Run ``python tests/benchmarks/choices.py NAME [...] [--roads N]`` from the top of the repository:
minutes each. NAME is one of

- laws: tire force and ride on a rigid road; lqr: a regulator of the truck beside those of its legs;
- hook: constants of bridgehook; deviation: bridgehook on another bridge than it was made for;
- rollout: the soft maximum of rollouts; clairvoyant: shorter steps of the optimum;
- bound: gap, time and splitting of proven bounds;
- intervals: how often those of characteristic effects and of their ratio hold the true value.

The paper's truck and bridge, 60 m of approach, c from 1 to 30 kN s/m, unless said otherwise.
"""

from __future__ import annotations

import timing  # isort: skip  # noqa: F401  # before numpy, for it limits the threads

import argparse
import time
from dataclasses import replace
from functools import partial
from unittest.mock import patch

import numpy as np
from scipy import stats
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
ROADS = {"laws": 36, "lqr": 20, "hook": 50, "deviation": 40, "rollout": 16, "clairvoyant": 3,
         "bound": 20, "intervals": 60}  # fmt: skip
"""How many; of `laws` each has 1 km, and intervals are of samples."""

YEARS = 1000.0
"""Of characteristic effects, with 1000 trucks on each of 250 days."""


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
            print(f"class {of_class}, {law.name:26}  DLC {found[0]:.4f}  a {found[1]:.3f}  J {j:.3f}")


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
    kmh, five = np.arange(60, 121, 5), truck_of("T5air")
    changes = {
        **{f"beta {beta}": (f"{module}.peak_values", partial(values, sharpness=beta), TRUCK)
           for beta in (7.0, 14.0)},
        **{f"v_0 {v}": (f"{module}.peak_values", partial(values, yield_speed=v), TRUCK)
           for v in (0.25, 0.7)},
        "48 knots": (f"{module}.KNOTS", 48, TRUCK),
        **{f"v_m {v}": ("bridgectl.dampers.peak_value.OTHERS_SPEED", v, five)
           for v in (0.05, 0.12)},
    }  # fmt: skip
    for of_class in "AB":
        roads, first = elevations(n, of_class), {}
        for title, (name, value, truck) in changes.items():
            bounds = (SOFT, STIFF) if truck is TRUCK else (2e3, STIFF)
            some = kmh if truck is TRUCK else kmh[::2]
            run = partial(dafs, roads=roads, kmh=some, truck=truck)
            if id(truck) not in first:
                first[id(truck)] = run(bridgehook(BEAM, truck, *bounds))
            with patch(name, value):
                change = run(bridgehook(BEAM, truck, *bounds)) - first[id(truck)]
            print(f"class {of_class}, {title:9}  mean over speeds {change.mean():+.4f}, of a speed at "
                  f"most {abs(change.mean(axis=1)).max():.4f}")  # fmt: skip


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
            print(f"held {held * 1e3:g} ms, {kmh} km/h: gap at most {max(gaps):.5f}, {min(times):.1f} to "
                  f"{max(times):.1f} s, splitting {np.mean(apart):.4f}, at most {max(apart):.4f}",
                  flush=True)  # fmt: skip


def intervals(n):
    """Print how many intervals of 1000 years hold the true value, with and without DEGREES."""
    rng_of, share = np.random.default_rng, 1 / (YEARS * 250 * 1000)
    parents = {
        "exponential": stats.expon(), "Gumbel": stats.gumbel_r(10, 2), "normal": stats.norm(10, 2),
        "Weibull 1.5": stats.weibull_min(1.5, scale=300.0), "Pareto": stats.genpareto(-0.2, 5, 2),
        "Weibull 2": stats.weibull_min(2, scale=300.0),
    }  # fmt: skip
    for method in METHODS:
        rule = Rule(method, YEARS, 1000.0, 250.0)
        for degrees in (2, 1):
            tails = patch("bridgectl.fleet.tails.DEGREES", degrees)
            with tails, patch("bridgectl.fleet.levels.DEGREES", degrees):
                for title, parent in parents.items():
                    found = [rule.reading(parent.rvs(10_000, random_state=rng_of(k))).estimate
                             for k in range(n)]  # fmt: skip
                    held = np.mean([low <= parent.isf(share) <= high for _, low, high in found])
                    print(f"{method}, {degrees} degrees, {title}: {held:.0%} of {n}", flush=True)
                held = np.mean([ratio_is_held(rule, share, rng_of(k)) for k in range(n)])
                print(f"{method}, {degrees} degrees, ratio: {held:.0%} of {n}", flush=True)


def ratio_is_held(rule, share, rng):
    """Whether it is: static effects up to 1, of a shape of -0.2, times 1 + 0.05 exponential."""
    static, more = stats.genpareto(-0.2, 0.0, 0.2), stats.expon(scale=0.05)
    middle = static.isf((np.arange(200_000) + 0.5) / 200_000)

    def exceeded(total):
        return np.mean(more.sf(total / middle - 1))

    from scipy.optimize import brentq

    known = brentq(lambda x: np.log(exceeded(x) / share), 0.9, 3.0) / static.isf(share)
    s = static.rvs(10_000, random_state=rng)
    found = ratio(rule.reading(s * (1 + more.rvs(10_000, random_state=rng))), rule.reading(s))
    return found.low <= known <= found.high


MEASURED = {"laws": laws, "lqr": lqr, "hook": hook, "deviation": deviation, "rollout": rollout,
            "clairvoyant": optimum, "bound": bound, "intervals": intervals}  # fmt: skip


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
