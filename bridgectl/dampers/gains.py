"""Gains of a strategy: what they may be called, and what they may be."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bridgectl import _checks as check


def checked_gains(gains: Any) -> dict[str, tuple[float, float, float]]:
    """Check the gains of a strategy and their bounds."""
    if not isinstance(gains, Mapping):
        raise TypeError(
            f'gains must be a mapping, got {gains!r}: type for example {{"share": (0.5, 0.0, 1.0)}}'
        )
    for key in gains:
        if not isinstance(key, str) or not key.isidentifier() or key in ("c_min", "c_max"):
            raise ValueError(
                f"a gain cannot be called {key!r}: type a word that a law can use as g.word, other "
                "than c_min and c_max"
            )
    return {key: checked_gain(key, value) for key, value in gains.items()}


def checked_gain(name: str, value: Any) -> tuple[float, float, float]:
    """Check a gain: its value, and the least and largest one."""
    if not isinstance(value, tuple | list) or len(value) != 3:
        raise TypeError(f"gain {name} must be (value, least, largest), got {value!r}")
    at, low, high = (check.number(f"gain {name}", entry) for entry in value)
    if not low <= at <= high:
        raise ValueError(f"gain {name} = {at:g} is outside its bounds, {low:g} to {high:g}")
    return at, low, high
