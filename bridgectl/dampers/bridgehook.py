"""Bridgehook: a damper that works against the bending moment, by the crossing's costate.

On a smooth road the peak moment M(t*) depends on the damper force at every instant before it by

    sigma(t) = dM(t*) / dF_d(t) = lambda(t)' B_F,   lambda' = -A' lambda,   lambda(t*)' = row of M

one backward pass through the crossing's own transition matrices. A force that pushes against the
sign of sigma lowers the peak, and a damper has the choice of how much of F_d = c v to give::

    c = c_max where sigma v < 0, c_min elsewhere; passive after t*

It needs position and speed, and no preview of the road.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._threads import on_one_thread
from bridgectl.beam import Beam
from bridgectl.crossing import Crossing
from bridgectl.peaks import find_peaks
from bridgectl.propagator import SAME_PLACE, build_cells
from bridgectl.quarter_car import QuarterCar
from bridgectl.simulation import effect_samples, prepare, propagate

from .strategy import Strategy

REACH = 60.0
"""How far before the bridge the damper is commanded [m]; before that it is passive."""


class Costate(NamedTuple):
    """Sensitivity of the peak moment of a smooth road's crossing to the damper force."""

    positions: FloatArray
    """Places of the reference tire [m], increasing, up to that of the peak."""
    sigma: FloatArray
    """dM(t*) / dF_d per time [1/(N s)], M over its static peak; same shape."""


@on_one_thread
def costate(
    beam: Beam, vehicle: QuarterCar, speed: float, *, section: float = 0.5, reach: float = REACH
) -> Costate:
    """Return how the peak moment depends on the damper force before it.

    Parameters
    ----------
    beam, vehicle, section
        See `bridgectl.crossing.Crossing`.
    speed : float
        Speed c [m/s].
    reach : float, optional
        Length of the approach that is looked at [m].

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
    crossing = Crossing(beam, vehicle, speed, section)
    run = prepare(crossing, None, -check.not_negative("reach", reach, unit="m"))
    nodes = run.nodes(crossing.speed)
    entry = int(np.searchsorted(nodes, -SAME_PLACE))
    at = np.array([crossing.speed])
    bridge = propagate(run, at, nodes)[-1]
    top = find_peaks(effect_samples(crossing, bridge).T)
    last = entry + int(top.cells[0] + (top.fractions[0] > 0.5))
    rows = crossing.rows(nodes[last])
    line = rows.per_state + rows.per_force @ crossing.tire_rows(float(nodes[last]))
    n = crossing.n_vehicle
    sigma = np.empty(last + 1)
    sigma[last] = line @ crossing.damper_matrix[:, 0]
    on_bridge = bridge.cells.transitions()[0][0, :, : crossing.n_states]
    for k in range(last - 1, entry - 1, -1):
        line = line @ on_bridge[k - entry]
        sigma[k] = line @ crossing.damper_matrix[:, 0]
    if entry:
        before = build_cells(crossing, at, nodes[: entry + 1], on_bridge=False)
        on_approach = before.transitions()[0][0, :, :n]
        line = line[:n]
        for k in range(entry - 1, -1, -1):
            line = line @ on_approach[before.map_of[k]]
            sigma[k] = line @ crossing.linear.damper_input[:, 0]
    return Costate(nodes[: last + 1], sigma)


class Bridgehook(Strategy):
    """The bridgehook strategy; made by `bridgehook`. At each speed it has its own law."""

    def __init__(
        self, beam: Beam, vehicle: QuarterCar, c_min: float, c_max: float, section: float = 0.5
    ) -> None:
        self.beam, self.vehicle, self.section = beam, vehicle, section
        self.laws: dict[float, Strategy] = {}
        super().__init__("bridgehook", self._untold, c_min, c_max)

    @staticmethod
    def _untold(s: Any, g: Any) -> Any:
        """Without a speed there is no law: see `for_speed`."""
        return g.c_min + 0 * s.speed

    def for_speed(self, speed: float) -> Strategy:
        """Return the law at a speed [m/s]."""
        if speed not in self.laws:
            found = costate(self.beam, self.vehicle, speed, section=self.section)
            self.laws[speed] = _law_of(found, self.passive_damping, self)
        return self.laws[speed]

    @cached_property
    def passive_damping(self) -> float:
        """Damping before and after it is commanded [N s/m]: the vehicle's own, in its range."""
        return float(np.clip(self.vehicle.damping, self.c_min, self.c_max))


def bridgehook(
    beam: Beam, vehicle: QuarterCar, c_min: float, c_max: float, *, section: float = 0.5
) -> Bridgehook:
    """Return the damper that works against the bending moment of a bridge.

    Parameters
    ----------
    beam, vehicle, section
        The bridge, the vehicle with its passive damping, and the section of the moment: what the
        costate is computed for.
    c_min, c_max : float
        Bounds of the damping [N s/m].

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import bridgehook
    >>> law = bridgehook(bc.li2006.beam(), bc.li2006.car(), 1e3, 30e3).for_speed(25.0)
    >>> law.command(position=[11.0, 20.0], suspension_velocity=-0.1)
    array([30000.,  7000.])
    """
    return Bridgehook(beam, vehicle, c_min, c_max, section)


def _law_of(found: Costate, passive: float, owner: Bridgehook) -> Strategy:
    """The switched law between the places where sigma changes its sign."""
    x, sigma = found
    turns = np.nonzero(np.sign(sigma[1:]) != np.sign(sigma[:-1]))[0]
    share = sigma[turns] / (sigma[turns] - sigma[turns + 1])
    places = x[turns] + share * (x[turns + 1] - x[turns])
    signs = np.sign(np.append(sigma[turns], sigma[-1]))
    start, end = float(x[0]), float(x[-1])

    def law(s: Any, g: Any) -> Any:
        sign = ca.pw_const(s.position, ca.DM(places), ca.DM(signs)) if len(places) else signs[0]
        active = ca.logic_and(s.position >= start, s.position <= end)
        stiff = sign * s.suspension_velocity < 0
        return ca.if_else(active, ca.if_else(stiff, g.c_max, g.c_min), passive)

    return Strategy(owner.name, law, owner.c_min, owner.c_max)
