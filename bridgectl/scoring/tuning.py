"""What tuning has found: gains before and after, and what they do on roads seen and not seen."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._labelled import Labelled
from bridgectl._version import __version__
from bridgectl.dampers.program import Program
from bridgectl.dampers.strategy import Strategy
from bridgectl.model.bridge import BridgeModel, described
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.scoring.agreement import Paired, paired
from bridgectl.scoring.study import parameters
from bridgectl.scoring.tuning_text import tuning_text

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

DAF, CLASS_DAE = "daf", "class_dae"
"""What may be minimised."""

GENERATIONS, GRADIENT = "generations", "gradient"
"""How."""

TRAINING, HELD_OUT = "training", "held_out"

FEW = 0.5
"""Share of the training roads' gain below which that of others tells of gains that fit the roads at
hand."""


@dataclass(frozen=True, eq=False)
class Tuning:
    """A damper strategy with tuned gains, and what they are worth; made by `bridgectl.tune`.

    Attributes
    ----------
    strategy : Strategy
        With the tuned gains.
    names : tuple of str
        Gains that were tuned.
    before, after : ndarray, shape (n_gains,)
        Their values: see `Strategy.bounds` for units.
    bounds : ndarray, shape (n_gains, 2)
        Least and largest values: see `Strategy.bounds` for units.
    objective, method : str
        What was minimised, and how: see `bridgectl.tune`.
    softness : float
        Of the maximum over the speeds [-]; infinity of the mean.
    history : ndarray, shape (n_steps + 1,)
        Best objective [-] so far: at the start, and after each generation or gradient.
    speeds : ndarray, shape (n_speeds,)
        Speeds c [m/s].
    training, held_out : ndarray, shape (2, n_speeds, n_roads)
        Simulated DAF of the roads, before and after.
    class_dae : mapping of str to ndarray, shape (2, n_speeds)
        By class of the training roads the mean DAE of second order, before and after [-].
    seconds : float
        Time that the search took [s].
    interrupted : bool
        Whether Ctrl-C ended it.
    beam, vehicle : Beam and Vehicle or QuarterCar
        Bridge and vehicle.
    approach : float
        Road before the bridge that is driven [m].
    """

    strategy: Strategy
    names: tuple[str, ...]
    before: FloatArray
    after: FloatArray
    bounds: FloatArray
    objective: str
    method: str
    softness: float
    history: FloatArray
    speeds: FloatArray
    training: FloatArray
    held_out: FloatArray
    class_dae: Mapping[str, FloatArray]
    seconds: float
    interrupted: bool
    beam: BridgeModel = field(repr=False)
    vehicle: Vehicle | QuarterCar = field(repr=False)
    approach: float

    def __repr__(self) -> str:
        told = [
            f"{'DAF ' * (not i)}{dafs[0].mean():.4f} to {dafs[1].mean():.4f} on {dafs.shape[2]} "
            f"{what}"
            for i, (dafs, what) in enumerate(
                [(self.training, "training roads"), (self.held_out, "held out")]
            )
            if dafs.size
        ]
        told.append(f"approach of {self.approach:g} m")
        return f"Tuning({self.strategy.name!r}, {len(self.names)} gains, {', '.join(told)})"

    def __str__(self) -> str:
        return tuning_text(self)

    def change(self, roads: str = HELD_OUT) -> Paired:
        """Return how much tuning changes the DAF, averaged over the speeds, of the same roads.

        Parameters
        ----------
        roads : {'held_out', 'training'}, optional
            Which of them.

        Returns
        -------
        Paired
            Of the DAF [-]; below 0 is better.

        Raises
        ------
        ValueError
            If there are no such roads.
        """
        check.choice("roads", roads, (HELD_OUT, TRAINING))
        dafs = self.held_out if roads == HELD_OUT else self.training
        if not dafs.size:
            raise ValueError("no roads were held out: type bridgectl.tune(..., held_out=[...])")
        return paired((dafs[1] - dafs[0]).mean(axis=0))

    @property
    def overfitted(self) -> bool:
        """Whether roads held out gain less than half of what the training roads gain."""
        gain = -self.change(TRAINING).mean
        return bool(self.held_out.size and gain > 0 and -self.change().mean < FEW * gain)

    @property
    def positions(self) -> FloatArray | None:
        """Places [m] of a program's dampings; None of other strategies."""
        return self.strategy.positions if isinstance(self.strategy, Program) else None

    def to_pandas(self) -> pandas.DataFrame:
        """Return the gains as a table: before, after, least and largest.

        Returns
        -------
        pandas.DataFrame
            Indexed by 'gain': see `Strategy.bounds` for units.
        """
        least, largest = self.bounds.T
        columns = {"before": self.before, "after": self.after, "least": least, "largest": largest}
        return Labelled({"gain": self.names}, columns, {}).table()

    def to_json(self) -> str:
        """Return all of it as JSON, with units in the names."""
        changes = {TRAINING: self.change(TRAINING)}
        if self.held_out.size:
            changes[HELD_OUT] = self.change()
        content = {
            "bridgectl": __version__,
            "bridge": described(self.beam),
            "vehicle": parameters(self.vehicle),
            "approach_m": self.approach,
            "strategy": self.strategy.name,
            "gains": [
                {"name": name, "before": a, "after": b, "least": low, "largest": high}
                for name, a, b, (low, high) in zip(
                    self.names, self.before.tolist(), self.after.tolist(), self.bounds.tolist(),
                    strict=True,
                )
            ],
            **({} if self.positions is None else {"position_m": self.positions.tolist()}),
            "objective": self.objective,
            "softness": None if np.isinf(self.softness) else self.softness,
            "method": self.method,
            "history": self.history.tolist(),
            "seconds": self.seconds,
            "interrupted": self.interrupted,
            "speed_m_per_s": self.speeds.tolist(),
            "training_daf": self.training.tolist(),
            "held_out_daf": self.held_out.tolist(),
            "class_dae": {name: dae.tolist() for name, dae in self.class_dae.items()},
            "change": {roads: _known(change) for roads, change in changes.items()},
            "overfitted": self.overfitted,
        }  # fmt: skip
        return json.dumps(content, indent=1)

    def plot(self) -> Figure:
        """Return a figure of the tuning: see `bridgectl.plots.tuning.tuning_figure`."""
        from bridgectl.plots.tuning import tuning_figure  # late, for matplotlib is slow to load

        return tuning_figure(self)


def _known(change: Paired) -> dict[str, float | None]:
    """JSON has no NaN: null."""
    return {k: None if np.isnan(v) else v for k, v in change._asdict().items()}
