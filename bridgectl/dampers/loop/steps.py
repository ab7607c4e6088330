"""Steps of a crossing with a damper in the loop: where they begin and end, and their matrices.

Between samples of the controller a crossing is cut where a tire meets stations of the road, the
section or an end of the bridge. Within a step vehicle and modes move freely and exactly; tire
forces R and damper forces F are straight lines through two Gauss points (the stages), and the
road under a tire is one too. With u = y_t - v at the stages and w = y_s' - y_t', of each tire and
damper,

    u = u_free + C_uR (R - W) + C_uF F,    R - W = max(-W, K_t (u - r)),     Eq. (2)
    w = w_free + C_wR (R - W) + C_wF F,    F = c w

which a few substitutions solve, since the masses hardly move within a step: C is small. The
vehicle takes R - W, so that one at rest on a level road stays so to the bit; the beam takes R.
Where a tire leaves or meets the road within a step, or F its limit, the step is cut there: see
`bridgectl.dampers.loop.events`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl.linear.modes import hold_responses, mode_matrices
from bridgectl.model.crossing import Crossing

STAGES = (np.polynomial.legendre.leggauss(2)[0] + 1) / 2
"""Gauss points of a step, as fractions of it."""

POINTS = np.array([*STAGES, 0.5, 1.0])
"""Where a step's responses are needed: stages, middle, end."""

MAX_PHASE = 0.1
"""Largest advance of phase of the vehicle's fastest motion in a step [rad]."""

MAX_MODE_PHASE = 2.0
"""And of the beam's fastest mode [rad]: it moves exactly, but peaks are sought through `POINTS`."""

MAX_LAG = 0.5
"""Largest step after a sample, over the lag of the damping, which then changes fastest."""

FORGOTTEN = 5.0
"""Lags after which a change of the damping is over, as far as steps are concerned."""

MOMENT = slice(-4, None)
"""Last rows of a step on the bridge: the states' share of the moment at all `POINTS`."""

END, ONE = 3, 0
"""The end among `POINTS`; column of the 1 before the states."""


class Rows(NamedTuple):
    """What the rows of a step are, and its columns of forces: at each place every tire's, in turn.

    >>> Rows.of(n_tires=2, n_dampers=1)
    Rows(tire=slice(0, 4, None), damper=slice(4, 6, None), later=slice(6, 10, None), states=10)
    """

    tire: slice
    """Rows of u, and columns of R, at the stages."""
    damper: slice
    """Rows of w, and columns of F, at the stages."""
    later: slice
    """Rows of u at middle and end."""
    states: int
    """First row of the states."""

    @classmethod
    def of(cls, n_tires: int, n_dampers: int) -> Rows:
        """Of a vehicle with so many tires and dampers."""
        forces, first = 2 * n_tires, 2 * (n_tires + n_dampers)
        later = slice(first, first + forces)
        return cls(slice(0, forces), slice(forces, first), later, later.stop)

    @classmethod
    def of_crossing(cls, crossing: Crossing) -> Rows:
        """Of the vehicle of a crossing."""
        return cls.of(crossing.linear.n_tires, len(crossing.linear.damper_map))


@dataclass(frozen=True)
class Plan:
    """Rounds from sample to sample, at each speed its own, in steps; S speeds in rising order.

    All speeds enter the bridge in the same round: the slowest start first and end last.
    """

    edges: FloatArray
    """Ends of the steps [m], (S, rounds, steps + 1); steps that a speed has no use for are
    empty."""
    first: NDArray[np.intp]
    """First round of each speed, (S,), falling."""
    last: NDArray[np.intp]
    """Round after the last of each speed, (S,), falling."""
    entry: int
    """The round in which the bridge is entered."""

    def at_work(self, rounds: slice) -> int:
        """How many of the speeds, counted from the slowest, are under way in some rounds."""
        here = (self.first < rounds.stop) & (self.last > rounds.start)
        return int(here.sum())


def longest_step(crossing: Crossing, c_max: float | FloatArray, n_modes: int) -> float:
    """Return the longest duration of a step [s], for dampings up to c_max [N s/m]."""
    vehicle = crossing.linear
    rates = vehicle.damper_map @ vehicle.velocities
    stiffest = vehicle.state_matrix_on_tires() + (vehicle.damper_input * c_max) @ rates
    fastest = np.abs(np.linalg.eigvals(stiffest)).max()
    return float(
        min(MAX_PHASE / fastest, MAX_MODE_PHASE / np.sort(crossing.beam.omega)[n_modes - 1])
    )


def times_within(sample_time: float, longest: float, lag: float) -> FloatArray:
    """Times after a sample at which a step ends [s], for a lag of the damping [s].

    A step's error goes with the fourth power of its length, and with how fast the damping changes,
    which fades: steps grow as it does.
    """
    times, last = [], 0.0
    while lag and last < FORGOTTEN * lag:
        last += min(longest, MAX_LAG * lag * np.exp(last / lag / 4))
        times.append(last)
    rest = last + longest * np.arange(lag == 0, np.ceil((sample_time - last) / longest))
    every = np.array([*times[:-1], *rest])
    return every[every < sample_time]


def make_plan(
    crossing: Crossing,
    speeds: FloatArray,
    stations: FloatArray,
    sample_time: float,
    parts: FloatArray,
    start: float,
) -> Plan:
    """Cut the way from the start to the last station into rounds and steps.

    Parameters
    ----------
    crossing : Crossing
        Whose bridge and section count; its speed does not.
    speeds : ndarray, shape (S,)
        Speeds [m/s], rising.
    stations : ndarray
        Stations of the road [m].
    sample_time : float
        Duration of a round [s].
    parts : ndarray
        Times within a round at which a step ends [s]: see `times_within`.
    start : float
        Where the reference tire starts [m].
    """
    stop = stations[-1]
    places = _places(crossing, stations)
    lengths = speeds * sample_time
    entries = np.floor(-start / lengths + SAME_PLACE).astype(np.intp)
    counts = np.ceil((stop - start) / lengths - SAME_PLACE).astype(np.intp)
    cuts = []
    for length, speed, count in zip(lengths, speeds, counts, strict=True):
        inner = (start + length * np.arange(count)[:, np.newaxis] + speed * parts).ravel()
        every = np.unique(np.concatenate([places, inner]))
        every = every[(every > start) & (every < stop)]
        rounds = np.floor((every - start) / length + SAME_PLACE / length).astype(np.intp)
        apart = np.append(np.diff(every) > SAME_PLACE, True)
        apart &= np.abs(every - start - length * np.round((every - start) / length)) > SAME_PLACE
        every, rounds = every[apart], rounds[apart]
        cuts.append((every, rounds, np.arange(every.size) - np.searchsorted(rounds, rounds)))
    most = max((int(rank.max(initial=-1)) for *_, rank in cuts), default=-1) + 1
    entry = int(entries.max())
    first = entry - entries
    edges = np.full((len(speeds), int((first + counts).max()), most + 2), stop)
    for i, (every, rounds, rank) in enumerate(cuts):
        samples = np.minimum(start + lengths[i] * np.arange(counts[i] + 1), stop)
        own = edges[i, first[i] : first[i] + counts[i]]
        own[:, 0], own[:, 1:] = samples[:-1], samples[1:, np.newaxis]
        own[rounds, rank + 1] = every
    return Plan(edges, first, first + counts, entry)


def _places(crossing: Crossing, stations: FloatArray) -> FloatArray:
    """Where a tire is at a kink of the road, of the effect or of the bridge [m], rising."""
    each = np.concatenate([stations, crossing.kinks, [0.0, crossing.beam.length]])
    return np.unique(np.add.outer(each, crossing.linear.tire_offsets))


class Responses:
    """Responses of vehicle and modes on their own to initial states and to held forces.

    They are smooth functions of the duration of a step, and read from Chebyshev series.
    """

    def __init__(self, crossing: Crossing, longest: float) -> None:
        phase = crossing.beam.omega.max() * longest
        n_terms = 16 + int(phase)  # beyond half the phase the series falls as fast as factorials
        nodes = np.cos(np.pi * (np.arange(n_terms) + 0.5) / n_terms)
        durations = (nodes[np.newaxis] + 1) / 2 * longest
        vehicle = crossing.linear
        inputs = np.hstack([vehicle.tire_input, vehicle.damper_input])
        found = [
            *hold_responses(vehicle.state_matrix, inputs, durations, STAGES, POINTS),
            *hold_responses(
                *mode_matrices(crossing, crossing.beam.n_modes), durations, STAGES, POINTS
            ),
        ]
        to_series = np.linalg.inv(chebyshev.chebvander(nodes, n_terms - 1))
        self.shapes = [values.shape[2:] for values in found]
        self.series = [to_series @ values[0].reshape(n_terms, -1) for values in found]
        self.longest = longest

    def at(self, durations: FloatArray) -> list[FloatArray]:
        """Return what `hold_responses` does, of vehicle and modes, for durations (S, K) [s]."""
        places = 2 * durations.ravel() / self.longest - 1
        values = chebyshev.chebvander(places, len(self.series[0]) - 1)
        return [
            (values @ series).reshape(*durations.shape, *shape)
            for series, shape in zip(self.series, self.shapes, strict=True)
        ]


@dataclass(frozen=True)
class Steps:
    """Matrices of K steps at each of S speeds, and what the road needs."""

    free: FloatArray
    """From [1, states], (S, K, rows, 1 + n)."""
    forced: FloatArray
    """From [R - W, F] at the stages, (S, K, rows, columns): see `Rows`."""
    influence: FloatArray
    """Moment per tire force at the points, (S, K, 4, T, 1)."""
    durations: FloatArray
    """Durations [s], (S, K)."""
    piece: NDArray[np.intp]
    """Piece of the road that each tire runs on, (S, K, T)."""
    share: FloatArray
    """Fractions of that piece behind the stages, the middle and the end, (S, K, 4, T, 1)."""
    counted: NDArray[np.bool_]
    """Whether a step is one of the crossing of the bridge, (S, K)."""


def make_steps(
    crossing: Crossing,
    responses: Responses,
    speeds: FloatArray,
    edges: FloatArray,
    stations: FloatArray,
    *,
    on_bridge: bool,
) -> Steps:
    """Compute the matrices of steps.

    Parameters
    ----------
    crossing : Crossing
        Beam and vehicle; the vehicle's own damper counts as part of it.
    responses : Responses
        Of that crossing.
    speeds : ndarray, shape (S,)
        Speeds [m/s].
    edges : ndarray, shape (S, rounds, steps + 1)
        See `Plan`; K = rounds x steps.
    stations : ndarray
        Stations of the road [m].
    on_bridge : bool
        False where no step reaches the bridge: of the states the vehicle's alone count then.
    """
    begin, end = (e.reshape(len(edges), -1) for e in (edges[..., :-1], edges[..., 1:]))
    durations = (end - begin) / speeds[:, np.newaxis]
    x = begin[..., np.newaxis] + (end - begin)[..., np.newaxis] * POINTS
    free_vehicle, held_vehicle, free_modes, held_modes = responses.at(durations)
    n, vehicle, rows = crossing.n_vehicle, crossing.linear, Rows.of_crossing(crossing)
    batch, n_modes = durations.shape, crossing.beam.n_modes if on_bridge else 0
    n_states, n_tires = n + 2 * n_modes, vehicle.n_tires
    n_rows = rows.states + n_states + (len(POINTS) if on_bridge else 0)
    free = np.zeros((*batch, n_rows, 1 + n_states))
    forced = np.zeros((*batch, n_rows, rows.damper.stop))
    own, by = slice(1, n + 1), slice(rows.states, rows.states + n)
    # Columns R, then F: at each stage those of all tires, or dampers.
    split = np.split(held_vehicle, [n_tires], axis=-1)
    held = np.concatenate([each.reshape(*each.shape[:-2], -1) for each in split], axis=-1)
    stages, later = slice(0, 2), slice(2, 4)
    rates = vehicle.damper_map @ vehicle.velocities
    for asked, points, read in (
        (rows.tire, stages, vehicle.hubs),
        (rows.damper, stages, rates),
        (rows.later, later, vehicle.hubs),
    ):
        free[..., asked, own] = (read @ free_vehicle[..., points, :, :]).reshape(*batch, -1, n)
        found = read @ held[..., points, :, :]
        forced[..., asked, :] = found.reshape(*batch, -1, rows.damper.stop)
    free[..., by, own], forced[..., by, :] = free_vehicle[..., 3, :, :], held[..., 3, :, :]
    influence = np.zeros((*x.shape, n_tires))
    if on_bridge:
        _add_beam(crossing, free, forced, x, free_modes, held_modes)
        gains = np.where(x <= crossing.exit + SAME_PLACE, 1.0, 0.0)
        influence = gains[..., np.newaxis] * crossing.rows(x).per_force
        free[..., MOMENT, :] *= gains[..., np.newaxis]
        forced[..., MOMENT, :] *= gains[..., np.newaxis]
    counted = (begin > -SAME_PLACE) & (end < crossing.exit + SAME_PLACE)
    return Steps(
        free, forced, influence[..., np.newaxis], durations,
        *_under_tires(crossing.tire_positions(x), stations), counted,
    )  # fmt: skip


def _under_tires(x: FloatArray, stations: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
    """Pieces of the road and fractions of them, for tires at the points (S, K, 4, T) of steps.

    Before its start the road is as high as there.
    """
    middle = np.clip(x[..., 2, :], stations[0], stations[-1])
    piece = np.clip(np.searchsorted(stations, middle, side="right") - 1, 0, stations.size - 2)
    before, length = stations[piece], np.diff(stations)[piece]
    share = (x - before[..., np.newaxis, :]) / length[..., np.newaxis, :]
    return piece, np.maximum(share, 0.0)[..., np.newaxis]


def _add_beam(
    crossing: Crossing,
    free: FloatArray,
    forced: FloatArray,
    x: FloatArray,
    free_modes: FloatArray,
    held_modes: FloatArray,
) -> None:
    """Add the modes to the rows and columns of steps on the bridge."""
    shapes = crossing.tire_shapes(x)  # (..., points, tires, modes)
    n, n_modes, order = crossing.n_vehicle, crossing.beam.n_modes, Rows.of_crossing(crossing)
    first, n_tires = order.states + n, crossing.linear.n_tires
    # Modal states at each point per value of R at each stage, of every tire: (..., modes, points,
    # 2, stages * tires).
    under_stages = np.moveaxis(shapes[..., :2, :, :], -1, -3)[..., None, None, :, :]
    modal = held_modes[..., 0][..., np.newaxis] * under_stages
    modal = modal.reshape(*modal.shape[:-2], -1)
    per_force = np.zeros_like(forced[..., order.tire])
    rows, columns = slice(first, first + 2 * n_modes), slice(1 + n, None)  # of the modes
    tires = np.r_[order.tire, order.later].reshape(len(POINTS), n_tires)
    for (point, tire), row in np.ndenumerate(tires):
        under = shapes[..., point, tire, :, np.newaxis]
        own = under * free_modes[..., point, 0, :]
        free[..., row, columns] -= own.reshape(*own.shape[:-2], -1)
        per_force[..., row, :] = -(under * modal[..., point, 0, :]).sum(axis=-2)
    of_beam = crossing.rows(0.0).per_state[n:].reshape(n_modes, 2)
    for point, row in enumerate(range(-len(POINTS), 0)):  # of `MOMENT`
        own = np.einsum("ja,...jab->...jb", of_beam, free_modes[..., point, :, :])
        free[..., row, columns] = own.reshape(*own.shape[:-2], -1)
        per_force[..., row, :] = np.einsum("ja,...jai->...i", of_beam, modal[..., point, :, :])
    from_modes, at_end = free[..., rows, columns], modal[..., END, :, :]
    for j in range(n_modes):
        pair = slice(2 * j, 2 * j + 2)
        from_modes[..., pair, pair] = free_modes[..., j, END, :, :]
    per_force[..., rows, :] = at_end.reshape(*at_end.shape[:-3], 2 * n_modes, -1)
    forced[..., order.tire] += per_force
    loads = np.tile(crossing.linear.static_loads, 2)
    free[..., ONE] = (loads * per_force).sum(axis=-1)
