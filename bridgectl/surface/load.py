"""Ramp surfaces from files: loaded if they are those of the study at hand."""

from __future__ import annotations

import dataclasses
import os
import warnings
import zipfile
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks, _version
from bridgectl._places import SAME_PLACE, count_pieces, even_places
from bridgectl.linear.cells import sample_positions
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.road.files.lines import printable
from bridgectl.surface import archive as npz
from bridgectl.surface.expected import (
    ANEW,
    SurfaceFileError,
    checked_expectations,
    require_expected,
)
from bridgectl.surface.factored import FactoredHistories
from bridgectl.surface.file import PARTS, WHOLE, Array, checksum
from bridgectl.surface.histories import DenseHistories
from bridgectl.surface.parts import ModalParts, dotted
from bridgectl.surface.surface import RampSurface

_CLASSES: dict[str, type[Any]] = {WHOLE: RampSurface, **PARTS}


class _Misfit(SurfaceFileError):  # noqa: N818
    """A file of this format whose parts do not fit this version of the package."""


def load_surface(
    path: str | os.PathLike[str],
    *,
    beam: BridgeModel | None = None,
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
        A file that `RampSurface.save` wrote.
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
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     bc.ramp_surface(beam, car, 110 / 3.6).save(pathlib.Path(folder, "li.npz"))
    ...     bc.load_surface(pathlib.Path(folder, "li.npz"), beam=beam, vehicle=car, approach=0)
    RampSurface(1 speeds from 110 to 110 km/h, 250 ramps of 1 mm over 100 mm
    from x = 0 m to 25 m, recovery='exact')
    """
    file = _checks.path("path", path, "surface.npz")
    expected = checked_expectations(
        _CLASSES[WHOLE], beam=beam, vehicle=vehicle, section=section, recovery=recovery,
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


def _read(file: str) -> RampSurface:
    """Read a surface; errors become SurfaceFileErrors, to which the file's name is added."""
    with npz.opened(file) as handle:
        try:
            with zipfile.ZipFile(handle) as archive:
                npz.require_sound_sizes(archive, os.fstat(handle.fileno()).st_size)
                header = npz.read_header(archive)
                arrays = npz.read_arrays(archive, header)
                surface = _surface(header, arrays)
                if header["checksum"] != checksum(header, arrays):
                    raise npz.damaged("its numbers are not those that were saved, or edited since")
                return surface
        except SurfaceFileError:
            raise
        except zipfile.BadZipFile as error:
            fault = f"no NPZ file, or cut short ({npz.reason(error)})"
        except Exception as error:  # of any kind, for anything may be in the file
            fault = f"no valid surface, or damaged ({npz.reason(error)})"
    raise SurfaceFileError(f"{fault}: type the name of a saved surface, or {ANEW}")


def _surface(header: dict[str, Any], arrays: dict[str, Array]) -> RampSurface:
    left = {**header["parameters"], **arrays}
    try:
        surface: RampSurface = _built("", header["classes"], left)
        if left:
            raise _Misfit(f"has the unknown {npz.listed(sorted(left))}")
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
    part = kind(**values)
    return part.bridge() if isinstance(part, ModalParts) else part


def _require_fitting_parts(surface: RampSurface) -> None:
    """Check the surface as `ramp_surface` does its arguments, and the arrays against them."""
    _checks.speeds(surface.speeds)
    surface.speeds.flags.writeable = False
    _ = surface._crossing
    before = _checks.not_negative("approach", surface.approach, unit="m")
    length = _checks.positive("ramp_length", surface.ramp_length, unit="m")
    _checks.positive("ramp_height", surface.ramp_height, unit="m")
    n_ramps = count_pieces(before + surface.beam.length, length)
    expected = even_places(-before, length, len(surface.positions))
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
