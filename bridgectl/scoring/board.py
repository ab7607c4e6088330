"""The scoreboard: what `bridgectl.score` finds, and its means over roads."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._labelled import Labelled
from bridgectl._units import to_kmh
from bridgectl._version import __version__
from bridgectl.model.bridge import BridgeModel, described
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.model.vehicle import Vehicle
from bridgectl.scoring.agreement import (
    GapClosed,
    Paired,
    agreement,
    gap_closed,
    over_roads,
    paired,
    pairs_in_order,
    rank_correlation,
)
from bridgectl.scoring.labelled import labelled_scores
from bridgectl.scoring.rows import CLASS_DAE, EQ_15, MEASURES, ClassRow, Ranking, Row
from bridgectl.scoring.study import parameters
from bridgectl.scoring.text import score_text

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure

    from bridgectl.surface.surface import RampSurface


@dataclass(frozen=True, eq=False)
class Scoreboard:
    """Scores of damper strategies over roads and speeds; made by `bridgectl.score`.

    Attributes
    ----------
    strategies : tuple of str
        Names, the first being what the others are compared with.
    dampings : tuple of float
        Damping of constant dampers [N s/m], NaN for others.
    roads : tuple of str
        Names of the roads.
    speeds : ndarray, shape (n_speeds,)
        Speeds c [m/s].
    values : mapping of str to ndarray, shape (n_strategies, n_roads, n_speeds)
        Every measure: see `bridgectl.scoring.rows.MEASURES`, which has the units.
    daf_smooth : ndarray, shape (n_strategies, n_speeds)
        DAF of a smooth road.
    fourth_power_95 : ndarray, shape (n_strategies, n_roads)
        Fourth power of the tire force over the static load, averaged over the speeds at each place
        of 0.25 m: what 95 % of the places stay below.
    beam, vehicle : Beam and Vehicle or QuarterCar
        Bridge and vehicle.
    approach : float
        Road before the bridge that is driven [m].
    road_classes : tuple of str
        Of each road, the ISO 8608 class whose ramps have the nearest standard deviation.
    surfaces : mapping of str to tuple of RampSurface
        By class, the surface of every strategy with ramps both ways of the class's height. None
        of a class whose ramp is higher than long.
    optimum : mapping of str to ndarray, shape (n_roads, n_speeds)
        Every simulated measure with the clairvoyant damper, the best that was found with all of the
        road known: see `bridgectl.scoring.rows.MEASURES`; empty if it was not asked for. And
        'daf_bound', which no damping that is held 10 ms goes below, if control begins at the bridge
        (approach 0), else NaN: see `bridgectl.dampers.damper_bound`.

    Examples
    --------
    >>> import bridgectl as bc
    >>> from bridgectl.dampers import passive
    >>> board = bc.score(
    ...     [passive(7e3), passive(30e3)], bc.li2006.beam(), bc.li2006.car(),
    ...     [bc.iso8608_profile("A", 25, seed=i) for i in range(2)], 25.0, approach=0, workers=1)
    >>> board
    Scoreboard(2 strategies, 2 roads, 1 speeds from 90 to 90 km/h)
    >>> [row.strategy for row in board.rows()]
    ['passive 7 kN s/m', 'passive 30 kN s/m']
    """

    strategies: tuple[str, ...]
    dampings: tuple[float, ...]
    roads: tuple[str, ...]
    speeds: FloatArray
    values: Mapping[str, FloatArray]
    daf_smooth: FloatArray
    fourth_power_95: FloatArray
    beam: BridgeModel = field(repr=False)
    vehicle: Vehicle | QuarterCar = field(repr=False)
    approach: float
    road_classes: tuple[str, ...] = ()
    surfaces: Mapping[str, tuple[RampSurface, ...]] = field(default_factory=dict, repr=False)
    optimum: Mapping[str, FloatArray] = field(default_factory=dict, repr=False)

    def __repr__(self) -> str:
        kmh = to_kmh(self.speeds)
        return (
            f"Scoreboard({len(self.strategies)} strategies, {len(self.roads)} roads, "
            f"{kmh.size} speeds from {kmh.min():g} to {kmh.max():g} km/h)"
        )

    def __str__(self) -> str:
        return score_text(self)

    def difference(
        self, strategy: str, measure: str = "daf", baseline: str | None = None
    ) -> Paired:
        """Return how much a strategy changes a measure, over the same roads.

        Parameters
        ----------
        strategy : str
            The strategy.
        measure : str, optional
            One of `bridgectl.scoring.rows.MEASURES`, averaged over the speeds.
        baseline : str, optional
            What it is compared with. Default: the first strategy.

        Returns
        -------
        Paired
            In the unit of the measure.

        Raises
        ------
        ValueError
            If a name is unknown.
        """
        check.choice("measure", measure, tuple(MEASURES))
        per_road = self.values[measure].mean(axis=2)
        other = self.strategies[0] if baseline is None else baseline
        return paired(per_road[self._index(strategy)] - per_road[self._index(other)])

    def gap_closed(self, strategy: str, speed: float | None = None) -> GapClosed:
        """Return how much of the way from the first strategy to the optimum a strategy goes.

        Parameters
        ----------
        strategy : str
            The strategy.
        speed : float, optional
            One of the speeds [m/s]. Default: DAFs are averaged over the speeds.

        Returns
        -------
        GapClosed
            NaN where the mean DAFs of those two are within 0.002, and without an optimum.

        Raises
        ------
        ValueError
            If strategy or speed is unknown.
        """
        own = self._index(strategy)
        if not self.optimum:
            return GapClosed(math.nan, math.nan, math.nan)
        which = np.ones(self.speeds.size, dtype=bool)
        if speed is not None:
            which = np.isclose(self.speeds, check.number("speed", speed, unit="m/s"))
            if not which.any():
                raise ValueError(
                    f"speed must be one of the board's, {self.speeds.tolist()} m/s, got {speed:g}"
                )
        dafs = self.values["daf"][0], self.values["daf"][own], self.optimum["daf"]
        return gap_closed(*(daf[:, which].mean(axis=1) for daf in dafs))

    def rows(self) -> list[Row]:
        """Return a summary of each strategy, the lowest mean DAF first."""
        return [self._row(i) for i in self._order()]

    def _order(self) -> list[int]:
        """Indices of the strategies, the lowest mean DAF first."""
        return np.argsort([own.mean() for own in self.values["daf"]], kind="stable").tolist()

    def class_rows(self, road_class: str) -> list[ClassRow]:
        """Return what a road class does with each strategy, in the order of `rows`.

        Parameters
        ----------
        road_class : str
            One of the classes in `surfaces`.

        Returns
        -------
        list of ClassRow

        Raises
        ------
        ValueError
            If there is no surface of the class.
        """
        check.choice("road_class", road_class, tuple(self.surfaces))
        simulated = self.values["daf"][:, self._roads_of(road_class)]
        means, spreads = over_roads(simulated), over_roads(simulated, "spread")
        found = []
        for i in self._order():
            dae = self.surfaces[road_class][i].class_dae(road_class)
            found.append(ClassRow(
                self.strategies[i], float(dae.mean.mean()), float(dae.sd.mean()),
                float(means[i]), float(spreads[i]),
            ))  # fmt: skip
        return found

    def rankings(self) -> list[Ranking]:
        """Return how DAEs order the strategies, beside the simulated DAF: of all roads, by class.

        Returns
        -------
        list of Ranking
            Of all roads the mean DAE of Eq. (15); of each class that, the mean of second order
            over the class and its spread, the latter beside the spread of the simulated DAF.
        """
        return list(self._rankings)

    @cached_property
    def _rankings(self) -> list[Ranking]:
        """What text, figure and JSON ask for: each draws the roads again and again."""
        daf, dae = self.values["daf"], self.values["dae"]
        found = [self._ranking(EQ_15, "all", dae, daf)]
        for name in self.surfaces:
            of_class = self._roads_of(name)
            own, roads = daf[:, of_class], f"class {name}"
            rows = {row.strategy: row for row in self.class_rows(name)}
            mean, spread = np.array([rows[each][1:3] for each in self.strategies]).T
            found.append(self._ranking(EQ_15, roads, dae[:, of_class], own))
            found.append(self._ranking(CLASS_DAE, roads, mean, own))
            if of_class.sum() > 1:
                tau = agreement(spread, own, "spread")
                found.append(Ranking("its spread, with that of the DAF", roads, tau, None))
        return found

    @staticmethod
    def _ranking(estimate: str, roads: str, values: FloatArray, daf: FloatArray) -> Ranking:
        means = over_roads(values) if values.ndim == 3 else values
        pairs = pairs_in_order(means, daf.mean(axis=2))
        return Ranking(estimate, roads, agreement(values, daf), pairs)

    def _roads_of(self, road_class: str) -> NDArray[np.bool_]:
        return np.array(self.road_classes) == road_class

    def _index(self, strategy: str) -> int:
        return self.strategies.index(check.choice("strategy", strategy, self.strategies))

    def _row(self, i: int) -> Row:
        own = {name: values[i] for name, values in self.values.items()}
        by_speed = own["daf"].mean(axis=0)
        worst = int(by_speed.argmax())
        return Row(
            self.strategies[i],
            float(own["daf"].mean()),
            self.difference(self.strategies[i]),
            float(self.speeds[worst]),
            float(by_speed[worst]),
            float(own["dae"].mean()),
            float(np.sqrt(np.mean((own["dae"] - own["daf"]) ** 2))),
            rank_correlation(own["dae"].ravel(), own["daf"].ravel()),
            float(own["dae_2"].mean()),
            float(np.sqrt(np.mean((own["dae_2"] - own["daf"]) ** 2))),
            float(own["dynamic_load_coefficient"].mean()),
            float(self.fourth_power_95[i].mean()),
            float(own["body_acceleration"].mean()),
            float(own["weighted_acceleration"].mean()),
            float(own["suspension_travel"].max()),
            float(own["least_force"].min()),
            float(own["switching_rate"].mean()),
            self.gap_closed(self.strategies[i]),
        )

    def to_pandas(self) -> pandas.DataFrame:
        """Return every measure as a table, one row for each strategy, road and speed [m/s].

        If the optimum is known, with its DAF and how much of the gap to it is closed (NaN where it
        is below 0.002). Units are in ``attrs["units"]``.

        Returns
        -------
        pandas.DataFrame
        """
        return self._labelled.table()

    def to_xarray(self) -> xarray.Dataset:
        """Return what `to_pandas` does as labelled arrays, each with its unit.

        Returns
        -------
        xarray.Dataset
            Over 'strategy', 'road' and 'speed' [m/s].

        Raises
        ------
        ImportError
            If xarray is not installed; the message says what to type.
        """
        return self._labelled.dataset()

    @property
    def _labelled(self) -> Labelled:
        axes = {"strategy": self.strategies, "road": self.roads, "speed": self.speeds}
        return labelled_scores(axes, self.values, self.optimum)

    def to_json(self) -> str:
        """Return all of it as JSON, with units in the names."""
        rows = [
            {
                **row._asdict(),
                "daf_difference": row.daf_difference._asdict(),
                "gap_closed": row.gap_closed._asdict(),
            }
            for row in self.rows()
        ]
        content = {
            "bridgectl": __version__,
            "bridge": described(self.beam),
            "vehicle": parameters(self.vehicle),
            "strategies": self.strategies,
            "damping_N_s_per_m": self.dampings,
            "roads": self.roads,
            "speed_m_per_s": self.speeds.tolist(),
            "approach_m": self.approach,
            "measures": MEASURES,
            "summary": rows,
            "values": {name: values.tolist() for name, values in self.values.items()},
            "optimum": {name: values.tolist() for name, values in self.optimum.items()},
            "gap_closed_by_speed": {
                name: [self.gap_closed(name, c)._asdict() for c in self.speeds.tolist()]
                for name in self.strategies
                if self.optimum
            },
            "daf_smooth": self.daf_smooth.tolist(),
            "road_classes": self.road_classes,
            "class_dae": {name: self._class_content(name) for name in self.surfaces},
            "rankings": [
                {
                    "estimate": each.estimate,
                    "roads": each.roads,
                    **each.agreement._asdict(),
                    "clear_pairs": each.pairs and each.pairs._asdict(),
                }
                for each in self.rankings()
            ],
            "fourth_power_95": self.fourth_power_95.tolist(),
        }
        return json.dumps(_without_nan(content), indent=1)

    def _class_content(self, name: str) -> dict[str, Any]:
        """What JSON has of a class: lists by strategy and speed."""
        found = [surface.class_dae(name) for surface in self.surfaces[name]]
        return {
            "ramp_height_m": self.surfaces[name][0].ramp_height,
            "mean": [each.mean.tolist() for each in found],
            "standard_deviation": [each.sd.tolist() for each in found],
        }

    def plot(self) -> Figure:
        """Return a figure of the scores: see `bridgectl.plots.scores.score_figure`."""
        from bridgectl.plots.scores import score_figure  # late, for matplotlib is slow to load

        return score_figure(self)


def _without_nan(value: Any) -> Any:
    """JSON has no NaN: null."""
    if isinstance(value, dict):
        return {key: _without_nan(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_without_nan(entry) for entry in value]
    return None if isinstance(value, float) and math.isnan(value) else value
