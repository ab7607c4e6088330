"""Functions of a place on the bridge as tables, so that any number of places is read alike.

What bridges tell of many places at once may depend on the others by round-off. Here each piece of
the bridge has a cubic of its own, made from the bridge once.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, merge_places

DEGREE = 4
"""Of the polynomials of a piece."""

_KNOTS = (np.polynomial.chebyshev.chebpts1(DEGREE + 1) + 1) / 2
_TO_POWERS = np.linalg.inv(np.vander(_KNOTS, increasing=True))


class Table(NamedTuple):
    """Functions on pieces of the bridge, zero off it: see `table`."""

    edges: FloatArray
    """Ends of the pieces [m], (pieces + 1,)."""
    bins: NDArray[np.intp]
    """The piece at the start of each of even bins, (bins,)."""
    scale: float
    """Bins per meter."""
    passes: int
    """Edges that a bin holds at most."""
    powers: FloatArray
    """By powers of the share of a piece, rising, of none on the last piece: off the bridge,
    (DEGREE + 1, functions, pieces + 1)."""

    def pieces(self, x: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
        """The piece of each place, and the share of it that is behind."""
        off = (x <= self.edges[0]) | (x >= self.edges[-1])
        inside = np.where(off, self.edges[0], x)
        found = self.bins[(inside * self.scale).astype(np.intp)]
        for _ in range(self.passes):
            found = found + (inside >= self.edges[found + 1])
        first = self.edges[found]
        share = (inside - first) / (self.edges[found + 1] - first)
        return np.where(off, len(self.edges) - 1, found), share

    def __call__(self, x: FloatArray) -> FloatArray:
        """Values at places, functions first."""
        found, share = self.pieces(x)
        values = self.powers[-1].take(found, axis=1)
        for power in self.powers[-2::-1]:
            values *= share
            values += power.take(found, axis=1)
        return values

    def slope_jumps(self) -> tuple[FloatArray, FloatArray]:
        """Edges where slopes jump [m], (n,), and by how much [1/m], (n, functions)."""
        widths = np.diff(self.edges)
        orders = np.arange(1, DEGREE + 1)[:, np.newaxis, np.newaxis]
        after, before = np.zeros((2, len(self.edges), self.powers.shape[1]))
        inner = self.powers[:, :, :-1]
        after[:-1] = (inner[1] / widths).T
        before[1:] = ((orders * inner[1:]).sum(axis=0) / widths).T
        jumps = after - before
        largest = np.maximum(np.abs(after), np.abs(before)).max(axis=0)
        felt = (np.abs(jumps) > FELT * largest).any(axis=1)
        return self.edges[felt], jumps[felt]


FELT = 1e-5
"""Share of the largest slope above which a jump is one: the fits of pieces differ by less."""


def table(
    function: Callable[[FloatArray], FloatArray], kinks: FloatArray, length: float, widest: float
) -> Table:
    """Tabulate functions of the place, (n, functions), smooth between kinks, on pieces [m]."""
    inside = kinks[(kinks > SAME_PLACE) & (kinks < length - SAME_PLACE)]
    ends = merge_places(np.concatenate([[0.0], inside, [length]]))
    edges = [np.zeros(1)]
    for first, last in itertools.pairwise(ends):
        edges.append(np.linspace(first, last, 1 + int(np.ceil((last - first) / widest)))[1:])
    cuts = np.concatenate(edges)
    widths = np.diff(cuts)
    at = cuts[:-1] + widths * _KNOTS[:, np.newaxis]
    values = function(at.ravel()).reshape(*at.shape, -1)
    powers = np.einsum("qk,kpf->qfp", _TO_POWERS, values)
    off = np.zeros((*powers.shape[:2], 1))
    count = 2 * len(widths)
    bins = np.searchsorted(cuts, np.arange(count + 1) * (length / count), side="right") - 1
    passes = int(np.diff(bins).max())
    bins = np.minimum(bins, len(widths) - 1)
    whole = np.concatenate([powers, off], axis=2)
    return Table(cuts, bins, count / length, passes, whole)
