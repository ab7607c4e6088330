"""Argument checks that name the argument, say what was expected, and what to type instead."""

from __future__ import annotations

import os
from collections.abc import Iterator, Set
from difflib import get_close_matches
from math import isfinite
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.floating[Any]]


class UnloadedTireError(ValueError):
    """A tire that a vehicle would have to hold down; `loads` are those of all tires [N]."""

    def __init__(self, loads: FloatArray) -> None:
        super().__init__(
            f"every tire must carry a static load above 0 N, got {loads} N; check mass_matrix, "
            "tire_map and heave"
        )
        self.loads = loads


def number(name: str, value: Any, *, unit: str = "") -> float:
    """Return `value` as a finite float, or say which argument is not one."""
    if type(value) in (float, int) and isfinite(value):  # almost always
        return float(value)
    zero_d = isinstance(value, np.ndarray) and value.ndim == 0 and value.dtype.kind in "iuf"
    if isinstance(value, bool) or not (isinstance(value, Real) or zero_d):
        raise TypeError(f"{name} must be one number{_in(unit)}, got {_short(value)}{_hint(value)}")
    refuse_masked(name, value)
    result = float(value)
    if not np.isfinite(result):
        raise ValueError(f"{name} must be finite{_in(unit)}, got {result}")
    return result


def positive(name: str, value: Any, *, unit: str = "") -> float:
    """Return `value` as a float above zero."""
    result = number(name, value, unit=unit)
    if result <= 0:
        remedy = f": type {-result:g}" if result < 0 else ""
        raise ValueError(f"{name} must be above 0{_in(unit)}, got {result:g}{remedy}")
    return result


def not_negative(name: str, value: Any, *, unit: str = "") -> float:
    """Return `value` as a float of at least zero."""
    result = number(name, value, unit=unit)
    if result < 0:
        raise ValueError(f"{name} must be 0 or more{_in(unit)}, got {result:g}: type {-result:g}")
    return result


def fraction(name: str, value: Any, length: float | None = None) -> float:
    """Return `value` as a float strictly between 0 and 1, of a span of `length` [m]."""
    result = number(name, value)
    if not 0 < result < 1:
        remedies = []
        if length is not None and 1 < result < length:
            remedies.append(f"for {result:g} m of {length:g} m type {result / length:.4g}")
        if 1 < result < 100:
            remedies.append(f"for {result:g} percent type {result / 100:g}")
        raise ValueError(
            f"{name} must lie between 0 and 1 (a fraction of the span, 0.5 for mid-span), "
            f"got {result:g}{': ' * bool(remedies)}{', '.join(remedies)}"
        )
    return result


def integer(name: str, value: Any, *, at_least: int) -> int:
    """Return `value` as an int of at least `at_least`."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        whole = isinstance(value, float | np.floating) and float(value).is_integer()
        remedy = f": type {value:.0f}" if whole else _hint(value)
        raise TypeError(f"{name} must be a whole number, got {_short(value)}{remedy}")
    if value < at_least:
        raise ValueError(f"{name} must be {at_least} or more, got {value}")
    return int(value)


def workers(value: Any, most: int) -> int:
    """Check a number of processes; by default one for each core, and no more than `most`."""
    if value is None:
        available = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else None
        value = available or os.cpu_count() or 1
    return max(1, min(integer("workers", value, at_least=1), most))


def array(
    name: str, value: ArrayLike, shape: tuple[int | None, ...], *, unit: str = ""
) -> FloatArray:
    """Return a read-only float copy of `value` of the given shape (None: any length)."""
    result = floats(name, value, unit=unit)
    if result.ndim != len(shape) or any(
        want is not None and want != got for want, got in zip(shape, result.shape, strict=True)
    ):
        expected = tuple("n" if size is None else size for size in shape)
        shown = "(" + ", ".join(map(str, expected)) + ("," if len(expected) == 1 else "") + ")"
        remedy = f": type [{result:g}]" if result.ndim == 0 and len(shape) == 1 else ""
        if result.ndim > len(shape) == 1:
            remedy = f": type numpy.ravel({name})"
        if result.ndim == 1 and len(shape) == 2:
            remedy = f": of a diagonal one type numpy.diag({name})"
        raise ValueError(f"{name} must have shape {shown}, got {result.shape}{remedy}")
    finite(name, result, unit=unit)
    result.flags.writeable = False
    return result


def floats(name: str, value: ArrayLike, *, unit: str = "") -> FloatArray:
    """Return a float copy of real numbers of any shape, none of which is masked."""
    refuse_masked(name, value)
    try:
        given = np.asarray(value)
    except ValueError as error:  # rows of different lengths
        raise TypeError(f"{name} must be an array of numbers{_in(unit)}: {error}") from None
    if given.dtype.kind not in "iuf" and given.size > 0:
        remedy = _hint(value)
        if not remedy and given.dtype.kind in "OU" and given.size > 1 and _of_numbers(given):
            remedy = f": type numpy.array({name}, dtype=float)"
        raise TypeError(
            f"{name} must be an array of numbers{_in(unit)}, got {_short(value)}{remedy}"
        )
    return np.array(given, dtype=np.float64)


def _of_numbers(given: NDArray[Any]) -> bool:
    """Tell whether strings or objects can be meant as numbers."""
    try:
        return bool(np.isfinite(given.astype(np.float64)).all())
    except (TypeError, ValueError):
        return False


def finite(name: str, values: FloatArray, *, unit: str = "") -> None:
    """Refuse NaN and infinity, with the first place where there is one."""
    if not np.isfinite(values).all():
        where = tuple(int(i) for i in np.argwhere(~np.isfinite(values))[0])
        raise ValueError(f"{name} must be finite{_in(unit)}, got {values[where]} at index {where}")


def refuse_masked(name: str, value: Any) -> None:
    """Refuse a masked array, or a list with one in it, whose mask hides values."""
    if type(value) is np.ndarray:
        return
    if isinstance(value, np.ma.MaskedArray):
        mask = np.ma.getmaskarray(value)
    elif isinstance(value, list | tuple) and any(
        isinstance(part, np.ma.MaskedArray) for part in value
    ):
        masks = [np.ma.getmaskarray(part) for part in value]
        if len({part.shape for part in masks}) > 1:
            return  # rows of different lengths, which are told as such
        mask = np.array(masks)
    else:
        return
    if mask.any():
        where = tuple(int(i) for i in np.argwhere(mask)[0])
        place = f", the first at index {where}" if mask.ndim else ""
        raise ValueError(
            f"{name} has {mask.sum()} masked values{place}: leave them out everywhere, type "
            f"keep = ~np.ma.getmaskarray({name}), then {name}[keep] and so on"
        )


def speeds(value: ArrayLike) -> FloatArray:
    """Return speeds as a 1-D array [m/s], all above zero."""
    given = floats("speeds", value, unit="m/s")
    result = array("speeds", np.atleast_1d(given), (None,), unit="m/s")
    if result.size == 0:
        raise ValueError("speeds must hold at least one speed in m/s, got an empty array")
    if np.any(result <= 0):
        raise ValueError(f"speeds must be above 0 m/s, got {result[result <= 0][0]:g}")
    return result


def choice(name: str, value: Any, allowed: tuple[str, ...]) -> str:
    """Return `value` if it is one of the allowed words."""
    if not isinstance(value, str) or value not in allowed:
        words = ", ".join(repr(word) for word in allowed)
        folded = {word.lower(): word for word in allowed}
        near = get_close_matches(str(value).lower(), folded, 1)
        remedy = f": type {folded[near[0]]!r}" if near else ""
        raise ValueError(f"{name} must be one of {words}, got {_short(value)}{remedy}")
    return str(value)


def path(name: str, value: Any, example: str) -> str:
    """Return the name of a file as text."""
    if isinstance(value, str | os.PathLike) and isinstance(file := os.fspath(value), str):
        return file
    raise TypeError(
        f'{name} must be a string or a Path, got {_short(value)}: type {name}="{example}"'
    )


def flag(name: str, value: Any) -> bool:
    """Return `value` if it is True or False."""
    if not isinstance(value, bool | np.bool_):
        raise TypeError(f"{name} must be True or False, got {_short(value)}")
    return bool(value)


def _hint(value: Any) -> str:
    """What to type for a number in quotes or brackets, and for what only looks like a list."""
    if isinstance(value, Set | Iterator):
        return ": type a list, as [20, 25]"
    bracketed = isinstance(value, list | tuple | np.ndarray) and np.size(value) == 1
    inner = np.ravel(value)[0] if bracketed else value
    if not isinstance(inner, str | Real):
        return ""
    try:
        number = float(inner.replace(",", ".") if isinstance(inner, str) else inner)
    except ValueError:  # some other text
        return ""
    if isinstance(inner, str):
        return f": type {number:g}, without quotes"
    return f": type {number:g}, without brackets" if bracketed else ""


def _short(value: Any) -> str:
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else text[:57] + "..."


def _in(unit: str) -> str:
    return f" [{unit}]" if unit else ""
