"""Assessments: crossings a second, two processes beside one, Dask beside joblib, and memory.

Run ``python tests/benchmarks/assess.py [--count N]`` from the top of the repository on two idle
cores: three minutes. N two-axle trucks (default 10 000) cross the paper's bridge after 100 m of a
class A road that is scaled so that tires stay down. Memory is that of a million crossings whose
numbers come from a file, which takes another minute: of those that were simulated no more is kept.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import timing  # noqa: F401 - one thread, before numpy

import bridgectl as bc
from bridgectl import _version
from bridgectl._parts import Parts
from bridgectl.fleet import assess as assessing
from bridgectl.fleet.study import SHARE

MILLION = 1_000_000


def fleet() -> bc.Fleet:
    """Two-axle trucks."""
    return bc.Fleet(
        {"T2": 1}, speed={"min": 15, "max": 30}, load={"min": 0.5, "max": 1.1},
        suspension={"median": 1, "log_sd": 0.2}, seed=1,
    )  # fmt: skip


def roads() -> list[bc.RoadProfile]:
    """Ten roads on which tires stay down."""
    found = [bc.iso8608_profile("A", 125, seed=k, start=-100) for k in range(10)]
    return [bc.RoadProfile(road.x, 0.2 * road.elevation) for road in found]


def seconds(count: int, **options: object) -> tuple[float, bc.Assessment]:
    """Time of an assessment."""
    begin = time.perf_counter()
    found = bc.assess(bc.li2006.beam(), fleet(), roads(), n=count, trucks_a_day=1000, **options)
    return time.perf_counter() - begin, found


def speeds(count: int) -> None:
    """Print times of one and two processes, and of Dask."""
    seconds(4 * SHARE, workers=2)  # libraries are loaded, processes started
    times = {}
    for name, options in (
        ("one process", {"workers": 1}), ("two processes", {"workers": 2}),
        ("Dask, two workers, with their start", {"workers": 2, "scheduler": "local"}),
    ):  # fmt: skip
        times[name], found = seconds(count, **options)
        print(f"{name:<40}{times[name]:7.1f} s {count / times[name]:8.0f} crossings/s")
        assert (found.columns["least_tire_force"] > 0).all()
    one, two, dask = times.values()
    print(f"two processes against one: {one / two:.2f} (at least 1.7)")
    print(f"Dask against joblib's processes: {dask / two:.2f} (at most 1.3)")


def memory() -> None:
    """Print the most memory of a million crossings read from a file, and written to a table."""
    with tempfile.TemporaryDirectory() as folder:
        file, table = Path(folder) / "million.jsonl", Path(folder) / "million.parquet"
        fill(file)
        code = (
            "import resource, sys; from assess import seconds; "
            f"found = seconds({MILLION}, resume=sys.argv[1], workers=1)[1]; "
            "found.to_parquet(sys.argv[2]); found.adr(75); "
            "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6)"
        )
        begin = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", code, str(file), str(table)], check=True, text=True,
            stdout=subprocess.PIPE, cwd=Path(__file__).parent,
        )  # fmt: skip
        size = table.stat().st_size / 1e6
        print(
            f"{MILLION} crossings from a file of {file.stat().st_size / 1e6:.0f} MB, to a table of "
            f"{size:.0f} MB: {float(done.stdout):.2f} GB at most (1 GB), "
            f"{time.perf_counter() - begin:.0f} s"
        )


def fill(path: Path) -> None:
    """Fill a file with a million crossings, of numbers as good as any."""
    study, names = assessing._study(
        bc.li2006.beam(), fleet(), roads(), "moment", 100.0, None, 1.0, 0.0, 1.0, 0
    )  # fmt: skip
    shares, rng = study.shares(MILLION), np.random.default_rng(1)
    expected = {assessing._name(own): assessing.shapes(study, own) for own in shares}
    header = study.header(names)
    with Parts(path, header, expected, assessing.FILE, in_memory=False) as parts:
        for own in shares:
            part = {
                name: 1 + rng.random(shape)
                for name, shape in expected[assessing._name(own)].items()
            }
            whole = {"kind": int, "n_axles": int, "road": int, "meeting": bool}
            part |= {name: np.zeros(part[name].shape, kind) for name, kind in whole.items()}
            parts.keep(*assessing._name(own), part)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=10_000)
    asked = parser.parse_args()
    print(f"bridgectl {_version.__version__}, shares of {SHARE}")
    speeds(asked.count)
    memory()
