"""What a closed loop asks of a controller with memory and preview; `BatchLaw` is that of laws."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from bridgectl._checks import FloatArray


class Controller(Protocol):
    """A controller of S speeds and R roads side by side, asked at every sample.

    Speeds that have crossed, and roads that are yet the same as the first, are not asked for: what
    is given then has the first so many speeds and roads. No case may depend on another.
    """

    preview: FloatArray
    """Distances ahead of the tire at which it sees the road [m], (S or 1, n)."""

    def start(self, n_speeds: int, n_roads: int) -> FloatArray:
        """Memory at the first sample, (S, m, R); m may be 0."""

    def command(
        self, signals: Mapping[str, FloatArray], memory: FloatArray, ahead: FloatArray, sample: int
    ) -> tuple[FloatArray, FloatArray]:
        """Command c [N s/m], (S, R), and the next memory (S, m, R).

        Of what is measured, by name and of shapes that broadcast to (S, R); the memory; the road's
        elevations ahead less that under the tire [m], (S, n, R), positive up; and the sample's
        number.
        """
