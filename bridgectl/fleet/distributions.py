"""Distributions of what differs from truck to truck, drawn from uniform numbers of its own.

A distribution is stated by its keys, in Python as in a file::

    22.0                                            this number alone
    {mean = 13, sd = 1, min = 10, max = 16}         normal, cut off at min and max if there are any
    {min = 10, max = 16}                            uniform
    {median = 3e5, log_sd = 0.2, min = 1e5}         lognormal, cut off likewise

Frozen distributions of `scipy.stats` do as well, in Python, but take longer for each number.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import exp, inf, log
from numbers import Real
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from bridgectl import _checks

KEYS = ("mean", "sd", "median", "log_sd", "min", "max")
LOOKS = "22.0, {'min': 18, 'max': 25}, {'mean': 22, 'sd': 2, 'min': 15, 'max': 28}"


class Distribution(Protocol):
    """What a number is drawn from."""

    @property
    def low(self) -> float:
        """No number is smaller."""
        ...

    @property
    def high(self) -> float:
        """No number is larger."""
        ...

    def ppf(self, u: float) -> float:
        """The number that a share u of all are below."""
        ...


@dataclass(frozen=True)
class Constant:
    """One number."""

    value: float

    @property
    def low(self) -> float:
        """The number."""
        return self.value

    high = low

    def ppf(self, u: float) -> float:
        """The number."""
        return self.value


@dataclass(frozen=True)
class Uniform:
    """Any number from low to high."""

    low: float
    high: float

    def ppf(self, u: float) -> float:
        """The number that a share u of all are below."""
        return self.low + u * (self.high - self.low)


@dataclass(frozen=True)
class Normal:
    """A normal distribution, cut off: what is outside is drawn again."""

    mean: float
    sd: float
    low: float = -inf
    high: float = inf

    @cached_property
    def _tail(self) -> tuple[float, float, float]:
        """Side of the mean on which all is, and shares of the whole below both ends, from there.

        Of what lies above the mean the mirror image is drawn: shares near 1 have no digits.
        """
        a, b = (self.low - self.mean) / self.sd, (self.high - self.mean) / self.sd
        side = -1.0 if a > 0 else 1.0
        return side, float(ndtr(side * a)), float(ndtr(side * b))

    def ppf(self, u: float) -> float:
        """The number that a share u of all are below."""
        side, below_low, below_high = self._tail
        drawn = side * ndtri(below_low + u * (below_high - below_low))
        return min(max(self.mean + self.sd * float(drawn), self.low), self.high)


@dataclass(frozen=True)
class Lognormal:
    """A number whose logarithm is normal, cut off."""

    median: float
    log_sd: float
    low: float = 0.0
    high: float = inf

    @cached_property
    def _log(self) -> Normal:
        low = log(self.low) if self.low > 0 else -inf
        return Normal(log(self.median), self.log_sd, low, log(self.high))

    def ppf(self, u: float) -> float:
        """The number that a share u of all are below."""
        return min(max(exp(self._log.ppf(u)), self.low), self.high)


@dataclass(frozen=True, eq=False)
class Frozen:
    """A frozen distribution of `scipy.stats`."""

    frozen: Any

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Frozen):
            return NotImplemented
        mine, theirs = ((f.dist.name, f.args, f.kwds) for f in (self.frozen, other.frozen))
        return bool(mine == theirs)

    def __hash__(self) -> int:
        return hash((self.frozen.dist.name, self.frozen.args))

    @property
    def low(self) -> float:
        """No number is smaller."""
        return float(self.frozen.support()[0])

    @property
    def high(self) -> float:
        """No number is larger."""
        return float(self.frozen.support()[1])

    def ppf(self, u: float) -> float:
        """The number that a share u of all are below."""
        return float(self.frozen.ppf(u))


def distribution(name: str, given: Any, unit: str = "") -> Distribution:
    """Return the distribution that is stated, or say how to state one."""
    if isinstance(given, Mapping):
        return _stated(name, given, unit)
    if all(hasattr(given, each) for each in ("ppf", "support", "dist", "args", "kwds")):
        return Frozen(given)
    if not isinstance(given, bool) and np.ndim(given) == 0 and isinstance(given, Real):
        return Constant(_checks.number(name, given, unit=unit))
    raise TypeError(
        f"{name} must be a number or a distribution{_in(unit)}, got {given!r}: type {LOOKS}"
    )


def positive(name: str, given: Any, unit: str = "") -> Distribution:
    """Return a distribution of numbers above zero alone."""
    made = distribution(name, given, unit)
    if made.low < 0 or made.ppf(2.0**-53) <= 0:
        raise ValueError(
            f"{name} must be above 0{_in(unit)} whatever is drawn, got {made.low:g} at least: "
            "type a min above 0"
        )
    return made


def uniforms(key: NDArray[np.uint64], i: int, n: int) -> list[float]:
    """Return n numbers between 0 and 1 that truck i of a seed has, whoever asks, in any order.

    Philox is a cipher of a counter: the trucks have each their own part of what it counts. 52 bits
    and a half are exact in a float, and never 0 or 1.
    """
    raw = np.random.Philox(key=key, counter=[0, i, 0, 0]).random_raw(n)
    return (((raw >> 12) + 0.5) * 2.0**-52).tolist()


def key_of(seed: int) -> NDArray[np.uint64]:
    """Return the key of a seed."""
    return np.random.SeedSequence(seed).generate_state(2, np.uint64).astype(np.uint64)


def _stated(name: str, given: Mapping[str, Any], unit: str) -> Distribution:
    for key in given:
        if key not in KEYS:
            raise ValueError(f"{name} has the key {key!r}: type some of {', '.join(KEYS)}")
    values = {key: _checks.number(f"{name}.{key}", each, unit=unit) for key, each in given.items()}
    low, high = values.get("min", -inf), values.get("max", inf)
    if not low < high:
        raise ValueError(f"{name}.min must be below {name}.max, got {low:g} and {high:g}")
    match sorted(key for key in values if key not in ("min", "max")):
        case ["mean", "sd"]:
            sd = _checks.positive(f"{name}.sd", values["sd"], unit=unit)
            return _inhabited(name, Normal(values["mean"], sd, low, high))
        case ["log_sd", "median"]:
            low = _checks.not_negative(f"{name}.min", values.get("min", 0.0), unit=unit)
            median = _checks.positive(f"{name}.median", values["median"], unit=unit)
            log_sd = _checks.positive(f"{name}.log_sd", values["log_sd"])
            made = Lognormal(median, log_sd, low, high)
            _inhabited(name, made._log)
            return made
        case [] if "min" in values and "max" in values:
            return Uniform(low, high)
    raise ValueError(
        f"{name} must have mean and sd, or median and log_sd, or min and max, got "
        f"{', '.join(values) or 'nothing'}: type {LOOKS}"
    )


def _inhabited(name: str, normal: Normal) -> Normal:
    """Refuse limits so far out that nothing is between them."""
    _, low, high = normal._tail
    if low == high:
        raise ValueError(
            f"{name}.min and {name}.max are too far from what is usual: nothing is between them"
        )
    return normal


def _in(unit: str) -> str:
    return f" [{unit}]" if unit else ""
