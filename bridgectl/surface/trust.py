"""The warning light of the DAE: where the estimate of a road is to be trusted, and why not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._labelled import Labelled
from bridgectl._threads import on_one_thread
from bridgectl.road.iri import GOOD, rectified_slope
from bridgectl.surface.histories import superposed
from bridgectl.surface.peaks import peaks_of
from bridgectl.surface.ramps import Roads, road_parts
from bridgectl.surface.surface import RampSurface

if TYPE_CHECKING:
    import pandas
    import xarray

TALLEST = 10e-3
"""Largest ramp that the paper superposes, Figs. 6 and 7 [m]."""

TOLERANCE = 0.02
"""Error of the DAE that counts as large."""


@dataclass(frozen=True, eq=False)
class DaeTrust:
    """What speaks against the DAE of roads; made by `dae_trust`.

    Arrays have the shape of the DAE, (n_speeds,) or (n_roads, n_speeds), or one number a road.

    Attributes
    ----------
    peak_rise : ndarray
        How far the peak moment lies above the moment where a smooth road has its peak. The DAE
        looks at that place: once the peak has moved, or another takes over, it is about so much
        too low [-].
    lift_off : ndarray of bool
        The tire force falls below 5 % of the static load, or a tire leaves the road.
    tallest_ramp : float or ndarray, shape (n_roads,)
        Largest rise or fall over a ramp [m].
    iri : float or ndarray, shape (n_roads,)
        IRI over approach and bridge [m/km].
    tolerance : float
        Rise of the peak that is too much [-].
    speeds : ndarray, shape (n_speeds,)
        Speeds c [m/s].
    """

    peak_rise: FloatArray
    lift_off: NDArray[np.bool_]
    tallest_ramp: FloatArray
    iri: FloatArray
    tolerance: float
    speeds: FloatArray

    @property
    def peak_moves(self) -> NDArray[np.bool_]:
        """Where another place has a peak that is higher by more than the tolerance."""
        return np.asarray(self.peak_rise > self.tolerance)

    @property
    def trusted(self) -> NDArray[np.bool_]:
        """Where nothing speaks against the DAE."""
        tall = np.asarray(self.tallest_ramp > TALLEST)[..., np.newaxis]
        rough = np.asarray(self.iri >= GOOD)[..., np.newaxis]
        return ~(self.peak_moves | self.lift_off | tall | rough)

    def to_pandas(self) -> pandas.DataFrame:
        """Return all that counts as a table, one row for each speed [m/s], and road if of many.

        Returns
        -------
        pandas.DataFrame
            Roads are numbered from 0; units are in ``attrs["units"]``.
        """
        return self._labelled.table()

    def to_xarray(self) -> xarray.Dataset:
        """Return what `to_pandas` does as labelled arrays, each with its unit.

        Returns
        -------
        xarray.Dataset
            Over 'speed' [m/s], and before it 'road' if of many.

        Raises
        ------
        ImportError
            If xarray is not installed; the message says what to type.
        """
        return self._labelled.dataset()

    @property
    def _labelled(self) -> Labelled:
        roads = {"road": range(len(self.peak_rise))} if self.peak_rise.ndim == 2 else {}
        arrays: dict[str, Any] = {
            name: getattr(self, name) for name in ("trusted", "peak_rise", "peak_moves", "lift_off")
        }
        arrays |= {name: (tuple(roads), getattr(self, name)) for name in ("tallest_ramp", "iri")}
        units = {"peak_rise": "1", "tallest_ramp": "m", "iri": "m/km"}
        return Labelled({**roads, "speed": self.speeds}, arrays, units)

    def __repr__(self) -> str:
        return (
            f"DaeTrust(trusted at {self.trusted.mean():.0%} of {self.trusted.size} crossings: peak "
            f"moves at {self.peak_moves.mean():.0%}, lift-off at {self.lift_off.mean():.0%}, ramps "
            f"up to {np.max(self.tallest_ramp) * 1e3:.3g} mm, IRI up to {np.max(self.iri):.3g} "
            "m/km)"
        )


@on_one_thread
def dae_trust(surface: RampSurface, roads: Roads, *, tolerance: float = TOLERANCE) -> DaeTrust:
    """Tell where the DAE of a road, or of many, is to be trusted.

    Four things speak against it: the peak moves (two peaks compete), a tire nearly leaves the road,
    ramps taller than the paper's 10 mm, and a road that is not good (IRI of 7 m/km or more over
    approach and bridge).

    Parameters
    ----------
    surface : RampSurface
        The ramp surface that the DAE is read from.
    roads
        As `RampSurface.ramps`.
    tolerance : float, optional
        Error of the DAE that is too much.

    Returns
    -------
    DaeTrust

    Raises
    ------
    TypeError, ValueError
        As `RampSurface.ramps`.

    Warns
    -----
    UserWarning
        As `RampSurface.ramps`.

    References
    ----------
    Y. Li, E. OBrien, A. Gonzalez, J. Sound Vib. 293 (2006) 125-137, Sections 4 and 5, on where the
    estimate is poor.

    Examples
    --------
    >>> import bridgectl as bc
    >>> surface = bc.ramp_surface(bc.li2006.beam(), bc.li2006.car(), [22.0, 30.0])
    >>> bc.dae_trust(surface, bc.li2006.fig7_road())
    DaeTrust(trusted at 100% of 2 crossings: peak moves at 0%, lift-off at 0%, ramps up to 7 mm, \
IRI up to 2.31 m/km)
    """
    limit = check.positive("tolerance", tolerance)
    if not isinstance(surface, RampSurface):
        raise TypeError(
            f"surface must be a bridgectl.RampSurface, got {type(surface).__name__}: type "
            "bridgectl.ramp_surface(beam, vehicle, speeds), and the road after it"
        )
    scales = surface.ramps(roads)
    drops = np.atleast_2d(scales) * surface.ramp_height
    rises, lifted = [], []
    for part in road_parts(drops.T):
        rises.append(_peak_rises(surface, part))
        lifted.append(surface.near_lift_off(part))
    rise, lift_off = np.hstack(rises).T, np.hstack(lifted).T
    level = np.zeros((len(drops), 1))
    elevations = np.hstack([level, -np.cumsum(drops, axis=1)])
    iri = rectified_slope(elevations, surface.ramp_length).mean(axis=1)
    tallest = np.abs(drops).max(axis=1)
    if scales.ndim == 1:
        rise, lift_off, tallest, iri = rise[0], lift_off[0], tallest[0], iri[0]
    return DaeTrust(rise, lift_off, tallest, iri, limit, surface.speeds)


def _peak_rises(surface: RampSurface, drops: FloatArray) -> FloatArray:
    """Superposed peak above the superposed moment at the smooth road's peak, (n_speeds, n)."""
    rises = np.empty((len(surface.speeds), drops.shape[1]))
    peaks = peaks_of(surface, surface.histories)
    for i, smooth in enumerate(surface.histories.smooth):
        moment = superposed(surface.histories, i, drops)
        rises[i] = peaks.of_roads(i, drops, moment) - moment[np.argmax(smooth)]
    return rises
