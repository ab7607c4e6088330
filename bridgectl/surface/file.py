"""Ramp surfaces in files: NPZ that tells what it holds, and labelled arrays for xarray.

A file holds the arrays of a `RampSurface` under their names ('daf_unit', 'histories.rows')
and one text, 'header': JSON with the format's version, every parameter ('beam.length'), the
class of every part, the units and axes of the arrays, and a sum of all that. Nothing in it is
pickled. It is not compressed: that would save a third of the bytes, and take longer than to compute
the surface.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import os
import warnings
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks, _version
from bridgectl._files import is_regular, replacing
from bridgectl.linear.cells import SAME_PLACE, sample_positions
from bridgectl.model.beam import Beam
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road.files.lines import printable
from bridgectl.surface.expected import (
    ANEW,
    SurfaceFileError,
    checked_expectations,
    require_expected,
)
from bridgectl.surface.histories import DenseHistories, FactoredHistories
from bridgectl.surface.parts import AXES, UNITS, dotted, leaves, parts, require_surface
from bridgectl.surface.surface import RampSurface

__all__ = ["SurfaceFileError", "load_surface", "save_surface"]

FORMAT = "bridgectl ramp surface"
VERSION = 2
"""Version of the format: files of another one are refused."""

INFLATION = 20
"""How many times its size a file may inflate to: numbers of a surface hardly compress."""

UNZIPPED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Ways of packing that NumPy uses, and that are undone piece by piece: never more at once."""

_CLASSES: dict[str, type[Any]] = {
    kind.__name__: kind
    for kind in (RampSurface, Beam, QuarterCar, Vehicle, FactoredHistories, DenseHistories)
}

Array = NDArray[Any]


class _Misfit(SurfaceFileError):  # noqa: N818
    """A file of this format whose parts do not fit this version of the package."""


def save_surface(surface: RampSurface, path: str | os.PathLike[str]) -> None:
    """Save a ramp surface to an NPZ file that `load_surface` reads back to the bit.

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
    >>> from bridgectl.surface.file import load_surface, save_surface
    >>> surface = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), 110 / 3.6)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_surface(surface, pathlib.Path(folder, "surface.npz"))
    ...     loaded = load_surface(pathlib.Path(folder, "surface.npz"))
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
    header["checksum"] = _checksum(header, arrays)
    with replacing(file) as handle:
        # Names of arrays are no other arguments.
        np.savez(handle, header=np.array(json.dumps(header)), **arrays)  # type: ignore[arg-type]


def load_surface(
    path: str | os.PathLike[str],
    *,
    beam: Beam | None = None,
    vehicle: Vehicle | QuarterCar | None = None,
    section: float | None = None,
    recovery: str | None = None,
    approach: float | None = None,
    speeds: ArrayLike | None = None,
    **others: Any,
) -> RampSurface:
    """Load a ramp surface, if it is that of the study at hand.

    Parameters
    ----------
    path : str or path-like
        A file that `save_surface` wrote.
    beam, vehicle, section, recovery, approach, speeds : optional
        What the study expects, as in `ramp_surface`, approach [m] and speeds [m/s]: the file is
        refused unless it has the same, to 9 digits. Anything is accepted of what is omitted.
    others : optional
        Further parameters of the surface, likewise: ``ramp_length=0.1``.

    Returns
    -------
    RampSurface
        All its numbers and results are those of the saved one, to the bit.

    Raises
    ------
    SurfaceFileError
        If there is no such file, it is damaged or was edited, it would fill the memory, it holds
        no surface in this version of the format, or one of other parameters; the message names the
        file and each difference.
    TypeError, ValueError
        If an expected parameter is none, or has the wrong kind or range.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import bridgectl as bc
    >>> from bridgectl.surface.file import load_surface, save_surface
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save_surface(bc.ramp_surface(beam, car, 110 / 3.6), pathlib.Path(folder, "li.npz"))
    ...     load_surface(pathlib.Path(folder, "li.npz"), beam=beam, vehicle=car, approach=0)
    RampSurface(1 speeds from 110 to 110 km/h, 250 ramps of 1 mm over 100 mm
    from x = 0 m to 25 m, recovery='exact')
    """
    file = _checks.path("path", path, "surface.npz")
    expected = checked_expectations(
        _CLASSES["RampSurface"], beam=beam, vehicle=vehicle, section=section, recovery=recovery,
        approach=approach, speeds=speeds, **others,
    )  # fmt: skip
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about a vehicle, say: they came when it was made
            surface = _read(file)
        require_expected(surface, expected)
    except SurfaceFileError as fault:
        raise SurfaceFileError(printable(f"{file}: {fault}")) from None
    return surface


def _classes(surface: RampSurface) -> Iterator[tuple[str, str]]:
    for name, part in parts(surface):
        kind = type(part)
        if dataclasses.is_dataclass(kind):
            if _CLASSES.get(kind.__name__) is not kind:
                raise TypeError(
                    f"{name or 'surface'} is a {kind.__name__}, which files do not hold: make it "
                    f"one of {', '.join(_CLASSES)}, for example by dataclasses.replace"
                )
            yield name, kind.__name__


def _description(name: str, array: Array) -> dict[str, Any]:
    """What the header tells of an array."""
    known = {"unit": UNITS.get(name), "axes": AXES.get(name)}
    # Products of matrices are the same to the bit only for the same order in memory.
    order = np.argsort([-stride for stride in array.strides], kind="stable").tolist()
    known["memory_order"] = order
    return {key: value for key, value in known.items() if value is not None}


def _checksum(header: dict[str, Any], arrays: Mapping[str, Array]) -> str:
    """Sum up what a file says, but for the sum itself; not how its JSON is written or packed."""
    said = {name: value for name, value in header.items() if name != "checksum"}
    found = hashlib.blake2b(json.dumps(said, sort_keys=True).encode(), digest_size=16)
    for name, array in sorted(arrays.items()):
        found.update(f"{name} {array.dtype.str} {array.shape}".encode())
        found.update(np.ascontiguousarray(array).data)
    return found.hexdigest()


# Reading. Errors become SurfaceFileErrors, to which `load_surface` adds the name of the file.


def _read(file: str) -> RampSurface:
    with _opened(file) as handle:
        try:
            with zipfile.ZipFile(handle) as archive:
                _require_sound_sizes(archive, os.fstat(handle.fileno()).st_size)
                header = _header(archive)
                arrays = _arrays(archive, header)
                surface = _surface(header, arrays)
                if header["checksum"] != _checksum(header, arrays):
                    raise _damaged("its numbers are not those that were saved, or edited since")
                return surface
        except SurfaceFileError:
            raise
        except zipfile.BadZipFile as error:
            fault = f"no NPZ file, or cut short ({_reason(error)})"
        except Exception as error:  # of any kind, for anything may be in the file
            fault = f"no valid surface, or damaged ({_reason(error)})"
    raise SurfaceFileError(f"{fault}: type the name of a saved surface, or {ANEW}")


def _opened(file: str) -> BinaryIO:
    try:
        if is_regular(file):  # first: to open a pipe may wait for ever
            return open(file, "rb")
        fault = "no file but a folder or device: type the name of a saved surface"
    except FileNotFoundError:
        fault = "no such file: check the name and the folder, or save a surface there first"
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        fault = f"cannot be opened ({getattr(error, 'strerror', None) or error}): check the name"
    raise SurfaceFileError(fault)


def _reason(error: Exception) -> str:
    kind = "" if isinstance(error, ValueError) else type(error).__name__
    text = ": ".join(filter(None, [kind, " ".join(str(error).split())]))
    return text if len(text) <= 200 else f"{text[:200]}..."


def _damaged(fault: str) -> SurfaceFileError:
    return SurfaceFileError(f"damaged: {fault}; copy it again, or {ANEW}")


def _require_sound_sizes(archive: zipfile.ZipFile, size: int) -> None:
    """Refuse an archive that fills the memory; it cannot inflate to more than it declares."""
    members = archive.infolist()
    if odd := [member.filename for member in members if member.compress_type not in UNZIPPED]:
        raise _damaged(f"{_listed(odd)} is packed in another way than NumPy's")
    whole = sum(member.file_size for member in members)
    if whole > INFLATION * size:
        raise _damaged(f"it has {size} bytes, and would inflate to {whole}")


def _require_declared_size(archive: zipfile.ZipFile, name: str) -> None:
    """Check the shape of an array against its bytes, before there is memory taken for it."""
    with archive.open(name) as member:
        if np.lib.format.read_magic(member) != (1, 0):
            raise ValueError("its header is none of NumPy's first version")
        shape, _, dtype = np.lib.format.read_array_header_1_0(member)
        declared, found = math.prod(shape) * dtype.itemsize, archive.getinfo(name).file_size
        if not dtype.hasobject and member.tell() + declared != found:
            raise ValueError(f"shape {shape} of {dtype} does not make its {found} bytes")


def _array(archive: zipfile.ZipFile, name: str) -> Array:
    try:
        _require_declared_size(archive, f"{name}.npy")
        with archive.open(f"{name}.npy") as member:
            array: Array = np.lib.format.read_array(member, allow_pickle=False)
            member.read(1)  # to read to the end checks the sum of all bytes
    except Exception as error:  # of any kind, for anything may be in the file
        raise _damaged(f"{name!r} cannot be read ({_reason(error)})") from None
    return array


def _header(archive: zipfile.ZipFile) -> dict[str, Any]:
    """Return the header, of this version of the format."""
    if "header.npy" not in archive.namelist():
        fault = "no ramp surface (it has no 'header'), but another NPZ file or archive"
        raise SurfaceFileError(f"{fault}: type the name of a saved surface")
    header: dict[str, Any] = json.loads(str(_array(archive, "header")))
    if header["format"] != FORMAT:
        raise SurfaceFileError(f"no ramp surface: its 'header' does not say {FORMAT!r}")
    if header["version"] != VERSION:
        raise SurfaceFileError(
            f"has version {header['version']!r} of the format, by bridgectl "
            f"{header['bridgectl']}, and this bridgectl, {_version.__version__}, reads version "
            f"{VERSION}: install the other bridgectl, or {ANEW}"
        )
    return header


def _arrays(archive: zipfile.ZipFile, header: dict[str, Any]) -> dict[str, Array]:
    present = {name.removesuffix(".npy") for name in archive.namelist()} - {"header"}
    if missing := sorted(header["arrays"].keys() - present):
        raise _damaged(f"lacks {_listed(missing)}")
    if unknown := sorted(present - header["arrays"].keys()):
        raise _damaged(f"has {_listed(unknown)}, which its 'header' does not name")
    arrays = {}
    for name, description in header["arrays"].items():
        array, order = _array(archive, name), description["memory_order"]
        if array.ndim != len(order):
            raise _damaged(f"{name!r} has shape {array.shape}, expected {len(order)} axes")
        arrays[name] = np.asarray(array.transpose(order), order="C").transpose(np.argsort(order))
    lengths: dict[str, int] = {}
    for name, array in arrays.items():
        _require_numbers(name, array)
        _require_fitting_shape(name, array, lengths)
    return arrays


def _listed(names: Sequence[str]) -> str:
    shown = ", ".join(repr(name[:60]) for name in names[:5])
    return f"{shown} and {len(names) - 5} more" if len(names) > 5 else shown


def _require_numbers(name: str, array: Array) -> None:
    wanted = np.dtype(np.intp if name == "histories.local" else np.float64)
    if name in AXES and array.dtype != wanted:
        raise _damaged(f"{name!r} holds {array.dtype}, expected {wanted}")
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        raise _damaged(f"{name!r} has numbers that are not finite")


def _require_fitting_shape(name: str, array: Array, lengths: dict[str, int]) -> None:
    """Check that axes of one name have one length; `lengths` holds those known so far."""
    axes = AXES.get(name)
    if axes is None:
        return
    fits = array.ndim == len(axes) and all(
        lengths.setdefault(axis, length) == length
        for axis, length in zip(axes, array.shape, strict=True)
    )
    if not fits:
        known = ", ".join(f"{axis}: {lengths.get(axis, 'any')}" for axis in axes)
        raise _damaged(f"{name!r} has shape {array.shape}, expected ({known})")


def _surface(header: dict[str, Any], arrays: dict[str, Array]) -> RampSurface:
    left = {**header["parameters"], **arrays}
    try:
        surface: RampSurface = _built("", header["classes"], left)
        if left:
            raise _Misfit(f"has the unknown {_listed(sorted(left))}")
        _require_fitting_parts(surface)
    except _Misfit as misfit:
        raise SurfaceFileError(
            f"{misfit}: this file, by bridgectl {header['bridgectl']}, does not fit this "
            f"bridgectl, {_version.__version__}; {ANEW}"
        ) from None
    return surface


def _built(name: str, classes: dict[str, str], left: dict[str, Any]) -> Any:
    """Make a part from its leaves, which are taken out of those left."""
    kind = _CLASSES.get(classes[name])
    if kind is None:
        raise _Misfit(f"{name or 'surface'} is a {classes[name][:60]}")
    values = {}
    for field in filter(lambda field: field.init, dataclasses.fields(kind)):
        where = dotted(name, field.name)
        if where in classes:
            values[field.name] = _built(where, classes, left)
        elif where in left:
            value = left.pop(where)
            values[field.name] = tuple(value) if isinstance(value, list) else value
        elif field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING:
            raise _Misfit(f"lacks {where!r}")
    return kind(**values)


def _require_fitting_parts(surface: RampSurface) -> None:
    """Check the surface as `ramp_surface` does its arguments, and the arrays against them."""
    _checks.speeds(surface.speeds)
    surface.speeds.flags.writeable = False
    surface._crossing()
    before = _checks.not_negative("approach", surface.approach, unit="m")
    length = _checks.positive("ramp_length", surface.ramp_length, unit="m")
    _checks.positive("ramp_height", surface.ramp_height, unit="m")
    n_ramps = int(np.ceil((before + surface.beam.length) / length - SAME_PLACE))
    expected = -before + length * np.arange(len(surface.positions))
    if len(expected) != n_ramps or np.abs(surface.positions - expected).max() > SAME_PLACE:
        raise _Misfit(f"'positions' are not those of {n_ramps} ramps over approach and bridge")
    _require_fitting_histories(surface)


def _require_fitting_histories(surface: RampSurface) -> None:
    histories, n_ramps = surface.histories, len(surface.positions)
    if not isinstance(histories, FactoredHistories | DenseHistories):
        raise _Misfit(f"'histories' is a {type(histories).__name__}")
    n_samples = histories.smooth.shape[1]
    if n_samples != len(sample_positions(histories.nodes)):
        raise _Misfit(f"{n_samples} samples do not fit {len(histories.nodes)} nodes")
    if isinstance(histories, FactoredHistories):
        local = histories.local
        if local.min() < 0 or local.max() > n_ramps:
            raise _Misfit(f"'histories.local' names a ramp beyond the {n_ramps}")
        if len(local) * (histories.rows.shape[2] - 1) + 1 < n_samples:
            raise _Misfit(f"{len(local)} blocks do not hold {n_samples} samples")
