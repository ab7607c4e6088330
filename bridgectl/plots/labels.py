"""Labels beside points, where they cover neither points nor each other.

Own code, since adjustText 1.4 covers points where many are close, and moves labels with another
rendering of letters.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.textpath import TextPath
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.plots.style import GREY

REACHES = (8.0, 12.0, 18.0, 27.0, 38.0, 51.0, 66.0, 83.0, 102.0)
"""How far from its point a label may lie [points]; the farther ones get a line."""

LINED = 12.5
"""From how far on a label has a line to its point [points]."""

N_DIRECTIONS, N_ROUNDS = 24, 6

GAP, LINE_GAP = 1.5, 3.0
"""Around labels and points, and around their lines [points]."""

OVERLAP, OUTSIDE, ON_POINT, ON_LINE, CROSSED = 1e3, 1e4, 1e3, 20.0, 150.0
"""What it costs: to cover a label, to leave the axes, to cover a point, a curve, a label's line."""


def label_points(
    ax: Axes, points: FloatArray, texts: Sequence[str], *, obstacles: FloatArray, curve: FloatArray,
    colors: Sequence[str], size: float = 8.0,
) -> None:  # fmt: skip
    """Write a label of some size [points] beside each of the points (n, 2), in data coordinates.

    No label covers an obstacle (m, 2), and labels keep off the corners (k, 2) of a curve. The axes
    must have their limits and their place in the figure: no layout may move them later.
    """
    scale = 72.0 / ax.figure.dpi
    at, points_at = (ax.transData.transform(p) * scale for p in (points, obstacles))
    curve_at = _along(ax.transData.transform(curve) * scale) if len(curve) else np.zeros((0, 2))
    frame = np.array(ax.bbox.extents).reshape(2, 2) * scale
    sizes = np.array([_size(text, size) for text in texts])
    place: Any = ax.transData.inverted().transform
    centres = _place(at, sizes, points_at, curve_at, frame)
    for point, centre, text, color, box in zip(at, centres, texts, colors, sizes, strict=True):
        offset: Any = centre - point
        clear = np.hypot(*np.maximum(np.abs(offset) - box / 2, 0))
        line: Any = {"arrowstyle": "-", "lw": 0.6, "color": GREY, "shrinkA": 0, "shrinkB": 3}
        ax.annotate(
            text, place(point / scale), offset,
            textcoords="offset points", ha="center", va="center", fontsize=size, color=color,
            arrowprops=line if clear > LINED else None, parse_math=False, zorder=4,
        )  # fmt: skip


def _size(text: str, size: float) -> tuple[float, float]:
    """Width and height of a label [points]."""
    return float(TextPath((0, 0), text.replace("$", "S"), size=size).get_extents().width), size


def _along(corners: FloatArray) -> FloatArray:
    """Points along a curve, close together."""
    steps = np.linspace(0, 1, 12, endpoint=False)[:, np.newaxis]
    pieces = [a + steps * (b - a) for a, b in pairwise(corners)]
    return np.concatenate([*pieces, corners[-1:]])


def _place(
    at: FloatArray, sizes: FloatArray, obstacles: FloatArray, curve: FloatArray, frame: FloatArray
) -> FloatArray:
    """Centres of the labels: each in turn goes where it costs least, some times over."""
    angles = np.linspace(0, 2 * np.pi, N_DIRECTIONS, endpoint=False)
    ways = np.column_stack([np.cos(angles), np.sin(angles)])
    choices = [
        np.concatenate([point + ways * (reach + box / 2) for reach in REACHES])
        for point, box in zip(at, sizes, strict=True)
    ]
    distances = np.repeat(REACHES, N_DIRECTIONS)
    centres = at + np.inf
    crowd = (np.abs(at[:, np.newaxis] - obstacles).max(axis=2) < REACHES[-1]).sum(axis=1)
    for _ in range(N_ROUNDS):
        for i in np.argsort(-crowd, kind="stable"):
            placed = np.isfinite(centres[:, 0]) & (np.arange(len(at)) != i)
            cost = distances + _cost(
                at[i], choices[i], sizes[i], centres[placed], sizes[placed], at[placed],
                obstacles, curve, frame,
            )  # fmt: skip
            centres[i] = choices[i][np.argmin(cost)]
    return centres


def _cost(
    point: FloatArray, choices: FloatArray, size: FloatArray, centres: FloatArray,
    sizes: FloatArray, points: FloatArray, obstacles: FloatArray, curve: FloatArray,
    frame: FloatArray,
) -> FloatArray:  # fmt: skip
    """What each choice of one label covers, crosses, or leaves."""
    half = size / 2 + GAP
    outside = (np.abs(choices - frame.mean(axis=0)) + half > np.ptp(frame, axis=0) / 2).any(axis=1)
    cost = OUTSIDE * outside + ON_POINT * _near(choices, obstacles, half + 2 * GAP).sum(axis=1)
    cost += ON_LINE * _near(choices, curve, half).sum(axis=1)
    # Points at nearly the same place cannot be kept off.
    others = obstacles[np.abs(obstacles - point).max(axis=1) > 2 * LINE_GAP]
    own = _lines(point, choices)
    cost += CROSSED * _any([_near(place, others, LINE_GAP) for place in own])
    if len(centres):
        cost += OVERLAP * _near(choices, centres, half + sizes / 2).sum(axis=1)
        cost += CROSSED * _any([_near(place, centres, sizes / 2 + GAP) for place in own])
        cost += CROSSED * _any([_near(choices, place, half) for place in _lines(points, centres)])
    return cost


def _near(first: FloatArray, second: FloatArray, reach: FloatArray | float) -> NDArray[np.bool_]:
    """Whether points are within a rectangle around others, shape (n_first, n_second)."""
    return np.all(np.abs(first[:, np.newaxis] - second) < reach, axis=2)


def _any(found: list[NDArray[np.bool_]]) -> FloatArray:
    """How many things each choice meets, each counted once."""
    return np.any(found, axis=0).sum(axis=1).astype(float)


def _lines(point: FloatArray, ends: FloatArray) -> list[FloatArray]:
    """Places along the lines from points to labels."""
    return [point + share * (ends - point) for share in np.linspace(0.1, 0.85, 12)]
