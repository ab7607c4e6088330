"""What a road does to a bridge, for control engineers: an extension of python-control.

A heavy vehicle crosses a bridge; the dynamic amplification factor (DAF) is the peak bending
moment over the peak static one. bridgectl gives the crossing as a control system, the DAF of
a road, and the dynamic amplification estimate (DAE) of Li, OBrien and Gonzalez (2006): the
DAF of a smooth road plus what each 100 mm ramp of the road adds.

SI units throughout; speeds in m/s. Displacements are positive downward, road elevations
positive upward.

Examples
--------
>>> import numpy as np
>>> import bridgectl as bc
>>> beam, truck = bc.li2006.beam(), bc.li2006.car()
>>> speeds = np.array([90, 100, 110]) / 3.6
>>> road = bc.utia_road().place_bridge(678).crop(-200, 25).detrend().resample(0.1)
>>> bc.daf(beam, truck, speeds, road, start=-200).round(3)
array([0.975, 1.014, 1.041])
>>> surface = bc.ramp_surface(beam, truck, speeds, approach=200)
>>> surface.dae(road).round(3)
array([0.89 , 1.007, 1.039])
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from bridgectl import li2006
from bridgectl._plausible import PlausibilityWarning
from bridgectl.beam import Beam
from bridgectl.crossing import Crossing, crossing_system
from bridgectl.dae import RampSurface
from bridgectl.quarter_car import QuarterCar, convoy
from bridgectl.response import LiftOffWarning, crossing_response, daf
from bridgectl.road import (
    ProfileFileError,
    RoadProfile,
    iso8608_profile,
    read_profile,
    read_tracks,
    utia_road,
    write_profile,
)
from bridgectl.surface import ramp_surface
from bridgectl.surface_file import SurfaceFileError, load_surface
from bridgectl.trust import DaeTrust, dae_trust
from bridgectl.vehicle import Vehicle

LAZY = ("dampers", "extremes", "measures", "passive_theory", "plots", "validation", "weighting")
"""Rooms that are loaded when they are first used: the dampers bring CasADi."""

if TYPE_CHECKING:
    from bridgectl.scoreboard import Scoreboard
    from bridgectl.scoring import score

__version__ = "0.1.0"


def __dir__() -> list[str]:
    """List what there is, loaded or not, for tab completion."""
    return sorted({*globals(), *__all__, *LAZY})


def __getattr__(name: str) -> Any:
    """Load what is heavy when it is first used."""
    if name in LAZY:
        return import_module(f"bridgectl.{name}")
    if name in ("Scoreboard", "score"):
        module = {"Scoreboard": "scoreboard", "score": "scoring"}[name]
        return getattr(import_module(f"bridgectl.{module}"), name)
    raise AttributeError(f"module 'bridgectl' has no attribute {name!r}")


__all__ = [
    "Beam",
    "Crossing",
    "DaeTrust",
    "LiftOffWarning",
    "PlausibilityWarning",
    "ProfileFileError",
    "QuarterCar",
    "RampSurface",
    "RoadProfile",
    "Scoreboard",
    "SurfaceFileError",
    "Vehicle",
    "convoy",
    "crossing_response",
    "crossing_system",
    "dae_trust",
    "daf",
    "iso8608_profile",
    "li2006",
    "load_surface",
    "ramp_surface",
    "read_profile",
    "read_tracks",
    "score",
    "utia_road",
    "write_profile",
]
