"""Units as people and programs read them: all else is in SI units."""

from __future__ import annotations

import math
from typing import TypeVar

from bridgectl._checks import FloatArray

KMH = 3.6
"""One m/s in km/h."""

READABLE = {"N m": (1e3, "kN m"), "N": (1e3, "kN"), "N/m^2": (1e6, "MPa"), "m": (1e-3, "mm")}
"""Size and name of the unit that texts have in place of an effect's own."""

DIGITS = 3
"""Significant ones at least, of values in such units."""

Speed = TypeVar("Speed", float, FloatArray)


def to_kmh(speed: Speed) -> Speed:
    """Return speeds [m/s] in km/h."""
    return speed * KMH


def from_kmh(speed: Speed) -> Speed:
    """Return speeds [km/h] in m/s."""
    return speed / KMH


def readable(value: float, unit: str) -> str:
    """Return a value of an effect as people read it, without its unit: see `readable_unit`."""
    if math.isnan(value):
        return "-"
    value /= READABLE.get(unit, (1.0, ""))[0]
    places = 0 if value == 0 else DIGITS - 1 - math.floor(math.log10(abs(value)))
    return f"{value:.{max(places, 0)}f}"


def readable_unit(unit: str) -> str:
    """Return the unit of `readable`: kN m of N m, MPa of N/m^2."""
    return READABLE.get(unit, (1.0, unit))[1]


def in_name(unit: str) -> str:
    """Return a unit for the end of a name: N_m, m_per_s2."""
    return unit.replace("/", "_per_").replace("^", "").replace(" ", "_")
