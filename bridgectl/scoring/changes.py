"""What strategies gain or do harm when something is wrong: what `bridgectl.robustness` finds."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._labelled import Labelled
from bridgectl._units import to_kmh
from bridgectl._version import __version__
from bridgectl.model.bridge import BridgeModel, described
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.scoring.agreement import Paired, paired
from bridgectl.scoring.errors import Error
from bridgectl.scoring.robust_text import robust_text
from bridgectl.scoring.study import parameters

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure


class Change(NamedTuple):
    """How one strategy changes the DAF of a road class with one error, made by `robustness`."""

    strategy: str
    """Its name."""
    error: Error
    """What is wrong."""
    road_class: str
    """ISO 8608 class of the roads."""
    daf: Paired
    """Change of the mean DAF over roads and speeds [-]: below 0 it is a gain, above 0 harm."""
    worst: Paired
    """That of the speed at which it is largest [-]."""
    worst_speed: float
    """That speed [m/s]."""

    @property
    def harmful(self) -> bool:
        """Whether it is clearly worse than what it is compared with, as a mean over the speeds."""
        return self.daf.clear and self.daf.mean > 0


@dataclass(frozen=True, eq=False)
class Robustness:
    """DAFs of strategies when something is wrong; made by `bridgectl.robustness`.

    Attributes
    ----------
    baseline : str
        Name of what the strategies are compared with.
    strategies : tuple of str
        Their names.
    errors : tuple of Error
        What is wrong, in the first case nothing.
    roads, road_classes : tuple of str
        Names of the roads, and the ISO 8608 class of each.
    speeds : ndarray, shape (n_speeds,)
        Speeds c [m/s].
    baseline_daf : ndarray, shape (n_errors, n_roads, n_speeds)
        DAF of the baseline, on the bridge and with the load that there then are.
    daf : ndarray, shape (n_strategies, n_errors, n_roads, n_speeds)
        DAF of the strategies; NaN where sensors do not tell what one needs.
    beam, vehicle : Beam and Vehicle or QuarterCar
        What the strategies are made for.
    approach : float
        Road before the bridge that is driven [m].
    """

    baseline: str
    strategies: tuple[str, ...]
    errors: tuple[Error, ...]
    roads: tuple[str, ...]
    road_classes: tuple[str, ...]
    speeds: FloatArray
    baseline_daf: FloatArray
    daf: FloatArray
    beam: BridgeModel = field(repr=False)
    vehicle: Vehicle | QuarterCar = field(repr=False)
    approach: float

    def __repr__(self) -> str:
        kmh = to_kmh(self.speeds)
        numbers = (
            f"{len(each)} {name if len(each) > 1 else one}"
            for each, one, name in (
                (self.strategies, "strategy", "strategies"), (self.errors, "error", "errors"),
                (self.roads, "road", "roads"), (kmh, "speed", "speeds"),
            )
        )  # fmt: skip
        return f"Robustness({', '.join(numbers)} from {kmh.min():g} to {kmh.max():g} km/h)"

    def __str__(self) -> str:
        return robust_text(self)

    @property
    def classes(self) -> tuple[str, ...]:
        """The different classes of the roads, in order."""
        return tuple(sorted(set(self.road_classes)))

    def change(
        self,
        strategy: str,
        error: str = "nothing wrong",
        road_class: str | None = None,
        speed: float | None = None,
    ) -> Paired:
        """Return how much a strategy changes the mean DAF, over the same roads.

        Parameters
        ----------
        strategy : str
            The strategy.
        error : str, optional
            What is wrong, as ``str`` tells an error: 'position +1 m'; or a kind, as 'all at once',
            whose errors all count the same. Default: nothing.
        road_class : str, optional
            Class of the roads. Default: all.
        speed : float, optional
            The one of `speeds` that is nearest counts [m/s]. Default: the mean of all.

        Returns
        -------
        Paired
            Of the DAF [-], below 0 for a gain; NaN where sensors do not tell what it needs.

        Raises
        ------
        TypeError, ValueError
            If a name is unknown, or the speed no number above 0.
        """
        i = self.strategies.index(check.choice("strategy", strategy, self.strategies))
        known = dict.fromkeys([*map(str, self.errors), *(each.kind for each in self.errors)])
        check.choice("error", error, tuple(known))
        if road_class is not None:
            check.choice("road_class", road_class, self.classes)
        meant = [j for j, each in enumerate(self.errors) if error in (str(each), each.kind)]
        changes = np.mean([self._changes(i, j, road_class) for j in meant], axis=0)
        if speed is not None:
            c = check.positive("speed", speed, unit="m/s")
            changes = changes[:, [int(np.abs(self.speeds - c).argmin())]]
        return paired(changes.mean(axis=1))

    def _changes(self, strategy: int, error: int, road_class: str | None = None) -> FloatArray:
        """Changes of the DAF of the roads of a class, (roads, speeds)."""
        own = np.array([road_class in (None, each) for each in self.road_classes])
        return np.asarray(self.daf[strategy, error, own] - self.baseline_daf[error, own])

    def rows(self) -> list[Change]:
        """Return the change of each strategy with each error in each road class, in that order."""
        return [
            self._row(i, j, road_class)
            for i in range(len(self.strategies))
            for j in range(len(self.errors))
            for road_class in self.classes
        ]

    def _row(self, i: int, j: int, road_class: str) -> Change:
        changes = self._changes(i, j, road_class)
        worst = int(changes.mean(axis=0).argmax())
        return Change(
            self.strategies[i], self.errors[j], road_class, paired(changes.mean(axis=1)),
            paired(changes[:, worst]), float(self.speeds[worst]),
        )  # fmt: skip

    def to_pandas(self) -> pandas.DataFrame:
        """Return every DAF as a table, one row for each strategy, error, road and speed [m/s].

        Units are in ``attrs["units"]``.

        Returns
        -------
        pandas.DataFrame
        """
        return self._labelled.table()

    def to_xarray(self) -> xarray.Dataset:
        """Return every DAF as labelled arrays, each with its unit.

        Returns
        -------
        xarray.Dataset
            'daf' over 'strategy', 'error', 'road' and 'speed' [m/s], 'baseline_daf' over the last
            three.

        Raises
        ------
        ImportError
            If xarray is not installed; the message says what to type.
        """
        return self._labelled.dataset()

    @property
    def _labelled(self) -> Labelled:
        axes = {
            "strategy": self.strategies, "error": [str(each) for each in self.errors],
            "road": self.roads, "speed": self.speeds,
        }  # fmt: skip
        baseline = ("error", "road", "speed"), self.baseline_daf
        return Labelled(axes, {"daf": self.daf, "baseline_daf": baseline}, {})

    def to_json(self) -> str:
        """Return all of it as JSON, with units in the names."""
        changes = [
            {
                "strategy": row.strategy, "error": str(row.error), "kind": row.error.kind,
                "size": _known(row.error.size), "unit": row.error.unit,
                "road_class": row.road_class, "daf_change": _numbers(row.daf),
                "harmful": row.harmful, "worst_speed_m_per_s": row.worst_speed,
                "worst_daf_change": _numbers(row.worst),
                "daf_change_by_speed": [
                    _numbers(self.change(row.strategy, str(row.error), row.road_class, speed))
                    for speed in self.speeds.tolist()
                ],
            }
            for row in self.rows()
        ]  # fmt: skip
        content = {
            "bridgectl": __version__,
            "bridge": described(self.beam),
            "vehicle": parameters(self.vehicle),
            "baseline": self.baseline,
            "strategies": self.strategies,
            "roads": self.roads,
            "road_classes": self.road_classes,
            "speed_m_per_s": self.speeds.tolist(),
            "approach_m": self.approach,
            "changes": changes,
        }
        return json.dumps(content, indent=1)

    def plot(self) -> Figure:
        """Return a figure of the changes: see `bridgectl.plots.robust.robust_figure`."""
        from bridgectl.plots.robust import robust_figure  # late, for matplotlib is slow to load

        return robust_figure(self)


def _known(value: float) -> float | None:
    """JSON has no NaN: null."""
    return None if np.isnan(value) else value


def _numbers(change: Paired) -> dict[str, Any]:
    return {name: _known(value) for name, value in change._asdict().items()}
