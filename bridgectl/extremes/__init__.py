"""Roads that roughness numbers do not tell apart, and the roads that amplify most and least.

Li, OBrien and Gonzalez (2006) show two roads of one IRI and one spectrum that load a bridge very
differently (Fig. 3), and test their estimate on two artificial roads made for extremes of the DAF
(Fig. 8, profiles 7 and 8).
"""

from bridgectl._gone import no_attribute
from bridgectl.extremes.linear_program import extreme_road
from bridgectl.extremes.pairs import equal_roughness_pair

__all__ = ["equal_roughness_pair", "extreme_road"]


def __getattr__(name: str) -> object:
    raise no_attribute(__name__, name)
