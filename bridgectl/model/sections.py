"""What a section of a beam of pieces feels: static influence lines, and effects of mode shapes.

A force on a piece acts on the nodes through the cubics, and on a section of its own piece also as
on a piece clamped at both ends. Both are exact. Moments are sagging positive, deflections downward,
shear is the derivative of the moment, reactions push upward.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl.model.elements import Modes, Pieces, chebyshev_values, derivative, squares

ORDERS = {"deflection": 0, "moment": 2, "shear": 3}
"""Derivative of the deflection that each effect at a section is, E J times its negative."""


def located(
    pieces: Pieces, x: FloatArray
) -> tuple[NDArray[np.bool_], NDArray[np.int_], FloatArray]:
    """Whether places are on the bridge, the piece of each (at a node that after), and its t."""
    edges = pieces.edges
    on_bridge = (x >= -SAME_PLACE) & (x <= edges[-1] + SAME_PLACE)
    piece = np.searchsorted(edges[1:-1], x, side="right")
    t = 2 * (x - edges[piece]) / pieces.lengths[piece] - 1
    return on_bridge, piece, np.minimum(np.maximum(t, -1.0), 1.0)


def along(pieces: Pieces, x: ArrayLike, of_pieces: tuple[FloatArray, ...]) -> FloatArray:
    """Values at places [m], zero off the bridge, of Chebyshev series in t for each piece."""
    _checks.refuse_masked("x", x)
    position = np.asarray(x, dtype=np.float64)
    on_bridge, piece, t = located(pieces, position.ravel())
    result = np.zeros((position.size, of_pieces[0].shape[1]))
    for i in range(piece.min(initial=len(of_pieces)), piece.max(initial=-1) + 1):
        here = np.flatnonzero(on_bridge & (piece == i))
        result[here] = chebyshev_values(t[here], of_pieces[i])
    return result.reshape(*position.shape, result.shape[1])


def line_at_section(pieces: Pieces, x: FloatArray, at: float, quantity: str) -> FloatArray:
    """Moment, shear or deflection at a place under a unit force at each x, zero off the beam."""
    own, t = _before(pieces, at)
    on_bridge, piece, t_force = located(pieces, x)
    result = _interpolated(_section_series(pieces, own, t, quantity), piece, t_force)
    here, length = piece == own, float(pieces.lengths[own])
    result[here] += clamped_effect(
        quantity, length * (1 + t) / 2, length * (1 + t_force[here]) / 2, length,
        float(pieces.rigidity[own]),
    )  # fmt: skip
    return np.where(on_bridge, result, 0.0)


def line_of_reaction(pieces: Pieces, x: FloatArray, node: int) -> FloatArray:
    """Force of a node's support under a unit force at each x, zero off the beam.

    That is the deflection as the support, if rigid, moves down by 1.
    """
    on_bridge, piece, t = located(pieces, x)
    return np.where(on_bridge, _interpolated(_reaction_series(pieces, node), piece, t), 0.0)


@lru_cache(maxsize=64)
def _section_series(pieces: Pieces, own: int, t: float, quantity: str) -> FloatArray:
    """What the nodes bring about of an effect at t of a piece, series of each piece."""
    forces = np.zeros(pieces.free.size)
    series = derivative(pieces.cubics[own].T, pieces.lengths[own], ORDERS[quantity])
    stiffness = 1.0 if quantity == "deflection" else -pieces.rigidity[own]
    forces[2 * own : 2 * own + 4] = stiffness * legendre.legval(t, series)
    return pieces.spread(pieces.solve(forces))


@lru_cache(maxsize=64)
def _reaction_series(pieces: Pieces, node: int) -> FloatArray:
    """Deflection as a rigid support moves down by 1, or a spring is pushed by its stiffness."""
    stiffness = pieces.springs[node, 0]
    if np.isinf(stiffness):
        return pieces.spread(pieces.settled(node))
    forces = np.zeros(pieces.free.size)
    forces[2 * node] = stiffness
    return pieces.spread(pieces.solve(forces))


def _interpolated(series: FloatArray, piece: NDArray[np.int_], t: FloatArray) -> FloatArray:
    """Values of cubic series of each piece at t of some."""
    return np.asarray(np.sum(series[piece] * legendre.legvander(t, 3), axis=-1))


def modes_at_section(pieces: Pieces, modes: Modes, at: float, quantity: str) -> FloatArray:
    """Moment, shear or deflection at a place per modal coordinate, shape (n_modes,)."""
    own, t = _before(pieces, at)
    if quantity == "deflection":
        return np.asarray(legendre.legval(t, modes.shapes[own]))
    series = derivative(modes.curvatures[own], pieces.lengths[own], ORDERS[quantity] - 2)
    return np.asarray(-pieces.rigidity[own] * legendre.legval(t, series))


def modes_of_reaction(pieces: Pieces, modes: Modes, node: int) -> FloatArray:
    """Force of a node's support per modal coordinate, shape (n_modes,).

    Of a rigid one it is the inertia that the node's cubics carry, less what their bending takes.
    """
    # The end of the piece before the node, and the start of the piece after it.
    sides = [(i, cubic) for i, cubic in ((node - 1, 2), (node, 0)) if 0 <= i < len(modes.shapes)]
    stiffness = pieces.springs[node, 0]
    if np.isfinite(stiffness):
        i, cubic = sides[0]
        return np.asarray(stiffness * legendre.legval(cubic - 1, modes.shapes[i]))
    total = np.zeros(modes.omega.size)
    for i, cubic in sides:
        length, shape = pieces.lengths[i], pieces.cubics[i, cubic]
        inertia = (shape * squares(length, 4)) @ modes.shapes[i][:4]
        bending = (derivative(shape, length, 2) * squares(length, 2)) @ modes.curvatures[i][:2]
        total += pieces.mass[i] * modes.omega**2 * inertia - pieces.rigidity[i] * bending
    return total


def clamped_effect(
    quantity: str, at: float, force: FloatArray, length: float, rigidity: float
) -> FloatArray:
    """Effect at a section of a piece clamped at both ends of a unit force on it.

    Parameters
    ----------
    quantity : {'moment', 'shear', 'deflection'}
        [N m / N], [-] or [m/N].
    at : float
        The section, from the start of the piece [m].
    force : ndarray
        Places of the force [m]. At the section it counts as just beyond it, at the end of the
        piece as just before it.
    length, rigidity : float
        Of the piece [m, N m^2].
    """
    beyond = (force > at) | ((force > at - SAME_PLACE) & (at < length - SAME_PLACE))
    # The section seen from the end that has no force before it: mirrored for the other one.
    s = np.where(beyond, at, length - at)
    a = np.where(beyond, force, length - force)
    b = length - a
    slope = b**2 * (3 * a + b) / length**3
    if quantity == "shear":
        return np.where(beyond, slope, -slope)
    if quantity == "moment":
        return np.asarray(s * slope - a * b**2 / length**2)
    return np.asarray(s**2 * (3 * a * b**2 / length**2 - s * slope) / (6 * rigidity))


def _before(pieces: Pieces, at: float) -> tuple[int, float]:
    """The piece of a section, at a node that before it, and its t."""
    own = int(np.searchsorted(pieces.edges[1:-1], at - SAME_PLACE))
    return own, float(2 * (at - pieces.edges[own]) / pieces.lengths[own] - 1)
