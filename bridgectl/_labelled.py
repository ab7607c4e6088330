"""Results as tables of pandas and labelled arrays of xarray: names of attributes, units beside.

Tables have units in ``frame.attrs["units"]``, by name of column or level of the index; arrays in
``array.attrs["units"]``, as NetCDF has them. SI units, "1" without dimension.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    import pandas
    import xarray

UNITS = {
    "speed": "m/s", "place": "m", "position": "m", "station": "m", "height": "m", "daf": "1",
    "baseline_daf": "1", "daf_smooth": "1", "dae": "1",
}  # fmt: skip
"""Of usual names."""


class Labelled(NamedTuple):
    """Arrays over named axes."""

    axes: Mapping[str, Any]
    """Labels along each axis."""
    arrays: Mapping[str, Any]
    """By name, over all axes; or some axes, in order, and an array over them."""
    units: Mapping[str, str]
    """By name, in place of the usual ones or besides."""

    def table(self) -> pandas.DataFrame:
        """Return a row for each combination of labels."""
        import pandas as pd  # late, for it takes a while

        names, labels = list(self.axes), [list(each) for each in self.axes.values()]
        index = pd.MultiIndex.from_product(labels, names=names)
        if len(names) == 1:
            index = pd.Index(labels[0], name=names[0])
        shape = tuple(map(len, labels))
        columns = {}
        for name, given in self.arrays.items():
            over, values = self._over(given)
            spread = np.expand_dims(values, [k for k, axis in enumerate(names) if axis not in over])
            columns[name] = np.broadcast_to(spread, shape).ravel()
        return with_units(pd.DataFrame(columns, index), {**UNITS, **self.units})

    def dataset(self) -> xarray.Dataset:
        """Return the arrays as they are."""
        units = {**UNITS, **self.units}
        arrays = {
            name: (*self._over(given), {"units": units[name]} if name in units else {})
            for name, given in self.arrays.items()
        }
        axes = {
            name: (name, list(labels), {"units": units[name]} if name in units else {})
            for name, labels in self.axes.items()
        }
        return load_xarray().Dataset(arrays, axes)

    def _over(self, given: Any) -> tuple[tuple[str, ...], Any]:
        """Names of an array's axes, and the array."""
        return given if isinstance(given, tuple) else (tuple(self.axes), given)


def with_units(frame: pandas.DataFrame, units: Mapping[str, str]) -> pandas.DataFrame:
    """Return the table with the units of its columns and index beside it."""
    names = [*frame.index.names, *frame.columns]
    frame.attrs["units"] = {name: units[name] for name in names if name in units}
    return frame


def load_xarray() -> Any:
    """Return the package, which not everyone has."""
    try:
        import xarray
    except ImportError:
        message = 'to_xarray needs the package xarray: type pip install "bridgectl[xarray]"'
        raise ImportError(message, name="xarray") from None
    return xarray
