"""Dampers that try out at each sample what a few dampings would lead to.

They know bridge, vehicle and speed, and the state at every sample: of the vehicle measured, of the
bridge followed by the measured tire force. From there the crossing is predicted to the end of the
bridge, for each of a few dampings held for a moment, with bridgehook's law after it, over the road
as far as it is known and a level one beyond. The damping with the lowest peak is commanded.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from bridgectl import _checks as check
from bridgectl._docs import filled
from bridgectl.dampers.bridgehook import Bridgehook
from bridgectl.dampers.costate import REACH
from bridgectl.dampers.rollout.ahead import Mapped, Seen
from bridgectl.dampers.rollout.observer import Observer
from bridgectl.dampers.rollout.plant import Plant
from bridgectl.dampers.rollout.predict import Policy, best_function
from bridgectl.dampers.strategy import Strategy
from bridgectl.dampers.weights import PEAK_ALONE, Weights
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import make_crossing
from bridgectl.model.effect import Effect
from bridgectl.model.quarter_car import QuarterCar, require_quarter_car
from bridgectl.road import RoadProfile
from bridgectl.road.events import require_road

SPACING = 0.1
"""Longest distance between the places that are seen ahead [m]."""

HOLD, LONGEST = 4e-3, 0.1
"""Time that a damping is tried out for [s], and the most of it."""


class Rollout(Bridgehook):
    """A strategy that looks how peaks come out; made by `rollout_hook` and `preview_hook`.

    `preview` is how far ahead the road is known [m], seen by sensors or from a map of it.
    """

    def __init__(
        self,
        name: str,
        beam: BridgeModel,
        vehicle: QuarterCar,
        c_min: float,
        c_max: float,
        *,
        section: float,
        effect: Effect | str,
        hold: float,
        preview: float = 0.0,
        road_map: RoadProfile | None = None,
        weights: Weights = PEAK_ALONE,
    ) -> None:
        why = "predictions are of one damper and one tire; bridgehook takes every vehicle"
        car = require_quarter_car(vehicle, why)
        ride, travel, tire_force = weights
        super().__init__(
            beam, car, c_min, c_max, section, effect=effect, ride=ride, travel=travel,
            tire_force=tire_force,
        )  # fmt: skip
        self.name, self.preview_distance, self.road_map = name, preview, road_map
        self.hold = check.positive("hold", hold, unit="s")
        if hold > LONGEST:
            raise ValueError(
                f"hold must be at most {LONGEST:g} s, got {hold:g} s: for {hold:g} ms type "
                f"{hold / 1e3:g}"
            )

    def __repr__(self) -> str:
        known = "" if self.road_map is None else f", road_map={self.road_map!r}"
        return (
            f"Rollout({self.name!r}, c from {self.c_min:g} to {self.c_max:g} N s/m, "
            f"tried for {self.hold:g} s, for a bridge of {self.beam.length:g} m, "
            f"preview={self.preview_distance:g} m{known})"
        )

    @property
    def _distances(self) -> list[float]:
        """What sensors see ahead [m]."""
        if self.road_map is not None or self.preview_distance == 0:
            return []
        count = int(np.ceil(self.preview_distance / SPACING - 1e-9))
        return [*np.linspace(0, self.preview_distance, count + 1)[1:].tolist()]

    def _made(self, speed: float) -> Strategy:
        crossing = make_crossing(self.beam, self.vehicle, self.effect)
        plant = Plant(crossing, speed, self._worth(speed))
        policy = Policy(self.c_min, self.c_max, self.passive_damping, self._square(speed))
        over: Seen | Mapped = Seen(plant, self._distances)
        if self.road_map is not None:
            over = Mapped(plant, self.road_map, self.preview_distance)
        rollout = best_function(plant, policy, self.weights, self.hold, over)
        observer = Observer(plant)

        def law(s: Any, g: Any) -> Any:
            active = ca.logic_and(s.position >= -REACH, s.position <= self.beam.length)
            modes, under = observer.moved(s)
            axle = under + (s.tire_force - plant.load) / plant.car.tire_stiffness
            state = ca.vertcat(
                s.suspension_travel, axle, s.body_velocity, s.axle_velocity, s.tire_force, *modes
            )
            place = ca.if_else(active, plant.place(s.position), plant.last + 1)
            ahead = ca.vertcat(*s.ahead) if self._distances else ca.SX(0, 1)
            return ca.if_else(active, rollout(place, state, ahead)[0], self.passive_damping)

        def update(s: Any, g: Any) -> dict[str, Any]:
            return dict(zip(observer.states, observer.moved(s)[0], strict=True))

        return Strategy(
            self.name, law, self.c_min, self.c_max, states=observer.states, update=update,
            preview=self._distances,
        )  # fmt: skip


documented = filled(
    before="""\
beam : Beam
    The bridge.
vehicle : QuarterCar
    The vehicle, with its passive damping.
c_min, c_max : float
    Bounds of the damping [N s/m].""",
    after="""\
section, effect : optional
    What it works against: see `bridgectl.daf`. A moment at mid-span if omitted.
hold : float, optional
    Time [s] that a damping is tried for, before bridgehook's law follows.
ride, travel, tire_force : float, optional
    What else counts beside the peak, with weights: see `bridgehook`.

Returns
-------
Strategy
    Without a law until its speed is known: `Strategy.for_speed`.

Raises
------
TypeError, ValueError
    If an argument is not what is described above.""",
)


@documented
def rollout_hook(
    beam: BridgeModel,
    vehicle: QuarterCar,
    c_min: float,
    c_max: float,
    *,
    section: float = 0.5,
    effect: Effect | str = "moment",
    hold: float = HOLD,
    ride: float = 0.0,
    travel: float = 0.0,
    tire_force: float = 0.0,
) -> Strategy:
    """Return the damper that predicts the peak on a level road, and takes what makes it lowest.

    See `preview_hook`, which knows the road ahead.

    Parameters
    ----------
    {before}
    {after}

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import rollout_hook
    >>> law = rollout_hook(bc.li2006.beam(), bc.li2006.car(), 1e3, 30e3).for_speed(30.0)
    >>> law.command(position=[-70.0, 11.0], tire_force=98100.0, body_velocity=0.1)
    array([7000., 1000.])
    """
    return Rollout(
        "rollout", beam, vehicle, c_min, c_max, section=section, effect=effect, hold=hold,
        weights=Weights(ride, travel, tire_force),
    )  # fmt: skip


@documented
def preview_hook(
    beam: BridgeModel,
    vehicle: QuarterCar,
    c_min: float,
    c_max: float,
    *,
    preview: float = 10.0,
    road_map: RoadProfile | None = None,
    section: float = 0.5,
    effect: Effect | str = "moment",
    hold: float = HOLD,
    ride: float = 0.0,
    travel: float = 0.0,
    tire_force: float = 0.0,
) -> Strategy:
    """Return the damper that predicts the peak on the road ahead, and takes what makes it lowest.

    Parameters
    ----------
    {before}
    preview : float, optional
        How far ahead the road is known [m]; beyond it counts as level.
    road_map : RoadProfile, optional
        The road as it is known from earlier passes, by place. Then no sensor looks ahead; and
        errors of position count for the road, too.
    {after}

    Notes
    -----
    It measures position and speed, the velocities of body and axle, the suspension travel and the
    tire force, which tells how far the tire is pressed in and what the bridge does. Sensors and
    tire are taken for exact, the bridge's modes for those of the plan.

    The paper's truck and bridge, 60 m of approach, c from 1 to 30 kN s/m, samples 4 ms apart; mean
    DAF over 40 random roads of each ISO class at 70, 90 and 108 km/h, by
    `tests/benchmarks/rollout.py`::

                             class A                  class B
        passive 7 kN s/m     1.070   1.012   1.127    1.091   1.038   1.124
        bridgehook           0.981   0.948   1.040    0.973   0.964   0.977
        rollout_hook         0.972   0.944   1.030    0.960   0.942   0.966
        preview of 5 m       0.960   0.935   1.025    0.933   0.931   0.955
        preview of 10 m      0.959   0.933   1.023    0.925   0.929   0.949

    What 10 m of preview are below bridgehook is known within 0.004 (A) and 0.013 (B), 95 %; no
    crossing of class A had a higher DAF than the passive one. Of the way from passive to
    `clairvoyant`, over the same roads of class A, and with the intervals of 10 m::

        bridgehook            0.66  0.64  0.67
        rollout_hook          0.72  0.68  0.74
        preview of 5 m        0.81  0.77  0.78
        preview of 10 m       0.81  0.80  0.79    0.78 to 0.84, 0.76 to 0.83, 0.75 to 0.84
        the same, ride=0.1    0.82  0.81  0.82

    In the mean over the speeds, on the first 20 of the roads of class A (of maps 10), 10 m of
    preview are 0.018 below bridgehook, and::

        20 m of preview              0.020    elevations seen 10 ms late    0.015
        1 mm of noise in elevations  0.015    50 ms late                   -0.005
        5 mm                        -0.010    a map, 0.3 m off              0.004

    So 5 mm of noise in each reading, or 50 ms, take more than preview gains. Longer holds, dampings
    between the bounds and random roads beyond the preview were tried: none is clearly better.

    Where there is a C compiler, closed loops use the law compiled: a decision takes 30 to 45 us on
    one core, of a hundred the longest some 0.1 ms; without one far longer. The law of a speed in C
    is a file of some 300 kB.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import preview_hook
    >>> law = preview_hook(bc.li2006.beam(), bc.li2006.car(), 1e3, 30e3, preview=5.0)
    >>> len(law.for_speed(30.0).preview)
    50
    """
    distance = check.positive("preview", preview, unit="m")
    if road_map is not None:
        require_road(road_map)
    return Rollout(
        f"{'preview' if road_map is None else 'map'} {distance:g} m", beam, vehicle, c_min, c_max,
        section=section, effect=effect, hold=hold, preview=distance,
        road_map=road_map, weights=Weights(ride, travel, tire_force),
    )  # fmt: skip
