"""Peaks of effects of many crossings: where they may be, and then exactly there.

Effects are sampled at the stages of all cells. Between two samples an effect may rise by what its
slope changes there; cells that may hold the peak are cut where a tire meets a kink of the road or
of the effect, and each piece is sampled as the propagator samples a cell.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.linear.cells import GAUSS, N_STAGES
from bridgectl.linear.many.bends import TERMS as MODE_TERMS
from bridgectl.linear.many.bends import moments
from bridgectl.linear.many.maps import TERMS
from bridgectl.linear.many.march import Group, Marched
from bridgectl.linear.many.places import Table
from bridgectl.linear.peaks import KNOTS, TO_FINE, tops

AT_ONCE = 4000
"""Pieces of cells that are sampled together."""

OWN_TERMS = 6
"""Of the response of a tire's hub to a kink under it, within a cell."""

BENT_TERMS = 9
"""Of that of the response to a kink, from the third power on."""

STEP = 0.05
"""Share of a cell over which slopes of mode shapes are taken."""

_FROM_STAGES = np.linalg.inv(np.vander(GAUSS, increasing=True))
"""Powers of s, rising, from values at the stages."""


class Read(NamedTuple):
    """What is read: gains on tire forces by place, or on one tire, and on modal states."""

    gains: Table | None
    tire: int
    kinks: FloatArray
    """Places of kinks of the gains [m]."""
    displacements: FloatArray
    rates: FloatArray
    """Gains on the modal states, (modes,)."""
    sense: float


class Tops(NamedTuple):
    """Peaks of an effect in its unit, and where the reference tire is then [m], (N,)."""

    values: FloatArray
    places: FloatArray


def find_tops(group: Group, marched: Marched, read: Read) -> Tops:
    """Peaks of an effect on the bridge."""
    samples = read.sense * _samples(group, marched, read)
    own, cells = _candidates(samples)
    values, places = _exact(group, marched, read, own, cells)
    return Tops(read.sense * values, places)


def _samples(group: Group, marched: Marched, read: Read) -> FloatArray:
    """The effect at the stages of all cells, (3 C, N); what is off the way counts as lowest."""
    cells = len(marched.loads)
    s = np.arange(cells)[:, np.newaxis] + GAUSS
    x = group.places(s[..., np.newaxis, np.newaxis])
    if read.gains is None:
        values = marched.forces[:, :, read.tire].copy()
    else:
        each = read.gains(x)[0] * marched.forces
        values = each[:, :, 0].copy()
        for tire in range(1, each.shape[2]):
            values += each[:, :, tire]
    for gain, kind in ((read.displacements, 0), (read.rates, 1)):
        for mode in np.flatnonzero(gain).tolist():
            values += gain[mode] * _at_stages(marched, kind, mode)
    flat = values.reshape(-1, values.shape[-1])
    front = (group.start + (group.ahead + s) * group.width).reshape(-1, 1)
    off = (front < 0) | (front > group.last)
    return np.where(off, read.sense * np.min(read.sense * flat, axis=0), flat)


def _at_stages(marched: Marched, kind: int, mode: int) -> FloatArray:
    """Displacements or rates of a mode at the stages, (C, 3, N)."""
    free, held = marched.free[:, kind, mode, :N_STAGES], marched.held[:, kind, mode, :N_STAGES]
    values = free[0] * marched.modes[:-1, 0, mode, np.newaxis]
    values += free[1] * marched.modes[:-1, 1, mode, np.newaxis]
    for stage in range(N_STAGES):
        values += held[stage] * marched.loads[:, mode, stage, np.newaxis]
    return values


def _candidates(samples: FloatArray) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Crossings and cells that may hold their peaks."""
    bends = np.abs(samples[:-2] - 2 * samples[1:-1] + samples[2:])
    bends = np.concatenate([bends[:1], bends, bends[-1:]])
    between = np.maximum(samples[:-1], samples[1:])
    between += np.maximum(bends[:-1], bends[1:])
    ends = samples[[0, -1]] + bends[[0, -1]]
    between = np.concatenate([ends[:1], between, ends[1:]])
    highest = between[:-1].reshape(-1, N_STAGES, samples.shape[1]).max(axis=1)
    highest = np.maximum(highest, between[N_STAGES::N_STAGES])
    cells, own = np.nonzero(highest >= samples.max(axis=0))
    return own, cells


class _Pieces(NamedTuple):
    """Pieces of cells: the candidate of each, and its ends as shares of the cell."""

    of: NDArray[np.intp]
    first: FloatArray
    last: FloatArray


def _pieces(group: Group, read: Read, own: NDArray[np.intp], cells: NDArray[np.intp]) -> _Pieces:
    """Cut cells where forces or gains have kinks, and where the way on the bridge ends."""
    starts = group.start + (group.ahead + cells) * group.width
    offsets = group.fleet.offsets[own]
    road = group.maps.kinks[own].reshape(len(own), -1)
    at = (read.kinks + offsets[..., np.newaxis]).reshape(len(own), -1)
    at = (at - starts[:, np.newaxis]) / group.width
    ends = np.stack([-starts, group.last[own] - starts], axis=1) / group.width
    first, last = np.clip(ends, 0.0, 1.0).T[..., np.newaxis]
    cuts = np.concatenate([road, at, first, last], axis=1)
    cuts = np.sort(np.minimum(np.maximum(cuts, first), last), axis=1)
    candidate, piece = np.nonzero(np.diff(cuts) > 0)
    return _Pieces(candidate, cuts[candidate, piece], cuts[candidate, piece + 1])


def _exact(
    group: Group, marched: Marched, read: Read, own: NDArray[np.intp], cells: NDArray[np.intp]
) -> tuple[FloatArray, FloatArray]:
    """Peaks and places from what is between the samples of cells."""
    inside = _Inside(group, marched, read, own, cells)
    pieces = _pieces(group, read, own, cells)
    values, shares = np.empty((2, len(pieces.of)))
    for first in range(0, len(pieces.of), AT_ONCE):
        part = slice(first, first + AT_ONCE)
        of, start, end = pieces.of[part], pieces.first[part], pieces.last[part]
        s = start[:, np.newaxis] + (end - start)[:, np.newaxis] * KNOTS
        fine = TO_FINE @ inside(of, s)[..., np.newaxis]
        values[part], along = tops(np.ascontiguousarray(fine[..., 0].T))
        shares[part] = start + (end - start) * along
    crossing = own[pieces.of]
    order = np.lexsort((values, crossing))
    count = len(group.speeds)
    best = order[np.searchsorted(crossing[order], np.arange(count), side="right") - 1]
    cell = cells[pieces.of[best]]
    return values[best], group.start + (group.ahead + cell + shares[best]) * group.width


class _Inside:
    """The effect anywhere in candidate cells, from polynomials of hubs and modes."""

    def __init__(
        self, group: Group, marched: Marched, read: Read, own: NDArray[np.intp],
        cells: NDArray[np.intp],
    ) -> None:  # fmt: skip
        self.group, self.read, self.own, self.cells = group, read, own, cells
        maps = group.maps
        self.road = marched.rows[cells, :, :, own]
        self.hubs = self._hubs(marched)
        n_kinks = maps.kinks.shape[1]
        diagonal = np.diagonal(maps.through[1:OWN_TERMS], axis1=2, axis2=3)[:, own]
        self.bent = [
            diagonal * self.road[:, 2 + i]
            / np.array([factorial(p + 2) for p in range(1, OWN_TERMS)])[:, np.newaxis, np.newaxis]
            for i in range(n_kinks)
        ]  # fmt: skip
        self.modes, self.blows = self._modes(marched)

    def _hubs(self, marched: Marched) -> FloatArray:
        """Hub displacements by powers of s without the road's kinks, (TERMS, candidates, K)."""
        maps, own = self.group.maps, self.own
        state = marched.states[self.cells, own][..., np.newaxis]
        powers = np.stack([(of[own] @ state)[..., 0] for of in maps.rows])
        under = marched.surface[self.cells, :, :, own]
        surface = []
        for m in range(N_STAGES):
            terms = [_FROM_STAGES[m, stage] * under[:, stage] for stage in range(N_STAGES)]
            surface.append(terms[0] + terms[1] + terms[2])
        surface[0] = surface[0] + self.road[:, 0]
        surface[1] = surface[1] + self.road[:, 1]
        for m, of in enumerate(surface):
            for p in range(1, TERMS - m - 1):
                share = factorial(m) / factorial(p + m + 1)
                powers[p + m + 1] += share * (maps.through[p][own] @ of[..., np.newaxis])[..., 0]
        return powers

    def _modes(self, marched: Marched) -> tuple[FloatArray, list[tuple[FloatArray, FloatArray]]]:
        """Modal displacements by powers of s without the road's kinks, (powers, candidates, modes).

        And for each kink of every tire in a cell its place (candidates, K), and what it adds by
        powers of s from there, from the third on, (powers, candidates, K, modes).
        """
        cells, own, bridge, fleet = self.cells, self.own, self.group.bridge, self.group.fleet
        width = (self.group.width / self.group.speeds)[own, np.newaxis]
        phase, damping = bridge.omega * width, bridge.damping_ratios
        yields = width**2 / bridge.modal_masses
        loads = marched.loads[cells, :, :, own]
        blows = []
        for i in range(self.group.maps.kinks.shape[1]):
            kinks = self.group.maps.kinks[own, i]
            bends = fleet.tires[own] * self.road[:, 2 + i]
            smooth = moments(kinks)
            for stage, s in enumerate(GAUSS):
                shapes = self.group.shapes(self._tires(own, cells + s))
                for tire in range(kinks.shape[1]):
                    loads[:, :, stage] += (bends * smooth[stage] * shapes)[:, :, tire].T
            shapes, further, before = (
                self.group.shapes(self._tires(own, cells[:, np.newaxis] + kinks + step))
                for step in (0.0, STEP, -STEP)
            )
            slopes = (further - before) / (2 * STEP)
            forces = [-np.moveaxis(bends * of, 0, -1) for of in (shapes, 2 * slopes)]
            blows.append((kinks, self._blows(forces, phase, yields)))
        blows += self._comings(marched, loads, phase, yields)
        start = marched.modes[cells, :, :, own]
        powers = np.zeros((MODE_TERMS, *phase.shape))
        powers[0], powers[1] = start[:, 0], start[:, 1] * width
        for p in range(MODE_TERMS - 2):
            given = -(phase**2) * powers[p] - 2 * damping * phase * (p + 1) * powers[p + 1]
            if p < N_STAGES:
                for stage in range(N_STAGES):
                    given += yields * _FROM_STAGES[p, stage] * loads[:, :, stage]
            powers[p + 2] = given / ((p + 1) * (p + 2))
        return powers, blows

    def _comings(
        self, marched: Marched, loads: FloatArray, phase: FloatArray, yields: FloatArray
    ) -> list[tuple[FloatArray, FloatArray]]:
        """What tires do where shapes have kinks, as where they come on, taken from the loads."""
        group, cells, own = self.group, self.cells, self.own
        found = []
        for place, jump in zip(*group.shapes.slope_jumps(), strict=True):
            way = (place + group.fleet.offsets[own] - group.start) / group.width - group.ahead
            kinks = way - cells[:, np.newaxis]
            here = (kinks >= 0) & (kinks < 1)
            if not here.any():
                continue
            kinks = np.where(here, kinks, 1.0)
            forces = np.where(here, marched.forces[cells, -1, :, own], 0.0)
            forces = forces[..., np.newaxis] * (group.width * jump)
            for stage, smooth in enumerate(moments(kinks)):
                for tire in range(kinks.shape[1]):
                    loads[:, :, stage] -= forces[:, tire] * smooth[:, tire, np.newaxis]
            found.append((kinks, self._blows([forces], phase, yields)))
        return found

    def _blows(
        self, forces: Sequence[FloatArray], phase: FloatArray, yields: FloatArray
    ) -> FloatArray:
        """What forces s, s^2 / 2, ... (candidates, K, modes) from a kink on do, by powers of s."""
        found = np.zeros((BENT_TERMS, *forces[0].shape))
        slowed = (2 * self.group.bridge.damping_ratios * phase)[:, np.newaxis]
        squared = phase[:, np.newaxis] ** 2
        for first, force in enumerate(forces):
            blow, before = force * yields[:, np.newaxis], np.zeros_like(force)
            for term in range(first, BENT_TERMS):
                found[term] += blow / factorial(term + 3)
                blow, before = -squared * before - slowed * blow, blow
        return found

    def _tires(self, own: NDArray[np.intp], cells: FloatArray) -> FloatArray:
        """Places of the tires for places in cells, (n, K)."""
        x = self.group.start + (self.group.ahead + cells) * self.group.width
        return np.asarray(x.reshape(len(own), -1) - self.group.fleet.offsets[own])

    def __call__(self, of: NDArray[np.intp], s: FloatArray) -> FloatArray:
        """The effect times its sense at shares of cells, (n, points)."""
        group, read, own = self.group, self.read, self.own[of]
        modes = self._horner(self.modes[:, of], s)
        for kinks, blows in self.blows:
            for tire in range(blows.shape[2]):
                after = np.maximum(s - kinks[of, tire, np.newaxis], 0.0)
                modes += self._horner(blows[:, of, tire], after) * (after**3)[..., np.newaxis]
        offsets = group.fleet.offsets[own][:, np.newaxis]
        x = group.start + (group.ahead + self.cells[of][:, np.newaxis] + s) * group.width
        tires = x[..., np.newaxis] - offsets
        shapes = group.shapes(tires)
        travel = self._horner(self.hubs[:, of], s)
        for mode, shape in enumerate(shapes):
            travel -= shape * modes[..., mode, np.newaxis]
        road = self.road[of][:, :, np.newaxis]
        s = s[..., np.newaxis]
        travel -= road[:, 0] + road[:, 1] * s
        for i, bent in enumerate(self.bent):
            after = np.maximum(s - group.maps.kinks[own, i][:, np.newaxis], 0.0)
            travel -= road[:, 2 + i] * after
            terms = bent[:, of][:, :, np.newaxis]
            total = terms[-1] * after
            for term in terms[-2::-1]:
                total = (total + term) * after
            travel += total * after**2
        forces = group.fleet.loads[own][:, np.newaxis]
        forces = forces + group.fleet.tires[own][:, np.newaxis] * travel
        if read.gains is None:
            values = forces[..., read.tire].copy()
        else:
            each = read.gains(tires)[0] * forces
            values = each[..., 0].copy()
            for tire in range(1, each.shape[-1]):
                values += each[..., tire]
        for mode in np.flatnonzero(read.displacements).tolist():
            values += read.displacements[mode] * modes[..., mode]
        if read.rates.any():
            widths = (group.width / group.speeds)[own, np.newaxis]
            orders = np.arange(1, MODE_TERMS)[:, np.newaxis, np.newaxis]
            rates = self._horner(orders * self.modes[1:, of], s[..., 0])
            orders = np.arange(3, 3 + BENT_TERMS)[:, np.newaxis, np.newaxis]
            for kinks, blows in self.blows:
                for tire in range(blows.shape[2]):
                    after = np.maximum(s[..., 0] - kinks[of, tire, np.newaxis], 0.0)
                    bent = self._horner(orders * blows[:, of, tire], after)
                    rates += bent * (after**2)[..., np.newaxis]
            for mode in np.flatnonzero(read.rates).tolist():
                values += read.rates[mode] * rates[..., mode] / widths
        return read.sense * values

    @staticmethod
    def _horner(powers: FloatArray, s: FloatArray) -> FloatArray:
        """Polynomials (powers, n, some) at (n, points): (n, points, some)."""
        s = s[..., np.newaxis]
        values = powers[-1][:, np.newaxis] * np.ones_like(s)
        for power in powers[-2::-1]:
            values *= s
            values += power[:, np.newaxis]
        return values
