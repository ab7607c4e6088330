"""A ramp surface as labelled arrays, for xarray and NetCDF."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from bridgectl import _version
from bridgectl._labelled import load_xarray
from bridgectl._units import to_kmh
from bridgectl.surface.parts import COMPUTED, UNITS, leaves, require_surface

if TYPE_CHECKING:
    import xarray


def surface_to_xarray(surface: Any) -> xarray.Dataset:
    """Return a ramp surface as labelled arrays, without its histories.

    Parameters
    ----------
    surface : RampSurface
        The surface.

    Returns
    -------
    xarray.Dataset
        Variables 'daf_smooth', 'daf_unit' and 'daf_difference' over 'speed' [m/s], also as
        'speed_kmh' [km/h], and 'position', the start x of each ramp [m], also as 'x_over_l'.
        The parameters are attributes: 'beam_length' in 'beam_length_units'.

    Raises
    ------
    TypeError
        If `surface` is no `RampSurface`.
    ImportError
        If xarray is not installed; the message says what to type.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.surface.labelled import surface_to_xarray
    >>> data = surface_to_xarray(bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), [25, 30]))
    >>> dict(data.sizes), data.daf_unit.dims, data.position.units
    ({'speed': 2, 'position': 250}, ('speed', 'position'), 'm')
    >>> data.attrs["beam_length"], data.attrs["beam_length_units"]
    (25.0, 'm')
    """
    require_surface(surface)
    both, x = ("speed", "position"), surface.positions
    daf, unit = surface.quantity
    unit = unit.replace("-", "1")
    unit_ramp = f"unit ramp, {surface.ramp_height:g} m down over {surface.ramp_length:g} m"
    change = _labels(unit, f"change of the {daf} by a {unit_ramp}")
    return load_xarray().Dataset(
        {
            "daf_smooth": ("speed", surface.daf_smooth, _labels(unit, f"{daf} of a smooth road")),
            "daf_unit": (both, surface.daf_unit, _labels(unit, f"{daf} of a {unit_ramp}")),
            "daf_difference": (both, surface.daf_difference, change),
        },
        {
            "speed": ("speed", surface.speeds, _labels("m/s", "speed c")),
            "speed_kmh": ("speed", to_kmh(surface.speeds), _labels("km/h", "speed c")),
            "position": ("position", x, _labels("m", "start x of the ramp on the bridge")),
            "x_over_l": ("position", x / surface.beam.length, _labels("1", "start x / l")),
        },
        dict(_attributes(surface)),
    )


def _labels(unit: str, name: str) -> dict[str, str]:
    return {"units": unit, "long_name": name}


def _attributes(surface: Any) -> Iterator[tuple[str, Any]]:
    """Parameters as NetCDF can hold them: numbers, lists of them, and text."""
    yield "bridgectl_version", _version.__version__
    for name in ("vehicle", "effect"):
        yield name, type(getattr(surface, name)).__name__
    for name, leaf in leaves(surface):
        if name.partition(".")[0] in (*COMPUTED, "speeds"):
            continue
        flat = name.replace(".", "_")
        yield flat, _attribute(leaf)
        if name in UNITS:
            yield f"{flat}_units", UNITS[name]


def _attribute(leaf: Any) -> Any:
    if isinstance(leaf, bool):
        return int(leaf)
    if isinstance(leaf, int | float | str):
        return leaf
    values = np.asarray(leaf)
    if values.ndim == 1 and values.size and values.dtype.kind in "if":
        return values
    return json.dumps(leaf.tolist() if isinstance(leaf, np.ndarray) else leaf)
