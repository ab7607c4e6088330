"""What a run of crossings with a damper in the loop has found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray


@dataclass(frozen=True, eq=False)
class LoopResult:
    """A crossing of each speed and road, found by `simulate_loop`: shapes (n_speeds, n_roads).

    Attributes
    ----------
    daf : ndarray
        Peak moment over the peak static one [-].
    least_force : ndarray
        Least force of any tire over its static load [-], from the first station to the last.
    lift_off : ndarray
        Where the reference tire is when one first leaves the road [m]; infinity if none does.
    dissipated : ndarray
        Energy that the dampers have taken out [J].
    switches : ndarray
        Number of times that the commands cross the middle of their range.
    histories : tuple of dict
        For each speed, what was recorded by name, shape (n_roads, n_samples), of several dampers
        or tires (n_dampers or n_tires, n_roads, n_samples): samples of the controllers, the first
        at the first station. See `simulate_loop` for their units.
    """

    daf: FloatArray
    least_force: FloatArray
    lift_off: FloatArray
    dissipated: FloatArray
    switches: NDArray[np.intp]
    histories: tuple[dict[str, FloatArray], ...] = ()

    def __repr__(self) -> str:
        recorded = ", ".join(self.histories[0]) if self.histories else "nothing"
        return (
            f"LoopResult({self.daf.shape[0]} speeds, {self.daf.shape[1]} roads, DAF from "
            f"{self.daf.min():.4f} to {self.daf.max():.4f}, least force "
            f"{self.least_force.min():.3f} of the static load, up to {self.dissipated.max():.3g} J "
            f"dissipated and {self.switches.max()} switches, recorded: {recorded})"
        )

    def of_speeds(self, order: NDArray[np.intp]) -> LoopResult:
        """Return the speeds in another order, of numbers from 0."""
        histories = tuple(self.histories[i] for i in order) if self.histories else ()
        return self._at(order, histories)

    def of_roads(self, roads: slice) -> LoopResult:
        """Return a slice of the roads; the histories are as they were recorded."""
        return self._at((slice(None), roads), self.histories)

    def _at(self, index: Any, histories: tuple[dict[str, FloatArray], ...]) -> LoopResult:
        arrays = {name: of[index] for name, of in vars(self).items() if name != "histories"}
        return LoopResult(**arrays, histories=histories)
