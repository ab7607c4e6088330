"""Semi-active dampers: strategies as CasADi expressions, and crossings with them in the loop."""

from .actuator import Damper
from .bridgehook import Bridgehook, bridgehook
from .closed_loop import simulate_loop
from .costate import Costate, costate
from .laws import add, continuous_skyhook, groundhook, hybrid, passive, pdd, sh_add, skyhook
from .library import library
from .lqr import clipped_lqr
from .optimal import Clairvoyant, clairvoyant
from .peak_value import PeakValue, peak_value
from .preset import preset
from .program import program
from .ramp_heights import RampHeights, ramp_heights
from .result import LoopResult
from .sensitivity import Sensitivity, program_sensitivity
from .strategy import SIGNALS, Strategy
from .tire_laws import extended_groundhook, selective_groundhook, tire_groundhook

__all__ = [
    "SIGNALS",
    "Bridgehook",
    "Clairvoyant",
    "Costate",
    "Damper",
    "LoopResult",
    "PeakValue",
    "RampHeights",
    "Sensitivity",
    "Strategy",
    "add",
    "bridgehook",
    "clairvoyant",
    "clipped_lqr",
    "continuous_skyhook",
    "costate",
    "extended_groundhook",
    "groundhook",
    "hybrid",
    "library",
    "passive",
    "pdd",
    "peak_value",
    "preset",
    "program",
    "program_sensitivity",
    "ramp_heights",
    "selective_groundhook",
    "sh_add",
    "simulate_loop",
    "skyhook",
    "tire_groundhook",
]
