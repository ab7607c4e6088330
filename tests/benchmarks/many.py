"""Crossings a second and core of many different vehicles at once, beside a loop over `daf`.

Run ``python tests/benchmarks/many.py [--before DIRECTORY] [--count N]`` from the top of the
repository: half a minute. Vehicles cross the paper's bridge of 25 m, with 3 modes, at 15 to 33 m/s
after 100 m of a class A road that is scaled so that tires stay down; each has other masses, springs
and dampers. DIRECTORY holds another version of the package, for its loop: that of ``git archive``.
Times are of the processor, the least of some, taken in turns. What arithmetic alone would take is
from the sums in the products of matrices, at the rate of a large product, and from the bytes that
these read, at the rate of a sum over memory.
"""

from __future__ import annotations

from timing import timed  # isort: skip  # before numpy, for it limits the threads

import argparse
import cProfile
import os
import pstats
import subprocess
import sys
import tempfile
import time
import warnings

import numpy as np

import bridgectl as bc

START = -100.0
KINDS = {"quarter-car": None, "two-axle": "T2", "five-axle": "T5air"}
PARTS = (
    "mass_matrix", "damping_matrix", "stiffness_matrix", "tire_stiffnesses", "tire_offsets",
    "tire_map", "heave",
)  # fmt: skip
ASKED = {"quarter-car": 1725, "two-axle": 860, "five-axle": 385}
SINGLE = 20
"""Crossings of the loop."""


def parts(kind):
    """What a vehicle is made of, which every version of the package knows."""
    name = KINDS[kind]
    one = (bc.trucks.load(name) if name else bc.li2006.car()).linear
    return {part: getattr(one, part) for part in PARTS}


def drawn(one, count, seed):
    """Vehicles like one, each with other masses, springs and dampers."""
    found, rng = [], np.random.default_rng(seed)
    for factors in rng.uniform(0.8, 1.2, (count, 3)):
        own = {part: by * one[part] for part, by in zip(PARTS, factors, strict=False)}
        found.append(bc.Vehicle(**{**one, **own}))
    return found


def road():
    """The road, whose tires stay down."""
    rough = bc.iso8608_profile("A", 125.1, seed=1, start=START)
    return bc.RoadProfile(rough.x, 0.3 * rough.elevation)


def loop(beam, vehicles, speeds, profile):
    """Crossings one by one."""
    return np.array(
        [
            bc.daf(beam, vehicle, float(speed), profile, start=START)[0]
            for vehicle, speed in zip(vehicles, speeds, strict=True)
        ]
    )


def seconds_of_loop(one):
    """Time of a crossing in the loop [s]."""
    vehicles, speeds = drawn(one, SINGLE, 0), np.linspace(15, 33, SINGLE)
    given = bc.li2006.beam(), vehicles, speeds, road()
    return timed(lambda: loop(*given), clock=time.process_time, warm=True) / SINGLE


def before(directory, one):
    """The same of another version of the package."""
    code = "import many, numpy, sys; print(many.seconds_of_loop(dict(numpy.load(sys.argv[1]))))"
    paths = os.pathsep.join([directory, os.path.dirname(os.path.abspath(__file__))])
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "vehicle.npz")
        np.savez(file, **one)
        told = subprocess.run(
            [sys.executable, "-W", "ignore", "-c", code, file], capture_output=True, text=True,
            env=os.environ | {"PYTHONPATH": paths}, check=True, cwd=directory,
        )  # fmt: skip
    return float(told.stdout)


def sums(one):
    """Sums in the products of matrices of a crossing, and bytes of matrices that they read."""
    n, tires = 2 * one.n_coordinates, one.n_tires
    rows, stages = 3 * tires, 3 * tires  # a kink a tire and cell
    approach, bridge = round(-START / 0.1), round((25 + one.tire_offsets.max()) / 0.1)
    step = (stages + n) * n + stages**2 + (stages + n) * stages
    count = approach * (n * n + n * rows + 2 * tires * (n + rows)) + bridge * (
        step + (stages + n) * rows
    )
    return 2 * count, 8 * (approach * n * n + bridge * step)


def rates():
    """Sums a second of a large product, and bytes a second of a sum over memory."""
    square, line = np.random.default_rng(0).random((700, 700)), np.ones(8_000_000)
    product = 2 * 700**3 / timed(lambda: square @ square, clock=time.process_time, warm=True)
    return product, line.nbytes / timed(line.sum, clock=time.process_time, warm=True)


def measure(kind, count, directory):
    """Print the rates of a kind of vehicle, and how far the two ways are apart."""
    beam, profile = bc.li2006.beam(), road()
    speeds = np.random.default_rng(1).uniform(15, 33, count)
    many, single, older, one = [], [], [], parts(kind)
    for turn in range(3):
        vehicles = drawn(one, count, turn)
        begin = time.process_time()
        found = bc.daf(beam, vehicles, speeds, profile, start=START)
        many.append((time.process_time() - begin) / count)
        single.append(seconds_of_loop(one))
        if directory:
            older.append(before(directory, one))
    apart = np.abs(found[:SINGLE] - loop(beam, vehicles[:SINGLE], speeds[:SINGLE], profile)).max()
    times = f" before {1 / min(older):5.0f} ({min(older) / min(many):.1f} x)" if older else ""
    (count_sums, count_bytes), (product, memory) = sums(vehicles[0]), rates()
    print(
        f"{kind:12} {1 / min(many):6.0f} a second (asked {ASKED[kind]}); loop "
        f"{1 / min(single):5.0f} ({min(single) / min(many):.1f} x){times}; apart by {apart:.1e}\n"
        f"{'':12} {count_sums / 1e6:.2f} million sums: {count_sums / product / min(many):.1%} of "
        f"the time at {product / 1e9:.0f} thousand million a second; {count_bytes / 1e6:.2f} MB: "
        f"{count_bytes / memory / min(many):.1%} at {memory / 1e9:.0f} GB/s",
        flush=True,
    )


def profiled(kind, count):
    """Print where the time of many crossings goes."""
    vehicles, speeds = drawn(parts(kind), count, 0), np.linspace(15, 33, count)
    profile = cProfile.Profile()
    profile.runcall(bc.daf, bc.li2006.beam(), vehicles, speeds, road(), start=START)
    stats = pstats.Stats(profile)
    total = stats.total_tt
    own = sorted(stats.stats.items(), key=lambda item: -item[1][2])[:10]
    print(f"\n{kind}, {count} crossings in {total:.2f} s under the profiler:")
    for (file, _, name), (_, calls, spent, _, _) in own:
        print(f"  {spent / total:5.1%}  {os.path.basename(file)} {name}, {calls} calls")


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--before", help="directory of another version of the package")
    parser.add_argument("--count", type=int, default=600, help="crossings at once")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    for kind in KINDS:
        measure(kind, given.count, given.before)
    for kind in KINDS:
        profiled(kind, given.count)


if __name__ == "__main__":
    main()
