"""Maps of a cell for many vehicles: what states, road and bridge do to tire forces and states.

A cell takes each vehicle its own duration h. In the time s = t / h, states z = (y, h y'), the
displacements and what they would change in a cell, follow

    z' = A z + B u,    u = r + v,    T y = C z

and every response is a power series in s of the few matrices C A^p, A^p B: all have converged long
before `TERMS`, for no motion advances by more than `MOST_PHASE` in a cell.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.linear.cells import GAUSS, N_STAGES
from bridgectl.linear.many.bends import moments
from bridgectl.model.vehicle import Vehicle

TERMS = 16
"""Of the power series."""

_FROM_STAGES = np.linalg.inv(np.vander(GAUSS, increasing=True))
"""Powers of s, rising, from values at the stages."""


class Fleet(NamedTuple):
    """Vehicles of the same number of coordinates and tires, N of them."""

    stiffness: FloatArray
    """M^-1 (K + T' K_t T) [1/s^2], (N, n, n)."""
    damping: FloatArray
    """M^-1 C [1/s], (N, n, n)."""
    inputs: FloatArray
    """M^-1 T' K_t [1/s^2], (N, n, K)."""
    hubs: FloatArray
    """T, (N, K, n)."""
    rest: FloatArray
    """Coordinates at rest from the road under each tire, (N, n, K)."""
    tires: FloatArray
    """K_t [N/m], (N, K)."""
    loads: FloatArray
    """Static loads [N], (N, K)."""
    offsets: FloatArray
    """Distance of each tire behind the first [m], (N, K)."""
    fastest: FloatArray
    """Fastest motion on a rigid road [rad/s], (N,)."""

    def of(self, which: NDArray[np.intp]) -> Fleet:
        """Some of them."""
        return Fleet(*(each[which] for each in self))


def fleet_of(vehicles: Sequence[Vehicle]) -> Fleet:
    """Stack vehicles of the same shape."""
    mass, damping, stiffness, hubs, tires, loads, offsets = (
        np.stack([getattr(vehicle, name) for vehicle in vehicles])
        for name in (
            "mass_matrix", "damping_matrix", "stiffness_matrix", "tire_map", "tire_stiffnesses",
            "static_loads", "tire_offsets",
        )
    )  # fmt: skip
    springs = np.swapaxes(hubs * tires[..., np.newaxis], 1, 2)
    supported = stiffness + springs @ hubs
    n = mass.shape[-1]
    both = np.linalg.solve(mass, np.concatenate([supported, damping, springs], axis=2))
    own, slow, inputs = both[..., :n], both[..., n : 2 * n], both[..., 2 * n :]
    matrix = np.zeros((len(mass), 2 * n, 2 * n))
    matrix[:, :n, n:] = np.eye(n)
    matrix[:, n:, :n], matrix[:, n:, n:] = -own, -slow
    fastest = np.abs(np.linalg.eigvals(matrix)).max(axis=1)
    rest = np.linalg.solve(supported, springs)
    return Fleet(own, slow, inputs, hubs, rest, tires, loads, offsets, fastest)


class Maps(NamedTuple):
    """Maps of a cell, for N vehicles of n coordinates on K tires, with P kinks a cell and tire.

    Road rows of a cell are [r at its start, rise of it if it goes on as there, P kinks], each of K
    tires: (2 + P) K. Rows of forces at the stages are 3 K, stage by stage.
    """

    kinks: FloatArray
    """Where in a cell each tire's kinks are, (N, P, K)."""
    step: FloatArray
    """Forces at the stages, and states at the end, from states at the start, (N, 3 K + 2 n, 2 n)"""
    drive: FloatArray
    """The same from road rows; forces as parabolas of the same moments, (N, 3 K + 2 n, ...)."""
    surface: FloatArray
    """The same from deflections under the tires at the stages, (N, 3 K + 2 n, 3 K)."""
    smoothed: FloatArray
    """What `drive` adds to forces at the stages for their moments, of each kink, (N, 3, P, K)."""
    rows: FloatArray
    """C A^p / p! for each p, (TERMS, N, K, 2 n)."""
    through: FloatArray
    """C A^p B for each p, (TERMS, N, K, K)."""
    watch: FloatArray
    """Hubs at the tires' own first kinks from states at the start, (N, K, 2 n)."""
    watch_road: FloatArray
    """Their forces from road rows, without `watch`, (N, K, ...)."""


def maps_of(fleet: Fleet, durations: FloatArray, kinks: FloatArray) -> Maps:
    """Maps of cells of a duration each [s], (N,), with kinks of the road in each, (N, P, K)."""
    count, n_tires, n = fleet.hubs.shape
    h = durations[:, np.newaxis, np.newaxis]
    matrix, inputs = np.zeros((count, 2 * n, 2 * n)), np.zeros((count, 2 * n, n_tires))
    matrix[:, :n, n:] = np.eye(n)
    matrix[:, n:, :n], matrix[:, n:, n:] = -(h**2) * fleet.stiffness, -h * fleet.damping
    inputs[:, n:] = h**2 * fleet.inputs
    rows, held = [np.zeros((count, n_tires, 2 * n))], [inputs]
    rows[0][..., :n] = fleet.hubs
    for _ in range(1, TERMS):
        rows.append(rows[-1] @ matrix)
        held.append(matrix @ held[-1])
    through = [rows[0] @ each for each in held]
    step = np.broadcast_to(np.eye(2 * n), matrix.shape)
    for p in range(TERMS, 0, -1):
        step = np.eye(2 * n) + matrix @ step / p
    n_kinks, q = kinks.shape[1], N_STAGES * n_tires
    size = q + 2 * n
    tires = fleet.tires[:, np.newaxis, :, np.newaxis]
    whole, drive = np.zeros((count, size, 2 * n)), np.zeros((count, size, (2 + n_kinks) * n_tires))
    hubs, road = (of[:, :q].reshape(count, N_STAGES, n_tires, -1) for of in (whole, drive))
    whole[:, q:] = step
    road = road.reshape(*road.shape[:3], 2 + n_kinks, n_tires)
    ends = drive[:, q:].reshape(count, 2 * n, 2 + n_kinks, n_tires)
    bent = np.zeros((count, size, n_tires))  # of u = s^2
    bent_hubs = bent[:, :q].reshape(count, N_STAGES, n_tires, n_tires)
    eye = np.eye(n_tires)
    left = 1 - kinks
    for p in range(TERMS):
        for stage, s in enumerate(GAUSS):
            hubs[:, stage] += rows[p] * (s**p / factorial(p))
            road[:, stage, :, 0] += through[p] * (s ** (p + 1) / factorial(p + 1))
            road[:, stage, :, 1] += through[p] * (s ** (p + 2) / factorial(p + 2))
            bent_hubs[:, stage] += through[p] * (2 * s ** (p + 3) / factorial(p + 3))
            after = np.maximum(s - kinks, 0.0)[:, np.newaxis] ** (p + 2) / factorial(p + 2)
            road[:, stage, :, 2:] += through[p][:, :, np.newaxis] * after
        ends[:, :, 0] += held[p] / factorial(p + 1)
        ends[:, :, 1] += held[p] / factorial(p + 2)
        bent[:, q:] += held[p] * (2 / factorial(p + 3))
        ends[:, :, 2:] += held[p][:, :, np.newaxis] * (
            left[:, np.newaxis] ** (p + 2) / factorial(p + 2)
        )
    smoothed = np.moveaxis(moments(kinks), 0, 1).copy()
    for stage, s in enumerate(GAUSS):
        smoothed[:, stage] -= np.maximum(s - kinks, 0.0)
    smoothed *= -fleet.tires[:, np.newaxis, np.newaxis]
    for stage, s in enumerate(GAUSS):
        road[:, stage, :, 0] -= eye
        road[:, stage, :, 1] -= eye * s
        bent_hubs[:, stage] -= eye * s**2
        road[:, stage, :, 2:] -= eye[:, np.newaxis] * np.maximum(s - kinks, 0.0)[:, np.newaxis]
    road *= tires[..., np.newaxis]
    hubs *= tires
    bent_hubs *= tires
    for stage in range(N_STAGES):
        road[:, stage, :, 2:] += eye[:, np.newaxis] * smoothed[:, np.newaxis, stage]
    # Deflections at the stages as powers of s.
    powers = np.stack(
        [
            np.concatenate([road[:, :, :, i].reshape(count, q, n_tires), ends[:, :, i]], axis=1)
            for i in range(2)
        ] + [bent], axis=2,
    )  # fmt: skip
    surface = np.zeros((count, size, N_STAGES, n_tires))
    for stage in range(N_STAGES):
        for power in range(N_STAGES):
            surface[:, :, stage] += powers[:, :, power] * _FROM_STAGES[power, stage]
    own = kinks[:, 0, :, np.newaxis]
    watch = np.zeros_like(rows[0])
    seen = np.zeros((count, n_tires, 2 + n_kinks, n_tires))
    for p in range(TERMS):
        watch += rows[p] * (own**p / factorial(p))
        seen[:, :, 0] += through[p] * (own ** (p + 1) / factorial(p + 1))
        seen[:, :, 1] += through[p] * (own ** (p + 2) / factorial(p + 2))
        after = np.maximum(own[:, :, np.newaxis] - kinks[:, np.newaxis], 0.0)
        seen[:, :, 2:] += through[p][:, :, np.newaxis] * (after ** (p + 2) / factorial(p + 2))
    seen[:, :, 0] -= eye
    seen[:, :, 1] -= eye * own
    return Maps(
        kinks, whole, drive, surface.reshape(count, size, -1), smoothed,
        np.stack([rows[p] / factorial(p) for p in range(TERMS)]), np.stack(through), watch,
        seen.reshape(count, n_tires, -1),
    )  # fmt: skip
