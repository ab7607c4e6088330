"""Effects by their names, which with a section and a recovery are short for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

from bridgectl import _checks
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.bridge_effects import Deflection, Moment
from bridgectl.model.effect import Effect
from bridgectl.model.recovery import RECOVERIES
from bridgectl.model.vehicle import Vehicle, signals
from bridgectl.model.vehicle_effects import BodyAcceleration, TireForce

NamedEffects: TypeAlias = Mapping[str, Effect | str] | tuple[tuple[str, Effect], ...]
"""Further effects of a crossing by their names."""

STATIC = "static_"
"""What the name of an output begins with that static loads give."""


def as_effect(
    effect: Effect | str,
    bridge: BridgeModel,
    vehicle: Vehicle,
    section: float = 0.5,
    recovery: str = "exact",
) -> Effect:
    """Return the effect that a value, or a name with a section and a recovery, stands for."""
    place = _checks.fraction("section", section, bridge.length)
    _checks.choice("recovery", recovery, RECOVERIES)
    if isinstance(effect, Effect):
        if place != 0.5:
            raise ValueError(
                f"section goes with the name of an effect, got {effect!r} and section={place:g}: "
                f"type for example Moment(at={place * bridge.length:g})"
            )
        if recovery == "exact" or not isinstance(effect, Moment):
            return effect.on(bridge, vehicle)
        if effect.recovery not in ("exact", recovery):
            raise ValueError(f"recovery is {recovery!r} and that of {effect!r}: leave one out")
        return replace(effect, recovery=recovery).on(bridge, vehicle)
    at = place * bridge.length
    named: dict[str, Effect] = {
        "moment": Moment(at, recovery=recovery),
        "deflection": Deflection(at),
        **{
            name: TireForce(tire)
            for tire, name in enumerate(signals("tire_force", vehicle.n_tires), 1)
        },
        "acceleration": BodyAcceleration(),
    }
    if isinstance(effect, Mapping):
        raise TypeError(
            f"effect must be one effect, or in daf and peak_effect a list, got {effect!r}: type "
            "there effect=list(effects.values()), and in crossing_response effects=effects"
        )
    if not isinstance(effect, str):
        raise TypeError(
            f"effect must be one of {', '.join(map(repr, named))}, or as Moment(at=12.5), got "
            f"{effect!r}; speeds go with daf(...), crossing_system(...) and others"
        )
    return named[_checks.choice("effect", effect, tuple(named))]


def named_effects(
    effects: NamedEffects, taken: Sequence[str], bridge: BridgeModel, vehicle: Vehicle
) -> tuple[tuple[str, Effect], ...]:
    """Further effects for a bridge and a vehicle; their names are words, and none that is taken."""
    if not isinstance(effects, Mapping | tuple):
        raise TypeError(
            f"effects must be effects by their names, got {effects!r:.60}: type for example "
            "effects={'pier': bridgectl.Moment(25.0)}"
        )
    named = dict(effects)
    for name in named:
        if not (isinstance(name, str) and name.isidentifier()) or name.startswith(STATIC):
            raise ValueError(
                f"effects must have words for names, not beginning with {STATIC!r}, got {name!r}: "
                "type for example effects={'pier': bridgectl.Moment(25.0)}"
            )
        if name in taken:
            raise ValueError(
                f"effects must have names of their own, and {name!r} is an output already: type "
                f"{name + '_2'!r}"
            )
    return tuple((name, as_effect(effect, bridge, vehicle)) for name, effect in named.items())
