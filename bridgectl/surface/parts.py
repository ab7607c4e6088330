"""What a ramp surface consists of: parts, which are dataclasses, and leaves, by dotted names."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

import numpy as np

from bridgectl.model.supports import Support

UNITS = {
    "section": "1", "effect.at": "m", "approach": "m", "ramp_length": "m", "ramp_height": "m",
    "speeds": "m/s", "positions": "m", "daf_smooth": "1", "daf_unit": "1", "daf_rise": "1",
    "beam.length": "m", "beam.mass_per_length": "kg/m", "beam.flexural_rigidity": "N m^2",
    "beam.spans": "m", "beam.n_modes": "1", "beam.damping_ratio": "1",
    "vehicle.sprung_mass": "kg", "vehicle.unsprung_mass": "kg",
    "vehicle.suspension_stiffness": "N/m", "vehicle.tire_stiffness": "N/m",
    "vehicle.damping": "N s/m", "vehicle.tire_damping": "N s/m",
    "vehicle.mass_matrix": "kg", "vehicle.damping_matrix": "N s/m",
    "vehicle.stiffness_matrix": "N/m", "vehicle.tire_stiffnesses": "N/m",
    "vehicle.tire_offsets": "m", "vehicle.tire_map": "1", "vehicle.damper_map": "1",
    "vehicle.heave": "1",
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
