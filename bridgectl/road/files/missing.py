"""Readings that a file marks as missing: dropped if they are told, refused if they are found.

Loggers write -999, 9999, -32768 and their like where they measured nothing. Such a number is taken
for an elevation only among neighbours that are like it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.road.files.lines import COMMENTS, printable, refusal

NONE = "none"
OFF = 0.5  # a marker differs from its neighbours by more than this part of itself,
TYPICAL = 5.0  # and by more than this many typical differences of neighbours
WINDOW = 2**16  # readings compared at once

_WORDS = re.compile(r"[^\d\s,\"']{0,20}|[+-]?[\d.]+e\+?\d+", re.IGNORECASE)


def _markers() -> FloatArray:
    """Return the numbers that mark missing readings, sorted."""
    nines = [
        float(f"{'9' * whole or '0'}.{'9' * decimals or '0'}")
        for whole in range(11)
        for decimals in range(5)
        if whole + decimals >= 3
    ]
    repeated = [float(digit * n) for digit in "78" for n in range(4, 8)]
    integers = [2.0**bits - less for bits in (15, 16, 23, 24, 31, 32) for less in (0, 1)]
    powers = [10.0**n for n in range(4, 12)]
    either = np.array([*nines, *repeated, *integers, *powers, 999.25, 9999.25])
    return np.unique([*either, *-either, -99.0])


MARKERS = _markers()


@dataclass(frozen=True)
class Missing:
    """What a caller says of missing readings."""

    numbers: tuple[float, ...] = ()
    words: frozenset[str] = frozenset()
    all_told: bool = False
    """Whether all other numbers are elevations, whatever they look like."""

    def marks(self, field: str) -> bool:
        """Tell whether a field that holds no number of a road marks a missing reading."""
        word = field.strip().strip("\"'").casefold()
        if word in self.words:
            return True
        try:
            return float(word) in self.numbers
        except ValueError:
            return False

    def telling(self, word: str) -> str:
        """Return what to type to leave out what a word marks as well, in Python and elsewhere."""
        told = ",".join([*sorted(self.words), *(f"{value:.12g}" for value in self.numbers), word])
        plain = self == UNTOLD and word[-1:].isdigit() and word.isascii()
        argument = word if plain else f'"{told}"'
        return f"pass missing={argument} (--missing={told} on the command line)"


UNTOLD = Missing()


def maybe_missing(word: str, missing: Missing) -> str:
    """Say what to type if a word that is no number of a road marks missing readings, if it may."""
    if not _WORDS.fullmatch(word) or word != printable(word) or word in COMMENTS:
        return ""
    return f"; {missing.telling(word)} if it marks missing readings"


def known_missing(missing: Any) -> Missing:
    """Return what marks missing readings, as passed by a caller."""
    if isinstance(missing, str):
        given: Sequence[Any] = missing.split(",")
    else:
        given = missing if isinstance(missing, list | tuple) else [missing]
    if not all(isinstance(item, str | Real) and not isinstance(item, bool) for item in given):
        example = 'type missing=-999, missing="nan", or both, missing=(-999, "nan")'
        raise TypeError(f"missing must be numbers or words, got {missing!r}: {example}")
    numbers, words = [], set()
    for item in given:
        try:
            value = float(item)
        except (ValueError, OverflowError):
            value = np.nan
        if np.isnan(value):
            words.add(str(item).strip().casefold())
        else:
            numbers.append(value)
    return Missing(tuple(numbers), frozenset(words), not given or NONE in words)


def marker_in(z: FloatArray) -> int | None:
    """Return the index of the first reading that looks like a marker, if any."""
    found = _at_markers(z)
    if not found.size:
        return None
    # Equal markers in a row are one; before and after it stand its neighbours.
    follows = np.append(False, (np.diff(found) == 1) & (z[found[1:]] == z[found[:-1]]))
    first = found[~follows]
    last = found[~np.append(follows[1:], False)]
    before = np.where(first > 0, np.abs(z[first] - z[first - 1]), np.inf)
    after = np.where(last < z.size - 1, np.abs(z[last] - z[(last + 1) % z.size]), np.inf)
    apart = np.minimum(before, after)
    odd = apart > OFF * np.abs(z[first])
    if not odd.any():
        return None
    others = np.abs(np.diff(np.delete(z, found)))
    odd &= apart > (TYPICAL * np.median(others) if others.size else 0.0)
    return int(first[np.argmax(odd)]) if odd.any() else None


def marker_station(x: FloatArray, i: int) -> int | None:
    """Return which of two stations out of order, i and the one before, is a marker, if any."""
    apart = abs(x[i] - x[i - 1])
    return next((j for j in (i, i - 1) if x[j] in MARKERS and apart > OFF * abs(x[j])), None)


def _at_markers(z: FloatArray) -> NDArray[np.int_]:
    parts = []
    for start in range(0, z.size, WINDOW):  # so that long roads need little memory
        window = z[start : start + WINDOW]
        nearest = MARKERS[np.minimum(np.searchsorted(MARKERS, window), MARKERS.size - 1)]
        parts.append(start + np.flatnonzero(window == nearest))
    return np.concatenate(parts) if parts else np.array([], dtype=int)


def require_no_marker(
    file: str, z: FloatArray, unit: str, line: Callable[[int], int], missing: Missing
) -> None:
    """Refuse a track in which the marker of a missing reading stands as an elevation."""
    if missing.all_told or (i := marker_in(z)) is None:
        return
    raise refusal(
        file,
        f"the elevation {z[i]:.12g} {unit} looks like the marker of a missing reading: "
        f"{missing.telling(f'{z[i]:.12g}')} to leave such readings out, or "
        f"missing=() (--missing={NONE}) if it is an elevation",
        line(i),
    )


def absent(z: FloatArray, missing: Missing) -> NDArray[np.bool_]:
    """Tell which readings are missing."""
    found = np.isnan(z)
    for value in missing.numbers:
        found |= z == value
    return found
