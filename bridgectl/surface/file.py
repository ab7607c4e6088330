"""Ramp surfaces in files: the format, and how they are saved.

A file holds the arrays of a `RampSurface` under their names ('daf_unit', 'histories.rows')
and one text, 'header': JSON with the format's version, every parameter ('beam.length'), the
class of every part, the units and axes of the arrays, and a sum of all that. Nothing in it is
pickled. It is not compressed: that would save a part of the bytes, and take longer than to compute
the surface.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks, _version
from bridgectl._files import replacing
from bridgectl.model.beam import Beam
from bridgectl.model.bridge_effects import (
    BridgeAcceleration,
    Deflection,
    Moment,
    Reaction,
    Shear,
    Stress,
)
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.spans import Bridge
from bridgectl.model.vehicle import Vehicle
from bridgectl.model.vehicle_effects import BodyAcceleration, TireForce
from bridgectl.surface.factored import FactoredHistories
from bridgectl.surface.histories import DenseHistories
from bridgectl.surface.parts import AXES, UNITS, ModalParts, leaves, parts, require_surface

FORMAT = "bridgectl ramp surface"
VERSION = 3
"""Version of the format: files of another one are refused."""

WHOLE = "RampSurface"
"""What the whole is called; its class lies above this module."""

PARTS: dict[str, type[Any]] = {
    kind.__name__: kind
    for kind in (
        Beam, Bridge, ModalParts, QuarterCar, Vehicle, Moment, Deflection, Shear, Reaction, Stress,
        BridgeAcceleration, TireForce, BodyAcceleration, FactoredHistories, DenseHistories,
    )
}  # fmt: skip
"""Classes of the parts."""

Array = NDArray[Any]


def save_surface(surface: Any, path: str | os.PathLike[str]) -> None:
    """Save a ramp surface to an NPZ file that `bridgectl.load_surface` reads back to the bit.

    A file that is there is replaced when the new one is complete, and not before.

    Parameters
    ----------
    surface : RampSurface
        The surface. Its file holds all parameters and arrays, in SI units.
    path : str or path-like
        The file, ``.npz``.

    Raises
    ------
    TypeError
        If `surface` is no `RampSurface`, or part of it is of a kind that files do not hold.
    ValueError
        If `path` does not end in ``.npz``.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import bridgectl as bc
    >>> from bridgectl.surface.file import save_surface
    >>> surface = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), 110 / 3.6)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_surface(surface, pathlib.Path(folder, "surface.npz"))
    ...     loaded = bc.load_surface(pathlib.Path(folder, "surface.npz"))
    >>> loaded.dae(bc.li2006.fig7_road()) == surface.dae(bc.li2006.fig7_road())
    array([ True])
    """
    require_surface(surface)
    file = _checks.path("path", path, "surface.npz")
    if Path(file).suffix.lower() != ".npz":
        raise ValueError(f"path must end in .npz, got {file!r}: type path='surface.npz'")
    found = dict(leaves(surface))
    arrays = {name: leaf for name, leaf in found.items() if isinstance(leaf, np.ndarray)}
    header = {
        "format": FORMAT,
        "version": VERSION,
        "bridgectl": _version.__version__,
        "parameters": {name: leaf for name, leaf in found.items() if name not in arrays},
        "classes": dict(_classes(surface)),
        "arrays": {name: _description(name, array) for name, array in arrays.items()},
        "units": {name: UNITS[name] for name in found if name in UNITS},
    }
    header["checksum"] = checksum(header, arrays)
    with replacing(file) as handle:
        # Names of arrays are no other arguments.
        np.savez(handle, header=np.array(json.dumps(header)), **arrays)  # type: ignore[arg-type]


def _classes(surface: Any) -> Iterator[tuple[str, str]]:
    for name, part in parts(surface):
        kind = type(part)
        if dataclasses.is_dataclass(kind):
            known = PARTS.get(kind.__name__) is kind if name else kind.__name__ == WHOLE
            if not known:
                raise TypeError(
                    f"{name or 'surface'} is a {kind.__name__}, which files do not hold: make it "
                    f"one of {', '.join([WHOLE, *PARTS])}, for example by dataclasses.replace"
                )
            yield name, kind.__name__


def _description(name: str, array: Array) -> dict[str, Any]:
    """What the header tells of an array."""
    known = {"unit": UNITS.get(name), "axes": AXES.get(name)}
    # Products of matrices are the same to the bit only for the same order in memory.
    order = np.argsort([-stride for stride in array.strides], kind="stable").tolist()
    known["memory_order"] = order
    return {key: value for key, value in known.items() if value is not None}


def checksum(header: dict[str, Any], arrays: Mapping[str, Array]) -> str:
    """Sum up what a file says, but for the sum itself; not how its JSON is written or packed."""
    said = {name: value for name, value in header.items() if name != "checksum"}
    found = hashlib.blake2b(json.dumps(said, sort_keys=True).encode(), digest_size=16)
    for name, array in sorted(arrays.items()):
        found.update(f"{name} {array.dtype.str} {array.shape}".encode())
        found.update(np.ascontiguousarray(array).data)
    return found.hexdigest()
