"""What every test shares: quiet plots, the reference numbers, and the paper's case."""

from __future__ import annotations

import json
import os
from pathlib import Path

import control
import matplotlib as mpl
import pytest
from hypothesis import settings

import bridgectl as bc

mpl.use("Agg")

# As many workers as cores are started after this: linear algebra of each keeps to one of them.
os.environ.setdefault("OMP_NUM_THREADS", "1")

# Examples of a property may build matrix exponentials: count them, do not time them.
settings.register_profile("bridgectl", deadline=None)
settings.load_profile("bridgectl")

CASES = Path(__file__).with_name("data") / "cases.json"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Of a test's cases, `quick_cases(n)` leaves n in the plain run, spread evenly over them all.

    The others are slow tests.
    """
    tests: dict[str, list[pytest.Item]] = {}
    for item in items:
        if item.get_closest_marker("quick_cases"):
            tests.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for cases in tests.values():
        marker = cases[0].get_closest_marker("quick_cases")
        assert marker is not None
        n, last = marker.args[0], len(cases) - 1
        quick = {k * last // max(n - 1, 1) for k in range(n)}
        for k, item in enumerate(cases):
            if k not in quick:
                item.add_marker("slow")


@pytest.fixture(scope="session")
def cases() -> dict:
    """Numbers of independent codes; tests/data/README.md tells how they were made."""
    return json.loads(CASES.read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def bridge() -> bc.Beam:
    return bc.li2006.beam()


@pytest.fixture(scope="session")
def truck() -> bc.QuarterCar:
    return bc.li2006.car()


@pytest.fixture(scope="session", autouse=True)
def _control_defaults_stay_as_they_are():
    before = dict(control.config.defaults)
    yield
    assert dict(control.config.defaults) == before
