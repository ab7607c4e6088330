"""Measures of a tire force or a ride: what roads and people feel."""

from bridgectl._gone import no_attribute
from bridgectl.measures.loads import aggregate_fourth_power, dynamic_load_coefficient
from bridgectl.measures.weighting import weighted_rms

__all__ = ["aggregate_fourth_power", "dynamic_load_coefficient", "weighted_rms"]


def __getattr__(name: str) -> object:
    raise no_attribute(__name__, name)
