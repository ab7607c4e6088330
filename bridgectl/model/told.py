"""What is told of a bridge that is known by its modes alone: checked, and judged by its mass."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline, make_interp_spline

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE
from bridgectl._plausible import PlausibilityWarning
from bridgectl._warn import warn

EffectName: TypeAlias = str | tuple[str, float]
"""A name, or a quantity and its section."""

COUPLED = 0.1
"""Mass coupling of two modes, of at most 1, above which their shapes can hardly be right."""

OFF = 0.2
"""Relative difference of a modal mass from that of its shape that is told."""


class ToldEffect(NamedTuple):
    """A load effect: its influence line, linear between places, and its value of each mode."""

    places: FloatArray
    influence: FloatArray
    modal: FloatArray


def positive(name: str, value: ArrayLike, shape: tuple[int | None, ...], unit: str) -> FloatArray:
    """Numbers above 0, one of which may stand for all if their number is known."""
    if np.ndim(value) == 0 and None not in shape:
        value = np.full(cast(tuple[int, ...], shape), _checks.positive(name, value, unit=unit))
    numbers = _checks.array(name, value, shape, unit=unit)
    if numbers.size == 0 or numbers.min() <= 0:
        wrong = f"got {numbers.min():g} at index {numbers.argmin()}" if numbers.size else "got none"
        raise ValueError(f"{name} must all be above 0 {unit}, {wrong}")
    return numbers


def checked_places(value: ArrayLike) -> FloatArray:
    """Places along the wheel path, rising from 0."""
    x = _checks.array("x", value, (None,), unit="m")
    if x.size < 2 or np.any(np.diff(x) <= 0):
        raise ValueError("x must be two places [m] or more, each beyond the one before")
    if abs(x[0]) > SAME_PLACE:
        raise ValueError(
            f"x must begin with 0, the start of the bridge, got {x[0]:g}: type x - x[0]"
        )
    return x


def checked_shapes(value: ArrayLike, n_places: int, n_modes: int) -> FloatArray:
    """Mode shapes, a mode a column, none of which is zero."""
    if np.shape(value) == (n_modes, n_places) != (n_places, n_modes):
        raise ValueError(
            f"mode_shapes must have shape ({n_places}, {n_modes}), a mode a column, got "
            f"({n_modes}, {n_places}): type numpy.transpose(mode_shapes)"
        )
    shapes = _checks.array("mode_shapes", value, (n_places, n_modes))
    still = np.flatnonzero(~shapes.any(axis=0))
    if still.size:
        raise ValueError(f"mode_shapes[:, {still[0]}] is zero everywhere: leave this mode out")
    return shapes


def checked_name(name: Any) -> EffectName:
    """The name of an effect, or its quantity and section."""
    if isinstance(name, str):
        return name
    if isinstance(name, tuple) and len(name) == 2 and isinstance(name[0], str):
        section = _checks.number("section of an effect", name[1])
        if 0 <= section <= 1:
            return name[0], section
    raise ValueError(
        "effects must be of a name or a quantity and its section, a fraction of the length, got "
        f"{name!r}: type ('moment', 0.5) or 'strain_gauge_1'"
    )


def checked_effect(name: EffectName, value: Any, x: FloatArray, n_modes: int) -> ToldEffect:
    """An effect from its places, influence line and modal values."""
    label = f"effects[{told(name)}]"
    if not (isinstance(value, tuple | list) and len(value) == 3):
        raise ValueError(
            f"{label} must be (places [m], influence per N, modal values), "
            f"got {type(value).__name__}"
        )
    places = _checks.array(f"{label}[0]", value[0], (None,), unit="m")
    if places.size < 2 or np.any(np.diff(places) <= 0):
        raise ValueError(f"{label}[0] must be two places [m] or more, each beyond the one before")
    if places[0] < -SAME_PLACE or places[-1] > x[-1] + SAME_PLACE:
        raise ValueError(
            f"{label}[0] must lie on the bridge, from 0 to {x[-1]:g} m, "
            f"got {places[0]:g} to {places[-1]:g} m"
        )
    return ToldEffect(
        places,
        _checks.array(f"{label}[1]", value[1], places.shape),
        _checks.array(f"{label}[2]", value[2], (n_modes,)),
    )


def told(name: EffectName) -> str:
    """The name of an effect as text."""
    return repr(name) if isinstance(name, str) else f"({name[0]!r}, {name[1]:g})"


def judge_coupling(coupling: FloatArray) -> None:
    """Warn of the two modes whose shapes are furthest from orthogonal."""
    np.fill_diagonal(coupling, 0.0)
    worst = float(coupling.max())
    if worst > COUPLED:
        i, j = sorted(int(k) + 1 for k in np.unravel_index(coupling.argmax(), coupling.shape))
        warn(
            f"modes {i} and {j} are coupled by mass_per_length, by {worst:.2g} where 0 is none and "
            "1 is the same shape: leave one out, or check the shapes and the mass",
            PlausibilityWarning,
        )


def judge_masses(masses: FloatArray, own: FloatArray) -> None:
    """Warn of the modal mass that is furthest from that of its shape."""
    off = np.abs(masses / own - 1)
    j = int(off.argmax())
    if off[j] > OFF:
        warn(
            f"modal_masses[{j}] is {masses[j]:g} kg, its shape and mass_per_length have "
            f"{own[j]:.4g} kg: is the shape scaled otherwise? Leave modal_masses out to take those",
            PlausibilityWarning,
        )


FEWEST = 4
"""Places from which on shapes are splines; of fewer they are straight lines."""


def interpolation(x: FloatArray, shapes: FloatArray) -> Callable[..., FloatArray]:
    """Shapes between places [m], and their derivatives of an order that is given after them."""
    spline = CubicSpline(x, shapes) if x.size >= FEWEST else make_interp_spline(x, shapes, k=1)
    return cast(Callable[..., FloatArray], spline)


def require_slopes(x: FloatArray) -> None:
    """Refuse places [m] between which shapes are straight lines, where slopes are asked for."""
    if x.size < FEWEST:
        raise ValueError(
            f"x must hold {FEWEST} places or more for the slopes of mode shapes, which tire "
            f"damping feels, got {x.size}: give more places, or type tire_damping=0"
        )
