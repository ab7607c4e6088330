"""A table by crossing of random traffic: what it holds, and which rows are those of a traffic."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._labelled import with_units
from bridgectl._version import __version__
from bridgectl.fleet import words
from bridgectl.fleet.comparison import traffic

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False, repr=False)
class Crossings:
    """Columns by crossing: see `bridgectl.Assessment`."""

    columns: Mapping[str, Any]
    effects: Mapping[str, str]
    bridge: str = ""
    trucks_a_day: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "effects", dict(self.effects))
        object.__setattr__(self, "columns", words.as_columns(self.columns, self.effects))
        if self.trucks_a_day is not None:
            object.__setattr__(
                self, "trucks_a_day", check.positive("trucks_a_day", self.trucks_a_day)
            )

    def __len__(self) -> int:
        return len(self.columns["crossing"])

    @property
    def qualities(self) -> tuple[str, ...]:
        """Road qualities; '' if they have no names."""
        words = self.columns["quality"]
        return tuple(words.names[code] for code in np.unique(words.codes))

    @property
    def most_damped(self) -> float:
        """Largest share of trucks that were simulated with dampers, on the road with the least."""
        shares = []
        for quality in self.qualities:
            own = self.columns["quality"].is_word(quality)
            truck, damped = self.columns["truck"][own], self.columns["damped"][own]
            shares.append(len(np.unique(truck[damped])) / len(np.unique(truck)))
        return min(shares)

    def to_pandas(self) -> pandas.DataFrame:
        """Return the columns as a table, words as categories.

        Returns
        -------
        pandas.DataFrame
            Units are in ``attrs["units"]``.
        """
        return with_units(words.to_pandas(self.columns), words.units(self.columns, self.effects))

    def to_parquet(self, path: str) -> None:
        """Write the columns to a Parquet file.

        Parameters
        ----------
        path : str
            The file.

        Raises
        ------
        ImportError
            If pyarrow is not installed.
        """
        told = {"bridgectl": __version__, "bridge": self.bridge}
        units = words.titles(self.columns, self.effects)
        words.write_parquet(self.columns, path, told | {"columns": ", ".join(units.values())})

    def to_csv(self, path: str) -> None:
        """Write the columns to a CSV file, with units in the heading.

        Parameters
        ----------
        path : str
            The file.
        """
        words.write_csv(self.columns, path, words.titles(self.columns, self.effects))

    def _effect(self, effect: str | None) -> str:
        return self._only("effect", effect, tuple(self.effects))

    @staticmethod
    def _only(name: str, value: str | None, there: tuple[str, ...]) -> str:
        """Return what is asked for, or the only one."""
        if value is None and len(there) == 1:
            return there[0]
        return check.choice(name, value, there)

    def _rows(self, quality: str | None, damper_share: float | None) -> NDArray[np.integer[Any]]:
        """Rows of the traffic on a road quality."""
        quality = self._only("quality", quality, self.qualities)
        own = np.flatnonzero(self.columns["quality"].is_word(quality))
        truck, damped = self.columns["truck"][own], self.columns["damped"][own]
        return own[traffic(truck, damped, damper_share)]

    def _values(
        self, quantity: str, effect: str | None, rows: NDArray[np.integer[Any]]
    ) -> FloatArray:
        """Values of rows."""
        return np.asarray(self.columns[f"{quantity} {self._effect(effect)}"][rows])
