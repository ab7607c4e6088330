"""Laws made for a quarter-car, at the legs of any vehicle: each for the quarter-car of its leg."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from functools import wraps
from typing import Any, ParamSpec, cast

import numpy as np

from bridgectl.dampers.legs import Legs, checked_leg, require_dampers
from bridgectl.dampers.strategy import Strategy
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import GRAVITY, Vehicle

P = ParamSpec("P")


class EachLeg(Strategy):
    """A strategy with a law of its own at each leg of a vehicle; elsewhere that of the first."""

    def __init__(self, vehicle: Vehicle, laws: Sequence[Strategy]) -> None:
        vars(self).update(vars(laws[0]))
        self.vehicle, self.laws = vehicle, tuple(laws)

    def for_leg(self, leg: int) -> Strategy:
        """Return the law of a leg: see `Strategy.for_leg`."""
        return self.laws[checked_leg(self.vehicle, leg) - 1]

    def renamed(self, name: str) -> Strategy:
        """Return the strategy under another name: see `Strategy.renamed`."""
        return EachLeg(self.vehicle, [law.renamed(name) for law in self.laws])

    def with_gains(self, **values: float) -> Strategy:
        """Return the strategy with other values of some gains: see `Strategy.with_gains`."""
        return EachLeg(self.vehicle, [law.with_gains(**values) for law in self.laws])


def at_each_leg(make: Callable[[QuarterCar], Strategy], vehicle: Vehicle | QuarterCar) -> Strategy:
    """Return what a law is for a quarter-car, or for the one of each leg of a vehicle."""
    if not isinstance(vehicle, Vehicle):
        return make(vehicle)
    return EachLeg(vehicle, [make(car) for car in corners(vehicle)])


def of_each_leg(law: Callable[P, Strategy]) -> Callable[P, Strategy]:
    """Let a law with the argument `vehicle` be made for any vehicle: see `at_each_leg`."""
    signature, of_car = inspect.signature(law), cast(Callable[..., Strategy], law)

    @wraps(law)
    def made(*args: P.args, **kwargs: P.kwargs) -> Strategy:
        bound = signature.bind(*args, **kwargs)
        vehicle: Any = bound.arguments["vehicle"]
        return at_each_leg(lambda car: of_car(**{**bound.arguments, "vehicle": car}), vehicle)

    return made


def corners(vehicle: Vehicle) -> list[QuarterCar]:
    """Return the quarter-car of each leg: its axle, springs and tires, and the load above them."""
    require_dampers(vehicle)
    legs, axles = Legs(vehicle), vehicle.damper_axles
    masses, springs = (
        ((axles @ matrix) * axles).sum(axis=1)
        for matrix in (vehicle.mass_matrix, vehicle.stiffness_matrix)
    )
    bodies, tires = legs.loads / GRAVITY - masses, legs.tires @ vehicle.tire_stiffnesses
    wrong = np.flatnonzero((bodies <= 0) | (springs <= 0) | (masses <= 0))
    if wrong.size:
        raise ValueError(
            f"damper {legs.names[wrong[0]]!r} of the vehicle must carry a body over an axle on "
            "tires for this law: check damper_axles and heave, or type skyhook(...), which asks "
            "for none of these"
        )
    parts = bodies, masses, springs, tires, vehicle.damper_dampings
    return [QuarterCar(*of) for of in zip(*(part.tolist() for part in parts), strict=True)]
