"""What users ask of a crossing: its response, and its dynamic amplification factor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import control
import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing, judge_range
from bridgectl._progress import track
from bridgectl._threads import on_one_thread
from bridgectl._warn import warn
from bridgectl.linear.cells import (
    SAME_PLACE,
    SAMPLES,
    bridge_entry,
    merge_places,
    sample_positions,
)
from bridgectl.linear.estimates import require_crossing
from bridgectl.linear.lift_off import fly
from bridgectl.linear.peaks import find_peaks
from bridgectl.linear.runs import (
    Run,
    at_nodes,
    effect_samples,
    first_flight,
    lifts_off,
    prepare,
    propagate,
    simulate_reference,
    speed_batches,
)
from bridgectl.model.beam import Beam
from bridgectl.model.crossing import Crossing
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile

if TYPE_CHECKING:
    from bridgectl.dampers import Damper, Strategy

METHODS = ("propagator", "control")


class LiftOffWarning(UserWarning):
    """A tire leaves the road: the crossing is not linear, and superposition not exact."""


@on_one_thread
def crossing_response(
    beam: Beam,
    vehicle: Vehicle | QuarterCar,
    speed: float,
    profile: RoadProfile | None = None,
    *,
    start: float = 0.0,
    section: float = 0.5,
    recovery: str = "exact",
    method: str = "propagator",
    damper: Damper | Strategy | None = None,
    tail: float = 0.0,
    timepts: ArrayLike | None = None,
) -> control.TimeResponseData:
    """Simulate one crossing.

    Time is zero when the reference tire is at the start of the bridge. At `start` the
    vehicle is in equilibrium on a level road that continues the profile backwards.

    Parameters
    ----------
    beam, vehicle, speed, section, recovery
        See `Crossing`.
    profile : RoadProfile, optional
        The road, covering `start` to the end of the bridge; level beyond its end. Default:
        a smooth road.
    start : float, optional
        Where the vehicle starts [m]: 0, or negative for a start on the approach.
    method : {'propagator', 'control'}, optional
        The fast path, or `control.input_output_response` with tight tolerances.
    damper : bridgectl.dampers.Damper or Strategy, optional
        A semi-active damper in place of the vehicle's own; by the fast path alone.
    tail : float, optional
        Time of free vibration after the last tire has left the bridge [s].
    timepts : array_like, optional
        Times of the response [s], increasing, within the crossing. Default: the
        samples of the propagator's cells, dense enough for every motion; a kink of the
        moment is always a sample.

    Returns
    -------
    control.TimeResponseData
        Outputs as in `crossing_system`: 'moment' (over the peak static moment),
        'deflection' [m], 'tire_force' [N], ... Inputs: the road r, positive downward, and
        the force of each controlled damper, zero without one.

    Raises
    ------
    TypeError, ValueError
        If a parameter has the wrong kind, shape or range, or the road does not cover the
        approach and the bridge.

    Warns
    -----
    LiftOffWarning
        If a tire leaves the road; the response then has R = 0 in flight.
    PlausibilityWarning
        If speed, vehicle, road or damper can hardly be meant.
    UserWarning
        If the road was measured at steps of more than one foot (see `RoadProfile.measured_step`),
        or the work takes minutes.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Eqs. (1)-(8).

    Examples
    --------
    >>> import bridgectl as bc
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> response = bc.crossing_response(beam, car, speed=110 / 3.6, recovery="li2006")
    >>> print(f"{response.outputs['moment'].max():.4f}")
    1.1302
    """
    crossing = Crossing(beam, vehicle, speed, section, recovery)
    _checks.choice("method", method, METHODS)
    run = prepare(crossing, profile, start, tail)
    judge_crossing(crossing, crossing.speed, profile)
    if damper is not None:
        _only_fast(method)
        from bridgectl.dampers.actuator import as_damper, bare_vehicle  # late, as they lie above
        from bridgectl.dampers.loop.damped import damped_response

        judge_range(bare_vehicle(vehicle), as_damper(damper))
        asked = np.zeros(0) if timepts is None else _times(timepts, run) * crossing.speed
        return _as_response(*damped_response(run, damper, asked))
    require_crossing(run, np.array([crossing.speed]), tail=tail, refine=4)
    nodes = run.nodes(crossing.speed, refine=4)
    keep = np.arange(len(nodes))
    if timepts is not None:
        asked = _times(timepts, run) * crossing.speed
        nodes = merge_places(np.concatenate([asked, nodes]))
        keep = np.searchsorted(nodes, asked - SAME_PLACE)
    if method == "control":
        states, forces = simulate_reference(run, nodes)
    else:
        stretches = propagate(run, np.array([crossing.speed]), nodes)
        if not lifts_off(crossing, stretches)[0]:
            return _as_response(run, nodes[keep], *at_nodes(crossing, stretches, keep))
        flight = fly(run, nodes)
        # The places of lift-offs and landings are among its nodes.
        keep = np.searchsorted(flight.nodes, nodes[keep] - SAME_PLACE)
        nodes, states, forces = flight.nodes, flight.states, flight.forces
    place = first_flight(nodes, forces)
    if place is not None:
        warn_of_flight(place)
    return _as_response(run, nodes[keep], states[:, keep], forces[:, keep])


@on_one_thread
def daf(
    beam: Beam,
    vehicle: Vehicle | QuarterCar,
    speeds: ArrayLike,
    profile: RoadProfile | None = None,
    *,
    start: float = 0.0,
    section: float = 0.5,
    recovery: str = "exact",
    effect: str = "moment",
    method: str = "propagator",
    damper: Damper | Strategy | None = None,
    progress: bool = True,
) -> FloatArray:
    """Dynamic amplification factor: the peak moment, or other effect, over its static peak.

    The peak is that of the crossing of the bridge; the approach is on the way to it.

    Parameters
    ----------
    beam, vehicle, section, recovery, effect
        See `Crossing`.
    speeds : float or array_like
        Speeds c [m/s].
    profile, start, method, damper
        See `crossing_response`; with a damper, the effect is the moment.
    progress : bool, optional
        Whether a progress bar shows on a terminal while speeds are simulated one by one.

    Returns
    -------
    ndarray, shape (n_speeds,)

    Raises
    ------
    TypeError, ValueError
        As `crossing_response`.

    Warns
    -----
    LiftOffWarning
        If a tire leaves the road at some speeds, which are then simulated with R >= 0.
    PlausibilityWarning, UserWarning
        As `crossing_response`.

    Examples
    --------
    >>> import bridgectl as bc
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> bc.daf(beam, car, [50 / 3.6, 110 / 3.6], recovery="li2006").round(4)
    array([1.0551, 1.1302])
    """
    c = _checks.speeds(speeds)
    _checks.flag("progress", progress)
    crossing = Crossing(beam, vehicle, float(c[0]), section, recovery, effect)
    _checks.choice("method", method, METHODS)
    run = prepare(crossing, profile, start)
    judge_crossing(crossing, c, profile)
    if damper is not None:
        _only_fast(method)
        _checks.choice("effect", effect, ("moment",))
        from bridgectl.dampers.actuator import as_damper, bare_vehicle
        from bridgectl.dampers.loop.damped import damped_dafs

        device, bare = as_damper(damper), bare_vehicle(vehicle)
        judge_range(bare, device)
        if device.constant is None:
            return damped_dafs(run, device, c)
        # A constant damper is another vehicle, whose crossing is linear.
        crossing = replace(crossing, vehicle=replace(bare, damping=device.constant))
        run = run._replace(crossing=crossing)
    require_crossing(run, c)
    result = np.empty(c.size)
    linear = np.zeros(c.size, dtype=bool)
    if method == "propagator":
        batches = list(speed_batches(run, c))
        for batch in track(batches, "Simulating crossings", len(batches), show=progress):
            stretches = propagate(run, c[batch], run.nodes(c[batch].min()))
            result[batch] = find_peaks(effect_samples(crossing, stretches[-1]).T).values
            linear[batch] = ~lifts_off(crossing, stretches)
    simulate = _flying_peak if method == "propagator" else _reference_peak
    flights = {}
    flying = np.nonzero(~linear)[0]
    for i in track(flying, "Simulating tires that leave the road", len(flying), show=progress):
        at_speed = run._replace(crossing=replace(crossing, speed=float(c[i])))
        result[i], place = simulate(at_speed)
        if place is not None:
            flights[float(c[i])] = place
    warn_of_flights(flights, c.size)
    return result


def warn_of_flight(place: float) -> None:
    """Tell where the tire of one crossing first leaves the road [m]."""
    warn(
        f"a tire leaves the road, first with the reference tire at x = {place:.2f} m: "
        "simulated with R >= 0; the crossing is not linear there",
        LiftOffWarning,
    )


def warn_of_flights(flights: Mapping[float, float], n_speeds: int) -> None:
    """Tell at which speeds [m/s] a tire leaves the road, if it does, and where first [m]."""
    if flights:
        warn(
            f"a tire leaves the road at {len(flights)} of {n_speeds} speeds, the slowest "
            f"{min(flights) * 3.6:.0f} km/h, the first place x = {min(flights.values()):.1f} m: "
            "simulated there with R >= 0",
            LiftOffWarning,
        )


def _flying_peak(run: Run) -> tuple[float, float | None]:
    """DAF with the tires kept from pulling, and where one first leaves the road."""
    flight = fly(run, run.nodes(run.crossing.speed))
    return _peak(flight.effects, flight.nodes), first_flight(flight.nodes, flight.forces)


def _reference_peak(run: Run) -> tuple[float, float | None]:
    """The same by the reference route."""
    nodes = run.nodes(run.crossing.speed)
    positions = sample_positions(nodes)
    states, forces = simulate_reference(run, positions)
    effect = run.crossing.values(positions, states.T, forces.T)
    return _peak(effect, nodes), first_flight(positions, forces)


def _peak(samples: FloatArray, nodes: FloatArray) -> float:
    """Peak of an effect on the bridge, from its samples on the approach and the bridge."""
    before = len(SAMPLES) * bridge_entry(nodes)
    return float(find_peaks(samples[before:, np.newaxis]).values[0])


def _only_fast(method: str) -> None:
    if method != "propagator":
        raise ValueError(f"method must be 'propagator' with a damper, got {method!r}: leave it out")


def _as_response(
    run: Run,
    positions: FloatArray,
    states: FloatArray,
    forces: FloatArray,
    damper: FloatArray | None = None,
) -> control.TimeResponseData:
    crossing, time = run.crossing, positions / run.crossing.speed
    if damper is None:
        damper = np.zeros((len(crossing.linear.damper_map), len(positions)))
    return control.TimeResponseData(
        time,
        crossing.outputs(time, states, forces, damper),
        states,
        np.vstack([run.road(positions).T, damper]),
        issiso=False,
        output_labels=crossing.output_labels,
        state_labels=crossing.state_labels,
        input_labels=crossing.input_labels,
        sysname="crossing",
        title=f"Crossing at {crossing.speed * 3.6:g} km/h",
        params={
            "speed": crossing.speed,
            "section": crossing.section,
            "recovery": crossing.recovery,
            "start": run.start,
        },
    )


def _times(timepts: ArrayLike, run: Run) -> FloatArray:
    times = _checks.array("timepts", timepts, (None,), unit="s")
    first, last = run.start / run.crossing.speed, run.end / run.crossing.speed
    slack = SAME_PLACE / run.crossing.speed
    if times.size < 2 or np.any(np.diff(times) <= 0):
        raise ValueError("timepts must hold two or more increasing times [s]")
    if times[0] < first - slack or times[-1] > last + slack:
        raise ValueError(
            f"timepts must lie within the crossing, {first:g} s to {last:g} s, "
            f"got {times[0]:g} s to {times[-1]:g} s"
        )
    return times
