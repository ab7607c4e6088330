"""Gains, states, signals and preview of a strategy: what they may be called, and be."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl.dampers.expression import SAMPLE_TIME


def checked_name(name: Any) -> str:
    """Check what tables call a strategy."""
    if not isinstance(name, str) or not name:
        raise TypeError(f'name must be a string, got {name!r}: type for example "skyhook"')
    return name


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


def changed_gains(
    law: str, bounds: Mapping[str, tuple[float, float, float]], values: Mapping[str, float]
) -> dict[str, tuple[float, float, float]]:
    """Return gains and their bounds with other values of some."""
    if unknown := set(values) - set(bounds):
        known = ", ".join(bounds) or "none"
        raise ValueError(f"{law} has no gain {sorted(unknown)[0]!r}, its gains: {known}")
    return {
        key: checked_gain(key, (values.get(key, value), low, high))
        for key, (value, low, high) in bounds.items()
    }


def checked_states(states: Any, update: Any, taken: Collection[str]) -> dict[str, float]:
    """Check the states of a strategy and their initial values, and that they have an update."""
    example = 'states={"filtered": 0.0}'
    if not isinstance(states, Mapping):
        raise TypeError(f"states must be a mapping, got {states!r}: type for example {example}")
    for key in states:
        if not isinstance(key, str) or not key.isidentifier() or key in taken:
            raise ValueError(
                f"a state cannot be called {key!r}: type a word that a law can use as s.word, "
                "other than those of signals and gains, sample_time and ahead"
            )
    if states and not callable(update):
        raise TypeError(
            "update must be a function update(s, g) that returns the next value of every state by "
            f"name, got {type(update).__name__}"
        )
    if update is not None and not states:
        raise ValueError(f"update needs states that it gives: type for example {example}")
    return {key: check.number(f"state {key}", value) for key, value in states.items()}


def checked_preview(preview: Any) -> list[float]:
    """Check the distances [m] at which a strategy sees the road ahead."""
    distances = check.array("preview", preview, (None,), unit="m")
    if np.any(np.diff(distances, prepend=0.0) <= 0):
        raise ValueError(
            "preview must be distances ahead that rise and are above 0 m, got "
            f"{distances.tolist()}: type for example preview=[2.0, 4.0, 8.0]"
        )
    return [*distances.tolist()]


def cases(
    law: str, known: Mapping[str, float], n_ahead: int, given: Mapping[str, ArrayLike]
) -> tuple[tuple[int, ...], float, FloatArray]:
    """Shape that what is given broadcasts to, the sample time [s], and a row of cases of the rest.

    Rows are of the signals and states that are known, with their values where none is given, and of
    what is seen ahead.
    """
    held: dict[str, Any] = {"sample_time": SAMPLE_TIME, "ahead": np.zeros(n_ahead)}
    if unknown := set(given) - set(known) - set(held):
        names = ", ".join([*known, *held])
        raise ValueError(f"unknown signal {sorted(unknown)[0]!r}, known: {names}")
    held |= {name: value for name, value in given.items() if name in held}
    time = check.positive("sample_time", held["sample_time"], unit="s")
    arrays = {name: _measured(law, name, given[name]) for name in given if name in known}
    seen = _measured(law, "ahead", held["ahead"])
    if seen.shape[-1:] != (n_ahead,):
        raise ValueError(
            f"ahead must have {n_ahead} elevations in its last axis, one for each distance of "
            f"preview, got shape {seen.shape}"
        )
    arrays |= {f"ahead[{i}]": seen[..., i] for i in range(n_ahead)}
    try:
        shape = np.broadcast_shapes(*(value.shape for value in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {value.shape}" for name, value in arrays.items())
        raise ValueError(f"signals must have shapes that broadcast, got {shapes}") from None
    rows = [np.broadcast_to(value, shape).ravel() for value in (dict(known) | arrays).values()]
    return shape, time, np.array(rows)


def _measured(law: str, name: str, value: ArrayLike) -> FloatArray:
    try:
        values = check.floats(name, value)
        check.finite(name, values)
    except ValueError as error:
        raise ValueError(f"{error}: from that {law} returned NaN") from None
    return values


def damping_bounds(c_min: float, c_max: float) -> tuple[float, float]:
    """Check bounds of the damping [N s/m]."""
    soft = check.not_negative("c_min", c_min, unit="N s/m")
    stiff = check.positive("c_max", c_max, unit="N s/m")
    if soft > stiff:
        raise ValueError(
            f"c_min must not exceed c_max, got {soft:g} and {stiff:g} N s/m: swap them"
        )
    return soft, stiff
