"""Measures of a tire force or a ride: what roads and people feel."""

from bridgectl.measures.loads import (
    FourthPower,
    aggregate_fourth_power,
    dynamic_load_coefficient,
    histories,
    largest,
    least_force,
    peak_to_peak,
    rms,
    road_stress_factor,
    switching_count,
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
