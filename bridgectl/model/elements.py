"""Modes and static influence lines of a straight beam of pieces, by Legendre elements.

The deflection of a piece is Hermite's four cubics of what its ends do, and bubbles that leave the
ends alone. The second derivative of a bubble is a Legendre polynomial, and those of the cubics are
the two lowest ones: bending energy is then a sum of squares, the cubics do not couple with the
bubbles, and a static problem is solved by the cubics alone, exactly.

Kinetic and bending energy are both kept as sums of squares, |B d|^2 and |G d|^2. With R of G = Q R
the modes are the singular vectors of Y = B R^-1, the frequencies 1 / its singular values: no matrix
is squared, w_j is as exact as round-off times w_j / w_1. The degree follows from the wave number:
`degrees` resolves each sine and exponential below the highest frequency to round-off, and as
frequencies of such elements (Rayleigh, Ritz) are never too low, none below is missed, double ones
included.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev, legendre
from numpy.typing import NDArray
from scipy.linalg import block_diag, solve_triangular, svd
from scipy.special import gammaln

from bridgectl._checks import FloatArray

ROUND_OFF = 1e-15
"""Largest Legendre coefficient of a mode shape that is left out, over those kept."""

FEW = 200
"""Places up to which cosines are quicker than a recurrence."""


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes as series in Legendre polynomials of each piece's t, which goes from -1 to 1."""

    omega: FloatArray
    """[rad/s], ascending, shape (n_modes,)."""
    shapes: tuple[FloatArray, ...]
    """Series of the deflection of each piece, shapes (degree + 1, n_modes)."""
    curvatures: tuple[FloatArray, ...]
    """Series of the second derivative [1/m^2], shapes (degree - 1, n_modes)."""

    @cached_property
    def chebyshev(self) -> tuple[FloatArray, ...]:
        """The deflection as Chebyshev series."""
        return tuple(to_chebyshev(series) for series in self.shapes)

    def scaled(self, mass: float) -> Modes:
        """Modes of modal mass 1 kg scaled to another, so that they begin downward.

        That is where a shape first has half its largest value, of places that are six or more
        in each half-wave.
        """
        values = np.vstack(
            [
                chebyshev_values(np.linspace(-1.0, 1.0, 4 * len(series)), series)
                for series in self.chebyshev
            ]
        )
        large = np.abs(values) > np.abs(values).max(axis=0) / 2
        first = np.take_along_axis(values, np.argmax(large, axis=0)[np.newaxis], axis=0)[0]
        scale = np.sign(first) * np.sqrt(mass)
        return Modes(
            self.omega,
            tuple(scale * series for series in self.shapes),
            tuple(scale * series for series in self.curvatures),
        )


@dataclass(frozen=True, eq=False)
class Pieces:
    """A beam of n prismatic pieces, and how its n + 1 nodes are held."""

    edges: FloatArray
    """Places of the nodes [m], shape (n + 1,)."""
    mass: FloatArray
    """Mass per length of each piece [kg/m], shape (n,)."""
    rigidity: FloatArray
    """Flexural rigidity of each piece [N m^2], shape (n,)."""
    springs: FloatArray
    """Stiffness [N/m, N m/rad] against deflection and rotation of the nodes, shape (n + 1, 2)."""

    @cached_property
    def lengths(self) -> FloatArray:
        """Lengths of the pieces [m], shape (n,)."""
        return np.diff(self.edges)

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """Which displacements of the nodes (w, w' of each in turn) are not held rigidly."""
        return np.isfinite(self.springs.ravel())

    @cached_property
    def strains(self) -> FloatArray:
        """G: rows whose squares add up to twice the energy of nodal displacements.

        The springs come first, the mean and the linear part of each piece's curvature after them.
        """
        elastic = self.free & (self.springs.ravel() > 0)
        springs = np.diag(np.sqrt(np.where(elastic, self.springs.ravel(), 0.0)))[elastic]
        bending = np.zeros((2 * len(self.lengths), self.free.size))
        for i, length in enumerate(self.lengths):
            curvatures = derivative(self.cubics[i].T, length, 2)
            own = slice(2 * i, 2 * i + 2), slice(2 * i, 2 * i + 4)
            bending[own] = _rows(self._bending_scale(i, 2)) * curvatures
        return np.vstack([springs, bending])

    @cached_property
    def cubics(self) -> FloatArray:
        """Series of the four cubics of each piece, shape (n, 4, 4)."""
        return np.array([hermite_shapes(length) for length in self.lengths])

    def spread(self, displacements: FloatArray) -> FloatArray:
        """Series of each piece's deflection without bubbles, shape (n, 4)."""
        of_ends = [displacements[2 * i : 2 * i + 4] for i in range(len(self.lengths))]
        return np.einsum("ia,iak->ik", of_ends, self.cubics)

    @cached_property
    def factors(self) -> tuple[FloatArray, FloatArray]:
        """Q and R of G for the displacements that are free."""
        q, r = np.linalg.qr(self.strains[:, self.free])
        return q, r

    def solve(self, forces: FloatArray) -> FloatArray:
        """Nodal displacements under nodal forces, shape (2 n + 2,)."""
        _, r = self.factors
        displacements = np.zeros(self.free.size)
        half = solve_triangular(r, forces[self.free], trans="T")
        displacements[self.free] = solve_triangular(r, half)
        return displacements

    def settled(self, node: int) -> FloatArray:
        """Nodal displacements as a rigid support moves down by 1, shape (2 n + 2,)."""
        q, r = self.factors
        displacements = np.zeros(self.free.size)
        displacements[2 * node] = 1.0
        displacements[self.free] = -solve_triangular(r, q.T @ self.strains[:, 2 * node])
        return displacements

    def modes(self, count: int) -> Modes:
        """The lowest modes, of modal mass 1 kg."""
        waves = np.sum(self.lengths * (self.mass / self.rigidity) ** 0.25)
        # Weyl: sines over the whole bridge; supports shift this by less than one a support.
        highest = float(np.pi * (count + 1) / waves) ** 2
        while True:
            modes = self._modes(count, degrees(self, highest))
            if modes.omega[-1] <= highest:
                return modes
            highest = 1.01 * float(modes.omega[-1])

    def _modes(self, count: int, degree: NDArray[np.int_]) -> Modes:
        q, r = self.factors
        left, periods, right = svd(self._momenta(degree), full_matrices=False)
        omega = 1 / periods[:count]
        strains = omega * right[:count].T
        bending = (q @ strains[: len(r)])[-2 * len(self.lengths) :]
        momenta = np.split(left[:, :count], np.cumsum(degree + 1)[:-1])
        bubbles = np.split(strains[len(r) :], np.cumsum(degree - 3)[:-1])
        curvatures = [np.vstack([bending[2 * i : 2 * i + 2], own]) for i, own in enumerate(bubbles)]
        return Modes(
            omega,
            tuple(_rows(1 / self._mass_scale(i, len(p))) * p for i, p in enumerate(momenta)),
            tuple(_rows(1 / self._bending_scale(i, len(k))) * k for i, k in enumerate(curvatures)),
        )

    def _momenta(self, degree: NDArray[np.int_]) -> FloatArray:
        """Y: rows whose squares add up to twice the kinetic energy of unit strains."""
        _, r = self.factors
        nodal, bubbles = [], []
        for i, n in enumerate(degree + 1):
            scale = _rows(self._mass_scale(i, n))
            cubics = np.zeros((n, self.free.size))
            cubics[:4, 2 * i : 2 * i + 4] = self.cubics[i].T
            nodal.append(scale * cubics)
            half = (self.lengths[i] / 2) ** 2 / self._bending_scale(i, n - 2)[2:]
            bubbles.append(scale * bubble_shapes(n - 1) * half)
        of_nodes = solve_triangular(r, np.vstack(nodal)[:, self.free].T, trans="T").T
        return np.hstack([of_nodes, block_diag(*bubbles)])

    def _mass_scale(self, i: int, count: int) -> FloatArray:
        """Roots of twice the kinetic energy of P_0, P_1, ... as velocities of a piece."""
        return np.asarray(np.sqrt(self.mass[i] * squares(self.lengths[i], count)))

    def _bending_scale(self, i: int, count: int) -> FloatArray:
        """Roots of twice the energy of P_0, P_1, ... as curvatures of a piece."""
        return np.asarray(np.sqrt(self.rigidity[i] * squares(self.lengths[i], count)))


def degrees(pieces: Pieces, omega: float) -> NDArray[np.int_]:
    """Degrees that resolve sines and exponentials of a frequency [rad/s] in each piece.

    The Legendre coefficients of exp(z t) and exp(i z t) are below (z / 2)^k / k!.
    """
    z = pieces.lengths * (pieces.mass / pieces.rigidity) ** 0.25 * np.sqrt(omega) / 2
    k = np.arange(4, 30 + int(4 * z.max()))
    size = k * np.log(z[:, np.newaxis] / 2) - gammaln(k + 1)
    small = (size < np.log(ROUND_OFF)) & (k > z[:, np.newaxis])
    return np.asarray(k[np.argmax(small, axis=1)] + 2)


def hermite_shapes(length: float) -> FloatArray:
    """Legendre series of the cubics of w, w' at the start and w, w' at the end, shape (4, 4)."""
    turn = np.array([1 / 12, -1 / 20, -1 / 12, 1 / 20]) * length
    move = np.array([1 / 2, -3 / 5, 0, 1 / 10])
    mirror = np.array([1, -1, 1, -1])
    return np.array([move, turn, mirror * move, -mirror * turn])


def bubble_shapes(degree: int) -> FloatArray:
    """Series of P_k integrated twice over t for k from 2 on, shape (degree + 1, degree - 3).

    They leave values and slopes at both ends 0.
    """
    k = np.arange(2, degree - 1)
    series = np.zeros((degree + 1, k.size))
    series[k + 2, k - 2] = 1 / ((2 * k + 1) * (2 * k + 3))
    series[k, k - 2] = -2 / ((2 * k - 1) * (2 * k + 3))
    series[k - 2, k - 2] = 1 / ((2 * k - 1) * (2 * k + 1))
    return series


def squares(length: float, count: int) -> FloatArray:
    """Integrals of the squares of P_0, P_1, ... over a piece [m]."""
    return np.asarray(length / (2 * np.arange(count) + 1))


def derivative(series: FloatArray, length: float, order: int) -> FloatArray:
    """Derivative along a piece [1/m] of Legendre series in the first axis."""
    return np.asarray(legendre.legder(series, order) * (2 / length) ** order)


def to_chebyshev(series: FloatArray) -> FloatArray:
    """The same polynomials as series in T_k, which are cosines and quick to have at one place."""
    angles = np.pi * (np.arange(len(series)) + 0.5) / len(series)
    cosines = np.cos(np.outer(np.arange(len(series)), angles))
    values = legendre.legval(np.cos(angles), series).T
    coefficients = 2 / len(series) * cosines @ values
    coefficients[0] /= 2
    return np.asarray(coefficients)


def chebyshev_values(t: FloatArray, series: FloatArray) -> FloatArray:
    """Values of Chebyshev series in the first axis at each t, shape (m, ...)."""
    if t.size > FEW:
        return np.asarray(chebyshev.chebvander(t, len(series) - 1) @ series)
    return np.asarray(np.cos(np.multiply.outer(np.arccos(t), np.arange(len(series)))) @ series)


def _rows(scale: FloatArray) -> FloatArray:
    """Factors of the rows of a matrix."""
    return scale[:, np.newaxis]
