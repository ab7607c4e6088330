"""What is scored: strategies, roads over common stations, and the pieces of the work."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, count_pieces, even_places
from bridgectl.dampers.actuator import Damper
from bridgectl.dampers.fitted import Dampers, Fitted, fitted_everywhere
from bridgectl.dampers.strategy import Strategy
from bridgectl.dampers.told import told_of
from bridgectl.model.bridge import BridgeModel, described
from bridgectl.model.bridge_effects import Moment
from bridgectl.model.crossing import Crossing
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road import RoadProfile
from bridgectl.road.sampling import warn_if_coarse
from bridgectl.scoring.classes import classes_of, with_surface
from bridgectl.surface.compute import RAMP_LENGTH

ROADS_AT_ONCE = 50
"""Roads of one part of the work: what an interruption may cost, and memory for histories."""

Piece = int | str
"""A part of the work: the first of some roads, a road class, or `UNIT_RAMPS`."""

UNIT_RAMPS = "unit ramps"
"""The part of the work that gives the DAE of all roads."""


@dataclass(frozen=True)
class Study:
    """What all parts of the work share."""

    crossing: Crossing
    speeds: FloatArray
    stations: FloatArray
    n_ramps: int
    elevations: FloatArray

    @property
    def beam(self) -> BridgeModel:
        """The bridge."""
        return self.crossing.beam

    @property
    def vehicle(self) -> Vehicle | QuarterCar:
        """The vehicle, with its own dampers."""
        return self.crossing.vehicle

    @property
    def durations(self) -> FloatArray:
        """Time from the start to where the road ends or the last tire leaves the bridge [s]."""
        return (max(self.stations[-1], self.crossing.exit) - self.stations[0]) / self.speeds

    @property
    def approach(self) -> float:
        """Road before the bridge [m]."""
        return -float(self.stations[0])

    @property
    def positions(self) -> FloatArray:
        """Starts of the unit ramps [m]."""
        return self.stations[: self.n_ramps]

    @property
    def under_ramps(self) -> FloatArray:
        """Elevations at the ends of the unit ramps [m], (n_roads, n_ramps + 1)."""
        return self.elevations[:, : self.n_ramps + 1]

    @cached_property
    def road_classes(self) -> tuple[str, ...]:
        """Class of each road."""
        return classes_of(self.under_ramps)

    @cached_property
    def classes(self) -> tuple[str, ...]:
        """Road classes that have a surface."""
        return with_surface(self.road_classes, self.n_ramps)

    def share(self, piece: Piece) -> Study:
        """What a piece needs of the study: its own roads, of ramps none."""
        own = slice(0) if isinstance(piece, str) else slice(piece, piece + ROADS_AT_ONCE)
        return dataclasses.replace(self, elevations=self.elevations[own])

    def of_road(self, i: int) -> Study:
        """The same of one road."""
        return dataclasses.replace(self, elevations=self.elevations[i : i + 1])

    @property
    def of_roads(self) -> list[int]:
        """What is simulated at once of each strategy."""
        return list(range(0, len(self.elevations), ROADS_AT_ONCE))

    @property
    def of_ramps(self) -> list[str]:
        """What DAE takes of each strategy beside that."""
        return [UNIT_RAMPS, *self.classes]


def _listed(value: object) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str)


def checked_devices(dampers: Sequence[Dampers], vehicle: Vehicle | QuarterCar) -> list[Fitted]:
    """Check the strategies, and fit them to the vehicle."""
    if isinstance(dampers, Damper | Strategy):
        raise TypeError("dampers must be a list of strategies, got one: type [damper]")
    if not _listed(dampers):
        raise TypeError(
            f"dampers must be a list of strategies, got {type(dampers).__name__}: type "
            "[bridgectl.dampers.passive(7e3), bridgectl.dampers.skyhook(1e3, 30e3)]"
        )
    devices = [fitted_everywhere(damper, vehicle) for damper in dampers]
    if not devices:
        raise ValueError(
            "dampers must hold a strategy, got none: type [bridgectl.dampers.passive(7e3)]"
        )
    names = [device.name for device in devices]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise ValueError(
            f"dampers must have different names, got {twice!r} twice: type "
            f'strategy.renamed("{twice}, other")'
        )
    return devices


def make_study(
    crossing: Crossing,
    roads: Sequence[RoadProfile],
    speeds: ArrayLike,
    approach: float,
    departure: float,
) -> Study:
    """Check what all strategies share, and lay the roads over common stations."""
    before = check.not_negative("approach", approach, unit="m")
    after = check.not_negative("departure", departure, unit="m")
    length = crossing.beam.length
    if not _listed(roads) or not all(isinstance(road, RoadProfile) for road in roads):
        raise TypeError(
            "roads must be a list of RoadProfile: type [road], or [bridgectl.read_profile(path)]"
        )
    if not len(roads):
        raise ValueError("roads must hold a road, got none: type [bridgectl.utia_road()]")
    c = check.speeds(speeds)
    n_ramps = count_pieces(before + length, RAMP_LENGTH)
    n_pieces = count_pieces(before + length + after, RAMP_LENGTH)
    stations = even_places(-before, RAMP_LENGTH, n_pieces + 1)
    for i, road in enumerate(roads, 1):
        road.require(-before, length + after, f"the crossing, of road {i},", "approach")
        warn_if_coarse(road, "dynamic amplification")
    elevations = np.array([np.interp(stations, road.x, road.elevation) for road in roads])
    elevations -= elevations[:, :1]
    _require_different(roads, elevations)
    return Study(crossing, c, stations, n_ramps, elevations)


def _require_different(roads: Sequence[RoadProfile], elevations: FloatArray) -> None:
    """Refuse a road that is given twice: it would look like more evidence than there is."""
    first: dict[bytes, int] = {}
    for i, heights in enumerate(np.round(elevations / SAME_PLACE), 1):
        j = first.setdefault((heights + 0.0).tobytes(), i)  # not -0.0
        if j != i:
            raise ValueError(
                f"roads {j} ({roads[j - 1].name!r}) and {i} ({roads[i - 1].name!r}) are the same, "
                "and would count twice in confidence intervals: leave one out"
            )


def task_name(device: Fitted, piece: Piece, n_roads: int) -> str:
    """What a piece of the work is called."""
    if isinstance(piece, int):
        return f"{device.name}, roads {piece + 1} to {min(piece + ROADS_AT_ONCE, n_roads)}"
    return f"{device.name}, {piece if piece == UNIT_RAMPS else f'class {piece}'}"


def header(study: Study) -> dict[str, Any]:
    """What two studies share if their parts fit together."""
    crossing = study.crossing
    plain = Moment(crossing.section * crossing.beam.length, recovery=crossing.recovery)
    effect = {} if crossing.effect == plain else {"effect": repr(crossing.effect)}
    return {
        "beam": described(study.beam),
        "vehicle": parameters(study.vehicle),
        "speeds": study.speeds.tolist(),
        "stations": [study.stations[0], study.stations[-1], len(study.stations)],
        "section": crossing.section,
        "recovery": crossing.recovery,
        **effect,
    }


def parameters(vehicle: Vehicle | QuarterCar) -> dict[str, Any]:
    """Parameters of a vehicle by name, as JSON has them."""
    return {
        name: value.tolist() if isinstance(value, np.ndarray) else value
        for name, value in dataclasses.asdict(vehicle).items()
    }


def key(device: Fitted, study: Study, piece: Piece) -> str:
    """Tell dampers, and roads if the piece is of them or their DAE, from others."""
    told = told_of(device, study.speeds)
    text = json.dumps(told if len(told) > 1 else told[0])
    whole = hashlib.sha256(text.encode())
    if piece not in study.classes:
        whole.update(np.ascontiguousarray(study.elevations).tobytes())
    return whole.hexdigest()[:16]
