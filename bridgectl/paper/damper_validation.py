"""The DAE of second order put to the test: it orders dampers, and simulation judges it.

The library and laws that had no part in finding the formula cross three bridges on random roads and
their mirror images; what the class DAE says of them stands beside the simulated DAF.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._places import even_places
from bridgectl._units import from_kmh
from bridgectl.model.beam import Beam
from bridgectl.paper import li2006
from bridgectl.paper.damper_sets import known_dampers, unseen_dampers
from bridgectl.road import RoadProfile, iso8608_elevations
from bridgectl.scoring.agreement import Agreement, Pairs, agreement, over_roads, pairs_in_order
from bridgectl.scoring.board import Scoreboard
from bridgectl.scoring.run import score
from bridgectl.surface.compute import RAMP_LENGTH

SPANS, CLASSES = (15, 25, 35), ("A", "B")
"""Bridges [m], and ISO 8608 classes of the roads."""

APPROACH = 60.0
"""Road before the bridge that is driven [m]."""

SPEEDS = from_kmh(np.arange(60.0, 121, 5))

N_PAIRS, SEED = 60, 1306
"""Roads of each class, which have a mirror image each, and their seed."""

FAR = 0.005
"""Difference of two mean DAFs that matters."""


class Wrong(NamedTuple):
    """Two dampers that differ clearly and that the class DAE has in the wrong order.

    Found by `validate_dampers`.
    """

    lower: str
    """The one of the lower simulated mean DAF."""
    higher: str
    """The other."""
    daf_difference: float
    """Of the simulated mean DAFs, above 0 [-]."""
    dae_difference: float
    """Of the class DAEs, 0 or below [-]."""


@dataclass(frozen=True, eq=False)
class DamperCase:
    """All dampers on one bridge and the roads of one class, found by `validate_dampers`."""

    span: float
    """Length of the bridge [m]."""
    road_class: str
    """ISO 8608 class of the roads."""
    dampers: tuple[str, ...]
    """Names."""
    n_known: int
    """How many of them, the first, the formula was found with."""
    daf: FloatArray
    """Simulated DAF [-] of roads and of their mirror images, (n_dampers, 2, n_pairs, n_speeds)."""
    dae: FloatArray
    """DAE of Eq. (15) [-], likewise."""
    dae_2: FloatArray
    """DAE of second order [-], likewise."""
    class_dae: FloatArray
    """Mean of second order over class and speeds, in closed form [-], shape (n_dampers,)."""

    def __repr__(self) -> str:
        clear, far = self.clear_pairs, self.far_pairs
        return (
            f"DamperCase({len(self.dampers)} dampers on {self.span:g} m, class {self.road_class}, "
            f"tau {self.tau.tau:.2f}, {clear.right} of {clear.number} clear pairs and {far.right} "
            f"of {far.number} far ones in order)"
        )

    @property
    def of_pairs(self) -> FloatArray:
        """DAF of pairs of road and mirror image [-], which are the independent samples."""
        return np.asarray(self.daf.mean(axis=1))

    @property
    def mean_daf(self) -> FloatArray:
        """Simulated mean DAF [-], shape (n_dampers,)."""
        return over_roads(self.of_pairs)

    @property
    def mean_eq_15(self) -> FloatArray:
        """Mean of Eq. (15) over the same roads [-], which is the smooth DAF, (n_dampers,)."""
        return over_roads(self.dae.mean(axis=1))

    @cached_property
    def tau(self) -> Agreement:
        """Kendall's tau of class DAE and simulated mean DAF, of all dampers."""
        return agreement(self.class_dae, self.of_pairs)

    @cached_property
    def tau_known(self) -> Agreement:
        """The same of those that the formula was found with."""
        return agreement(self.class_dae[: self.n_known], self.of_pairs[: self.n_known])

    @cached_property
    def tau_eq_15(self) -> Agreement:
        """Kendall's tau of the mean of Eq. (15), of those that the formula was found with."""
        return agreement(self.mean_eq_15[: self.n_known], self.of_pairs[: self.n_known])

    @cached_property
    def clear_pairs(self) -> Pairs:
        """Pairs of dampers that differ clearly, and how many of them are in the right order."""
        return pairs_in_order(self.class_dae, self.of_pairs.mean(axis=2))

    @cached_property
    def far_pairs(self) -> Pairs:
        """The same of pairs whose mean DAFs are more than 0.005 apart."""
        return pairs_in_order(self.class_dae, self.of_pairs.mean(axis=2), FAR)

    @property
    def wrong(self) -> list[Wrong]:
        """Clear pairs in the wrong order, the furthest apart first."""
        found = []
        for i, j in combinations(np.argsort(self.mean_daf), 2):
            rows = [i, j]
            pair = pairs_in_order(self.class_dae[rows], self.of_pairs[rows].mean(axis=2))
            if pair.number > pair.right:
                apart = (
                    float(np.diff(values[rows])[0]) for values in (self.mean_daf, self.class_dae)
                )
                found.append(Wrong(self.dampers[i], self.dampers[j], *apart))
        return sorted(found, key=lambda each: -each.daf_difference)

    @property
    def share(self) -> tuple[float, float]:
        """How much of what roads add to the smooth DAF the class DAE has [-], and how alike.

        The slope of the line through all dampers, and the correlation about it.
        """
        from scipy.stats import linregress  # slow to load

        line = linregress(self.mean_daf - self.mean_eq_15, self.class_dae - self.mean_eq_15)
        return float(line.slope), float(line.rvalue)

    @property
    def errors(self) -> tuple[FloatArray, FloatArray]:
        """Rms errors on single roads of Eq. (15) and of second order [-], (n_dampers,) each."""
        first, second = (
            np.sqrt(np.mean((estimate - self.daf) ** 2, axis=(1, 2, 3)))
            for estimate in (self.dae, self.dae_2)
        )
        return first, second

    @property
    def error_ratio(self) -> float:
        """Rms error on single roads of second order over that of Eq. (15) [-], of all dampers."""
        first, second = (np.sqrt(np.mean(each**2)) for each in self.errors)
        return float(second / first)


def validate_dampers(
    speeds: ArrayLike | None = None,
    spans: Sequence[int] = SPANS,
    n_pairs: int = N_PAIRS,
    *,
    approach: float = APPROACH,
    resume: str | os.PathLike[str] | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: bool = True,
) -> tuple[DamperCase, ...]:
    """Compare the class DAE of many dampers with their simulated mean DAF, by span and class.

    The paper's truck crosses its bridges on `n_pairs` roads of class A and B and their mirror
    images, at `speeds` [m/s] after an `approach` [m]; `resume` keeps what is done in a file for
    each span.
    """
    c = check.speeds(SPEEDS if speeds is None else speeds)
    count = check.integer("n_pairs", n_pairs, at_least=2)
    before = check.not_negative("approach", approach, unit="m")
    if not len(spans):
        raise ValueError("spans must hold one value at least, got none: type [25]")
    bridges, car = [li2006.beam(span) for span in spans], li2006.car()
    found: list[DamperCase] = []
    for beam in bridges:
        known, unseen = known_dampers(beam, car), unseen_dampers(beam, car)
        board = score(
            [*known, *unseen], beam, car, _roads(beam, count, before), c, approach=before,
            resume=_file(resume, beam), workers=workers, scheduler=scheduler,
            progress=progress,
        )  # fmt: skip
        found += [_case(board, name, len(known)) for name in CLASSES]
    return tuple(found)


def _file(resume: str | os.PathLike[str] | None, beam: Beam) -> Path | None:
    """Each bridge is a study with a file of its own."""
    if resume is None:
        return None
    path = Path(resume)
    return path.with_name(f"{path.stem}-{beam.length:g}m{path.suffix}")


def _roads(beam: Beam, n_pairs: int, approach: float) -> list[RoadProfile]:
    """Roads of each class and then their mirror images."""
    length = approach + beam.length
    found = []
    for number, name in enumerate(CLASSES):
        z = iso8608_elevations(n_pairs, name, length, RAMP_LENGTH, seed=SEED + number)
        x = even_places(-approach, RAMP_LENGTH, z.shape[1])
        found += [RoadProfile(x, each, name=f"class {name}") for each in (*z, *-z)]
    return found


def _case(board: Scoreboard, road_class: str, n_known: int) -> DamperCase:
    """Take what a board has of a class."""
    own = np.array_split(np.arange(len(board.roads)), len(CLASSES))[CLASSES.index(road_class)]
    n_dampers, n_speeds = len(board.strategies), len(board.speeds)
    daf, dae, dae_2 = (
        board.values[name][:, own].reshape(n_dampers, 2, -1, n_speeds)
        for name in ("daf", "dae", "dae_2")
    )
    rows = {row.strategy: row.dae for row in board.class_rows(road_class)}
    means = np.array([rows[name] for name in board.strategies])
    return DamperCase(
        board.beam.length, road_class, board.strategies, n_known, daf, dae, dae_2, means
    )
