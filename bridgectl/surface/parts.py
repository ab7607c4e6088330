"""What a ramp surface consists of: parts, which are dataclasses, and leaves, by dotted names."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.model.modal import ModalBridge
from bridgectl.model.supports import Support

UNITS = {
    "section": "1", "effect.at": "m", "approach": "m", "ramp_length": "m", "ramp_height": "m",
    "speeds": "m/s", "positions": "m", "daf_smooth": "1", "daf_unit": "1", "daf_rise": "1",
    "beam.length": "m", "beam.mass_per_length": "kg/m", "beam.flexural_rigidity": "N m^2",
    "beam.x": "m", "beam.mode_shapes": "1", "beam.frequencies": "Hz", "beam.modal_masses": "kg",
    "beam.places": "m", "beam.influence": "effect/N", "beam.modal": "effect",
    "beam.spans": "m", "beam.n_modes": "1", "beam.damping_ratio": "1",
    "vehicle.sprung_mass": "kg", "vehicle.unsprung_mass": "kg",
    "vehicle.suspension_stiffness": "N/m", "vehicle.tire_stiffness": "N/m",
    "vehicle.damping": "N s/m", "vehicle.tire_damping": "N s/m",
    "vehicle.mass_matrix": "kg", "vehicle.damping_matrix": "N s/m",
    "vehicle.stiffness_matrix": "N/m", "vehicle.tire_stiffnesses": "N/m",
    "vehicle.tire_offsets": "m", "vehicle.tire_map": "1", "vehicle.damper_map": "1",
    "vehicle.body_places": "m", "vehicle.body_map": "1",
    "vehicle.damper_axles": "1", "vehicle.damper_dampings": "N s/m",
    "vehicle.heave": "1", "vehicle.pitch_input": "kg",
    "histories.nodes": "m", "histories.smooth": "1", "histories.unit": "1/m",
    "histories.entry": "state/m", "histories.local": "1", "histories.carried": "state/state",
    "histories.added": "state/m", "histories.rows": "1/state", "histories.direct": "1/m",
}  # fmt: skip
"""Units of parameters and arrays; 'state' is a displacement [m], its rate [m/s] or the road [m]."""

COMPUTED = ("positions", "daf_smooth", "daf_unit", "daf_rise", "histories")
"""What a surface computes from the rest."""

AXES: dict[str, tuple[str, ...]] = {
    "speeds": ("speed",),
    "positions": ("ramp",),
    "daf_smooth": ("speed",),
    "daf_unit": ("speed", "ramp"),
    "daf_rise": ("speed", "ramp"),
    "histories.nodes": ("node",),
    "histories.smooth": ("speed", "sample"),
    "histories.unit": ("speed", "sample", "ramp"),
    "histories.entry": ("speed", "state", "ramp"),
    "histories.local": ("block", "local ramp"),
    "histories.carried": ("speed", "block", "state", "state"),
    "histories.added": ("speed", "block", "state", "local ramp"),
    "histories.rows": ("speed", "block", "block sample", "state"),
    "histories.direct": ("speed", "block", "block sample", "local ramp"),
}
"""Axes of the arrays: those of one name have one length."""


@dataclasses.dataclass(frozen=True, eq=False)
class ModalParts:
    """What a `ModalBridge` is made of: the lines of its effects one after the other."""

    x: FloatArray
    mode_shapes: FloatArray
    frequencies: FloatArray
    modal_masses: FloatArray
    damping_ratio: FloatArray
    effects: tuple[tuple[str, float | None], ...]
    sizes: tuple[int, ...]
    places: FloatArray
    influence: FloatArray
    modal: FloatArray

    @classmethod
    def of(cls, bridge: ModalBridge) -> ModalParts:
        """Take a bridge apart."""
        told = list(bridge._effects.values())
        return cls(
            bridge._x, bridge._shapes, bridge.frequencies, bridge.modal_masses,
            np.array(bridge.damping_ratios),
            tuple((each, None) if isinstance(each, str) else each for each in bridge._effects),
            tuple(each.places.size for each in told),
            np.concatenate([np.zeros(0), *(each.places for each in told)]),
            np.concatenate([np.zeros(0), *(each.influence for each in told)]),
            np.array([each.modal for each in told]).reshape(-1, bridge.n_modes),
        )  # fmt: skip

    def bridge(self) -> ModalBridge:
        """Put the bridge together again."""
        ends = np.cumsum(self.sizes, dtype=int)
        lines = zip(np.split(self.places, ends), np.split(self.influence, ends), self.modal,
                    strict=False)  # fmt: skip
        names = [name if at is None else (name, at) for name, at in self.effects]
        return ModalBridge(
            self.x, self.mode_shapes, self.frequencies, self.modal_masses, self.damping_ratio,
            effects=dict(zip(names, lines, strict=True)),
        )  # fmt: skip


def require_surface(surface: Any) -> None:
    """Raise a TypeError for what is no ramp surface."""
    # Its class lies above this module.
    if not all(hasattr(surface, name) for name in COMPUTED):
        raise TypeError(
            f"surface must be a bridgectl.RampSurface, got {type(surface).__name__}: "
            "type surface = bridgectl.ramp_surface(beam, vehicle, speeds)"
        )


def parts(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """A dataclass and what it holds, each with its dotted name, '' for the first."""
    if isinstance(value, ModalBridge):
        value = ModalParts.of(value)
    yield name, value
    if dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            if field.init:
                yield from parts(getattr(value, field.name), dotted(name, field.name))


def dotted(*names: str) -> str:
    """Join names that are not empty."""
    return ".".join(filter(None, names))


def leaves(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Numbers, texts, tuples of them and arrays, each with its dotted name."""
    for where, part in parts(value, name):
        if not dataclasses.is_dataclass(part):
            yield where, _leaf(where, part)


def _leaf(name: str, value: Any) -> Any:
    if isinstance(value, np.ndarray) and value.dtype.kind in "biufU":
        return value
    if isinstance(value, np.generic):
        return _leaf(name, value.item())
    if isinstance(value, tuple | list):
        return tuple(_leaf(name, entry) for entry in value)
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Support):  # which a bridge takes by what it is stiff against
        return dataclasses.asdict(value)
    raise TypeError(
        f"{name} is a {type(value).__name__}, which files do not hold: they hold numbers, text, "
        "and arrays of them"
    )
