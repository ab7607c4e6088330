"""Places along a road that round-off alone keeps apart, and pieces that a way is cut into."""

from __future__ import annotations

import numpy as np

from bridgectl._checks import FloatArray

SAME_PLACE = 1e-9
"""Places closer than this [m] are one: below any road's resolution, above round-off."""


def merge_places(places: FloatArray) -> FloatArray:
    """Sort places, and merge those that only round-off keeps apart."""
    places = np.sort(places)
    return np.asarray(places[np.concatenate([[True], np.diff(places) > SAME_PLACE])])


def even_places(start: float, step: float, count: int) -> FloatArray:
    """Places at equal steps, each from the start, so that round-off does not add up."""
    return start + step * np.arange(count, dtype=np.float64)


def count_pieces(way: float, length: float) -> int:
    """Number of pieces of a length that cover a way, not one more by round-off."""
    return int(np.ceil(way / length - SAME_PLACE))


def whole_pieces(way: float, length: float) -> int:
    """Number of whole pieces of a length in a way, not one less by round-off."""
    return int(np.floor(way / length + SAME_PLACE))
