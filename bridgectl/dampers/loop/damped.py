"""What the rest of the package asks of crossings with dampers: responses, DAFs, ramp surfaces."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, merge_places
from bridgectl._threads import on_one_thread
from bridgectl._warn import warn
from bridgectl.dampers.actuator import with_damping
from bridgectl.dampers.fitted import Fitted
from bridgectl.dampers.loop.advance import Ends
from bridgectl.dampers.loop.closed_loop import run_loop
from bridgectl.dampers.loop.loop import Loop
from bridgectl.dampers.loop.result import LoopResult
from bridgectl.dampers.loop.work import require_loop
from bridgectl.linear.lift_off import LiftOffWarning, warn_of_flight, warn_of_flights
from bridgectl.linear.runs import Run
from bridgectl.model.crossing import Crossing
from bridgectl.surface.compute import RampGrid, linear_surface
from bridgectl.surface.histories import FeedbackHistories
from bridgectl.surface.surface import RampSurface


def damped_dafs(run: Run, dampers: Fitted, speeds: FloatArray) -> FloatArray:
    """Return the DAF of one road at some speeds [m/s], shape (n_speeds,)."""
    found = simulate_run(run, dampers, speeds)
    places = dict(zip(speeds.tolist(), found.lift_off[:, 0].tolist(), strict=True))
    warn_of_flights({c: x for c, x in places.items() if x < np.inf}, speeds.size)
    return found.daf[:, 0]


@on_one_thread
def simulate_run(run: Run, dampers: Fitted, speeds: FloatArray) -> LoopResult:
    """Simulate one road at some speeds [m/s]: see `simulate_loop`."""
    x = _stations(run, np.zeros(0))
    crossing = dampers.bare(run.crossing)
    return run_loop(crossing, dampers, speeds, x, _elevations(run, x), start=run.start)


@on_one_thread
def damped_response(
    run: Run, speed: float, dampers: Fitted, asked: FloatArray
) -> tuple[Run, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return a run of one crossing without the dampers' passive ones, and what happened in it.

    That is places [m], states, tire forces and damper forces [N], of shapes (m,), (n, m),
    (n_tires, m) and (n_dampers, m): at places that are asked for [m], by default the ends of all
    steps. The passive dampers that stay are no forces but part of the vehicle.
    """
    crossing = dampers.bare(run.crossing)
    x = _stations(run, asked)
    speeds = np.array([speed])
    require_loop(crossing, [dampers], speeds, x, 1)
    loop = Loop(crossing, dampers, speeds, x, _elevations(run, x), start=run.start)
    first = loop.at_start()
    places: list[float] = [run.start]
    states: list[FloatArray] = [first.states[0, 1:, 0]]
    forces: list[FloatArray] = [first.force[0, :, 0]]
    dampings: list[FloatArray] = [np.zeros(len(dampers.legs))]

    def keep(now: Ends, place: float) -> None:
        places.append(place)
        states.append(now.states[0, 1:, 0].copy())
        forces.append(now.force[0, :, 0].copy())
        dampings.append(now.damping[0, :, 0].copy())

    place = float(loop.run(keep).lift_off[0, 0])
    if place < np.inf:
        warn_of_flight(place)
    every = np.array(places)
    wanted = asked if asked.size else every
    index = np.minimum(np.searchsorted(every, wanted - SAME_PLACE), every.size - 1)
    columns, tires, c = (np.array(of).T[:, index] for of in (states, forces, dampings))
    velocity = loop.stepper.velocity(columns[np.newaxis])
    whole = len(run.crossing.linear.damper_map)
    force = np.zeros((whole, wanted.size))
    force[list(dampers.legs)] = loop.stepper.damper_force(c[np.newaxis], velocity)[0]
    still = replace(crossing, vehicle=dampers.without(run.crossing.vehicle))
    return run._replace(crossing=still), wanted, columns, tires, force


class RampsAndRoads(NamedTuple):
    """DAFs of a smooth road, of unit ramps and of roads, from one run."""

    smooth: FloatArray
    """Shape (n_speeds,)."""
    unit: FloatArray
    """DAF of a ramp at every place, shape (n_speeds, n_ramps)."""
    roads: LoopResult
    """Of the roads, with what was recorded."""
    flights: int
    """Number of crossings of a ramp whose tire leaves the road."""


def damped_surface(
    crossing: Crossing, dampers: Fitted, speeds: FloatArray, grid: RampGrid, name: str
) -> RampSurface:
    """Return the surface of dampers that are not constant: see `bridgectl.ramp_surface`.

    It is called by the name of all dampers, constant ones too.
    """
    histories = FeedbackHistories(name)
    if dampers.kept is not None:
        smooth, ramps = _best_kept(crossing, dampers, speeds, grid)
        return grid.surface(crossing, speeds, smooth, ramps, histories)
    heights, starts = grid.heights, np.arange(0, grid.n_ramps, grid.every)
    kept = np.unique([*starts, *(starts + 1), grid.n_ramps])  # steps end at stations
    found = ramps_and_roads(
        crossing, dampers, speeds, grid.edges[kept],
        np.repeat(np.searchsorted(kept, starts), len(heights)), np.tile(heights, len(starts)),
    )  # fmt: skip
    if found.flights:
        warn(
            f"a tire leaves the road in {found.flights} of {found.unit.size} crossings of a ramp "
            f"of {heights[0]:g} m: simulated there with R >= 0; type a smaller ramp_height",
            LiftOffWarning,
        )
    ramps = np.moveaxis(found.unit.reshape(len(speeds), -1, len(heights)), -1, 0)
    return grid.surface(crossing, speeds, found.smooth, ramps, histories)


def _best_kept(
    crossing: Crossing, dampers: Fitted, speeds: FloatArray, grid: RampGrid
) -> tuple[FloatArray, FloatArray]:
    """DAFs of the smooth road and of ramps, of the best of dampings that a crossing keeps."""
    dense = replace(grid, every=1)
    kept = [] if dampers.kept is None else dampers.kept.tolist()
    vehicles = [with_damping(crossing.vehicle, c, dampers.legs) for c in kept]
    surfaces = [linear_surface(replace(crossing, vehicle=v), speeds, dense) for v in vehicles]
    lowest = np.min if crossing.orientation > 0 else np.max
    names = ("daf_unit", "daf_rise")[: len(grid.heights)]
    best = [lowest([getattr(s, name) for s in surfaces], axis=0) for name in names]
    smooth = lowest([surface.daf_smooth for surface in surfaces], axis=0)
    return smooth, np.array(best)[..., :: grid.every]


@on_one_thread
def ramps_and_roads(
    crossing: Crossing,
    dampers: Fitted,
    speeds: FloatArray,
    stations: FloatArray,
    starts: NDArray[np.intp],
    drops: FloatArray,
    roads: FloatArray | None = None,
    record: tuple[str, ...] = (),
) -> RampsAndRoads:
    """Simulate unit ramps and roads side by side at speeds [m/s], shape (n_speeds,).

    The roads have `stations` [m], shape (n,), and elevations [m], shape (n_roads, n). Each ramp
    reaches from one of `starts`, stations by number that never fall, to the next station, and drops
    by one of `drops` [m], both of shape (n_ramps,). What `simulate_loop` is to record is of the
    roads.
    """
    whole = np.empty((0, len(stations))) if roads is None else roads
    bare = dampers.bare(crossing)
    require_loop(
        bare, [dampers], speeds, stations, len(whole) + 1, n_ramps=len(starts),
        n_recorded=len(record), announced=roads is None,
    )  # fmt: skip
    after = np.arange(len(stations)) > starts[:, np.newaxis]
    # A ramp's road is the smooth one, the first, until the ramp begins.
    elevations = np.vstack([np.zeros((1, len(stations))), whole, -drops[:, np.newaxis] * after])
    first = 1 + len(whole)
    begins = np.concatenate([np.full(first, stations[0]), stations[starts]])
    order = np.argsort(speeds, kind="stable")
    found = Loop(
        bare, dampers, speeds[order], stations, elevations, record, slice(1, first), begins
    ).run().of_speeds(np.argsort(order))  # fmt: skip
    of_roads = found.of_roads(slice(1, first))
    flights = int(np.isfinite(found.lift_off[:, first:]).sum())
    return RampsAndRoads(found.daf[:, 0], found.daf[:, first:], of_roads, flights)


def _stations(run: Run, asked: FloatArray) -> FloatArray:
    """Where a road is straight between, and what is asked for [m]."""
    own: FloatArray = np.zeros(0)
    first = run.start
    if run.profile is not None:
        own = run.profile.x
        rearmost = run.start - run.crossing.linear.tire_offsets.max()
        first = min(first, max(rearmost, own[0]))
    inside = own[(own > first) & (own < run.end)]
    return merge_places(np.concatenate([[first, run.start, run.end], inside, asked]))


def _elevations(run: Run, x: FloatArray) -> FloatArray:
    """Elevations of the run's road [m], (1, n)."""
    if run.profile is None:
        return np.zeros((1, len(x)))
    return -run.profile.drop(x, run.start, level=False)[np.newaxis]
