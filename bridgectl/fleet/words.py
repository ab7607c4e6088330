"""Columns of a table by crossing: arrays, words as codes, and what files they are written to."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks as check
from bridgectl._files import replacing

if TYPE_CHECKING:
    import pandas

USUAL = (
    "crossing", "truck", "kind", "road", "quality", "speed", "gross_weight", "n_axles", "damped",
    "meeting", "least_tire_force",
)  # fmt: skip
"""Columns of every crossing."""

WORDS = ("kind", "road", "quality")

OF_EFFECT = ("static", "total", "daf", "place", "time")
"""Columns of each effect, whose name follows."""

UNITS = {"speed": "m/s", "gross_weight": "N", "place": "m", "time": "s"}
"""Of columns, and of the first words of those of an effect."""

CHUNK = 10_000
"""Rows that are made text at once."""


class Words(NamedTuple):
    """A column of words, few of which differ: word `names[codes[i]]` of each row."""

    codes: NDArray[np.integer[Any]]
    names: tuple[str, ...]

    @classmethod
    def of(cls, values: Any) -> Words:
        """Return words of an array of them, or of codes and names."""
        if isinstance(values, tuple):
            codes, names = values
            return cls(np.asarray(codes), tuple(map(str, names)))
        names, codes = np.unique(np.asarray(values, dtype=str), return_inverse=True)
        return cls(codes.astype(np.min_scalar_type(len(names))), tuple(names.tolist()))

    def is_word(self, word: str) -> NDArray[np.bool_]:
        """Tell which rows have a word."""
        if word not in self.names:
            return np.zeros(len(self.codes), dtype=bool)
        return np.asarray(self.codes == self.names.index(word))


Columns: TypeAlias = Mapping[str, Any]


def as_columns(columns: Columns, effects: Mapping[str, str]) -> dict[str, Any]:
    """Return the columns that must be there, words as codes, all of one length."""
    names = [*USUAL, *(f"{of} {effect}" for effect in effects for of in OF_EFFECT)]
    missing = [name for name in names if name not in columns]
    if missing:
        raise ValueError(f"columns must have {', '.join(names)}; there is no {missing[0]!r}")
    found = {
        name: Words.of(columns[name]) if name in WORDS else np.asarray(columns[name])
        for name in names
    }
    lengths = {len(rows(column)) for column in found.values()}
    if len(lengths) > 1 or 0 in lengths:
        raise ValueError(f"columns must be of one length above 0, got {sorted(lengths)}")
    return found


def rows(column: Any) -> NDArray[Any]:
    """Return the array of a column: of words their codes."""
    return column.codes if isinstance(column, Words) else column


def units(columns: Columns, effects: Mapping[str, str]) -> dict[str, str]:
    """Return the units of the columns that have one."""
    own = {f"{of} {effect}": unit for effect, unit in effects.items()
           for of in ("static", "total")}  # fmt: skip
    every = {name: own.get(name, UNITS.get(name.split(" ")[0])) for name in columns}
    return {name: unit for name, unit in every.items() if unit}


def titles(columns: Columns, effects: Mapping[str, str]) -> dict[str, str]:
    """Return the names of columns with their units."""
    found = units(columns, effects)
    return {name: f"{name} [{found[name]}]" if name in found else name for name in columns}


def to_pandas(columns: Columns) -> pandas.DataFrame:
    """Return the columns as a table, words as categories."""
    import pandas as pd

    return pd.DataFrame({
        name: pd.Categorical.from_codes(column.codes, list(column.names))
        if isinstance(column, Words)
        else column
        for name, column in columns.items()
    })  # fmt: skip


def write_parquet(columns: Columns, path: str, told: Mapping[str, str]) -> None:
    """Write a Parquet file: words as dictionaries; what is told is metadata of the file."""
    check.path("path", path, "crossings.parquet")
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError as error:
        raise ImportError(
            "Parquet files need pyarrow: pip install 'bridgectl[parquet]', or write CSV"
        ) from error
    arrays = [
        pa.DictionaryArray.from_arrays(column.codes, list(column.names))
        if isinstance(column, Words)
        else pa.array(column)
        for column in columns.values()
    ]
    table = pa.table(dict(zip(columns, arrays, strict=True))).replace_schema_metadata(dict(told))
    with replacing(path) as file:
        pq.write_table(table, file)


def write_csv(columns: Columns, path: str, names: Mapping[str, str]) -> None:
    """Write a CSV file, whose numbers are those of the table to the bit."""
    check.path("path", path, "crossings.csv")
    with replacing(path) as file:
        text = io.TextIOWrapper(file, encoding="utf-8", newline="")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([names[name] for name in columns])
        for lines in _chunks(columns):
            writer.writerows(lines)
        text.flush()
        text.detach()


def _chunks(columns: Columns) -> Iterator[Iterator[tuple[Any, ...]]]:
    """Rows, some thousand at a time: a million of them do not fit in memory as objects."""
    n = len(rows(next(iter(columns.values()))))
    for start in range(0, n, CHUNK):
        part = slice(start, start + CHUNK)
        yield zip(*(
            [column.names[code] for code in column.codes[part]]
            if isinstance(column, Words)
            else column[part].tolist()
            for column in columns.values()
        ), strict=True)  # fmt: skip
