"""The front door: what users ask of a crossing, and which engine answers.

Arguments are checked and judged here, once; the engines, linear and closed loops, never come back.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

import control
import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing, judge_range
from bridgectl._threads import on_one_thread
from bridgectl.linear.estimates import require_surface
from bridgectl.linear.lift_off import warn_of_flight
from bridgectl.linear.many.crossings import alone, dafs_at_speeds, given, is_sequence
from bridgectl.linear.many.front import peaks_of_many, responses_of_many
from bridgectl.linear.response import METHODS, as_response, linear_response, until
from bridgectl.linear.runs import Run
from bridgectl.linear.samples import crossings_of, dafs_of_motions
from bridgectl.linear.start import begin
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing, make_crossing, require_factor
from bridgectl.model.effect import Effect
from bridgectl.model.effects import NamedEffects
from bridgectl.model.motion import Motion, Speeds, as_motion
from bridgectl.model.quarter_car import QuarterCar, require_springs
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile
from bridgectl.surface.compute import RAMP_HEIGHT, RAMP_LENGTH, linear_surface, ramp_grid
from bridgectl.surface.surface import RampSurface

if TYPE_CHECKING:  # dampers, which bring CasADi, are imported late
    from bridgectl.dampers.fitted import Dampers, Fitted


@on_one_thread
def crossing_response(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar | Sequence[Vehicle | QuarterCar],
    speed: float | Motion | ArrayLike,
    profile: RoadProfile | Sequence[RoadProfile | None] | None = None,
    *,
    start: float = 0.0,
    section: float = 0.5,
    recovery: str = "exact",
    effect: Effect | str = "moment",
    effects: NamedEffects = (),
    static: bool = False,
    method: str = "propagator",
    damper: Dampers | None = None,
    tail: float = 0.0,
    timepts: ArrayLike | None = None,
) -> control.TimeResponseData:
    """Simulate one crossing.

    Time is zero when the reference tire is at the start of the bridge. At `start` the vehicle is
    at rest on the road under each axle, level before the profile: crop that for a level start.

    Parameters
    ----------
    beam, vehicle
        See `Crossing`. A sequence of vehicles is simulated one by one, with a speed and a road for
        all or one each.
    speed : float or Motion
        Speed c [m/s], or a motion that is not uniform.
    section, recovery, effect
        Where 'moment' and 'deflection' are read, and how: see `daf`.
    effects, static
        Further outputs: see `crossing_system`.
    profile : RoadProfile, optional
        The road, covering `start` to the end of the bridge; level beyond its end. Default:
        a smooth road.
    start : float, optional
        Where the reference tire starts [m]: 0, or negative for a start on the approach.
    method : {'propagator', 'control'}, optional
        The fast path, or `control.input_output_response` with tight tolerances.
    damper : bridgectl.dampers.Damper or Strategy, or a list or dict of them, optional
        Semi-active dampers in place of the vehicle's own (`damper_dampings`): one for all, a list
        of one for each (None for a passive one that stays), or some by `Vehicle.damper_names`. At
        constant speed.
    tail : float, optional
        Time of free vibration after the last tire has left the bridge [s].
    timepts : array_like, optional
        Times of the response [s], increasing, within the crossing. Default: those of the
        propagator's cells, dense enough for every motion and with every kink of the moment.

    Returns
    -------
    control.TimeResponseData, or a list of these
        Outputs and inputs as in `crossing_system`: 'moment' over the static peak, ...

    Raises
    ------
    TypeError, ValueError
        If a parameter has the wrong kind, shape or range, the road does not cover approach and
        bridge, or the vehicle stands still on its way.

    Warns
    -----
    LiftOffWarning
        If a tire leaves the road; the response then has R = 0 in flight.
    PlausibilityWarning
        If speed, vehicle, road or damper can hardly be meant, or the vehicle has several axles and
        its start is still felt at the bridge.
    UserWarning
        If the road's `RoadProfile.measured_step` is above one foot, or the work takes minutes.

    Examples
    --------
    >>> import bridgectl as bc
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> response = bc.crossing_response(beam, car, speed=110 / 3.6, recovery="li2006")
    >>> print(f"{response.outputs['moment'].max():.4f}")
    1.1302
    """
    if is_sequence(vehicle):
        many = given(beam, vehicle, speed, profile, start, effect, section, recovery)
        return responses_of_many(many, method, damper, effects, static, tail, timepts)
    vehicle, profile = alone(vehicle, profile)
    motion = as_motion(cast(float | Motion, speed))
    crossing = make_crossing(beam, vehicle, effect, section, recovery, effects, static)
    crossing.paths.require(motion)
    _checks.choice("method", method, METHODS)
    devices = fitted_to(damper, vehicle, method, [] if motion.uniform else [motion])
    run = begin(crossing, profile, start, motion.speed, motion)
    judge_crossing(crossing, motion.speed, profile)
    run, asked = until(run, motion, tail, timepts)
    if devices is None:
        found, place = linear_response(run, motion, asked, method)
        if place is not None:
            warn_of_flight(place)
        return as_response(run, motion, *found)
    from bridgectl.dampers.loop.damped import damped_response

    judge_range(vehicle, devices)
    places = np.zeros(0) if asked is None else asked
    damped = damped_response(run, motion.speed, devices, places)
    return as_response(damped[0], motion, *damped[1:])


@on_one_thread
def daf(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar | Sequence[Vehicle | QuarterCar],
    speeds: Speeds,
    profile: RoadProfile | Sequence[RoadProfile | None] | None = None,
    *,
    start: float = 0.0,
    section: float = 0.5,
    recovery: str = "exact",
    effect: Effect | str | Sequence[Effect | str] = "moment",
    method: str = "propagator",
    damper: Dampers | None = None,
    progress: bool = True,
) -> FloatArray:
    """Dynamic amplification factor: the peak moment, or other effect, over its static peak.

    The peak is that on the bridge; the approach is on the way to it.

    Parameters
    ----------
    beam, vehicle
        See `Crossing`. Of a sequence of vehicles each has one of the speeds and roads, or all the
        same: they are simulated side by side, and the bits of one are no matter of the others.
    section, recovery, effect : optional
        What the factor is of: `Moment`, `Deflection` or `TireForce`. 'moment' and 'deflection' are
        short for those at a section, a fraction of the span, with the recovery of `Moment`,
        'tire_force' ('tire_force_1', ...) for that of a tire. A list of effects is simulated once;
        with a damper that is not constant, once an effect.
    speeds : float or array_like, or Motion or list of these
        Speeds c [m/s], or motions that are not uniform. Several speeds of a truck may go side by
        side, too, which is within 1e-6 of each alone.
    profile, start, method, damper
        See `crossing_response`.
    progress : bool, optional
        Whether a progress bar shows on a terminal while speeds are simulated one by one.

    Returns
    -------
    ndarray, shape (n_speeds,) or (n_effects, n_speeds)
        Of a sequence of vehicles (n_vehicles,) or (n_effects, n_vehicles).

    Raises
    ------
    TypeError, ValueError
        As `crossing_response`; also if the effect has no static peak: see `peak_effect`.

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
    >>> bc.daf(beam, [car, bc.trucks.load("T5air")], [20.0, 25.0]).round(4)
    array([1.0387, 1.0458])
    """
    if is_sequence(vehicle):
        many = given(beam, vehicle, speeds, profile, start, effect, section, recovery)
        found = peaks_of_many(many, method, damper, progress=progress, factor=True).factors
        return found if isinstance(effect, list | tuple) else found[0]
    vehicle, profile = alone(vehicle, profile)
    crossings = crossings_of(effect, beam, vehicle, section, recovery)
    c, motions = crossings[0].paths.given(speeds)
    for crossing in crossings:
        require_factor(crossing)
    devices = fitted_to(damper, vehicle, method, motions)
    run = begin(crossings[0], profile, start, c)
    judge_crossing(crossings[0], c, profile)
    judge_range(vehicle, devices)
    found = _peaks(run, crossings, c, motions, devices, method, progress)
    return found if isinstance(effect, list | tuple) else found[0]


@on_one_thread
def peak_effect(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar | Sequence[Vehicle | QuarterCar],
    speeds: Speeds,
    profile: RoadProfile | Sequence[RoadProfile | None] | None = None,
    *,
    start: float = 0.0,
    section: float = 0.5,
    recovery: str = "exact",
    effect: Effect | str | Sequence[Effect | str] = "moment",
    method: str = "propagator",
    damper: Dampers | None = None,
    progress: bool = True,
) -> FloatArray:
    """Peak of an effect, in its own unit, whether or not static loads give it one.

    Parameters
    ----------
    beam, vehicle, speeds, profile, start, section, recovery, method, damper, progress
        See `daf`.
    effect : Moment, Deflection, TireForce, BodyAcceleration or str, or a list, optional
        'acceleration' is that of the first coordinate of the vehicle.

    Returns
    -------
    ndarray, shape (n_speeds,) or (n_effects, n_speeds), or of n_vehicles
        In N m, m, N or m/s^2.

    Raises
    ------
    TypeError, ValueError
        As `crossing_response`.

    Warns
    -----
    LiftOffWarning, PlausibilityWarning, UserWarning
        As `daf`.

    Examples
    --------
    How far the span rises again behind the truck:

    >>> import bridgectl as bc
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> bc.peak_effect(beam, car, 30.0, effect=bc.Deflection(sense="smallest")).round(5)
    array([-5.e-05])
    """
    if is_sequence(vehicle):
        many = given(beam, vehicle, speeds, profile, start, effect, section, recovery)
        found = peaks_of_many(many, method, damper, progress=progress, factor=False).peaks
        return found if isinstance(effect, list | tuple) else found[0]
    vehicle, profile = alone(vehicle, profile)
    crossings = crossings_of(effect, beam, vehicle, section, recovery)
    c, motions = crossings[0].paths.given(speeds)
    devices = fitted_to(damper, vehicle, method, motions)
    run = begin(crossings[0], profile, start, c)
    judge_crossing(crossings[0], c, profile)
    judge_range(vehicle, devices)
    found = _peaks(run, crossings, c, motions, devices, method, progress)
    found *= np.array([[crossing.static_peak or 1.0] for crossing in crossings])
    return found if isinstance(effect, list | tuple) else found[0]


@on_one_thread
def ramp_surface(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    speeds: ArrayLike,
    *,
    approach: float = 0.0,
    ramp_length: float = RAMP_LENGTH,
    ramp_height: float | str = RAMP_HEIGHT,
    both_ways: bool = False,
    every: int = 1,
    section: float = 0.5,
    recovery: str = "exact",
    effect: Effect | str = "moment",
    method: str = "propagator",
    damper: Dampers | None = None,
    progress: bool = True,
) -> RampSurface:
    """Compute the DAF of a unit ramp at every place, for every speed: Fig. 5 of the paper.

    Parameters
    ----------
    beam, vehicle, section, recovery, effect
        See `daf`. Of accelerations, which have no static peak, "DAF" stands for the peak [m/s^2].
    speeds : float or array_like
        Speeds c [m/s].
    approach : float, optional
        Length of the approach [m], where the vehicle starts in equilibrium, and ramps lie too.
    ramp_length, ramp_height : float, optional
        The unit ramp [m]: by default 1 mm over 100 mm, a *drop*, as in the paper. A road class,
        "A" to "H", stands for the height sigma sqrt(N) of one ramp with the variance of the drops
        over all N ramps of its roads: 13.4 mm for class A and 850 ramps.
    both_ways : bool, optional
        Whether there are rises of that height beside the drops: `RampSurface.dae` of order 2 and
        `RampSurface.class_dae` need what both do together to tell dampers apart.
    every : int, optional
        Take a ramp at every so many-th place alone, and straight lines between.
    method : {'propagator', 'control'}, optional
        All ramps from one propagation, or one `control.input_output_response` for each.
    damper : bridgectl.dampers.Damper or Strategy, or a list or dict of them, optional
        See `crossing_response`. Responses of a semi-active one do not superpose: the surface has a
        DAE, an estimate twice over, and no superposed DAF.
    progress : bool, optional
        Whether 'control' shows a progress bar on a terminal.

    Returns
    -------
    RampSurface

    Raises
    ------
    TypeError, ValueError
        If a parameter has the wrong kind, shape or range, or the work would be too much; the
        message names it.

    Warns
    -----
    PlausibilityWarning
        If speeds, vehicle or damper can hardly be meant.
    LiftOffWarning
        If a ramp lifts the tire: its crossing is simulated with R >= 0.
    UserWarning
        If it takes minutes.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Section 3.1.

    Examples
    --------
    The paper prints 0.00433 for a unit ramp at 0.12 l and 110 km/h.

    >>> import bridgectl as bc
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> surface = bc.ramp_surface(beam, car, 110 / 3.6, recovery="li2006")
    >>> surface.positions[29].round(3), round(surface.daf_unit[0, 29] - surface.daf_smooth[0], 5)
    (np.float64(2.9), np.float64(0.00429))
    """
    c = _checks.speeds(speeds)
    _checks.choice("method", method, METHODS)
    _checks.flag("progress", progress)
    crossing = make_crossing(beam, vehicle, effect, section, recovery)
    crossing.paths.require_alike()
    require_factor(crossing, unless_none=True)
    given = approach, ramp_length, ramp_height, both_ways, every
    grid = ramp_grid(beam.length, *given, crossing.paths.beyond())
    judge_crossing(crossing, c)
    require_surface(crossing, c, grid.approach, grid.length, method)
    if method == "control":
        require_springs(vehicle, 'ramp surfaces by method="control"')
    devices = fitted_to(damper, vehicle, method)
    judge_range(vehicle, devices)
    if devices is not None:
        crossing, left = devices.resolved(crossing)
        if left is not None:
            from bridgectl.dampers.loop.damped import damped_surface

            return damped_surface(crossing, left, c, grid, devices.name)
    return linear_surface(crossing, c, grid, method, progress)


def fitted_to(
    damper: Dampers | None, vehicle: Vehicle | QuarterCar, method: str = "propagator",
    motions: Sequence[Motion] = (),
) -> Fitted | None:  # fmt: skip
    """The dampers, if there are any, checked to go with the route and the vehicle."""
    if damper is None:
        return None
    from bridgectl.dampers.fitted import fitted

    require_springs(vehicle, "crossings with a damper")
    if motions:
        raise ValueError(f"damper goes with a constant speed: got {motions[0]!r}, leave it out")
    if method != "propagator":
        raise ValueError(f"method must be 'propagator' with a damper, got {method!r}: leave it out")
    return fitted(damper, vehicle)


def _peaks(
    run: Run, crossings: list[Crossing], speeds: FloatArray, motions: list[Motion],
    devices: Fitted | None, method: str, progress: bool,
) -> FloatArray:  # fmt: skip
    """Peaks over their static ones, if they have any, by the engine that they need."""
    _checks.flag("progress", progress)
    _checks.choice("method", method, METHODS)
    if motions:
        return dafs_of_motions(run, crossings, motions, method, progress)
    if devices is not None:
        resolved = [devices.resolved(crossing) for crossing in crossings]
        crossings, left = [crossing for crossing, _ in resolved], resolved[0][1]
        if left is not None:
            from bridgectl.dampers.loop.damped import damped_dafs

            runs = [run._replace(crossing=crossing) for crossing in crossings]
            return np.array([damped_dafs(each, left, speeds) for each in runs])
        run = run._replace(crossing=crossings[0])
    return dafs_at_speeds(run, crossings, speeds, method, progress)
