"""Tables of weighed trucks as they come: text of many dialects, bad rows, rows of all lengths."""

from __future__ import annotations

import csv
import io
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._plausible import FASTEST
from bridgectl.fleet.columns import Columns, find_columns, sort_of
from bridgectl.road.files import lines
from bridgectl.road.files.lines import ProfileFileError

DataFrame = Any  # of pandas, which is loaded when a table is read

SPEEDS, LOADS, SPACINGS = (0.1, FASTEST), (0.5e3, 500e3), (0.3, 40.0)
"""Speeds [m/s], axle loads [N] and spacings [m] that are possible."""

PEEK = 50  # lines among which the names of the columns stand
_GROUPS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class Rows:
    """What a table holds, in SI units: NaN where a truck has no more axles."""

    ARRAYS: ClassVar = ("numbers", "time", "speed", "loads", "spacings")

    numbers: NDArray[np.int_]
    """Of the trucks, shape (n,): as they were in the table, from 0 on."""
    time: FloatArray
    """After the first truck [s]; NaN if it is not told."""
    speed: FloatArray
    """[m/s]"""
    loads: FloatArray
    """Shape (n, most axles) [N]."""
    spacings: FloatArray
    left_out: tuple[str, ...] = ()
    """Bad rows, each with its place and what is wrong."""


@dataclass
class _Judge:
    """What is wrong with rows: the first fault of each is told."""

    faults: dict[int, str] = field(default_factory=dict)

    def refuse(self, bad: Mask, tell: Callable[[int], str]) -> None:
        """Refuse the rows of a mask."""
        for i in np.flatnonzero(bad).tolist():
            self.faults.setdefault(i, tell(i))


def read_rows(
    table: str | os.PathLike[str] | DataFrame,
    columns: Mapping[str, Any] | None,
    units: Mapping[str, str] | None,
    decimal: str | None,
    leave_out: bool,
) -> Rows:
    """Read a file, or take a DataFrame."""
    faults: dict[int, str] = {}
    frame: Any = table
    if hasattr(frame, "columns") and hasattr(frame, "iloc"):
        name = "the table"
        places = [f"row {label}" for label in frame.index]
        frame = frame.set_axis([str(each) for each in frame.columns], axis=1)
    else:
        name = _checks.path("table", table, "weighed.csv")
        frame, numbers, faults = _read(name, columns)
        places = [f"line {number}" for number in numbers]
    try:
        found = find_columns(list(frame.columns), columns, units)
        rows, judge = _judged(frame, found, decimal, faults)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: {error}") from None
    told = tuple(f"{places[i]}: {fault}" for i, fault in sorted(judge.faults.items()))
    if told and not leave_out:
        raise ValueError(
            f"{name}, {told[0]}; correct the {len(told)} bad of {len(frame)} rows, or type "
            'bad="leave out"'
        )
    if len(told) == len(frame):
        first = f", the first is {told[0]}" if told else ""
        raise ValueError(f"{name} has no row of a truck{first}")
    keep = np.setdiff1d(np.arange(len(frame)), list(judge.faults))
    time = rows.time[keep]
    if np.isfinite(time).any():
        time = time - time.min()
    return Rows(keep, time, rows.speed[keep], rows.loads[keep], rows.spacings[keep], told)


def _read(
    file: str, columns: Mapping[str, Any] | None
) -> tuple[DataFrame, list[int], dict[int, str]]:
    """Return the cells of a file as text, the lines of the rows, and rows of too many cells."""
    import pandas as pd

    try:
        with lines.opened(file) as handle:
            encoding = lines.encoding_of(handle.peek(4)[:4])  # type: ignore[attr-defined]
            texts = list(lines.text_lines(file, handle, encoding))
    except ProfileFileError as error:
        raise ValueError(str(error).replace("save the profile in one", "split it")) from None
    kept = [
        (number, text if text.isascii() else lines.lettered(text))
        for number, text in enumerate(texts, start=1)
        if not (lines.is_blank(text) or lines.is_comment(text))
    ]  # fmt: skip
    if not kept:
        raise ValueError(
            f"{file}: there is no line of names: expected time,speed_kmh,load_1_kN,..."
        )
    start, delimiter = _header(kept, columns)
    names = next(_cells([kept[start][1]], delimiter))
    names = [name or f"column {i}" for i, name in enumerate(names, start=1)]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"{file}:{kept[start][0]}: two columns are called {twice!r}: rename one")
    body = kept[start + 1 :]
    faults: dict[int, str] = {}
    quoted = any('"' in text for _, text in body)
    wide = []
    for i, (_, text) in enumerate(body):
        if quoted or text.count(delimiter) >= len(names):
            cells = next(_cells([text], delimiter))
            if any(cells[len(names) :]):
                faults[i] = f"{len(cells)} cells, and {len(names)} columns have names"
            cells = (cells + [""] * len(names))[: len(names)]
            text = delimiter.join('"' + cell.replace('"', '""') + '"' for cell in cells)
        wide.append(text)
    frame = pd.read_csv(
        io.StringIO("\n".join(wide)), sep=delimiter, names=names, header=None, dtype=str,
        keep_default_na=False, na_filter=False, skip_blank_lines=False,
    ) if wide else pd.DataFrame(columns=names)  # fmt: skip
    return frame, [number for number, _ in body], faults


def _header(kept: Sequence[tuple[int, str]], columns: Mapping[str, Any] | None) -> tuple[int, str]:
    """Return which line names the columns, and what separates them.

    Stations tell of themselves in lines above, of other lengths.
    """
    wanted: set[str] = set()
    for given in (columns or {}).values() if isinstance(columns, Mapping) else ():
        wanted |= {given} if isinstance(given, str) else {*given}
    for i, (_, text) in enumerate(kept[:PEEK]):
        delimiter = lines.delimiter_of(text)
        names = next(_cells([text], delimiter))
        sorts = [found[0] for name in names if (found := sort_of(name)) is not None]
        if (wanted and wanted <= {*names}) or {"speed", "load", "spacing"} <= {*sorts}:
            return i, delimiter
    return 0, lines.delimiter_of(kept[0][1])


def _cells(texts: Sequence[str], delimiter: str) -> Iterator[list[str]]:
    for cells in csv.reader(texts, delimiter=delimiter, skipinitialspace=True):
        yield [cell.strip() for cell in cells]


def _judged(
    frame: DataFrame, columns: Columns, decimal: str | None, faults: Mapping[int, str]
) -> tuple[Rows, _Judge]:
    judge = _Judge(dict(faults))
    names = [name for sort in ("speed", "load", "spacing") for name in columns.names[sort]]
    cells = _pointed({name: frame[name] for name in names}, decimal)
    time = _times(frame, columns, judge)
    numbers = {name: _numbers(name, cells[name], judge) for name in names}

    def of(sort: str) -> FloatArray:
        each = [
            numbers[name] * factor
            for name, factor in zip(columns.names[sort], columns.factors[sort], strict=True)
        ]
        return np.array(each).reshape(len(each), len(frame)).T

    def told(sort: str, i: int, k: int) -> str:
        name = columns.names[sort][k]
        return f"{name!r} = {numbers[name][i]:g} {columns.units[sort][k]}"

    speed, loads, spacings = of("speed")[:, 0], of("load"), of("spacing")
    low, high = SPEEDS
    judge.refuse(np.isnan(speed), lambda i: "has no speed")
    judge.refuse(
        ~((speed >= low) & (speed < high)),
        lambda i: f"{told('speed', i, 0)} is no speed of a truck, {low:g} to {high:g} m/s",
    )
    loads, spacings = _judge_axles(loads, spacings, told, judge)
    return Rows(np.arange(len(frame)), time, speed, loads, spacings), judge


def _judge_axles(
    loads: FloatArray, spacings: FloatArray, told: Callable[[str, int, int], str], judge: _Judge
) -> tuple[FloatArray, FloatArray]:
    """Refuse impossible axles; what is 0 behind the last one is none."""
    loads = np.where(loads == 0, np.nan, loads)
    there = ~np.isnan(loads)
    count = there.sum(axis=1)
    judge.refuse(count == 0, lambda i: "has no axles")
    holes = there != (np.arange(loads.shape[1]) < count[:, np.newaxis])
    judge.refuse(holes.any(axis=1), lambda i: "has a load behind an axle that has none")
    judge.refuse(count == 1, lambda i: "has one axle, and a truck has two or more")
    gaps = np.arange(spacings.shape[1]) < (count - 1)[:, np.newaxis]
    missing = gaps & np.isnan(spacings)
    judge.refuse(
        missing.any(axis=1),
        lambda i: f"has {count[i]} axles, and no spacing {missing[i].argmax() + 1}",
    )
    beyond = ~gaps & ~np.isnan(spacings) & (spacings != 0)
    judge.refuse(
        beyond.any(axis=1),
        lambda i: f"has {count[i]} axles, and a spacing {beyond[i].argmax() + 1} behind them",
    )
    for sort, values, limits, unit, of in (
        ("load", loads, LOADS, "N", there), ("spacing", spacings, SPACINGS, "m", gaps)
    ):  # fmt: skip
        outside = of & ~((values >= limits[0]) & (values <= limits[1]))
        judge.refuse(np.any(outside, axis=1), partial(_limits, told, sort, outside, limits, unit))
    return loads, np.where(gaps, spacings, np.nan)[:, : loads.shape[1] - 1]


def _limits(
    told: Callable[[str, int, int], str],
    sort: str,
    outside: Mask,
    limits: tuple[float, float],
    unit: str,
    i: int,
) -> str:
    low, high = limits
    found = told(sort, i, int(outside[i].argmax()))
    return f"{found} is no {sort} of an axle, {low:g} to {high:g} {unit}"


def _pointed(cells: dict[str, Any], decimal: str | None) -> dict[str, Any]:
    """Return cells of text with decimal points."""
    if decimal not in (None, ".", ","):
        raise ValueError(f'decimal must be "." or ",", got {decimal!r}')
    texts = {name: each for name, each in cells.items() if each.dtype.kind not in "iufb"}
    texts = {
        name: each.astype(object).where(each.notna(), "").astype(str).str.strip()
        for name, each in texts.items()
    }
    if decimal is None:
        points = any(each.str.contains(".", regex=False).any() for each in texts.values())
        found = [each[each.str.contains(",", regex=False)] for each in texts.values()]
        commas = [text for each in found for text in each.iloc[:1000]]
        if commas and not points and all(map(_GROUPS.fullmatch, commas)):
            text = commas[0]
            raise ValueError(
                f"{text!r} may be {text.replace(',', '.', 1)} or {text.replace(',', '')}: type "
                'decimal="," or take out the commas'
            )
        decimal = "," if commas and not points else "."
    if decimal == ",":
        texts = {
            name: each.where(~each.str.contains(".", regex=False), "?" + each)
            .str.replace(",", ".", regex=False)
            for name, each in texts.items()
        }  # fmt: skip
    return {**cells, **texts}


def _numbers(name: str, cells: Any, judge: _Judge) -> FloatArray:
    """Return a column of numbers, NaN where a cell is empty."""
    import pandas as pd

    if cells.dtype.kind in "iuf":
        return np.asarray(cells, dtype=np.float64)
    values = np.asarray(pd.to_numeric(cells, errors="coerce"), dtype=np.float64)
    empty = np.asarray(cells.isin(["", "nan", "NaN", "<NA>", "None"]))
    judge.refuse(
        ~np.isfinite(values) & ~empty,
        lambda i: f"{name!r} = {cells.iloc[i].removeprefix('?')!r} is no number",
    )
    return np.where(np.isfinite(values), values, np.nan)


def _times(frame: DataFrame, columns: Columns, judge: _Judge) -> FloatArray:
    """Return times [s], from any."""
    import pandas as pd

    names = columns.names["time"]
    if not names:
        return np.full(len(frame), np.nan)
    cells = frame[names[0]]
    if columns.units["time"][0]:
        numbers = _numbers(names[0], _pointed({"": cells}, None)[""], judge)
        judge.refuse(np.isnan(numbers), lambda i: f"{names[0]!r} is empty")
        return numbers
    if cells.dtype.kind in "iuf" or (
        columns.time_format is None and cells.astype(str).str.fullmatch(r"[\d.,]+").all()
        and len(cells)
    ):  # fmt: skip
        raise ValueError(
            f'the column {names[0]!r} holds numbers without a unit: type units={{"time": "s"}}, or '
            'a format, as {"time": "%Y%m%d%H%M%S"}'
        )
    for name in names[1:]:
        cells = cells.astype(str) + " " + frame[name].astype(str)
    times = pd.to_datetime(
        cells, format=columns.time_format or "ISO8601", errors="coerce", utc=True
    )
    judge.refuse(
        np.asarray(times.isna()),
        lambda i: (
            f"{' '.join(names)!r} = {str(cells.iloc[i])!r} is no time: expected "
            f"{columns.time_format or '2026-03-01 14:05:09.25'}, for another form type "
            'units={"time": "%d.%m.%Y %H:%M:%S"}'
        ),
    )
    return np.asarray((times - times.min()).dt.total_seconds(), dtype=np.float64)
