"""What a study expects of a surface that it loads, and how it is told that it has another."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from bridgectl import _checks
from bridgectl.model.beam import Beam
from bridgectl.model.effect import Effect
from bridgectl.model.modal import ModalBridge
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.recovery import RECOVERIES
from bridgectl.model.spans import Bridge
from bridgectl.model.vehicle import Vehicle
from bridgectl.surface.parts import COMPUTED, UNITS, leaves

SAME = 1e-9
"""Parameters that differ by less, relatively, are the same: far above round-off."""

ANEW = "compute it anew by bridgectl.ramp_surface and save it"


class SurfaceFileError(ValueError):
    """A file that holds no ramp surface, or not the expected one; one line says why."""


def checked_expectations(kind: type[Any], **given: Any) -> dict[str, Any]:
    """Return the expected parameters, without those omitted."""
    allowed = ["section", "recovery", *(f.name for f in dataclasses.fields(kind) if f.init)]
    allowed = [name for name in allowed if name not in COMPUTED]
    for name in given:
        if name not in allowed:
            raise TypeError(
                f"load_surface has no parameter {name!r}: expected parameters of the surface are "
                f"{', '.join(allowed)}"
            )
    return {name: _expectation(name, value) for name, value in given.items() if value is not None}


def _expectation(name: str, value: Any) -> Any:
    kinds = {"beam": (Beam, Bridge, ModalBridge), "vehicle": (Vehicle, QuarterCar)}.get(name)
    if kinds:
        if not isinstance(value, kinds):
            *others, last = (kind.__name__ for kind in kinds)
            words = f"{', '.join(others)} or {last}"
            raise TypeError(f"{name} must be a bridgectl.{words}, got {type(value).__name__}")
        return value
    if name == "speeds":
        return _checks.speeds(value)
    if name == "section":
        return _checks.fraction(name, value)
    if name == "recovery":
        return _checks.choice(name, value, RECOVERIES)
    if name == "effect" and not isinstance(value, Effect):
        raise TypeError(f"effect must be one as bridgectl.Moment(at=12.5), got {value!r}")
    return _checks.number(name, value, unit=UNITS[name]) if name in UNITS else value


def require_expected(surface: Any, expected: Mapping[str, Any]) -> None:
    """Refuse a surface that differs from what is expected, with every difference."""
    found = {
        name: list(_differences(name, getattr(surface, name), wanted))
        for name, wanted in expected.items()
    }
    if texts := [text for each in found.values() for text in each]:
        names = ", ".join(f"{name}=" for name, each in found.items() if each)
        raise SurfaceFileError(
            f"not the expected surface: {'; '.join(texts)}. For the expected one, {ANEW}; for "
            f"the one in the file, leave out {names}"
        )


def _differences(name: str, found: Any, wanted: Any) -> Iterator[str]:
    """What differs of a parameter, with both values."""
    if name == "vehicle" and type(found) is not type(wanted):
        found, wanted = found.linear, wanted.linear
    if name in ("beam", "effect") and type(found) is not type(wanted):
        yield f"{name} is {found!r} in the file, {wanted!r} expected"
        return
    wanted_leaves = dict(leaves(wanted, name))
    for where, leaf in leaves(found, name):
        if not _same(leaf, wanted_leaves[where]):
            yield _difference(where, leaf, wanted_leaves[where])


def _same(found: Any, wanted: Any) -> bool:
    a, b = np.asarray(found), np.asarray(wanted)
    if a.dtype.kind not in "iuf" or b.dtype.kind not in "iuf" or a.shape != b.shape:
        return bool(np.array_equal(a, b))
    return bool(np.allclose(a, b, rtol=SAME, atol=SAME * np.abs(b).max(initial=0.0)))


def _difference(name: str, found: Any, wanted: Any) -> str:
    a, b = np.asarray(found), np.asarray(wanted)
    if isinstance(found, np.ndarray) and a.shape == b.shape:
        where = next(i for i in np.ndindex(a.shape) if not _same(a[i], b[i]))
        name, found, wanted = f"{name}[{', '.join(map(str, where))}]", a[where], b[where]
    unit = UNITS.get(name.partition("[")[0], "1")
    return f"{name} is {_shown(found, unit)} in the file, {_shown(wanted, unit)} expected"


def _shown(value: Any, unit: str) -> str:
    if isinstance(value, np.ndarray):
        size = " x ".join(map(str, value.shape))
        span = f" from {value.min():.6g} to {value.max():.6g}" if value.size else ""
        text = f"an array of {size}{span}"
    else:
        text = repr(value.item() if isinstance(value, np.generic) else value)
    return text if unit == "1" else f"{text} {unit}"
