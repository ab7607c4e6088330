"""Measure rollouts: gains over bridgehook on random roads, and the time of a decision.

Run ``python tests/benchmarks/rollout.py [--roads N] [--clairvoyant] [--out FILE.npz]`` from the top
of the repository: 40 roads take some minutes. The paper's truck starts in equilibrium 60 m before
the paper's bridge; c is from 1 to 30 kN s/m, sampled every 4 ms; intervals are 95 % over the roads.
With --clairvoyant the shares of the gap from passive to the optimum of class A are printed, too,
which takes some 10 s for each road and speed. The file has the DAF of every crossing, (speeds,
roads) by class and law.
"""

from __future__ import annotations

import timing  # isort: skip  # noqa: F401  # before numpy, for it limits the threads

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

import bridgectl as bc
from bridgectl.dampers import (
    SIGNALS,
    Damper,
    bridgehook,
    clairvoyant,
    passive,
    preview_hook,
    rollout_hook,
    simulate_loop,
)
from bridgectl.dampers.compiled import compiled
from bridgectl.scoring.agreement import gap_closed

CASE = BEAM, TRUCK, SOFT, STIFF = bc.li2006.beam(), bc.li2006.car(), 1e3, 30e3
KMH = np.array([70, 90, 108])
X = -60 + 0.1 * np.arange(851)
SEED, SAMPLE = 1000, 4e-3
LAWS = {
    "bridgehook": Damper(bridgehook(*CASE), SAMPLE),
    "rollout": Damper(rollout_hook(*CASE), SAMPLE),
    "5 m": Damper(preview_hook(*CASE, preview=5.0), SAMPLE),
    "10 m": Damper(preview_hook(*CASE), SAMPLE),
}
FURTHER = {
    "20 m": Damper(preview_hook(*CASE, preview=20.0), SAMPLE),
    "10 m, 1 mm": Damper(preview_hook(*CASE), SAMPLE, preview_noise=1e-3),
    "10 m, 5 mm": Damper(preview_hook(*CASE), SAMPLE, preview_noise=5e-3),
    "10 m, 10 ms": Damper(preview_hook(*CASE), SAMPLE, preview_delay=0.01),
    "10 m, 50 ms": Damper(preview_hook(*CASE), SAMPLE, preview_delay=0.05),
    "ride 0.1": Damper(preview_hook(*CASE, ride=0.1), SAMPLE),
}
"""And what else is told of, on the first roads of class A."""


def road(name, seed):
    """A random road of an ISO class."""
    return bc.iso8608_profile(name, 85, start=-60, seed=seed)


def crossings(damper, roads):
    """DAF, (speeds, roads), and the time on the processor [s]."""
    start = time.process_time()
    daf = simulate_loop(BEAM, TRUCK, damper, KMH / 3.6, X, roads).daf
    return daf, time.process_time() - start


def mapped(roads):
    """DAF with 10 m of a map, right and told of a place 0.3 m too far."""
    found = np.zeros((2, len(KMH), len(roads)))
    for k, z in enumerate(roads):
        law = preview_hook(*CASE, road_map=bc.RoadProfile(X, z))
        for i, error in enumerate((0.0, 0.3)):
            damper = Damper(law, SAMPLE, position_error=error)
            found[i, :, k] = crossings(damper, z[np.newaxis])[0][:, 0]
    return dict(zip(("map 10 m", "map 10 m, 0.3 m off"), found, strict=True))


def gained(name, daf, hook, own):
    """Print mean DAFs, and how far they are below bridgehook's and passive ones."""
    below, error = (hook - daf).mean(axis=1), (hook - daf).std(axis=1) / np.sqrt(daf.shape[1])
    told = "  ".join(
        f"{mean:.4f} ({d:+.4f} +- {1.96 * e:.4f})"
        for mean, d, e in zip(daf.mean(axis=1), below, error, strict=True)
    )
    most = (daf - own).max()
    print(f"{name:20}  {told}  below passive {(own - daf).mean():.4f}, of a crossing at most "
          f"{most:.4f} above it", flush=True)  # fmt: skip


def closed(kept, roads):
    """Print the share of the gap to the clairvoyant optimum that each law closes, with 95 %."""
    profiles = [bc.RoadProfile(X, z) for z in roads]
    best = np.array([
        [each.daf for each in of_speed]
        for of_speed in clairvoyant(BEAM, TRUCK, KMH / 3.6, profiles, SOFT, STIFF, start=X[0])
    ])  # fmt: skip
    for name, daf in kept.items():
        if not name.startswith("A "):
            continue
        few = slice(0, daf.shape[1])
        shares = [
            gap_closed(*each)
            for each in zip(kept["A passive"][:, few], daf, best[:, few], strict=True)
        ]
        print(name, *(f"{s.share:.2f} ({s.low:.2f} to {s.high:.2f})" for s in shares), sep="  ")


def decision_times(law, count=4000):
    """CPU times [s] of single decisions, at places all along the way."""
    function, rng = compiled(law.function), np.random.default_rng(0)
    sizes = {"tire_force": 5e3, "suspension_travel": 0.01, "axle_velocity": 0.3}
    rows = np.array([rng.normal(0, sizes.get(name, 0.1), count) for name in SIGNALS])
    rows[SIGNALS.index("tire_force")] += 98.1e3
    rows[SIGNALS.index("position")] = rng.uniform(-60, 25, count)
    buffer, trigger = function.buffer()
    given = [np.zeros(function.size1_in(i)) for i in range(function.n_in())]
    given[3][:] = SAMPLE
    for i, each in enumerate(given):
        buffer.set_arg(i, memoryview(each))
    results = [np.zeros(function.size1_out(i)) for i in range(function.n_out())]
    for i, each in enumerate(results):
        buffer.set_res(i, memoryview(each))
    times = np.zeros(count)
    for k, row in enumerate(rows.T):
        given[0][:] = row
        start = time.thread_time_ns()
        trigger()
        times[k] = (time.thread_time_ns() - start) * 1e-9
    return times


def main():
    """Print all; write what was measured."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--roads", type=int, default=40, help="roads of each class")
    parser.add_argument("--further", type=int, default=20, help="of them for what is beside")
    parser.add_argument("--out", help="file of the DAFs")
    parser.add_argument("--clairvoyant", action="store_true", help="shares of the gap to it")
    given = parser.parse_args()
    for name in ("rollout", "10 m"):
        for kmh in KMH[[0, 2]]:
            law = LAWS[name].strategy.for_speed(float(kmh) / 3.6)
            p50, p99 = np.percentile(1e6 * decision_times(law), [50, 99])
            with tempfile.TemporaryDirectory() as folder:
                size = law.to_c(Path(folder) / "law.c").stat().st_size / 1e3
            print(f"a decision of {name} at {kmh} km/h: p50 {p50:.0f} us, p99 {p99:.0f} us; "
                  f"in C {size:.0f} kB")  # fmt: skip
    kept = {}
    for of_class in "AB":
        roads = np.array([road(of_class, SEED + k).elevation for k in range(given.roads)])
        own, _ = crossings(Damper(passive(TRUCK.damping), SAMPLE), roads)
        hook = own
        print(f"class {of_class}, mean DAF at {KMH} km/h (below bridgehook, 95 %)")
        for name, damper in {"passive": None, **LAWS}.items():
            daf, seconds = (own, 0) if damper is None else crossings(damper, roads)
            hook = daf if name == "bridgehook" else hook
            kept[f"{of_class} {name}"] = daf
            gained(f"{name}, {seconds:.1f} s", daf, hook, own)
        if of_class == "A":
            first = slice(0, given.further)
            beside = {n: crossings(d, roads[first])[0] for n, d in FURTHER.items()}
            beside["10 m"] = kept["A 10 m"][:, first]
            for name, daf in (beside | mapped(roads[first][:10])).items():
                some = slice(0, daf.shape[1])
                gained(name, daf, kept["A bridgehook"][:, some], own[:, some])
                kept[f"A {name} (first)"] = daf
            if given.clairvoyant:
                closed(kept, roads)
        if given.out:
            np.savez(given.out, seeds=SEED + np.arange(given.roads), kmh=KMH, **kept)


if __name__ == "__main__":
    main()
