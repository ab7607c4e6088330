"""Dampers fitted to the legs of a vehicle: one for all, or each leg its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.dampers.actuator import (
    Damper,
    as_damper,
    bare_vehicle,
    with_damping,
)
from bridgectl.dampers.laws import passive
from bridgectl.dampers.legs import require_dampers
from bridgectl.dampers.signals import SIGNALS, others_of
from bridgectl.dampers.strategy import Strategy
from bridgectl.model.crossing import Crossing
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.traffic import require_row
from bridgectl.model.vehicle import Vehicle
from bridgectl.model.vehicle_effects import BodyAcceleration


@dataclass(frozen=True)
class Fitted:
    """Dampers at some legs of a vehicle; the others keep their passive ones. Made by `fitted`."""

    legs: tuple[int, ...]
    """Numbers of the legs, rising, of those that the vehicle has."""
    dampers: tuple[Damper, ...]
    """The damper of each."""

    @property
    def name(self) -> str:
        """What tables call it."""
        names = [damper.strategy.name for damper in self.dampers]
        return names[0] if len(set(names)) == 1 else ", ".join(names)

    @property
    def sample_time(self) -> float:
        """Time between samples [s]."""
        return self.dampers[0].sample_time

    @property
    def dampings(self) -> FloatArray:
        """Largest damping of each [N s/m]."""
        return np.array([damper.strategy.c_max for damper in self.dampers])

    @property
    def kept(self) -> FloatArray | None:
        """Dampings [N s/m], the best of which all legs keep: see `Damper.kept`."""
        every = [damper.kept for damper in self.dampers]
        return every[0] if _alike(every) else None

    @property
    def constant(self) -> float | None:
        """Damping [N s/m] that all legs keep; None if they keep none, or not the same."""
        return None if self.kept is None or len(self.kept) > 1 else float(self.kept[0])

    @property
    def whole(self) -> bool:
        """Whether a law measures at other legs, so that all have their dampers in the loop."""
        return any(d.constant is None and d.strategy.signals != SIGNALS for d in self.dampers)

    def without(self, vehicle: Vehicle | QuarterCar) -> Vehicle | QuarterCar:
        """Return a vehicle with all its legs, and at these no passive dampers."""
        return with_damping(vehicle, 0.0, self.legs)

    def bare(self, crossing: Crossing) -> Crossing:
        """Return the crossing whose vehicle has these legs' dampers controlled, and no others."""
        return replace(crossing, vehicle=bare_vehicle(crossing.vehicle, self.legs))

    def resolved(self, crossing: Crossing) -> tuple[Crossing, Fitted | None]:
        """Return the crossing with constant dampers in the vehicle, and those that are not."""
        vehicle, left = crossing.vehicle, {}
        for leg, damper in zip(self.legs, self.dampers, strict=True):
            if damper.constant is None or self.whole:
                left[leg] = damper
            else:
                vehicle = with_damping(vehicle, damper.constant, (leg,))
        if left and isinstance(crossing.effect, BodyAcceleration):
            raise ValueError(
                "with a damper that is not constant the effect is a moment, a deflection or a tire "
                f"force, got {crossing.effect!r}: histories of accelerations has simulate_loop("
                'record=["body_acceleration"])'
            )
        rest = Fitted(tuple(left), tuple(left.values())) if left else None
        return replace(crossing, vehicle=vehicle), rest


def _alike(dampings: Sequence[FloatArray | None]) -> bool:
    """Whether all are the same dampings."""
    first = dampings[0]
    return first is not None and all(
        own is not None and np.array_equal(own, first) for own in dampings
    )


Dampers = (
    Damper
    | Strategy
    | Sequence[Damper | Strategy | None]
    | Mapping[str, Damper | Strategy]
    | Fitted
)
"""One damper for all legs, one for each in the vehicle's order, some by name, or fitted ones."""


def fitted_everywhere(dampers: Any, vehicle: Vehicle | QuarterCar) -> Fitted:
    """Do as `fitted`, with passive dampers in the loop at the legs that keep theirs."""
    return _everywhere(fitted(dampers, vehicle), vehicle.linear.damper_dampings)


def _everywhere(found: Fitted, own: FloatArray) -> Fitted:
    """Add passive dampers at legs without any."""
    every = dict(zip(found.legs, found.dampers, strict=True))
    time = found.sample_time
    for leg in set(range(len(own))) - set(every):
        every[leg] = Damper(passive(float(own[leg])), sample_time=time)
    return Fitted(tuple(sorted(every)), tuple(every[leg] for leg in sorted(every)))


def fitted(dampers: Any, vehicle: Vehicle | QuarterCar) -> Fitted:
    """Check dampers, given as `Dampers`, and fit them to a vehicle."""
    if isinstance(dampers, Fitted):
        return dampers
    require_row(vehicle, "crossings with a damper")
    require_dampers(vehicle)
    names = vehicle.linear.damper_names
    if isinstance(dampers, Mapping):
        given = _by_name(dampers, names)
    elif isinstance(dampers, Sequence) and not isinstance(dampers, str):
        given = _in_order(dampers, names)
    else:
        given = dict.fromkeys(range(len(names)), as_damper(dampers))
    legs = {leg: _at(damper, leg) for leg, damper in sorted(given.items())}
    _require_one_clock(list(legs.values()))
    found = Fitted(tuple(legs), tuple(legs.values()))
    for damper in found.dampers:
        others_of(damper.strategy.name, damper.strategy.signals, names)
    return _everywhere(found, vehicle.linear.damper_dampings) if found.whole else found


def _at(damper: Damper, leg: int) -> Damper:
    """The damper with the law of a leg."""
    own = damper.strategy.for_leg(leg + 1)
    return damper if own is damper.strategy else replace(damper, strategy=own)


def _by_name(dampers: Mapping[Any, Any], names: Sequence[str]) -> dict[int, Damper]:
    unknown = [name for name in dampers if name not in names]
    if unknown or not dampers:
        got = repr(unknown[0]) if unknown else "none"
        raise ValueError(
            f"damper must name dampers of the vehicle, {', '.join(map(repr, names))}, got {got}: "
            f"type {{{names[0]!r}: bridgectl.dampers.skyhook(1e3, 30e3)}}"
        )
    return {names.index(name): as_damper(damper) for name, damper in dampers.items()}


def _in_order(dampers: Sequence[Any], names: Sequence[str]) -> dict[int, Damper]:
    if len(dampers) != len(names) or all(damper is None for damper in dampers):
        raise ValueError(
            f"damper must be one for all {len(names)} dampers of the vehicle, or a list of one for "
            f"each, got {len(dampers)}: type None in the list where the passive one stays"
        )
    return {leg: as_damper(damper) for leg, damper in enumerate(dampers) if damper is not None}


def _require_one_clock(dampers: Sequence[Damper]) -> None:
    """Refuse dampers that no run has side by side."""
    times = [damper.sample_time for damper in dampers]
    if len(set(times)) > 1:
        raise ValueError(
            f"dampers of one vehicle must have the same sample_time, got {sorted(set(times))} s"
        )
    switching = [damper for damper in dampers if damper.kept is None or len(damper.kept) > 1]
    kept = [damper.strategy.kept for damper in switching]
    if any(own is not None and len(own) > 1 for own in kept) and not _alike(kept):
        raise ValueError(
            "a preset damper knows no other that is not constant beside it: type the same preset "
            "for all of them"
        )
