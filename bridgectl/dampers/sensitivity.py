"""What each damping of a program does to the peak moment: an exact gradient for many roads at once.

A program makes a crossing a chain of linear steps (see `loop.steps`), in each of which a
damping c_k is held, while the tire stays on the road. With the states s, the road d under the tire,
f = [R - W, F] at the stages, and z = [u, w], deflection of the tire and suspension velocity,

    z = A_z s - d + C f,   f = D z,   D = diag(K_t, K_t, c_k, c_k)
    f = (I - D C)^-1 D (A_z s - d),   df = (I - D C)^-1 [0, w] dc_k

The peak M(t*) moves with dc_k as the moment at t* does (Danskin: at a maximum a change of its place
counts for nothing), so that one row lambda' for each road, taken back from t* through the steps,
has every dM / dc_k = lambda' (dx / df) df / dc_k.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing
from bridgectl._threads import on_one_thread
from bridgectl._warn import warn
from bridgectl.dampers.fitted import Fitted, fitted
from bridgectl.dampers.legs import Legs
from bridgectl.dampers.loop.advance import BETWEEN, CLOSE
from bridgectl.dampers.loop.closed_loop import checked_roads
from bridgectl.dampers.loop.loop import level_beyond
from bridgectl.dampers.loop.steps import (
    MOMENT,
    POINTS,
    Responses,
    Rows,
    Steps,
    longest_step,
    make_plan,
    make_steps,
    times_within,
)
from bridgectl.dampers.loop.work import require_loop
from bridgectl.dampers.program import program
from bridgectl.linear.lift_off import LiftOffWarning
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing, make_crossing, require_factor
from bridgectl.model.motion import Motion
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road.elevations import drops_of

N_POINTS = len(POINTS)

ROADS_AT_ONCE = 250
"""Roads whose histories are in memory together."""


class Sensitivity(NamedTuple):
    """DAF of a program and its gradient, made by `program_sensitivity`."""

    daf: FloatArray
    """Peak moment over the peak static one of each road [-], shape (n_roads,)."""
    gradient: FloatArray
    """Its change per damping of each position [m/(N s)], shape (n_roads, n_positions)."""

    def __repr__(self) -> str:
        steepest = 1e3 * np.abs(self.gradient).max()
        return (
            f"Sensitivity({self.daf.size} roads, DAF from {self.daf.min():.4f} to "
            f"{self.daf.max():.4f}, changing by up to {steepest:.3g} for 1 kN s/m)"
        )


@on_one_thread
def program_sensitivity(
    beam: BridgeModel, vehicle: Vehicle | QuarterCar, speed: float, positions: ArrayLike,
    dampings: ArrayLike, stations: ArrayLike, elevations: ArrayLike, *, section: float = 0.5,
    recovery: str = "exact",
) -> Sensitivity:  # fmt: skip
    """Return the DAF of roads with a damping program, and its gradient.

    Each damper is one of the default kind: see `Damper`.

    Parameters
    ----------
    beam, section, recovery
        See `bridgectl.Crossing`.
    vehicle : Vehicle or QuarterCar
        The vehicle; its passive dampers are taken out, and each follows the program.
    speed : float
        Speed c [m/s].
    positions, dampings : array_like, shape (n_positions,)
        Places [m] and dampings there [N s/m], with straight lines between: see
        `bridgectl.dampers.program`.
    stations, elevations : array_like
        Roads [m]: see `simulate_loop`.

    Returns
    -------
    Sensitivity

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Warns
    -----
    LiftOffWarning
        If a tire would have to pull: DAF and gradient then are those of one that does.

    Examples
    --------
    Where more damping lowers the peak moment of a road, and where less:

    >>> import bridgectl as bc
    >>> from bridgectl.dampers import program_sensitivity
    >>> road = bc.iso8608_profile("A", 45, seed=1, start=-20)
    >>> found = program_sensitivity(
    ...     bc.li2006.beam(), bc.li2006.car(), 30.0, [-10, 0, 5, 10], [7e3] * 4, road.x,
    ...     road.elevation)
    >>> found
    Sensitivity(1 roads, DAF from 1.1544 to 1.1544, changing by up to 0.00122 for 1 kN s/m)
    >>> (1e3 * found.gradient).round(4)  # per kN s/m
    array([[ 0.0002,  0.0002,  0.0012, -0.0002]])
    """
    law = program(positions, dampings, shape="lines")
    crossing = make_crossing(beam, vehicle, "moment", section, recovery)
    require_factor(crossing)
    devices = fitted(law, vehicle)
    crossing = devices.bare(crossing)
    x, z = level_beyond(crossing, *checked_roads(beam, stations, elevations))
    speeds = np.array([Motion(speed).speed])
    judge_crossing(crossing, speeds[0])
    require_loop(crossing, [devices], speeds, x, len(z))
    steps, sampled = _steps(crossing, devices, speeds, x)
    maps = _maps(crossing, steps, law.command(position=sampled))
    drops = drops_of(z)
    dafs, at_steps = [], []
    for first in range(0, len(z), ROADS_AT_ONCE):
        rates, moments = _forward(maps, drops[:, first : first + ROADS_AT_ONCE], crossing)
        daf, weights = _peaks(moments)
        dafs.append(daf)
        at_steps.append(_backward(maps, rates, weights))
    places = check.floats("positions", positions)
    shares = np.array([np.interp(sampled, places, one) for one in np.eye(places.size)])
    gradients = np.einsum("rkd,pkd->rp", np.concatenate(at_steps), shares)
    return Sensitivity(np.concatenate(dafs), gradients)


def _steps(
    crossing: Crossing, dampers: Fitted, speeds: FloatArray, stations: FloatArray
) -> tuple[Steps, FloatArray]:
    """The closed loop's steps of one speed, and where each damper was sampled [m], (K, D)."""
    dt = dampers.sample_time
    longest = min(longest_step(crossing, dampers.dampings, crossing.beam.n_modes), dt)
    within = times_within(dt, longest, 0.0)
    edges = make_plan(crossing, speeds, stations, dt, within, stations[0]).edges
    some = np.diff(edges).ravel() > 0  # the others fill up rounds
    each = np.stack([edges[..., :-1].ravel(), edges[..., 1:].ravel()], axis=1)[some]
    responses = Responses(crossing, longest)
    steps = make_steps(crossing, responses, speeds, each[np.newaxis], stations, on_bridge=True)
    sampled = np.repeat(edges[0, :, 0], edges.shape[2] - 1)[some]
    return steps, sampled[:, np.newaxis] - Legs(crossing.linear).offsets


class _Maps(NamedTuple):
    """K steps with their dampings, to [w, u - r at the end, states at the end, moments]."""

    given: FloatArray
    """From [1, states, road at the stations before and after each tire], (K, rows, 1 + n + 2 T)."""
    force: FloatArray
    """From damper forces added at the stages, (K, rows, 2 D)."""
    piece: NDArray[np.intp]
    """Station before each tire in each step, (K, T)."""
    rates: slice
    """Rows of w."""
    ends: slice
    """Rows of u - r at the end; those of the states and the moments follow."""


def _maps(crossing: Crossing, steps: Steps, c: FloatArray) -> _Maps:
    """Steps with the dampings of each [N s/m], (K, D)."""
    rows, n_tires = Rows.of_crossing(crossing), crossing.linear.n_tires
    stiffness = np.tile(crossing.linear.tire_stiffnesses, 2)
    free, forced, share, influence = (
        of[0] for of in (steps.free, steps.forced, steps.share, steps.influence)
    )
    # The road is one more thing that is given, and counts in u alone.
    given = np.pad(free, ((0, 0), (0, 0), (0, 2 * n_tires)))
    for each, points in ((rows.tire, slice(0, 2)), (rows.later, slice(2, 4))):
        for tire in range(n_tires):
            own = np.arange(each.start + tire, each.stop, n_tires)
            here = share[:, points, tire, 0]
            given[:, own, tire - 2 * n_tires] -= 1 - here
            given[:, own, tire - n_tires] -= here
    tied = np.zeros((len(c), rows.damper.stop))
    tied[:, rows.tire], tied[:, rows.damper] = stiffness, np.tile(c, 2)
    together = tied[..., np.newaxis] * forced[:, : rows.damper.stop]
    by_force = np.linalg.inv(np.eye(rows.damper.stop) - together)
    gains = forced @ by_force
    given += gains @ (tied[..., np.newaxis] * given[:, : rows.damper.stop])
    loads = crossing.linear.static_loads
    for every in (given, gains):
        tires = np.concatenate([every[:, rows.tire], every[:, rows.later]], axis=1)
        tires = tires.reshape(len(c), N_POINTS, n_tires, -1)
        stiff = crossing.linear.tire_stiffnesses[:, np.newaxis] * influence
        every[:, MOMENT] += (stiff * tires).sum(axis=2)
    given[:, MOMENT, 0] += (influence[..., 0] * loads).sum(axis=2)
    n_rates = rows.damper.stop - rows.damper.start
    asked = np.r_[
        rows.damper, rows.later.stop - n_tires : rows.states + crossing.n_states, -N_POINTS:0
    ]
    return _Maps(
        given[:, asked], gains[:, asked, rows.damper], steps.piece[0], slice(0, n_rates),
        slice(n_rates, n_rates + n_tires),
    )  # fmt: skip


def _forward(maps: _Maps, drops: FloatArray, crossing: Crossing) -> tuple[FloatArray, FloatArray]:
    """Suspension velocities (K, 2 D, R) and moments (K, 4, R)."""
    n_steps, _, n_given = maps.given.shape
    vehicle, n_tires, n_roads = crossing.linear, crossing.linear.n_tires, drops.shape[1]
    given = np.zeros((n_given, n_roads))
    given[0] = 1.0
    rates = np.empty((n_steps, maps.rates.stop, n_roads))
    moments, least = np.empty((n_steps, N_POINTS, n_roads)), 0.0
    weights = vehicle.static_loads / vehicle.tire_stiffnesses
    for k, (step, piece) in enumerate(zip(maps.given, maps.piece, strict=True)):
        given[-2 * n_tires : -n_tires], given[-n_tires:] = drops[piece], drops[piece + 1]
        found = step @ given
        rates[k], moments[k] = found[maps.rates], found[-N_POINTS:]
        given[1 : -2 * n_tires] = found[maps.ends.stop : -N_POINTS]
        least = min(least, float((found[maps.ends] / weights[:, np.newaxis]).min()))
    if least < -1:
        warn(
            "a tire leaves the road: DAF and gradient are those of one that could pull",
            LiftOffWarning,
        )
    return rates, moments


def _peaks(moments: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Largest moment of each road (R,), and its change per moment at each point (K, R, 4).

    As the closed loop has it: of the quartics through the moments at start and points of a step.
    """
    samples = np.concatenate([np.zeros_like(moments[:, :1]), moments], axis=1)
    samples[1:, 0] = moments[:-1, -1]
    highest = moments.max(axis=1)
    steps, roads = np.nonzero(highest > (1 - CLOSE) * highest.max(axis=0))
    between = samples[steps, :, roads] @ BETWEEN
    order = np.lexsort((between.max(axis=1), roads))
    best = order[np.searchsorted(roads[order], np.arange(moments.shape[2]), side="right") - 1]
    step, place, road = steps[best], between[best].argmax(axis=1), roads[best]
    weights = np.zeros((len(moments), moments.shape[2], N_POINTS))
    weights[step, road] = BETWEEN[1:, place].T
    weights[step - 1, road, -1] += BETWEEN[0, place]  # there is none in the very first step
    return between[best, place], weights


def _backward(maps: _Maps, rates: FloatArray, weights: FloatArray) -> FloatArray:
    """Change of each road's largest moment per damping of each step [m/(N s)], (R, K, D)."""
    n_steps, n_roads, _ = weights.shape
    first, n_tires = maps.ends.stop, maps.piece.shape[1]
    found = np.empty((n_steps, n_roads, maps.rates.stop // 2))
    outputs = np.zeros((n_roads, maps.force.shape[1] - first))
    for k in range(n_steps - 1, -1, -1):
        outputs[:, -N_POINTS:] = weights[k]
        each = (outputs @ maps.force[k, first:]) * rates[k].T
        found[k] = each.reshape(n_roads, 2, -1).sum(axis=1)
        outputs[:, :-N_POINTS] = outputs @ maps.given[k, first:, 1 : -2 * n_tires]
    return np.swapaxes(found, 0, 1)
