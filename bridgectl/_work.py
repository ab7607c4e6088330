"""How much work something is, told before it begins: one estimate, one message.

Estimates are within a factor of a few. What would not fit in memory, or take days, is refused with
the argument that makes it so and a value that would do; what takes minutes is announced.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bridgectl._warn import warn

MOST_BYTES, MOST_SECONDS, MOST_CELLS = 8e9, 86_400.0, 400_000.0
"""Limits of what is begun: memory, time on one core, and steps of one crossing."""

LONG = 300.0
"""Work that is announced [s]; examples and benchmarks take less."""

MEMORY = "not enough memory"


class Work(NamedTuple):
    """Memory [bytes], time on one core [s], and steps of one crossing."""

    bytes: float
    seconds: float
    cells: float = 0.0

    @property
    def share(self) -> float:
        """Largest part of a limit that is used up; beyond 1 it is too much."""
        limits = MOST_BYTES, MOST_SECONDS, MOST_CELLS
        return max(used / limit for used, limit in zip(self, limits, strict=True))

    def __str__(self) -> str:
        texts = [f"{_amount(self.bytes)} of memory", _duration(self.seconds)]
        return ", ".join([f"{_shown(self.cells)} steps", *texts] if self.cells else texts)


@dataclass(frozen=True)
class Given:
    """An argument that counts for the work: its value, and one that is no trouble."""

    value: float
    harmless: float
    unit: str = ""
    what: str = "{name} = {value}"
    """How it is told."""

    def told(self, name: str, value: float) -> str:
        """Name and value, with the unit."""
        shown = f"{value:.6g}{' ' * bool(self.unit)}{self.unit}"
        return self.what.format(name=name, value=shown)


def at_most(value: float, usual: float, unit: str = "", what: str = Given.what) -> Given:
    """An argument that makes more work the larger it is, either way from 0."""
    return Given(value, usual if abs(usual) < abs(value) else value, unit, what)


def at_least(value: float, usual: float, unit: str = "", what: str = Given.what) -> Given:
    """An argument that makes more work the smaller it is."""
    return Given(value, max(value, usual), unit, what)


_latest: list[tuple[Callable[..., Work], Mapping[str, Given]]] = []


def require_feasible(
    estimate: Callable[..., Work], arguments: Mapping[str, Given], *, announced: bool = True
) -> None:
    """Refuse work beyond the limits, and announce what takes minutes without a progress bar.

    The estimate takes values of all arguments by name, of which the one that can save most is told.
    """
    _latest[:] = [(estimate, arguments)]
    work = _evaluate(estimate, arguments)
    if work.share <= 1:
        if announced and work.seconds > LONG:
            name = _cause(estimate, arguments)
            warn(
                f"this takes about {_duration(work.seconds)} on one core; what counts most is "
                f"{arguments[name].told(name, arguments[name].value)}"
            )
        return
    raise ValueError(
        f"this would take about {work}, more than {_amount(MOST_BYTES)}, a day or "
        f"{MOST_CELLS:.0f} steps of a crossing: {_advice(estimate, arguments)}"
    )


def memory_advice() -> str:
    """What to do when memory has run out all the same."""
    return f"{MEMORY}: {_advice(*_latest[0])}" if _latest else f"{MEMORY}: ask for less at once"


def _advice(estimate: Callable[..., Work], arguments: Mapping[str, Given]) -> str:
    """Name the argument whose harmless value saves most, and a value that would do."""
    name = _cause(estimate, arguments)
    given = arguments[name]
    text = f"the cause is {given.told(name, given.value)}"
    low, high = given.harmless, given.value

    def too_much(value: float) -> bool:
        return _evaluate(estimate, arguments, **{name: value}).share > 1

    if too_much(low) or not too_much(high):
        return f"{text}: change it, or ask for less at once"
    for _ in range(40):  # between the two, in equal ratios
        middle = float(np.sign(high) * np.sqrt(abs(low * high)))
        low, high = (low, middle) if too_much(middle) else (middle, high)
    return f"{text}; {given.told(name, _rounded(low, given.harmless))} would do"


def _cause(estimate: Callable[..., Work], arguments: Mapping[str, Given]) -> str:
    return min(
        arguments,
        key=lambda name: _evaluate(estimate, arguments, **{name: arguments[name].harmless}).share,
    )


def _evaluate(
    estimate: Callable[..., Work], arguments: Mapping[str, Given], **changed: float
) -> Work:
    return estimate(**{name: given.value for name, given in arguments.items()} | changed)


def _rounded(value: float, towards: float) -> float:
    """Round to two digits, to the side of what is no trouble."""
    unit = 10.0 ** (np.floor(np.log10(abs(value))) - 1)
    down = abs(towards) < abs(value)
    digits = np.floor(abs(value) / unit) if down else np.ceil(abs(value) / unit)
    return float(np.sign(value) * digits * unit)


def _amount(count: float) -> str:
    return f"{_shown(count / 1e9)} GB" if count >= 1e9 else f"{_shown(max(1.0, count / 1e6))} MB"


def _duration(seconds: float) -> str:
    for unit, size in (("days", 86_400.0), ("hours", 3600.0), ("minutes", 60.0)):
        if seconds >= 2 * size:
            return f"{_shown(seconds / size)} {unit}"
    return f"{_shown(max(1.0, seconds))} s"


def _shown(value: float) -> str:
    """Two digits, as an estimate has."""
    return f"{float(f'{value:.2g}'):.9g}"
