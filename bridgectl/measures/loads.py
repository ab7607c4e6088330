"""Measures of tire forces: what they do to the road.

Tire forces are histories as in `bridgectl.measures.history`, of whole forces R, static load
included.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE, count_pieces, whole_pieces
from bridgectl._warn import asker, warn
from bridgectl.measures.history import histories

CELL = 0.25
"""Length of a place on the road [m], about that of a tire's contact."""


def dynamic_load_coefficient(force: ArrayLike, static_load: ArrayLike) -> FloatArray:
    """Return the dynamic load coefficient (DLC) of tire forces, std(R) / W.

    The denominator is the static load, not the mean force, which a short crossing does not
    bring to its long-run value.

    Parameters
    ----------
    force : array_like, shape (..., n)
        Tire forces R [N]; R - W does as well here.
    static_load : float or array_like
        W [N], one for all or any shape that broadcasts to the leading axes of `force`.

    Returns
    -------
    float or ndarray, shape (...)
        Dimensionless.

    Raises
    ------
    TypeError, ValueError
        If the forces are not finite numbers, or a static load is not above 0 N or of another
        shape.

    References
    ----------
    D. Cebon, Handbook of Vehicle-Road Interaction, Swets & Zeitlinger, 1999.
    `bridgectl.dampers.passive_theory.variances` gives its value for a passive quarter-car.

    Examples
    --------
    >>> import numpy as np
    >>> from bridgectl.measures import dynamic_load_coefficient
    >>> force = 98.1e3 * (1 + 0.1 * np.sin(np.linspace(0, 2 * np.pi, 1001)[:-1]))
    >>> print(dynamic_load_coefficient(force, 98.1e3).round(4))
    0.0707
    """
    forces = histories("force", force, "N")
    return np.std(forces, axis=-1) / _loads(static_load, forces)


def road_stress_factor(force: ArrayLike, static_load: ArrayLike) -> FloatArray:
    """Return the dynamic road stress factor of whole tire forces R, the mean of (R / W)^4 [-].

    Fatigue of a road grows with the fourth power of the load (J. Eisenmann, Strasse und Autobahn 4,
    1975). Over a path on which R is normally distributed with mean W, the factor is ``1 + 6 DLC^2 +
    3 DLC^4`` (D. Cebon, Vehicle System Dynamics 18 (1989) 107-150); here it is the mean along the
    path itself, as a single crossing is not Gaussian.
    """
    return np.mean(_relative(force, static_load) ** 4, axis=-1)


class FourthPower(NamedTuple):
    """Fourth power of tire forces at each place of a road, found by `aggregate_fourth_power`."""

    places: FloatArray
    """Middles of the places [m], shape (n_places,)."""
    values: FloatArray
    """Sum of R^4 over sum of W^4 [-] of all tires and crossings there, shape (n_places,)."""

    def __repr__(self) -> str:
        return (
            f"FourthPower({self.values.size} places from {self.places[0]:.6g} m to "
            f"{self.places[-1]:.6g} m, mean {self.mean:.4g}, 95 % below {self.percentile(95):.4g})"
        )

    @property
    def mean(self) -> float:
        """Mean over the places: the road stress factor of all crossings together."""
        return float(np.mean(self.values))

    def percentile(self, q: float = 95.0) -> float:
        """Return the value [-] that `q` % of the places stay below: roads fail at the rest."""
        share = check.number("q", q, unit="%")
        if not 0 <= share <= 100:
            raise ValueError(f"q must lie between 0 and 100 %, got {share:g}: type 95")
        return float(np.percentile(self.values, share))


def aggregate_fourth_power(
    force: ArrayLike, static_load: ArrayLike, position: ArrayLike, cell: float = CELL
) -> FourthPower:
    """Return the fourth power of all tire forces that each place of a road bears.

    Roads fail at their worst places, and the same trucks load the same places. At each place,
    R^4 is averaged over the samples of each tire and crossing, then added up over all of them
    and divided by the same sum for the static loads. One smooth crossing gives 1 everywhere.

    Parameters
    ----------
    force : array_like, shape (..., n)
        Tire forces R [N] of any number of tires, crossings and speeds.
    static_load : float or array_like
        As `dynamic_load_coefficient`.
    position : array_like, shape (n,) or (..., n)
        Where on the road each tire is [m], rising; for several speeds, one row for each.
    cell : float
        Length of a place [m].

    Returns
    -------
    FourthPower
        For the whole multiples of `cell` that every tire runs over; `.mean` and
        `.percentile(95)` are what is usually reported.

    Raises
    ------
    TypeError, ValueError
        As `dynamic_load_coefficient`; if the positions do not rise or fit the forces, if no
        place is common to all, or if a place has no sample of a tire.

    Warns
    -----
    UserWarning
        If the forces look like R - W.

    References
    ----------
    D. Cebon, Vehicle System Dynamics 18 (1989) 107-150.

    Examples
    --------
    Two crossings at 20 and 25 m/s that load the road by the same wave, 10 m long:

    >>> import numpy as np
    >>> from bridgectl.measures import aggregate_fourth_power
    >>> x = np.array([[20.0], [25.0]]) * np.arange(0, 2, 0.001)
    >>> damage = aggregate_fourth_power(98.1e3 * (1 + 0.1 * np.sin(2 * np.pi * x / 10)), 98.1e3, x)
    >>> print(damage.places[:2], round(damage.mean, 3), round(damage.percentile(95), 3))
    [0.125 0.375] 1.03 1.451
    """
    forces = histories("force", force, "N")
    loads = _loads(static_load, forces)
    fourth = _relative(forces, loads) ** 4
    where = _positions(position, forces.shape)
    width = check.positive("cell", cell, unit="m")
    first, stop = _common_cells(where, width)
    means = _cell_means(
        fourth, np.floor(where / width + SAME_PLACE).astype(int) - first, stop - first
    )
    weights = np.broadcast_to(loads, forces.shape[:-1]).reshape(-1) ** 4
    values = weights @ means / weights.sum()
    return FourthPower((np.arange(first, stop) + 0.5) * width, values)


def _loads(static_load: ArrayLike, forces: FloatArray) -> FloatArray:
    """Check static loads against the leading axes of the forces."""
    loads = check.array("static_load", static_load, (None,) * np.ndim(static_load), unit="N")
    if np.any(loads <= 0):
        raise ValueError(f"static_load must be above 0 N, got {loads[loads <= 0].flat[0]:g}")
    try:
        return np.broadcast_to(loads, forces.shape[:-1])
    except ValueError:
        raise ValueError(
            f"static_load must be one load or broadcast to the leading axes of force, "
            f"{forces.shape[:-1]}, got shape {loads.shape}: type car.linear.static_loads[0] for "
            "one tire"
        ) from None


def _relative(force: ArrayLike, static_load: ArrayLike) -> FloatArray:
    """R / W, with a warning where it looks like R / W - 1."""
    forces = histories("force", force, "N")
    ratio = forces / _loads(static_load, forces)[..., np.newaxis]
    lowest = np.min(np.mean(ratio, axis=-1), initial=1.0)
    if lowest < 0.5 and asker(2) != "package":  # the mean force of a stretch carries the vehicle
        warn(f"the mean of force is {lowest:.2g} of static_load: is it R - W? Pass R")
    return ratio


def _positions(position: ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    """Check positions that go with forces of a shape, as rows of one each."""
    where = histories("position", position, "m")
    if np.any(np.diff(where, axis=-1) <= 0):
        raise ValueError("position must rise from sample to sample")
    try:
        return np.broadcast_to(where, shape)
    except ValueError:
        raise ValueError(
            f"position must have the shape of force, {shape}, or of one row of it, got "
            f"{where.shape}"
        ) from None


def _common_cells(where: FloatArray, width: float) -> tuple[int, int]:
    """First place that every row covers, and the one after the last, in cells from 0 m."""
    begin, end = where[..., 0].max(), where[..., -1].min()
    first, stop = count_pieces(begin, width), whole_pieces(end, width)
    if stop <= first:
        raise ValueError(
            f"no place of {width:g} m lies on every tire's way, from {begin:g} m to {end:g} m: "
            "pass longer histories or a shorter cell"
        )
    return first, stop


def _cell_means(values: FloatArray, cells: NDArray[np.intp], n_cells: int) -> FloatArray:
    """Mean of the values in each of the cells 0 to n_cells - 1, shape (rows, n_cells)."""
    inside = (cells >= 0) & (cells < n_cells)
    n_rows = values.size // values.shape[-1]
    rows = np.arange(n_rows).reshape(*values.shape[:-1], 1) * n_cells
    flat = (rows + cells)[inside]
    count = np.bincount(flat, minlength=n_rows * n_cells)
    if not count.all():
        raise ValueError("cell must hold a sample of every tire at every place: type a longer one")
    sums = np.bincount(flat, values[inside], minlength=count.size)
    return (sums / count).reshape(n_rows, n_cells)
