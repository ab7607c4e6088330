"""Speeds in km/h, for axes, tables, texts and the command line: all else is in SI units."""

from __future__ import annotations

from typing import TypeVar

from bridgectl._checks import FloatArray

KMH = 3.6
"""One m/s in km/h."""

Speed = TypeVar("Speed", float, FloatArray)


def to_kmh(speed: Speed) -> Speed:
    """Return speeds [m/s] in km/h."""
    return speed * KMH


def from_kmh(speed: Speed) -> Speed:
    """Return speeds [km/h] in m/s."""
    return speed / KMH
