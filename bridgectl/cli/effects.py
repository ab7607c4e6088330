"""Load effects on the command line: ``--effect hogging@25,reaction@0,tire_force``."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any, cast

import numpy as np

import bridgectl as bc
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl.cli.bridge_file import QUANTITIES
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.bridge_effects import AtSection
from bridgectl.model.effect import NO_FACTOR, Effect
from bridgectl.model.effects import as_effect
from bridgectl.model.supports import Support

EFFECTS: dict[str, Callable[..., Effect]] = {
    "moment": bc.Moment, "shear": bc.Shear, "reaction": bc.Reaction, "deflection": bc.Deflection,
    "bridge_acceleration": bc.BridgeAcceleration, "tire_force": bc.TireForce,
    "body_acceleration": bc.BodyAcceleration,
}  # fmt: skip
"""Effects by name, of which the largest values count; the smallest of 'least_' and the name."""

ALIASES = {"sagging": "moment", "hogging": "least_moment"}

LEAST = "least_"


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
        """Whether what is told of it is over a static peak, or in its own unit."""
        return self.effect.has_static

    @property
    def least(self) -> bool:
        """Whether the worst of what is told is the least, as of a tire force."""
        return self.crossing.orientation < 0

    @property
    def told(self) -> str:
        """The effect in words."""
        place = f" at {self.effect.at:g} m" if isinstance(self.effect, AtSection) else ""
        return f"{self.effect.sense} {self.effect.label}{place}"

    @property
    def content(self) -> dict[str, Any]:
        """The effect for JSON."""
        effect = self.effect
        static = {"static_peak": self.crossing.static_peak} if self.is_factor else {}
        return {
            "name": self.name, "told": self.told, "sense": effect.sense, "unit": effect.unit,
            "at_m": effect.at if isinstance(effect, AtSection) else None, **static,
        }  # fmt: skip

    def worst(self, values: FloatArray) -> int:
        """Index of the worst of some factors or peaks."""
        return int(np.argmin(values) if self.least else np.argmax(values))


def asked_effects(
    args: argparse.Namespace, bridge: BridgeModel, vehicle: bc.Vehicle | bc.QuarterCar
) -> list[Asked]:
    """Return the effects of --effect, or the moment at --section."""
    if getattr(args, "effect", None) is None:  # which there may be no option for
        effect = as_effect("moment", bridge, vehicle.linear, args.section, args.recovery)
        elsewhere = f"type another --section, as {_elsewhere(bridge) / bridge.length:.3g}"
        return [_asked("moment", f"--section {args.section:g}", elsewhere, effect, bridge, vehicle)]
    if args.section != 0.5:
        raise ValueError(
            "--section and --effect exclude each other: for a moment there type --effect "
            f"moment@{args.section * bridge.length:g}"
        )
    texts = [text.strip() for text in args.effect.split(",")]
    if twice := [text for text in texts if texts.count(text) > 1]:
        raise ValueError(f"--effect names {twice[0]!r} twice: leave one out")
    found = []
    for text in texts:
        effect, name = _effect(text, args.recovery, bridge), text.partition("@")[0]
        elsewhere = f"type another place, as {name}@{_elsewhere(bridge):g}"
        found.append(_asked(text, f"--effect {text}", elsewhere, effect, bridge, vehicle))
    return found


def _elsewhere(bridge: BridgeModel) -> float:
    """A place [m] in the field of the first span."""
    first = bridge.support_places[1] if isinstance(bridge, bc.Bridge) else bridge.length
    return 0.4 * float(first)


def _asked(
    name: str, option: str, elsewhere: str, effect: Effect, bridge: BridgeModel,
    vehicle: bc.Vehicle | bc.QuarterCar,
) -> Asked:  # fmt: skip
    """The effect of a crossing; errors tell the option that asks for it."""
    if isinstance(effect, AtSection):
        _require_place(option, elsewhere, effect, bridge)
    found = Asked(name, bc.Crossing(bridge, vehicle, effect))
    if found.is_factor and found.crossing.static_peak == 0:
        other = f", or {_opposite(name)}" if option.startswith("--effect") else ""
        raise ValueError(
            f"{option}: the {found.told} is 0 while the vehicle creeps across, and makes no "
            f"factor: {elsewhere}{other}"
        )
    return found


def _opposite(text: str) -> str:
    """The other sense of an effect."""
    name, mark, place = text.partition("@")
    full = ALIASES.get(name, name)
    if full in ("moment", "least_moment"):
        return f"{'hogging' if full == 'moment' else 'sagging'}{mark}{place}"
    other = full.removeprefix(LEAST) if full.startswith(LEAST) else f"{LEAST}{full}"
    return f"{other}{mark}{place}"


def _effect(text: str, recovery: str, bridge: BridgeModel) -> Effect:
    """The effect of a text, with its place."""
    name, mark, place = text.partition("@")
    name = name.strip().lower()
    full = ALIASES.get(name, name)
    kind = EFFECTS.get(full.removeprefix(LEAST))
    if kind is None:
        names = [*EFFECTS, *ALIASES, *(f"{LEAST}{each}" for each in EFFECTS)]
        near, listed = get_close_matches(name, names, 1), ", ".join(names)
        raise ValueError(
            f"--effect: there is no {name!r}: type {near[0] if near else f'one of {listed}'}"
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


def _require_place(option: str, elsewhere: str, effect: AtSection, bridge: BridgeModel) -> None:
    """Refuse a place where a bridge tells no such effect, or where it is always 0."""
    at, places = effect.section(bridge) * bridge.length, _places(effect, bridge)
    if places is not None and not any(abs(at - place) < SAME_PLACE for place in places):
        name = option.partition("@")[0]
        listed = [f"{name}@{place:.9g}" for place in places]
        if option.startswith("--section"):
            listed = [f"--section {place / bridge.length:.9g}" for place in places]
        raise ValueError(
            f"{option}: the bridge tells no {effect.label} at {at:g} m: "
            + (f"type {' or '.join(listed)}" if places else "leave it out")
        )
    if _is_always_zero(effect, at, bridge):
        raise ValueError(
            f"{option}: the {effect.label} at {at:g} m is 0, whatever crosses: {elsewhere}"
        )


def _places(effect: AtSection, bridge: BridgeModel) -> list[float] | None:
    """Places [m] where a bridge tells an effect; None for anywhere."""
    kind = type(effect).__name__.lower()
    if isinstance(bridge, bc.ModalBridge) and kind in QUANTITIES:
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
