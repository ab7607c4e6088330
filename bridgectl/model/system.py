"""The crossing of a vehicle as a control system."""

from __future__ import annotations

import control

from bridgectl._plausible import judge_crossing
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import make_crossing
from bridgectl.model.effect import Effect
from bridgectl.model.effects import NamedEffects
from bridgectl.model.motion import Motion, as_motion
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle


def crossing_system(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    speed: float | Motion,
    *,
    section: float = 0.5,
    recovery: str = "exact",
    effect: Effect | str = "moment",
    effects: NamedEffects = (),
    static: bool = False,
    name: str = "crossing",
) -> control.NonlinearIOSystem:
    """Return the crossing of a vehicle as a control system.

    Time is zero when the reference tire is at the start of the bridge. The system
    works in `control.interconnect`, in `control.linearize(sys, 0, t=...)` (frozen-time poles
    and Bode plots) and in `control.input_output_response`. Give the last one tolerances,
    ``solve_ivp_kwargs=dict(rtol=1e-9, atol=1e-12)``: at its defaults the DAF at 110 km/h
    comes out as 1.136 instead of 1.130, which is more than a unit ramp changes. `control.lqr` and
    `control.lqe` want a bridge with a `damping_ratio`: undamped modes have no such regulator.

    Parameters
    ----------
    beam, vehicle
        See `Crossing`.
    speed : float or Motion
        Speed c [m/s], or a motion that is not uniform.
    section, recovery, effect
        Where 'moment' and 'deflection' are read, and how: see `bridgectl.daf`.
    effects : mapping of str to effect, optional
        Further outputs by name, each in its effect's unit, as ``{"pier": Moment(25.0)}``.
    static : bool, optional
        Whether there are outputs 'static_moment', 'static_deflection' and 'static_' with each name
        of `effects` too: what the weight of the vehicle alone would give at its place.
    name : str, optional
        Name of the system.

    Returns
    -------
    control.NonlinearIOSystem
        Inputs: 'road' [m], the road r under the tire, positive *downward* (minus the
        elevation), with tire damping 'road_rate' [m/s], the rate at which it changes under the
        moving tire, and 'damper_force' [N], which acts as -F on the body and +F on the axle
        on top of the passive damping. Outputs: 'moment' (over the peak static moment),
        'deflection' [m] at the section, 'tire_force' [N], the vehicle's states
        ('y_s', 'y_s_dot', 'y_t', 'y_t_dot' for a quarter-car), accelerations ('y_s_ddot',
        'y_t_ddot'), 'suspension_travel' [m] and 'suspension_velocity' [m/s] of each
        controlled damper, then `effects` and static ones. Several tires or dampers are numbered:
        'road_1', 'road_2', ... The static loads are inside: the zero state is the vehicle in
        equilibrium before an unloaded bridge.

    Raises
    ------
    TypeError, ValueError
        If a parameter has the wrong kind or range; the message names it.

    Warns
    -----
    PlausibilityWarning
        As `Crossing`.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Eqs. (1)-(8).

    Examples
    --------
    >>> import control as ct
    >>> import bridgectl as bc
    >>> sys = bc.crossing_system(bc.li2006.beam(), bc.li2006.car(), speed=110 / 3.6)
    >>> sys.input_labels
    ['road', 'damper_force']
    >>> mid_span = ct.linearize(sys, 0, t=12.5 / (110 / 3.6))
    >>> sorted({round(float(abs(pole)) / 6.2832, 2) for pole in mid_span.poles()})
    [0.46, 4.08, 6.91, 16.37, 36.83]
    """
    motion = as_motion(speed)
    crossing = make_crossing(beam, vehicle, effect, section, recovery, effects, static)
    crossing.paths.require(motion)
    judge_crossing(crossing, motion.speed)
    return crossing.system(motion, name)
