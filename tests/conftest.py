"""What every test shares: quiet plots, the reference numbers, and the paper's case."""

from __future__ import annotations

import json
from pathlib import Path

import control
import matplotlib as mpl
import pytest
from hypothesis import settings

import bridgectl as bc

mpl.use("Agg")

# Examples of a property may build matrix exponentials: count them, do not time them.
settings.register_profile("bridgectl", deadline=None)
settings.load_profile("bridgectl")

CASES = Path(__file__).with_name("data") / "cases.json"


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
