"""What a road does to a bridge, for control engineers: an extension of python-control.

A heavy vehicle crosses a bridge; the dynamic amplification factor (DAF) is the peak bending
moment over the peak static one. bridgectl gives the crossing as a control system, the DAF of
a road, and the dynamic amplification estimate (DAE) of Li, OBrien and Gonzalez (2006): the
DAF of a smooth road plus what each 100 mm ramp of the road adds.

Its rooms, each of which imports from those below it alone (`lint-imports`, `tests/house.py`)::

    cli         the commands: options, tables
    paper       parameters, printed numbers and validation of the paper
    scoring     scores of damper strategies: run, board, text; tune their gains;
                animation, envelopes
    fleet       random and weighed trucks, what they do to a bridge: assess, its extreme values
    simulate    the front door: crossing_response, daf, ramp_surface choose an engine
    dampers     strategies, rollout/ that predict; loop/ closed loops, optimum/ the best;  extremes
    surface     ramp surfaces: compute, histories, DAE, trust, file
    linear      linear crossings: cells, runs, peaks, lift-off
    model       bridge, vehicle (trucks/), load effects, their crossing;  road (files/);  measures
    plots       figures of whatever has what they draw

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
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from bridgectl._gone import no_attribute
from bridgectl._version import __version__ as __version__

if TYPE_CHECKING:
    from bridgectl import dampers as dampers
    from bridgectl import extremes as extremes
    from bridgectl import measures as measures
    from bridgectl import plots as plots
    from bridgectl import road as road
    from bridgectl._plausible import PlausibilityWarning
    from bridgectl.animation import crossing_animation
    from bridgectl.dampers import passive_theory as passive_theory
    from bridgectl.envelopes import envelope
    from bridgectl.fleet.assess import assess
    from bridgectl.fleet.assessment import Assessment
    from bridgectl.fleet.fleet import Fleet
    from bridgectl.linear.lift_off import LiftOffWarning
    from bridgectl.linear.prediction import prediction_matrices
    from bridgectl.model import trucks as trucks
    from bridgectl.model.beam import Beam
    from bridgectl.model.bridge_effects import (
        BridgeAcceleration,
        Deflection,
        Moment,
        Reaction,
        Shear,
        Stress,
    )
    from bridgectl.model.crossing import Crossing
    from bridgectl.model.modal import ModalBridge
    from bridgectl.model.motion import Motion
    from bridgectl.model.quarter_car import QuarterCar
    from bridgectl.model.spans import Bridge
    from bridgectl.model.system import crossing_system
    from bridgectl.model.traffic import convoy
    from bridgectl.model.vehicle import Vehicle
    from bridgectl.model.vehicle_effects import BodyAcceleration, TireForce
    from bridgectl.paper import li2006
    from bridgectl.road import (
        ProfileFileError,
        RoadProfile,
        iso8608_profile,
        read_profile,
        read_tracks,
        utia_road,
        write_profile,
    )
    from bridgectl.scoring.board import Scoreboard
    from bridgectl.scoring.calibration import calibrated_class_dae
    from bridgectl.scoring.ramp_heights import ramp_heights
    from bridgectl.scoring.robust import robustness
    from bridgectl.scoring.run import score
    from bridgectl.scoring.tune import tune
    from bridgectl.scoring.tuning import Tuning
    from bridgectl.simulate import crossing_response, daf, peak_effect, ramp_surface
    from bridgectl.surface.expected import SurfaceFileError
    from bridgectl.surface.load import load_surface
    from bridgectl.surface.surface import RampSurface
    from bridgectl.surface.trust import dae_trust

__all__ = [
    "Assessment",
    "Beam",
    "BodyAcceleration",
    "Bridge",
    "BridgeAcceleration",
    "Crossing",
    "Deflection",
    "Fleet",
    "LiftOffWarning",
    "ModalBridge",
    "Moment",
    "Motion",
    "PlausibilityWarning",
    "ProfileFileError",
    "QuarterCar",
    "RampSurface",
    "Reaction",
    "RoadProfile",
    "Scoreboard",
    "Shear",
    "Stress",
    "SurfaceFileError",
    "TireForce",
    "Tuning",
    "Vehicle",
    "assess",
    "calibrated_class_dae",
    "convoy",
    "crossing_animation",
    "crossing_response",
    "crossing_system",
    "dae_trust",
    "daf",
    "envelope",
    "iso8608_profile",
    "li2006",
    "load_surface",
    "peak_effect",
    "prediction_matrices",
    "ramp_heights",
    "ramp_surface",
    "read_profile",
    "read_tracks",
    "robustness",
    "score",
    "tune",
    "utia_road",
    "write_profile",
]

_ROOMS = {
    "dampers": "dampers", "extremes": "extremes", "li2006": "paper.li2006",
    "measures": "measures", "passive_theory": "dampers.passive_theory", "plots": "plots",
    "road": "road", "trucks": "model.trucks",
}  # fmt: skip
"""Modules that are offered as such, and where they are."""

_MOVED = {"validation": "paper.validation", "weighting": "measures.weighting"}
"""Modules that are found where they once were."""

_HOMES = {
    "_plausible": ("PlausibilityWarning",),
    "animation": ("crossing_animation",),
    "envelopes": ("envelope",),
    "fleet.assess": ("assess",),
    "fleet.assessment": ("Assessment",),
    "fleet.fleet": ("Fleet",),
    "linear.lift_off": ("LiftOffWarning",),
    "linear.prediction": ("prediction_matrices",),
    "model.beam": ("Beam",),
    "model.crossing": ("Crossing",),
    "model.bridge_effects": (
        "BridgeAcceleration", "Deflection", "Moment", "Reaction", "Shear", "Stress",
    ),
    "model.modal": ("ModalBridge",),
    "model.motion": ("Motion",),
    "model.quarter_car": ("QuarterCar",),
    "model.spans": ("Bridge",),
    "model.system": ("crossing_system",),
    "model.traffic": ("convoy",),
    "model.vehicle": ("Vehicle",),
    "model.vehicle_effects": ("BodyAcceleration", "TireForce"),
    "road": (
        "ProfileFileError", "RoadProfile", "iso8608_profile", "read_profile", "read_tracks",
        "utia_road", "write_profile",
    ),
    "scoring.board": ("Scoreboard",),
    "scoring.calibration": ("calibrated_class_dae",),
    "scoring.ramp_heights": ("ramp_heights",),
    "scoring.robust": ("robustness",),
    "scoring.run": ("score",),
    "scoring.tune": ("tune",),
    "scoring.tuning": ("Tuning",),
    "simulate": ("crossing_response", "daf", "peak_effect", "ramp_surface"),
    "surface.expected": ("SurfaceFileError",),
    "surface.load": ("load_surface",),
    "surface.surface": ("RampSurface",),
    "surface.trust": ("dae_trust",),
}  # fmt: skip
"""Where the other names are from. All are loaded when they are first used: that takes a second,
in which the command line must already listen to Ctrl-C, and the dampers bring CasADi."""


def __dir__() -> list[str]:
    """List what is offered, loaded or not, for tab completion."""
    return sorted({*__all__, *_ROOMS, "__version__"})


if not TYPE_CHECKING:  # which knows the names above, and no others

    def __getattr__(name: str) -> Any:
        """Load what is offered when it is first used."""
        home = next((home for home, names in _HOMES.items() if name in names), None)
        if home is not None:
            globals()[name] = found = getattr(import_module(f"bridgectl.{home}"), name)
            return found
        if where := (_ROOMS | _MOVED).get(name):
            globals()[name] = room = import_module(f"bridgectl.{where}")
            return room
        if not name.startswith("__") and find_spec(f"bridgectl.{name}"):
            return import_module(f"bridgectl.{name}")
        raise no_attribute("bridgectl", name)
