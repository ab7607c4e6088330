"""Speeds in km/h are made in one place."""

import ast
from pathlib import Path

import numpy as np

import bridgectl
from bridgectl._units import KMH, from_kmh, to_kmh

PACKAGE = Path(bridgectl.__file__).parent


def test_a_speed_in_km_h_is_3_6_times_that_in_m_s():
    assert to_kmh(25.0) == 90.0
    assert from_kmh(90.0) == 25.0
    assert to_kmh(np.array([10.0, 20.0])).tolist() == [36.0, 72.0]
    assert from_kmh(np.array([36.0, 72.0])).tolist() == [10.0, 20.0]


def factors(code):
    """Numbers 3.6 in code, but for the sizes of figures [inch]."""
    tree = ast.parse(code)
    sizes = [k.value for k in ast.walk(tree) if isinstance(k, ast.keyword) and k.arg == "figsize"]
    inches = {id(node) for size in sizes for node in ast.walk(size)}
    constants = [node for node in ast.walk(tree) if isinstance(node, ast.Constant)]
    return [node.lineno for node in constants if node.value == KMH and id(node) not in inches]


def test_no_other_code_has_the_factor_of_km_h():
    assert factors("speed = 90 / 3.6") == [1]
    assert factors("Figure(figsize=(9, 3.6))") == []
    found = {
        path.relative_to(PACKAGE).as_posix(): lines
        for path in PACKAGE.rglob("*.py")
        if (lines := factors(path.read_text(encoding="utf-8")))
    }
    assert list(found) == ["_units.py"]
    assert len(found["_units.py"]) == 1
