"""The costate of a crossing: what a damper force does to the peak moment of a smooth road."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_crossing
from bridgectl._threads import on_one_thread
from bridgectl.dampers.legs import checked_leg
from bridgectl.linear.peaks import find_peaks
from bridgectl.linear.prediction import Prediction, predict
from bridgectl.linear.runs import Stretch, effect_samples, prepare, propagate
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing, make_crossing
from bridgectl.model.effect import Effect
from bridgectl.model.motion import Motion
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle

REACH = 60.0
"""How far before the bridge a damper is looked at, or commanded [m]."""


class Costate(NamedTuple):
    """Sensitivity of a smooth road's peak moment to the damper force; made by `costate`."""

    positions: FloatArray
    """Places of the reference tire [m], increasing, up to that of the peak."""
    sigma: FloatArray
    """dM(t*) / dF_d per time [1/(N s)], M over its static peak; same shape."""

    def __repr__(self) -> str:
        return (
            f"Costate({len(self.positions)} places from x = {self.positions[0]:.4g} m to "
            f"{self.positions[-1]:.4g} m, sigma from {self.sigma.min():.3g} to "
            f"{self.sigma.max():.3g} 1/(N s))"
        )


def smooth_crossing(crossing: Crossing, speed: float, reach: float) -> tuple[Prediction, Stretch]:
    """Prediction from a reach [m] before the bridge, and the motion on the bridge."""
    run = prepare(crossing, None, -reach)
    nodes = run.nodes(speed)
    stretches = propagate(run, np.array([speed]), nodes)
    return predict(run, speed, nodes, stretches), stretches[-1]


@on_one_thread
def costate(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    speed: float,
    *,
    section: float = 0.5,
    effect: Effect | str = "moment",
    reach: float = REACH,
    leg: int = 1,
) -> Costate:
    """Return how the peak moment depends on the damper force before it.

    Parameters
    ----------
    beam, vehicle, section, effect
        See `bridgectl.daf`.
    speed : float
        Speed c [m/s].
    reach : float, optional
        Length of the approach that is looked at [m].
    leg : int, optional
        Which damper of the vehicle, counted from 1.

    Returns
    -------
    Costate

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import costate
    >>> found = costate(bc.li2006.beam(), bc.li2006.car(), 25.0)
    >>> found.positions[0].round(3), found.positions[-1].round(3)
    (np.float64(-60.0), np.float64(11.7))
    """
    crossing, c = make_crossing(beam, vehicle, effect, section), Motion(speed).speed
    judge_crossing(crossing, c)
    return costate_of(
        crossing, c, check.not_negative("reach", reach, unit="m"), checked_leg(vehicle, leg)
    )


def costate_of(crossing: Crossing, speed: float, reach: float, leg: int = 1) -> Costate:
    """Return the costate of a crossing: see `costate`."""
    known, bridge = smooth_crossing(crossing, speed, reach)
    top = find_peaks(effect_samples(crossing, bridge).T)
    last = known.entry + int(top.cells[0] + (top.fractions[0] > 0.5))
    lines = [known.effect_rows[last]]
    for transition in known.transitions[:last][::-1]:
        lines.append(lines[-1] @ transition)
    sigma = np.array(lines[::-1]) @ known.damper_input[:, leg - 1]
    return Costate(known.positions[: last + 1], sigma)
