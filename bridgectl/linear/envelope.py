"""The envelope of a crossing: extremes of an effect at every place of a bridge, from one run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._labelled import Labelled
from bridgectl._places import merge_places
from bridgectl._units import to_kmh
from bridgectl.linear.cells import sample_positions
from bridgectl.linear.lift_off import warn_of_flight
from bridgectl.linear.peaks import find_peaks
from bridgectl.linear.runs import Run
from bridgectl.linear.samples import Samples, sampled, with_nodes_of
from bridgectl.model.beam import Beam
from bridgectl.model.bridge import BridgeModel
from bridgectl.model.bridge_effects import AtSection, BridgeAcceleration, Deflection, Moment, Shear
from bridgectl.plots.bridge import envelope_plot

if TYPE_CHECKING:
    import pandas

QUANTITIES: dict[str, type[AtSection]] = {
    "moment": Moment, "shear": Shear, "deflection": Deflection, "acceleration": BridgeAcceleration,
}  # fmt: skip

PLACES = 101
"""Places along the bridge, besides supports and steps."""

BEYOND = 1e-3
"""How far behind a support [m] the shear is told too, which jumps there."""

INSIDE = 1e-8
"""Where a beam tells the moment at its ends [m], which is none."""

Simulate: TypeAlias = Callable[[Run], Samples]


@dataclass(frozen=True, eq=False)
class Envelope:
    """Extremes of an effect along a bridge in one crossing, made by `bridgectl.envelope`.

    All arrays have shape (n_places,); effects are in their unit: N m, N, m or m/s^2.
    """

    quantity: str
    """What of: 'moment', 'shear', 'deflection' or 'acceleration'."""
    unit: str
    """Unit of the effect."""
    speed: float
    """Speed of the vehicle [m/s]."""
    bridge: BridgeModel
    """The bridge."""
    places: FloatArray
    """Places from the start of the bridge [m], ascending."""
    largest: FloatArray
    """Largest value at each place [N m, N, m or m/s^2: by quantity]."""
    smallest: FloatArray
    """Smallest value at each place [likewise]."""
    largest_at: FloatArray
    """Where the reference tire is at the largest value [m]; the time is that over the speed."""
    smallest_at: FloatArray
    """Where the reference tire is at the smallest value [m]."""
    static_largest: FloatArray
    """Largest value that the weight of the vehicle alone gives [likewise]."""
    static_smallest: FloatArray
    """Smallest value that the weight of the vehicle alone gives [likewise]."""

    def __repr__(self) -> str:
        lowest, highest = self.smallest.argmin(), self.largest.argmax()
        return (
            f"Envelope({self.quantity} at {self.places.size} places, {to_kmh(self.speed):.4g} km/h:"
            f" from {self.smallest[lowest]:.4g} {self.unit} at x = {self.places[lowest]:.4g} m to "
            f"{self.largest[highest]:.4g} {self.unit} at x = {self.places[highest]:.4g} m)"
        )

    def to_pandas(self) -> pandas.DataFrame:
        """Return the extremes as a table over the places [m].

        Returns
        -------
        pandas.DataFrame
            Indexed by 'place'; units are in ``attrs["units"]``.
        """
        effects = "largest", "smallest", "static_largest", "static_smallest"
        where = "largest_at", "smallest_at"
        units = dict.fromkeys(effects, self.unit) | dict.fromkeys(where, "m")
        columns = {name: getattr(self, name) for name in units}
        return Labelled({"place": self.places}, columns, units).table()

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the envelope along the bridge, that of the weight alone dashed; moments downward.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Axes to draw into; new ones if omitted.

        Returns
        -------
        matplotlib.axes.Axes
        """
        return envelope_plot(self, ax)


def places_of(bridge: BridgeModel, quantity: str, at: ArrayLike | None) -> FloatArray:
    """Places of an envelope [m]: those given, or even ones and every support and step."""
    if at is not None:
        places = np.unique(_checks.array("at", np.atleast_1d(at), (None,), unit="m"))
        if not places.size or places[0] < 0 or places[-1] > bridge.length:
            raise ValueError(
                f"at must be places on the bridge, from 0 to {bridge.length:g} m, got "
                f"{'none' if not places.size else f'{places[0]:g} to {places[-1]:g} m'}"
            )
        return places
    told = [
        name[1] * bridge.length
        for name in getattr(bridge, "effects", ())
        if isinstance(name, tuple) and name[0] == quantity
    ]
    if told:
        return np.unique(told)
    own = bridge.kinks(0.5)
    behind = own[1:-1] + BEYOND if quantity == "shear" else own[:0]
    even = np.linspace(0.0, bridge.length, PLACES)
    return merge_places(np.clip(np.concatenate([even, own, behind]), 0.0, bridge.length))


def effects_at(
    bridge: BridgeModel, quantity: str, recovery: str, places: FloatArray
) -> list[AtSection]:
    """The effect at each place."""
    kind = QUANTITIES[_checks.choice("quantity", quantity, tuple(QUANTITIES))]
    if quantity != "moment":
        return [kind(float(at)) for at in places]
    if isinstance(bridge, Beam):
        places = np.clip(places, INSIDE, bridge.length - INSIDE)
    return [Moment(float(at), recovery=recovery) for at in places]


def envelope_of(
    run: Run,
    speed: float,
    quantity: str,
    recovery: str,
    places: FloatArray,
    simulate: Simulate | None = None,
) -> Envelope:
    """Return an envelope at places from one run, which `simulate` may make in its own way."""
    crossing = run.crossing
    effects = [
        effect.on(crossing.beam, crossing.linear)
        for effect in effects_at(crossing.beam, quantity, recovery, places)
    ]
    run = run._replace(crossing=with_nodes_of(crossing, effects))
    if simulate is None:
        ((_, found),) = sampled(run, np.array([speed]), progress=False)
    else:
        found = simulate(run)
    if found.flight is not None:
        warn_of_flight(found.flight)
    x, bridge = sample_positions(found.nodes), crossing.beam
    static = np.stack([e.static_values(bridge, crossing.linear, x) for e in effects], axis=1)
    every = np.ones(len(effects))
    highest, lowest = (found.peaks(crossing, speed, effects, sign * every) for sign in (1, -1))
    return Envelope(
        quantity, effects[0].unit, speed, bridge, places, highest.values, -lowest.values,
        highest.positions(found.nodes), lowest.positions(found.nodes),
        find_peaks(static).values, -find_peaks(-static).values,
    )  # fmt: skip
