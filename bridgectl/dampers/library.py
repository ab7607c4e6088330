"""The library: every strategy, for one bridge and one vehicle."""

from __future__ import annotations

import numpy as np

from bridgectl.dampers import laws
from bridgectl.dampers.bridgehook import bridgehook
from bridgectl.dampers.each_leg import at_each_leg
from bridgectl.dampers.legs import require_dampers
from bridgectl.dampers.lqr import clipped_lqr
from bridgectl.dampers.preset import preset
from bridgectl.dampers.strategy import Strategy
from bridgectl.dampers.tire_laws import extended_groundhook, selective_groundhook, tire_groundhook
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle


def library(
    beam: BridgeModel, vehicle: Vehicle | QuarterCar, c_min: float, c_max: float, *,
    section: float = 0.5,
) -> list[Strategy]:  # fmt: skip
    """Return every strategy for a bridge and a vehicle, the vehicle's own damper first.

    Parameters
    ----------
    beam : Beam
        The bridge, which `bridgehook` knows.
    vehicle : Vehicle or QuarterCar
        The vehicle, with its passive damper.
    c_min, c_max : float
        Bounds of the damping [N s/m], above 0.
    section : float, optional
        Section of the moment, as a fraction of the span: what `bridgehook` works for.

    Returns
    -------
    list of Strategy
        Of different names; all but the first within the bounds.

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above, or the vehicle has no damper.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import library
    >>> for strategy in library(bc.li2006.beam(), bc.li2006.car(), 1e3, 30e3):
    ...     print(strategy.name)
    passive 7 kN s/m
    preset
    skyhook
    continuous skyhook
    groundhook
    tire groundhook
    extended groundhook
    selective groundhook
    hybrid
    ADD
    SH-ADD
    PDD
    clipped LQR
    bridgehook
    """
    require_dampers(vehicle)
    if not np.all(vehicle.linear.damper_dampings > 0):
        raise ValueError(
            "vehicle must have a damping above 0 [N s/m], which strategies are compared with"
        )
    return [
        at_each_leg(lambda car: laws.passive(car.damping), vehicle),
        preset(c_min, c_max),
        laws.skyhook(c_min, c_max),
        laws.continuous_skyhook(c_min, c_max),
        laws.groundhook(c_min, c_max),
        tire_groundhook(c_min, c_max),
        extended_groundhook(c_min, c_max, vehicle=vehicle),
        selective_groundhook(c_min, c_max, vehicle=vehicle),
        laws.hybrid(c_min, c_max),
        laws.add(c_min, c_max),
        laws.sh_add(c_min, c_max),
        at_each_leg(
            lambda car: laws.pdd(c_min, c_max, stiffness=car.suspension_stiffness), vehicle
        ),
        clipped_lqr(vehicle, c_min, c_max),
        bridgehook(beam, vehicle, c_min, c_max, section=section),
    ]
