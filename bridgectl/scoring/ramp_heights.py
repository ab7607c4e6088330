"""The DAF against the height of one ramp: what the DAE of first and second order make of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._labelled import Labelled
from bridgectl._plausible import judge_crossing, judge_range
from bridgectl._units import to_kmh
from bridgectl.dampers.fitted import Dampers, fitted
from bridgectl.dampers.loop.closed_loop import simulate_loop
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.crossing import Crossing, require_factor
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.simulate import ramp_surface
from bridgectl.surface.compute import RAMP_HEIGHT, RAMP_LENGTH
from bridgectl.surface.ramps import one_ramp

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

N_RISING = 40
"""Heights above 0, and as many below, but for those of the unit ramp."""


@dataclass(frozen=True, eq=False)
class RampHeights:
    """The DAF of one ramp of many heights, at one place and speed, found by `ramp_heights`.

    Attributes
    ----------
    damper : str
        Name of the damper's strategy.
    speed, place : float
        Speed c [m/s], and where the ramp starts [m].
    ramp_height : float
        Height h of the second order's ramps [m].
    heights : ndarray, shape (n,)
        Heights of the ramp [m], rising, positive for a drop; -h, 0 and h are among them.
    daf : ndarray, shape (n,)
        Simulated DAF.
    first_order, second_order : ndarray, shape (n,)
        DAE of the same road: Eq. (15), from a drop of 1 mm, and of order 2, from -h and h.
    lift_off : ndarray of bool, shape (n,)
        Whether the tire leaves the road.
    """

    damper: str
    speed: float
    place: float
    ramp_height: float
    heights: FloatArray
    daf: FloatArray
    first_order: FloatArray
    second_order: FloatArray
    lift_off: NDArray[np.bool_]

    def __repr__(self) -> str:
        return (
            f"RampHeights({self.damper!r}, {self.heights.size} heights up to "
            f"{self.heights[-1] * 1e3:.4g} mm at x = {self.place:.4g} m and "
            f"{to_kmh(self.speed):.4g} km/h, DAF from {self.daf.min():.4f} to {self.daf.max():.4f})"
        )

    def to_pandas(self) -> pandas.DataFrame:
        """Return DAF, both DAEs and lift-off as a table over the heights [m].

        Returns
        -------
        pandas.DataFrame
            Indexed by 'height'; units are in ``attrs["units"]``.
        """
        names = "daf", "first_order", "second_order", "lift_off"
        columns = {name: getattr(self, name) for name in names}
        return Labelled({"height": self.heights}, columns, dict.fromkeys(names[1:3], "1")).table()

    def plot(self, *others: RampHeights) -> Figure:
        """Draw the DAF over the height, and what the DAE of both orders makes of it.

        Those of other dampers at the same place and speed go beside it.
        """
        from bridgectl.plots.ramp_heights import ramp_height_figure  # late: matplotlib is slow

        return ramp_height_figure([self, *others])


def ramp_heights(
    beam: BridgeModel,
    vehicle: Vehicle | QuarterCar,
    damper: Dampers,
    speed: float,
    place: float,
    *,
    approach: float = 60.0,
    largest: float = 0.02,
    ramp_height: float | str = "A",
) -> RampHeights:
    """Simulate single ramps of many heights at one place, and estimate their DAF.

    In a linear crossing the DAF is convex in the height: the largest of moments that are straight
    lines in it. With a damper that switches it is not, and what that gains at a drop and a rise
    alike, the even part, no tangent has.

    Parameters
    ----------
    beam, vehicle
        As `simulate_loop`.
    damper : Damper or Strategy, or a list or dict of them
        Dampers in place of the vehicle's own: see `bridgectl.crossing_response`.
    speed : float
        Speed c [m/s].
    place : float
        Where the ramp starts [m], from the start of the bridge: the nearest of the places of
        `bridgectl.ramp_surface`, 0.1 m apart.
    approach : float, optional
        Length of the approach [m].
    largest : float, optional
        Largest height [m], either way, if it is above `ramp_height`.
    ramp_height : float or str, optional
        Height h of the second order's ramps [m], or the road class that it stands for: see
        `bridgectl.ramp_surface`.

    Returns
    -------
    RampHeights

    Raises
    ------
    TypeError, ValueError
        If an argument is not what is described above.

    Warns
    -----
    PlausibilityWarning
        If speed, vehicle or damper can hardly be meant.
    LiftOffWarning
        If the tire leaves the road at a ramp of `ramp_height`.

    Examples
    --------
    What bridgehook gains at a drop and a rise, no tangent can have: rms errors of both estimates,
    35 m before the bridge at 90 km/h.

    >>> import numpy as np
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import bridgehook
    >>> beam, car = bc.li2006.beam(), bc.li2006.car()
    >>> found = bc.ramp_heights(beam, car, bridgehook(beam, car, 1e3, 30e3), 25.0, -35.0)
    >>> for estimate in (found.first_order, found.second_order):
    ...     print(f"{np.sqrt(np.mean((estimate - found.daf) ** 2)):.3f}")
    0.031
    0.008
    """
    velocity = check.positive("speed", speed, unit="m/s")
    before = check.not_negative("approach", approach, unit="m")
    crossing = Crossing(beam, vehicle)
    device = fitted(damper, vehicle)
    require_factor(crossing)
    judge_crossing(crossing, velocity)
    judge_range(vehicle, device)
    ramp = _ramp_at(place, before, beam.length)
    reach = check.positive("largest", largest, unit="m")
    if reach > RAMP_LENGTH:
        raise ValueError(
            f"largest must not exceed the ramp's length of {RAMP_LENGTH:g} m (a slope of 1), got "
            f"{reach:g} m: for 20 mm type 0.02"
        )
    # The surfaces have a ramp at this place, and straight lines where nobody looks.
    every = ramp or round((before + beam.length) / RAMP_LENGTH) + 1
    one, both = (
        ramp_surface(
            beam, vehicle, velocity, approach=before, ramp_height=height, both_ways=both_ways,
            every=every, damper=device,
        )
        for height, both_ways in ((RAMP_HEIGHT, False), (ramp_height, True))
    )  # fmt: skip
    rising = np.linspace(0, max(reach, both.ramp_height), N_RISING + 1)
    rising = np.union1d(rising, both.ramp_height)
    heights = np.concatenate([-rising[:0:-1], rising])
    roads = one_ramp(both.stations, ramp, heights)
    kept = np.unique([0, ramp, ramp + 1, len(both.stations) - 1])
    found = simulate_loop(beam, vehicle, device, velocity, both.stations[kept], roads[:, kept])
    return RampHeights(
        device.name, velocity, float(both.positions[ramp]), both.ramp_height, heights,
        found.daf[0], one.dae(roads)[:, 0], both.dae(roads, order=2)[:, 0],
        np.isfinite(found.lift_off[0]),
    )  # fmt: skip


def _ramp_at(place: float, approach: float, span: float) -> int:
    """Number of the ramp that is nearest to a place."""
    x = check.number("place", place, unit="m")
    last = span - RAMP_LENGTH
    if not -approach <= x <= last:
        raise ValueError(
            f"place must lie between the start of the approach, {0.0 - approach:g} m, and the last "
            f"ramp on the bridge, {last:g} m, got {x:g} m: for a place farther ahead of the bridge "
            f"type approach={max(-x, approach):g}"
        )
    return round((x + approach) / RAMP_LENGTH)
