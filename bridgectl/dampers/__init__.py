"""Semi-active dampers: strategies as CasADi expressions, and crossings with them in the loop."""

from bridgectl._gone import no_attribute
from bridgectl.dampers.actuator import Damper
from bridgectl.dampers.bridgehook import bridgehook
from bridgectl.dampers.costate import costate
from bridgectl.dampers.laws import (
    add,
    continuous_skyhook,
    groundhook,
    hybrid,
    passive,
    pdd,
    sh_add,
    skyhook,
)
from bridgectl.dampers.library import library
from bridgectl.dampers.loop.closed_loop import simulate_loop
from bridgectl.dampers.lqr import clipped_lqr
from bridgectl.dampers.measured import measured
from bridgectl.dampers.optimum.clairvoyant import clairvoyant
from bridgectl.dampers.preset import preset
from bridgectl.dampers.program import program
from bridgectl.dampers.rollout.hooks import preview_hook, rollout_hook
from bridgectl.dampers.sensitivity import program_sensitivity
from bridgectl.dampers.sensors import Sensors
from bridgectl.dampers.signals import SIGNALS
from bridgectl.dampers.strategy import Strategy
from bridgectl.dampers.tire_laws import extended_groundhook, selective_groundhook, tire_groundhook

__all__ = [
    "SIGNALS",
    "Damper",
    "Sensors",
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
    "measured",
    "passive",
    "pdd",
    "preset",
    "preview_hook",
    "program",
    "program_sensitivity",
    "rollout_hook",
    "selective_groundhook",
    "sh_add",
    "simulate_loop",
    "skyhook",
    "tire_groundhook",
]


def __getattr__(name: str) -> object:
    raise no_attribute(__name__, name)
