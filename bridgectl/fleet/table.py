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
        kind, places = "row", frame.index
        frame = frame.set_axis([str(each) for each in frame.columns], axis=1)
        _require_different(name, list(frame.columns))
    else:
        name = _checks.path("table", table, "weighed.csv")
        frame, places, faults = _read(name, columns)
        kind = "line"
    try:
        found = find_columns(list(frame.columns), columns, units)
        rows, judge = _judged(frame, found, decimal, faults)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: {error}") from None
    told = tuple(f"{kind} {places[i]}: {fault}" for i, fault in sorted(judge.faults.items()))
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


def _require_different(name: str, columns: Sequence[str]) -> None:
    twice = next((each for each in columns if columns.count(each) > 1), None)
    if twice is not None:
        raise ValueError(f"{name}: two columns are called {twice!r}: rename one")


def _read(
    file: str, columns: Mapping[str, Any] | None
) -> tuple[DataFrame, list[int], dict[int, str]]:
    """Return the cells of a file as text, the lines of the rows, and rows of too many cells."""
    import pandas as pd

    try:
        with lines.opened(file) as handle:
            encoding = lines.encoding_of(handle.peek(4)[:4])  # type: ignore[attr-defined]
            numbers, texts = _kept(lines.text_lines(file, handle, encoding))
    except ProfileFileError as error:
        raise ValueError(str(error).replace("save the profile in one", "split it")) from None
    if not texts:
        fault = "there is no line of names: expected time,speed_kmh,load_1_kN and so on"
        raise ValueError(f"{file}: {fault}")
    start, delimiter = _header(texts, columns)
    names = [name or f"column {i}" for i, name in enumerate(_cells(texts[start], delimiter), 1)]
    _require_different(file, names)
    del numbers[: start + 1], texts[: start + 1]
    faults = _fitted(texts, delimiter, len(names))
    if not texts:
        return pd.DataFrame(columns=names), numbers, faults
    whole = io.BytesIO("\n".join(texts).encode())
    texts.clear()  # of a million trucks all of this fills some memory
    frame = pd.read_csv(
        whole, sep=delimiter, names=names, header=None, dtype=str, keep_default_na=False,
        na_filter=False, skip_blank_lines=False,
    )  # fmt: skip
    return frame, numbers, faults


def _kept(texts: Iterator[str]) -> tuple[list[int], list[str]]:
    """Numbers and texts of the lines that are neither blank nor comments."""
    numbers, kept = [], []
    for number, text in enumerate(texts, start=1):
        if not (lines.is_blank(text) or lines.is_comment(text)):
            numbers.append(number)
            kept.append(text if text.isascii() else lines.lettered(text))
    return numbers, kept


def _fitted(texts: list[str], delimiter: str, width: int) -> dict[int, str]:
    """Cut rows to the columns that have names, in place, and tell of those with more cells."""
    faults = {}
    for i, text in enumerate(texts):
        if text.count(delimiter) >= width or '"' in text:
            cells = _cells(text, delimiter)
            if any(cells[width:]):
                faults[i] = f"{len(cells)} cells, and {width} columns have names"
            quoted = ('"' + cell.replace('"', '""') + '"' for cell in cells[:width])
            texts[i] = delimiter.join(quoted)
    return faults


def _header(texts: Sequence[str], columns: Mapping[str, Any] | None) -> tuple[int, str]:
    """Return which line names the columns, and what separates them.

    Stations tell of themselves in lines above, of other lengths.
    """
    wanted: set[str] = set()
    for given in (columns or {}).values() if isinstance(columns, Mapping) else ():
        wanted |= {given} if isinstance(given, str) else {*given}
    for i, text in enumerate(texts[:PEEK]):
        delimiter = lines.delimiter_of(text)
        names = _cells(text, delimiter)
        sorts = [found[0] for name in names if (found := sort_of(name)) is not None]
        if (wanted and wanted <= {*names}) or {"speed", "load", "spacing"} <= {*sorts}:
            return i, delimiter
    return 0, lines.delimiter_of(texts[0])


def _cells(text: str, delimiter: str) -> list[str]:
    row = next(csv.reader([text], delimiter=delimiter, skipinitialspace=True))
    return [cell.strip() for cell in row]


def _judged(
    frame: DataFrame, columns: Columns, decimal: str | None, faults: Mapping[int, str]
) -> tuple[Rows, _Judge]:
    judge = _Judge(dict(faults))
    names = [name for sort in ("speed", "load", "spacing") for name in columns.names[sort]]
    mark = _mark((frame[name] for name in names), decimal)
    time = _times(frame, columns, decimal, judge)
    numbers = {name: _numbers(name, frame[name], mark, judge) for name in names}

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


def _text(cells: Any) -> Any:
    """A column as text, empty where nothing is."""
    return cells.astype(object).where(cells.notna(), "").astype(str).str.strip()


def _mark(columns: Iterator[Any], decimal: str | None) -> str:
    """Return the decimal mark of columns: a comma where there are commas and no points."""
    if decimal is not None:
        return _checks.choice("decimal", decimal, (".", ","))
    commas: list[str] = []
    for cells in columns:  # one after the other: those of a million trucks fill some memory
        if cells.dtype.kind not in "iufb":
            texts = _text(cells)
            if texts.str.contains(".", regex=False).any():
                return "."
            commas += texts[texts.str.contains(",", regex=False)].head(1000).tolist()
    if commas and all(map(_GROUPS.fullmatch, commas)):
        text = commas[0]
        raise ValueError(
            f"{text!r} may be {text.replace(',', '.', 1)} or {text.replace(',', '')}: type "
            'decimal="," or take out the commas'
        )
    return "," if commas else "."


def _numbers(name: str, cells: Any, mark: str, judge: _Judge) -> FloatArray:
    """Return a column of numbers, NaN where a cell is empty."""
    import pandas as pd

    if cells.dtype.kind in "iuf":
        return np.asarray(cells.to_numpy(dtype=np.float64, na_value=np.nan))
    texts = _text(cells)
    pointed = texts
    if mark == ",":
        pointed = texts.where(~texts.str.contains(".", regex=False), "?")
        pointed = pointed.str.replace(",", ".", regex=False)
    values = np.asarray(pd.to_numeric(pointed, errors="coerce"), dtype=np.float64)
    bad = ~np.isfinite(values)
    empty = np.asarray(texts.isin(["", "nan", "NaN", "<NA>", "None"]))
    judge.refuse(bad & ~empty, lambda i: f"{name!r} = {texts.iloc[i]!r} is no number")
    return np.where(bad, np.nan, values)


def _times(frame: DataFrame, columns: Columns, decimal: str | None, judge: _Judge) -> FloatArray:
    """Return times [s], from any."""
    import pandas as pd

    names = columns.names["time"]
    if not names:
        return np.full(len(frame), np.nan)
    cells = frame[names[0]]
    if columns.units["time"][0]:
        numbers = _numbers(names[0], cells, _mark(iter([cells]), decimal), judge)
        judge.refuse(np.isnan(numbers), lambda i: f"{names[0]!r} is empty")
        return numbers
    if cells.dtype.kind != "M":
        cells = _text(cells)
        for name in names[1:]:
            cells = cells + " " + _text(frame[name])
    some = cells.iloc[:0] if cells.dtype.kind == "M" else cells[cells != ""]
    if columns.time_format is None and len(some) and some.str.fullmatch(r"[\d.,]+").all():
        raise ValueError(
            f'the column {names[0]!r} holds numbers without a unit: type units={{"time": "s"}}, or '
            'a format, as {"time": "%Y%m%d%H%M%S"}'
        )
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
