"""The envelope of a crossing: what users ask of it, and which engine answers."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from bridgectl._checks import choice
from bridgectl._plausible import judge_crossing, judge_range
from bridgectl._threads import on_one_thread
from bridgectl.dampers.fitted import Dampers, Fitted
from bridgectl.dampers.loop.damped import damped_response
from bridgectl.linear.cells import bridge_entry, sample_positions
from bridgectl.linear.envelope import QUANTITIES, Envelope, envelope_of, places_of
from bridgectl.linear.estimates import require_crossing
from bridgectl.linear.runs import Run
from bridgectl.linear.samples import Samples
from bridgectl.linear.start import begin
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import make_crossing
from bridgectl.model.motion import Motion
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile
from bridgectl.simulate import fitted_to


@on_one_thread
def envelope(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    speed: float,
    profile: RoadProfile | None = None,
    *,
    quantity: str = "moment",
    at: ArrayLike | None = None,
    start: float = 0.0,
    recovery: str = "exact",
    damper: Dampers | None = None,
) -> Envelope:
    """Find the extremes of moment, shear or deflection at every place of a bridge in a crossing.

    One crossing is simulated for all places; peaks between its samples count.

    Parameters
    ----------
    beam, vehicle, profile, start, damper
        See `crossing_response`.
    speed : float
        Speed c [m/s].
    quantity : {'moment', 'shear', 'deflection', 'acceleration'}, optional
        What of: see `Moment`, `Shear`, `Deflection` and `BridgeAcceleration`.
    at : array_like, optional
        Places from the start of the bridge [m]. Default: 101, and every support and step of the
        deck; of a `ModalBridge` those that the quantity is told at.
    recovery : str, optional
        Of moments: see `Moment`.

    Returns
    -------
    Envelope
        With `places` [m], `largest`, `smallest`, where the vehicle is then, the same of the
        static load, and `plot()`.

    Raises
    ------
    TypeError, ValueError
        As `crossing_response`, or if the quantity is none of these or a place is off the bridge.

    Warns
    -----
    LiftOffWarning, PlausibilityWarning, UserWarning
        As `crossing_response`.

    Examples
    --------
    >>> import bridgectl as bc
    >>> bridge = bc.Bridge([25, 25], 18358, 4.865e10)
    >>> hogging = bc.envelope(bridge, bc.li2006.car(), 30.0, at=[10.0, 25.0]).smallest / 1e3
    >>> print(hogging.round(), "kN m")
    [-144. -268.] kN m
    """
    c = Motion(speed).speed
    choice("quantity", quantity, tuple(QUANTITIES))
    crossing = make_crossing(beam, vehicle, recovery=recovery)
    places = places_of(beam, quantity, at)
    crossing.paths.require_steady(np.array([c]))
    run = begin(crossing, profile, start, c)
    judge_crossing(crossing, c, profile)
    require_crossing(run, np.array([c]))
    devices, simulate = fitted_to(damper, vehicle), None
    judge_range(vehicle, devices)
    if devices is not None:
        crossing, left = devices.resolved(crossing)
        run = run._replace(crossing=crossing)
        simulate = None if left is None else partial(_damped, speed=c, dampers=left)
    return envelope_of(run, c, quantity, recovery, places, simulate)


def _damped(run: Run, speed: float, dampers: Fitted) -> Samples:
    """The samples of a crossing with a damper that is not constant."""
    nodes = run.nodes(speed)
    nodes = nodes[bridge_entry(nodes) :]
    _, _, states, forces, _ = damped_response(run, speed, dampers, sample_positions(nodes))
    return Samples(nodes, states, forces)
