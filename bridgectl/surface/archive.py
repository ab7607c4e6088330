"""NPZ files that may hold anything: header and arrays of a surface, or one line that says why not.

Nothing is unpickled, and no memory is taken for more than the file declares and holds.
"""

from __future__ import annotations

import json
import math
import zipfile
from collections.abc import Sequence
from typing import Any, BinaryIO

import numpy as np

from bridgectl import _version
from bridgectl._files import is_regular
from bridgectl.surface.expected import ANEW, SurfaceFileError
from bridgectl.surface.file import FORMAT, VERSION, Array
from bridgectl.surface.parts import AXES

INFLATION = 20
"""How many times its size a file may inflate to: numbers of a surface hardly compress."""

UNZIPPED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""Ways of packing that NumPy uses, and that are undone piece by piece: never more at once."""


def opened(file: str) -> BinaryIO:
    """Open a file that may hold a surface, or say why it cannot be opened."""
    try:
        if is_regular(file):  # first: to open a pipe may wait for ever
            return open(file, "rb")
        fault = "no file but a folder or device: type the name of a saved surface"
    except FileNotFoundError:
        fault = "no such file: check the name and the folder, or save a surface there first"
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        fault = f"cannot be opened ({getattr(error, 'strerror', None) or error}): check the name"
    raise SurfaceFileError(fault)


def reason(error: Exception) -> str:
    """What an error says, in one line."""
    kind = "" if isinstance(error, ValueError) else type(error).__name__
    text = ": ".join(filter(None, [kind, " ".join(str(error).split())]))
    return text if len(text) <= 200 else f"{text[:200]}..."


def damaged(fault: str) -> SurfaceFileError:
    """Return the error of a file that is not as it was saved."""
    return SurfaceFileError(f"damaged: {fault}; copy it again, or {ANEW}")


def require_sound_sizes(archive: zipfile.ZipFile, size: int) -> None:
    """Refuse an archive that fills the memory; it cannot inflate to more than it declares."""
    members = archive.infolist()
    if odd := [member.filename for member in members if member.compress_type not in UNZIPPED]:
        raise damaged(f"{listed(odd)} is packed in another way than NumPy's")
    whole = sum(member.file_size for member in members)
    if whole > INFLATION * size:
        raise damaged(f"it has {size} bytes, and would inflate to {whole}")


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
        raise damaged(f"{name!r} cannot be read ({reason(error)})") from None
    return array


def read_header(archive: zipfile.ZipFile) -> dict[str, Any]:
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


def read_arrays(archive: zipfile.ZipFile, header: dict[str, Any]) -> dict[str, Array]:
    """Return the arrays that a header names, of the shapes and kinds that a surface has."""
    present = {name.removesuffix(".npy") for name in archive.namelist()} - {"header"}
    if missing := sorted(header["arrays"].keys() - present):
        raise damaged(f"lacks {listed(missing)}")
    if unknown := sorted(present - header["arrays"].keys()):
        raise damaged(f"has {listed(unknown)}, which its 'header' does not name")
    arrays = {}
    for name, description in header["arrays"].items():
        array, order = _array(archive, name), description["memory_order"]
        if array.ndim != len(order):
            raise damaged(f"{name!r} has shape {array.shape}, expected {len(order)} axes")
        arrays[name] = np.asarray(array.transpose(order), order="C").transpose(np.argsort(order))
    lengths: dict[str, int] = {}
    for name, array in arrays.items():
        _require_numbers(name, array)
        _require_fitting_shape(name, array, lengths)
    return arrays


def listed(names: Sequence[str]) -> str:
    """The first few of some names."""
    shown = ", ".join(repr(name[:60]) for name in names[:5])
    return f"{shown} and {len(names) - 5} more" if len(names) > 5 else shown


def _require_numbers(name: str, array: Array) -> None:
    wanted = np.dtype(np.intp if name == "histories.local" else np.float64)
    if name in AXES and array.dtype != wanted:
        raise damaged(f"{name!r} holds {array.dtype}, expected {wanted}")
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        raise damaged(f"{name!r} has numbers that are not finite")


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
        raise damaged(f"{name!r} has shape {array.shape}, expected ({known})")
