"""Effects, crossings and sizes of effects in words, for the texts that people read."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bridgectl._units import readable, readable_unit
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.bridge_effects import AtSection
from bridgectl.model.effect import Effect
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle


def effect_in_words(effect: Effect) -> str:
    """Return the sense of an effect, what it is, and its place."""
    at = effect.at if isinstance(effect, AtSection) else None
    return f"{effect.sense} {effect.label}" + ("" if at is None else f" at {at:g} m")


def crossing_in_words(bridge: BridgeModel, vehicle: Vehicle | QuarterCar) -> str:
    """Return what crosses what, in one line."""
    first, linear = float(bridge.omega.min()) / (2 * np.pi), vehicle.linear
    axles = linear.static_loads.size
    wheels = f" on {axles} axles" if axles > 1 else ""
    return (
        f"Bridge of {bridge.length:g} m, first frequency {first:.3g} Hz; vehicle of "
        f"{linear.static_loads.sum() / 1e3:.3g} kN{wheels}"
    )


class Amounts(NamedTuple):
    """How much an effect is, in the units that people read; of moments their stress, too."""

    unit: str
    section_modulus: float | None = None
    """W of the fibre whose stress is told beside a moment [m^3]."""

    @property
    def units(self) -> list[str]:
        """Units of the numbers of each value."""
        return [readable_unit(self.unit)] + ["MPa"] * (self.section_modulus is not None)

    def cells(self, value: float) -> list[str]:
        """Return a value in each of the units."""
        found = [readable(value, self.unit)]
        if self.section_modulus is not None:
            found.append(readable(value / self.section_modulus, "N/m^2"))
        return found

    def told(self, value: float, *, units: bool = True) -> str:
        """Return a value as '531 kN m (0.48 MPa)', or without the units."""
        each = zip(self.cells(value), self.units, strict=True)
        first, *more = (f"{cell} {unit}" if units else cell for cell, unit in each)
        return f"{first} ({more[0]})" if more else first
