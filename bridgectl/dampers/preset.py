"""The passive damper that is set once before each crossing, from speed and road."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl.dampers.actuator import with_damping
from bridgectl.dampers.strategy import Strategy
from bridgectl.linear.lift_off import LiftOffWarning
from bridgectl.linear.response import linear_dafs
from bridgectl.linear.runs import prepare
from bridgectl.model.crossing import Crossing
from bridgectl.road import RoadProfile
from bridgectl.road.limits import evenly_spaced
from bridgectl.surface.compute import RAMP_HEIGHT, RampGrid, linear_surface


class Preset(Strategy):
    """The preset strategy; made by `preset`. Each crossing has its own damping."""

    def __init__(self, c_min: float, c_max: float, n_dampings: int) -> None:
        self.dampings = np.geomspace(c_min, c_max, n_dampings)
        bounds = {"damping": (float(self.dampings[0]), float(c_min), float(c_max))}
        super().__init__("preset", lambda s, g: g.damping + 0 * s.speed, c_min, c_max, bounds)

    @property
    def kept(self) -> FloatArray | None:
        """See `Strategy`."""
        return self.dampings

    def __repr__(self) -> str:
        return (
            f"Preset({self.name!r}, one of {self.dampings.size} dampings from {self.c_min:g} to "
            f"{self.c_max:g} N s/m)"
        )

    def gains_for(
        self, crossing: Crossing, speeds: FloatArray, stations: FloatArray, elevations: FloatArray
    ) -> Mapping[str, FloatArray]:
        """Return the damping of the smallest DAF of each crossing [N s/m], by superposition."""
        cars = [with_damping(crossing.vehicle, float(c)) for c in self.dampings]
        crossings = [replace(crossing, vehicle=car) for car in cars]
        # Of the one that is taken its crossing tells.
        with warnings.catch_warnings(action="ignore", category=LiftOffWarning):
            dafs = [_dafs(own, speeds, stations, elevations) for own in crossings]
        best = np.argmin(crossing.orientation * np.array(dafs), axis=0)
        return {"damping": self.dampings[best].T}


def _dafs(
    crossing: Crossing, speeds: FloatArray, stations: FloatArray, elevations: FloatArray
) -> FloatArray:
    """DAF of roads of straight pieces, shape (n_roads, n_speeds)."""
    start = float(stations[0])
    if not evenly_spaced(stations):  # unit ramps are all of one length
        roads = [RoadProfile(stations, z) for z in elevations]
        return np.array([linear_dafs(prepare(crossing, road, start), speeds) for road in roads])
    last = int(np.searchsorted(stations, crossing.beam.length - SAME_PLACE))
    step = float(stations[last] - start) / last
    grid = RampGrid(-start, step, min(step, RAMP_HEIGHT), last)
    return linear_surface(crossing, speeds, grid).superposed_daf(elevations[:, : last + 1])


def preset(c_min: float, c_max: float, *, n_dampings: int = 9) -> Preset:
    """Return the passive damper whose damping is chosen before each crossing.

    From the ramp surfaces of `n_dampings` dampings, evenly spaced in ratio, it takes the one
    whose superposed DAF is least for the speed and the road at hand, which must be known:

        c = argmin over c of max over t of M(t; c),  M = M_smooth + sum_i s(i) M_i

    It cannot react to anything during the crossing. Its gain `damping` [N s/m] is what counts
    where no crossing is known, as in C export.

    Parameters
    ----------
    c_min, c_max : float
        Bounds of the damping [N s/m].
    n_dampings : int, optional
        How many dampings it chooses from.

    Returns
    -------
    Preset

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    References
    ----------
    N. K. Harris, E. J. OBrien, A. Gonzalez, J. Sound Vib. 302 (2007) 471-485.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import passive, preset, simulate_loop
    >>> road = bc.iso8608_profile("B", 25, seed=1)
    >>> dafs = [
    ...     simulate_loop(bc.li2006.beam(), bc.li2006.car(), law, 25.0, road.x, road.elevation).daf
    ...     for law in (preset(1e3, 30e3), passive(7e3))
    ... ]
    >>> bool(dafs[0] < dafs[1])
    True
    """
    soft = check.positive("c_min", c_min, unit="N s/m")
    stiff = check.positive("c_max", c_max, unit="N s/m")
    return Preset(soft, stiff, check.integer("n_dampings", n_dampings, at_least=2))
