"""Load effects on the command line: ``--effect hogging@25,reaction@0,tire_force``."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, cast

import numpy as np

import bridgectl as bc
from bridgectl._places import SAME_PLACE
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.bridge_effects import AtSection
from bridgectl.model.effect import NO_FACTOR, Effect
from bridgectl.model.effects import as_effect
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.supports import Support

EFFECTS: dict[str, Callable[..., Effect]] = {
    "moment": bc.Moment, "shear": bc.Shear, "reaction": bc.Reaction, "deflection": bc.Deflection,
    "bridge_acceleration": bc.BridgeAcceleration, "tire_force": bc.TireForce,
    "body_acceleration": bc.BodyAcceleration,
}  # fmt: skip
"""Effects by name, of which the largest values count; the smallest of 'least_' and the name."""

ALIASES = {"sagging": "moment", "hogging": "least_moment"}

LEAST = "least_"

EFFECT_HELP = """\
NAME@METRES, several separated by commas; the place counts from the start of the bridge, halfway if
left out: moment (also sagging), hogging (the smallest moment), shear, reaction, deflection,
bridge_acceleration, tire_force, body_acceleration; least_shear, least_tire_force, ... of the
smallest value (default moment, at --section)"""


@dataclass(frozen=True)
class Asked:
    """An effect that is asked for, of a bridge and a vehicle."""

    name: str
    crossing: bc.Crossing

    @property
    def effect(self) -> Effect:
        """The effect, with its place."""
        return self.crossing.effect

    @property
    def is_factor(self) -> bool:
        """Whether a static peak makes a factor of it."""
        return self.crossing.static_peak != 0

    @property
    def unit(self) -> str:
        """Unit of what is told."""
        return "-" if self.is_factor else self.effect.unit

    @property
    def told(self) -> str:
        """The effect in words."""
        place = f" at {self.effect.at:g} m" if isinstance(self.effect, AtSection) else ""
        return f"{self.effect.sense} {self.effect.label}{place}"

    def worst(self, values: Any) -> int:
        """Index of the worst of some factors or peaks."""
        return int(np.argmax(self.crossing.orientation * values))


def asked_effects(
    args: argparse.Namespace, bridge: BridgeModel, vehicle: QuarterCar
) -> list[Asked]:
    """Return the effects of --effect, or the moment at --section."""
    if args.effect is None:
        effect = as_effect("moment", bridge, vehicle.linear, args.section, args.recovery)
        return [_asked("moment", effect, bridge, vehicle)]
    if args.section != 0.5:
        raise ValueError(
            "--section and --effect exclude each other: for a moment there type --effect "
            f"moment@{args.section * bridge.length:g}"
        )
    texts = [text.strip() for text in args.effect.split(",")]
    if twice := [text for text in texts if texts.count(text) > 1]:
        raise ValueError(f"--effect names {twice[0]!r} twice: leave one out")
    return [
        _asked(text, _effect(text, args.recovery, bridge), bridge, vehicle) for text in texts
    ]


def _effect(text: str, recovery: str, bridge: BridgeModel) -> Effect:
    """The effect of a text, with its place."""
    name, mark, place = text.partition("@")
    name = name.strip().lower()
    full = ALIASES.get(name, name)
    kind = EFFECTS.get(full.removeprefix(LEAST))
    if kind is None:
        names = [*EFFECTS, *ALIASES, *(f"{LEAST}{each}" for each in EFFECTS)]
        near = get_close_matches(name, names, 1)
        raise ValueError(
            f"--effect: there is no {name!r}: type {near[0] if near else f'one of {names}'}"
        )
    options: dict[str, Any] = {"recovery": recovery} if kind is bc.Moment else {}
    if full.startswith(LEAST):
        options["sense"] = "smallest"
    if not mark:
        return kind(**options)
    if kind in (bc.TireForce, bc.BodyAcceleration):
        raise ValueError(f"--effect {text}: that of the vehicle has no place: type {name}")
    return kind(_place(text, name, place, bridge.length), **options)


def _place(text: str, name: str, place: str, length: float) -> float:
    try:
        at = float(place)
    except ValueError:
        at = float("nan")
    if not 0 <= at <= length:
        raise ValueError(
            f"--effect {text} must have a place on the bridge, from 0 to {length:g} m: for halfway "
            f"type {name}@{length / 2:g}"
        )
    return at


def _asked(text: str, effect: Effect, bridge: BridgeModel, vehicle: QuarterCar) -> Asked:
    _require_place(text, effect, bridge)
    try:
        found = Asked(text, bc.Crossing(bridge, vehicle, effect))
        _ = found.is_factor
    except (TypeError, ValueError) as error:
        raise ValueError(f"--effect {text}: {error}") from None
    return found


def _require_place(text: str, effect: Effect, bridge: BridgeModel) -> None:
    """Refuse a place where a bridge tells no such effect, or where it is always 0."""
    if not isinstance(effect, AtSection):
        return
    name, at = text.partition("@")[0], effect.section(bridge) * bridge.length
    places = _places(effect, bridge)
    if places is not None and not any(abs(at - place) < SAME_PLACE for place in places):
        listed = ", ".join(f"{name}@{place:.9g}" for place in places)
        remedy = f"type one of {listed}" if places else "leave it out"
        raise ValueError(
            f"--effect {text}: the bridge has no {effect.label} at {at:g} m that it tells: {remedy}"
        )
    if _is_always_zero(effect, at, bridge):
        raise ValueError(
            f"--effect {text}: the {effect.label} at {at:g} m is 0, whatever crosses: type "
            f"another place, as {name}@{0.4 * bridge.length:g}"
        )


def _places(effect: AtSection, bridge: BridgeModel) -> list[float] | None:
    """Places [m] where a bridge tells an effect; None for anywhere."""
    if isinstance(bridge, bc.ModalBridge) and isinstance(effect, bc.Moment | bc.Shear | bc.Reaction):
        kind = type(effect).__name__.lower()
        told = [name for name in bridge.effects if not isinstance(name, str)]
        return [section * bridge.length for quantity, section in told if quantity == kind]
    if not isinstance(effect, bc.Reaction):
        return None
    if not isinstance(bridge, bc.Bridge):
        return [0.0, bridge.length]
    supports = cast(Sequence[str | Support], bridge.supports)
    held = [support.vertical if isinstance(support, Support) else support != "free"
            for support in supports]  # fmt: skip
    return [float(place) for place, here in zip(bridge.support_places, held, strict=True) if here]


def _is_always_zero(effect: AtSection, at: float, bridge: BridgeModel) -> bool:
    """Whether no mode does anything to a moment, or to what is said of deflections, at a place."""
    if not isinstance(effect, bc.Moment | bc.Deflection | bc.BridgeAcceleration):
        return False
    if isinstance(bridge, bc.Beam):
        return at in (0.0, bridge.length)
    if isinstance(effect, bc.Moment) and isinstance(bridge, bc.ModalBridge):
        return False

    def size(section: float) -> float:
        if isinstance(effect, bc.Moment):
            return float(np.abs(bridge.modal_moments(section)).max())
        return float(np.abs(bridge.mode_shapes(section * bridge.length)).max())

    return size(at / bridge.length) < NO_FACTOR * max(map(size, np.linspace(0, 1, 51)))
