"""Measures of a tire force or a ride: what roads and people feel."""

from bridgectl.measures.history import histories, largest, peak_to_peak, rms, switching_count
from bridgectl.measures.loads import (
    FourthPower,
    aggregate_fourth_power,
    dynamic_load_coefficient,
    least_force,
    road_stress_factor,
)

__all__ = [
    "FourthPower",
    "aggregate_fourth_power",
    "dynamic_load_coefficient",
    "histories",
    "largest",
    "least_force",
    "peak_to_peak",
    "rms",
    "road_stress_factor",
    "switching_count",
]
