"""Unit ramps over approach and bridge, and roads in terms of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._places import count_pieces
from bridgectl.linear.runs import linear_contact, prepare, require_beyond
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing
from bridgectl.model.effect import Effect
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile
from bridgectl.road.sampling import COARSE
from bridgectl.surface.tire_contact import TireContact, is_plain

Roads = RoadProfile | Sequence[RoadProfile] | ArrayLike
"""A road, several, or elevations at a surface's stations."""

ROADS_AT_ONCE = 250
"""Roads whose histories are superposed together."""


def ends_of_ramps(starts: FloatArray, length: float) -> FloatArray:
    """Return where the ramps begin, and where the last one ends [m]."""
    return np.append(starts, starts[-1] + length)


def one_ramp(ends: FloatArray, ramp: int, drop: float | FloatArray) -> FloatArray:
    """Elevations [m] of roads, at the ends of the ramps, that are level but for a drop over one."""
    return np.multiply.outer(-np.asarray(drop), np.arange(len(ends)) > ramp)


@dataclass(frozen=True, eq=False)
class UnitRamps:
    """What crosses what over which ramps: see `bridgectl.RampSurface`, which is one."""

    beam: BridgeModel
    vehicle: Vehicle | QuarterCar
    effect: Effect
    approach: float
    ramp_length: float
    ramp_height: float
    speeds: FloatArray
    positions: FloatArray

    @property
    def stations(self) -> FloatArray:
        """Ends of the ramps [m]: where roads given as arrays have their elevations."""
        return ends_of_ramps(self.positions, self.ramp_length)

    @property
    def _end(self) -> float:
        """The end of the bridge [m], or of the ramps that vehicles come over from there."""
        on_bridge = count_pieces(self.approach + self.beam.length, self.ramp_length)
        return float(self.stations[-1]) if len(self.positions) > on_bridge else self.beam.length

    def ramps(self, roads: Roads) -> FloatArray:
        """Ramp scale factors s(i) of a road or of many, Eq. (14): positive for a drop.

        Parameters
        ----------
        roads : RoadProfile, sequence of RoadProfile, or array_like
            A road that covers the approach and the bridge, or several; or their elevations [m] at
            `stations`, positive up, shape (n_ramps + 1,) or (n_roads, n_ramps + 1).

        Returns
        -------
        ndarray, shape (n_ramps,) or (n_roads, n_ramps)

        Raises
        ------
        TypeError
            If `roads` is none of these.
        ValueError
            If a road does not cover the approach and the bridge, or the elevations do not fit
            the stations.

        Warns
        -----
        UserWarning
            If a road was measured at steps longer than one foot and than a ramp: see
            `RoadProfile.measured_step`.
        """
        if isinstance(roads, RoadProfile):
            run = prepare(self._crossing, roads, -self.approach, pieces=self.ramp_length)
            require_beyond(run)
            ramps = roads.ramps(self.ramp_length, start=-self.approach, stop=self._end)
            return np.asarray(ramps.heights / self.ramp_height)
        if isinstance(roads, Sequence) and any(isinstance(road, RoadProfile) for road in roads):
            return np.array([self.ramps(road) for road in roads])
        try:
            elevations = _checks.floats("roads", cast(ArrayLike, roads), unit="m")
        except TypeError:
            raise TypeError(
                "roads must be a RoadProfile, a list of them, or elevations [m] at the surface's "
                f"stations, got {type(roads).__name__}"
            ) from None
        if elevations.ndim not in (1, 2) or elevations.shape[-1] != len(self.positions) + 1:
            raise ValueError(
                f"roads must have elevations at the {len(self.positions) + 1} stations of the "
                f"surface, shape (n_roads, {len(self.positions) + 1}), got {elevations.shape}: "
                "type RoadProfile(x, elevation)"
            )
        scales = elevations[..., :-1] - elevations[..., 1:]
        scales /= self.ramp_height
        if not np.isfinite(scales).all():
            raise ValueError("roads must be finite elevations [m]")
        return scales

    def road(self, drops: ArrayLike, name: str = "") -> RoadProfile:
        """Road of straight ramps: what superposed histories belong to; see `ramps`.

        Parameters
        ----------
        drops : array_like, shape (n_ramps,)
            Drop over each ramp [m], positive downward.
        name : str, optional
            Name of the road.

        Returns
        -------
        RoadProfile
            Over approach and bridge, at elevation 0 where it starts.

        Raises
        ------
        TypeError, ValueError
            If there is not one drop for each ramp, or a ramp is steeper than 1 m/m.
        """
        falls = _checks.array("drops", drops, (len(self.positions),), unit="m")
        road = RoadProfile(self.stations, -np.append(0.0, np.cumsum(falls)), name=name)
        # Its ramps are meant to be straight, whatever their length.
        return road._measured_as(min(self.ramp_length, COARSE))

    def near_lift_off(self, drops: FloatArray) -> NDArray[np.bool_]:
        """Tell where a tire force falls below 5 % of its static load in the linear crossing.

        Of vehicles with several tires: where one falls below zero.

        Parameters
        ----------
        drops : ndarray, shape (n_ramps, n_roads)
            Drop over each ramp of each road [m].

        Returns
        -------
        ndarray of bool, shape (n_speeds, n_roads)
        """
        if self._contact is not None:
            return np.array([self._contact.doubtful(i, drops) for i in range(len(self.speeds))])
        runs = [prepare(self._crossing, self.road(road), -self.approach) for road in drops.T]
        return ~np.column_stack([linear_contact(run, self.speeds) for run in runs])

    @cached_property
    def _contact(self) -> TireContact | None:
        """Tire forces of the same ramps; None for several tires, whose roads are simulated."""
        if not is_plain(self.vehicle.linear):
            return None
        run = prepare(self._crossing, self.road(np.zeros(len(self.positions))), -self.approach)
        return TireContact(run, self.speeds, self.ramp_length, len(self.positions))

    @cached_property
    def _crossing(self) -> Crossing:
        return Crossing(self.beam, self.vehicle, self.effect)

    @property
    def quantity(self) -> tuple[str, str]:
        """Name and unit of what stands under the names of DAFs: of a peak where there is none."""
        effect = self.effect
        is_factor = self._crossing.static_peak != 0
        return ("DAF", "-") if is_factor else (f"{effect.sense} {effect.label}", effect.unit)

    @property
    def section(self) -> float:
        """Section of the moment or deflection, as a fraction of the bridge's length."""
        return self._crossing.section

    @property
    def recovery(self) -> str:
        """How moments are recovered: see `bridgectl.Moment`."""
        return self._crossing.recovery


def profiles(roads: Roads) -> list[RoadProfile]:
    """Those of the roads that are profiles; arrays at stations may be anything."""
    listed = roads if isinstance(roads, Sequence) else [roads]
    return [road for road in listed if isinstance(road, RoadProfile)]


def road_parts(drops: FloatArray) -> Iterator[FloatArray]:
    """Roads a few hundred at a time, so that their histories fit in memory."""
    for first in range(0, drops.shape[1], ROADS_AT_ONCE):
        yield drops[:, first : first + ROADS_AT_ONCE]
