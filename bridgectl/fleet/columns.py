"""Columns of tables of weighed trucks: what they are called, and their units, which are stated.

A column is one of time, speed, the load of an axle or the spacing behind it, by its name or as the
caller says. Its unit is at the end of its name (speed_kmh, "axle 1 [t]"), or the caller says so.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bridgectl._units import KMH
from bridgectl.model.vehicle import GRAVITY

POUND = 4.4482216152605  # N
UNITS = {
    "speed": {"km/h": 1 / KMH, "m/s": 1.0, "mph": 0.44704},
    "load": {
        "N": 1.0, "kN": 1e3, "kg": GRAVITY, "t": 1e3 * GRAVITY, "kip": 1e3 * POUND, "lb": POUND,
    },
    "spacing": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "ft": 0.3048},
    "time": {"s": 1.0},
}  # fmt: skip
"""Of each column: m/s, N, m and s in its units."""

SPELLED = {
    "kmh": "km/h", "kph": "km/h", "kmph": "km/h", "km_h": "km/h", "mps": "m/s", "m_s": "m/s",
    "mi/h": "mph", "tonne": "t", "tonnes": "t", "kips": "kip", "lbs": "lb", "lbf": "lb",
    "feet": "ft", "sec": "s", "seconds": "s",
}  # fmt: skip
"""Other spellings of units, in small letters."""

NAMES = {
    "time": re.compile(r"date[ _]?time|time[ _]?stamp|time|date"),
    "speed": re.compile(r"speed|velocity|v"),
    "load": re.compile(
        r"(?:axle[ _]*)?(?:load|weight|w)[ _]*(\d+)|axle[ _]*(\d+)(?:[ _]*(?:load|weight))?"
    ),
    "spacing": re.compile(r"(?:axle[ _]*)?(?:spacing|distance|s)[ _]*(\d+)(?:[ _-]+\d+)?"),
}
_STAMP = re.compile(r"date[ _]?time|time[ _]?stamp")
LOOKS = {
    "time": "time", "speed": "speed_kmh", "load": "load_1_kN and so on",
    "spacing": "spacing_1_m and so on",
}  # fmt: skip
_BRACKET = re.compile(r"[\[(]")
_UNIT = re.compile(r"\s*[\[(]\s*([^\])]*?)\s*[\])]\s*$|[ _]([a-z/]+|km_h|m_s)$", re.IGNORECASE)


@dataclass(frozen=True)
class Columns:
    """Names of the columns of each sort, in order, and m/s, N, m and s in their units."""

    names: Mapping[str, tuple[str, ...]]
    factors: Mapping[str, tuple[float, ...]]
    units: Mapping[str, tuple[str, ...]]
    time_format: str | None = None
    """How times are written that are none in seconds; None is as ISO 8601 has it."""


def unit_of(sort: str, text: str) -> str | None:
    """Return a unit of a sort of column as it is known here, if it is one."""
    folded = {unit.lower(): unit for unit in UNITS[sort]}
    word = text.strip().lower()
    return folded.get(SPELLED.get(word, word).lower())


def parted(name: str) -> tuple[str, str]:
    """Return what a column is called, and what may be its unit."""
    found = _UNIT.search(name)
    return (name[: found.start()], found[1] or found[2] or "") if found else (name, "")


def sort_of(name: str) -> tuple[str, int] | None:
    """Return what a column is by its name, and the number in it."""
    stem, unit = parted(name.strip())
    for sort, pattern in NAMES.items():
        # In brackets it is a unit, and one that is none is told later.
        has_unit = _BRACKET.search(name) or unit_of(sort, unit)
        for text in (name.strip(), *([stem.strip()] if has_unit else [])):
            if found := pattern.fullmatch(text.lower()):
                return sort, int(next(filter(None, found.groups()), 0))
    return None


def find_columns(
    names: Sequence[str], columns: Mapping[str, Any] | None, units: Mapping[str, str] | None
) -> Columns:
    """Return the columns of a table, each with its unit, or say what to type."""
    stated = _of_sorts("units", units, '{"load": "kN"}')
    chosen = _chosen(names, _of_sorts("columns", columns, '{"speed": "V"}'))
    for sort in ("speed", "load", "spacing"):
        if not chosen[sort]:
            listed = ", ".join(map(repr, names[:8])) + ", ..." * (len(names) > 8)
            name = '["A", "B"]' if sort != "speed" else '"A"'
            raise ValueError(
                f"no column is called {LOOKS[sort]}, there are {listed}: type "
                f'columns={{"{sort}": {name}}} with the names that the table has'
            )
    if len(chosen["spacing"]) < len(chosen["load"]) - 1:
        raise ValueError(
            f"{len(chosen['load'])} columns of loads need {len(chosen['load']) - 1} of spacings, "
            f'found {len(chosen["spacing"])}: type columns={{"spacing": ["A", "B"]}} with the '
            "names that the table has"
        )
    time_format = stated.get("time")
    if time_format is not None and unit_of("time", time_format):
        time_format = None
    found = {
        sort: tuple(_unit(sort, name, stated) for name in chosen[sort])
        for sort in UNITS if sort != "time"
    }  # fmt: skip
    found["time"] = tuple(
        unit_of("time", stated.get("time", "")) or unit_of("time", parted(name)[1]) or ""
        for name in chosen["time"]
    )
    factors = {
        sort: tuple(UNITS[sort].get(unit, 0.0) for unit in each) for sort, each in found.items()
    }
    return Columns(chosen, factors, found, time_format)


def _of_sorts(name: str, given: Any, example: str) -> dict[str, Any]:
    """A mapping by sorts of columns."""
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise TypeError(f"{name} must be by what they are, got {given!r}: type {name}={example}")
    for key in given:
        if key not in UNITS:
            raise ValueError(f"{name} has {key!r}: type some of {', '.join(UNITS)}")
    return dict(given)


def _chosen(names: Sequence[str], columns: Mapping[str, Any]) -> dict[str, tuple[str, ...]]:
    by_name: dict[str, list[tuple[int, str]]] = {sort: [] for sort in UNITS}
    for name in names:
        if (known := sort_of(name)) is not None:
            by_name[known[0]].append((known[1], name))
    chosen = {}
    for sort, found in by_name.items():
        given = columns.get(sort)
        own = [name for _, name in sorted(found)]
        if sort == "time":  # a date is put before the time of day, and one column may have both
            own = next(([name] for name in own if _STAMP.match(name.lower())), own)
        each = [given] if isinstance(given, str) else own if given is None else list(given)
        for name in each:
            if name not in names:
                raise ValueError(
                    f"columns[{sort!r}] = {name!r} is no column of the table: type some of "
                    f"{', '.join(map(repr, names))}"
                )
        if sort == "speed" and len(each) > 1:
            raise ValueError(
                f"speed may be any of {', '.join(map(repr, each))}: type "
                f'columns={{"speed": "{each[0]}"}}'
            )
        chosen[sort] = tuple(each)
    return chosen


def _unit(sort: str, name: str, stated: Mapping[str, str]) -> str:
    """The unit of a column, from its name or as it is stated."""
    stem, text = parted(name)
    own = unit_of(sort, text)
    known = ", ".join(UNITS[sort])
    if sort not in stated:
        if own is None:
            usual = {"speed": "km/h", "load": "kN", "spacing": "m"}[sort]
            bracket = _BRACKET.search(name)
            told = f"has the unit {text!r}" if bracket else "states no unit"
            better = f"{(stem if bracket else name).strip()} [{usual}]"
            raise ValueError(
                f'the column {name!r} {told}, of {known}: type units={{"{sort}": "{usual}"}}, or '
                f"call it {better!r}"
            )
        return own
    given = stated[sort]
    unit = unit_of(sort, given) if isinstance(given, str) else None
    if unit is None:
        raise ValueError(f"units[{sort!r}] must be one of {known}, got {given!r}")
    if own not in (None, unit):
        raise ValueError(
            f"the column {name!r} is in {own}, and units says {unit}: leave out units[{sort!r}]"
        )
    return unit
