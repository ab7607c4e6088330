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
from bridgectl.dampers.actuator import Damper, bare_vehicle
from bridgectl.dampers.loop.advance import BETWEEN, CLOSE
from bridgectl.dampers.loop.closed_loop import checked_roads
from bridgectl.dampers.loop.steps import (
    DAMPER,
    MOMENT,
    POINTS,
    STATES,
    TIRE,
    TIRE_LATER,
    Responses,
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
from bridgectl.road.elevations import drops_of

N_POINTS = len(POINTS)

RATES, END, AFTER, MOMENTS = slice(0, 2), 2, slice(3, -N_POINTS), slice(-N_POINTS, None)
"""Rows of `_Maps`: suspension velocities w, u - r at the end, states at the end, moments."""

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
    beam: BridgeModel, vehicle: QuarterCar, speed: float, positions: ArrayLike, dampings: ArrayLike,
    stations: ArrayLike, elevations: ArrayLike, *, section: float = 0.5, recovery: str = "exact",
) -> Sensitivity:  # fmt: skip
    """Return the DAF of roads with a damping program, and its gradient.

    The damper is one of the default kind: see `Damper`.

    Parameters
    ----------
    beam, section, recovery
        See `bridgectl.Crossing`.
    vehicle : QuarterCar
        The vehicle; its passive damper is taken out.
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
    crossing = make_crossing(beam, bare_vehicle(vehicle), "moment", section, recovery)
    require_factor(crossing)
    x, z = checked_roads(beam, stations, elevations)
    speeds = np.array([Motion(speed).speed])
    judge_crossing(crossing, speeds[0])
    require_loop(crossing, [Damper(law)], speeds, x, len(z))
    steps, sampled = _steps(crossing, Damper(law), speeds, x)
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
    return Sensitivity(np.concatenate(dafs), np.concatenate(at_steps) @ shares.T)


def _steps(
    crossing: Crossing, damper: Damper, speeds: FloatArray, stations: FloatArray
) -> tuple[Steps, FloatArray]:
    """The closed loop's steps of one speed, and where the damping of each was sampled [m]."""
    dt = damper.sample_time
    longest = min(longest_step(crossing, damper.strategy.c_max, crossing.beam.n_modes), dt)
    parts = times_within(dt, longest, damper.lag)
    edges = make_plan(crossing, speeds, stations, dt, parts).edges
    some = np.diff(edges).ravel() > 0  # the others fill up rounds
    each = np.stack([edges[..., :-1].ravel(), edges[..., 1:].ravel()], axis=1)[some]
    responses = Responses(crossing, longest)
    steps = make_steps(crossing, responses, speeds, each[np.newaxis], stations, on_bridge=True)
    return steps, np.repeat(edges[0, :, 0], edges.shape[2] - 1)[some]


class _Maps(NamedTuple):
    """K steps with their damping, to [w, u - r at the end, states at the end, moments]."""

    given: FloatArray
    """From [1, states, road at the stations before and after], (K, 3 + n + 4, 1 + n + 2)."""
    force: FloatArray
    """From a damper force added at the stages, (K, 3 + n + 4, 2)."""
    piece: NDArray[np.intp]
    """Station before each step, (K,)."""


def _maps(crossing: Crossing, steps: Steps, c: FloatArray) -> _Maps:
    """Steps with the damping of each [N s/m], (K,)."""
    stiffness = crossing.linear.tire_stiffnesses[0]
    free, forced, share, influence = (
        of[0] for of in (steps.free, steps.forced, steps.share, steps.influence)
    )
    # The road is one more thing that is given, and counts in u alone.
    given = np.pad(free, ((0, 0), (0, 0), (0, 2)))
    for rows, points in ((TIRE, slice(0, 2)), (TIRE_LATER, slice(2, 4))):
        given[:, rows, -2:] -= np.concatenate([1 - share, share], axis=2)[:, points]
    tied = np.zeros((len(c), 4))
    tied[:, TIRE], tied[:, DAMPER] = stiffness, c[:, np.newaxis]
    by_force = np.linalg.inv(np.eye(4) - tied[..., np.newaxis] * forced[:, : DAMPER.stop])
    gains = forced @ by_force
    given += gains @ (tied[..., np.newaxis] * given[:, : DAMPER.stop])
    for every in (given, gains):
        tires = np.concatenate([every[:, TIRE], every[:, TIRE_LATER]], axis=1)
        every[:, MOMENT] += influence * stiffness * tires
    given[:, MOMENT, :1] += influence * crossing.linear.static_loads[0]
    n = crossing.n_states
    asked = np.r_[DAMPER, TIRE_LATER.stop - 1, STATES : STATES + n, -N_POINTS:0]
    return _Maps(given[:, asked], gains[:, asked, DAMPER], steps.piece[0])


def _forward(maps: _Maps, drops: FloatArray, crossing: Crossing) -> tuple[FloatArray, FloatArray]:
    """Suspension velocities (K, 2, R) and moments (K, 4, R)."""
    n_steps, _, n_given = maps.given.shape
    given = np.zeros((n_given, drops.shape[1]))
    given[0] = 1.0
    rates = np.empty((n_steps, 2, drops.shape[1]))
    moments, least = np.empty((n_steps, N_POINTS, drops.shape[1])), 0.0
    for k, (step, piece) in enumerate(zip(maps.given, maps.piece, strict=True)):
        given[-2:] = drops[piece : piece + 2]
        found = step @ given
        rates[k], moments[k], given[1:-2] = found[RATES], found[MOMENTS], found[AFTER]
        least = min(least, float(found[END].min()))
    if crossing.linear.static_loads[0] + crossing.linear.tire_stiffnesses[0] * least < 0:
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
    """Change of each road's largest moment per damping of each step [m/(N s)], (R, K)."""
    n_steps, n_roads, _ = weights.shape
    found = np.empty((n_steps, n_roads))
    outputs = np.zeros((n_roads, maps.force.shape[1] - AFTER.start))
    for k in range(n_steps - 1, -1, -1):
        outputs[:, MOMENTS] = weights[k]
        found[k] = np.einsum("ri,ir->r", outputs @ maps.force[k, AFTER.start :], rates[k])
        outputs[:, :-N_POINTS] = outputs @ maps.given[k, AFTER.start :, 1:-2]
    return found.T
