"""Semi-active dampers: strategies as CasADi expressions, and crossings with them in the loop."""

from .actuator import Damper
from .bridgehook import Bridgehook, Costate, bridgehook, costate
from .closed_loop import LoopResult, simulate_loop
from .laws import add, continuous_skyhook, groundhook, hybrid, passive, pdd, sh_add, skyhook
from .strategy import SIGNALS, Strategy

__all__ = [
    "SIGNALS",
    "Bridgehook",
    "Costate",
    "Damper",
    "LoopResult",
    "Strategy",
    "add",
    "bridgehook",
    "continuous_skyhook",
    "costate",
    "groundhook",
    "hybrid",
    "passive",
    "pdd",
    "sh_add",
    "simulate_loop",
    "skyhook",
]
