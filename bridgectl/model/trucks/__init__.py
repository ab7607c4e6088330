"""Trucks from their parts, from files, and from a catalog of sets that have been published.

`rigid` and `articulated` make a `bridgectl.Vehicle` of bodies and the axles, or groups of axles,
under them; `half_car` of two axles makes one from numbers alone. `load` takes a truck from the
catalog, or from a TOML file. Places along a body are in metres, positive backward, from wherever
its own count: its centre of gravity, the first axle.
"""

from bridgectl.model.trucks.build import articulated, half_car, rigid
from bridgectl.model.trucks.file import catalog, load
from bridgectl.model.trucks.parts import Axle, Body

__all__ = ["Axle", "Body", "articulated", "catalog", "half_car", "load", "rigid"]
