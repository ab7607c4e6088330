"""Read roads from delimited text: a column of stations, and one or more of elevations."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bridgectl._checks import FloatArray

from .limits import first_unsorted
from .lines import (
    COMMENTS,
    DELIMITERS,
    Line,
    delimiter_of,
    is_blank,
    is_comment,
    passing,
    printable,
    quoted,
    refusal,
    split,
    wrong_separator,
)
from .profile import RoadProfile
from .table import Layout, Table, read_table
from .tracks import (
    STEPS,
    TELL_UNITS,
    UNITS,
    Pick,
    Request,
    even_stations,
    odd_step,
    require_gentle_track,
    widest_gap,
)

_NUMBER_LIKE = re.compile(r"[+-]?(\.?\d|(nan|inf|infinity)$)", re.IGNORECASE)
_KNOWN = "|".join(UNITS)
_BRACKETED = rf"[\[(]\s*({_KNOWN})\s*[\])]"
_UNIT = re.compile(rf"""(?:{_BRACKETED}|_({_KNOWN}))["']?\s*$""")


@dataclass(frozen=True)
class _Header:
    """What one line says of the columns."""

    line: int = 0
    names: tuple[str, ...] = ()
    units: tuple[str | None, ...] = ()

    def unit(self, column: int) -> str | None:
        return self.units[column] if self.units else None

    def label(self, column: int) -> str:
        return self.names[column] if self.names else ""


@dataclass(frozen=True)
class _Columns:
    """Which columns hold what; no station where the steps are equal and told by the caller."""

    station: int | None
    elevations: tuple[int, ...]


def read_delimited(
    file: str, texts: Iterator[str], request: Request, pick: Pick
) -> list[RoadProfile]:
    """Return the tracks wanted of a file of delimited text."""
    header, comment, first = _preamble(file, texts)
    delimiter = request.delimiter or delimiter_of(first[1])
    width = len(split(first[1], delimiter))
    named, stating = _headers(header, comment, width, request)
    columns = _columns(request, stating, width)
    _require_columns(file, columns, delimiter, width, first)
    units = _units(file, columns, stating, request)
    picked = pick([named.label(column) for column in columns.elevations])
    stations = () if columns.station is None else (columns.station,)
    wanted = (*stations, *(columns.elevations[i] for i, _ in picked))
    table = read_table(Layout(file, wanted, delimiter, width), first, texts)
    if table.values.shape[1] < 2:
        fault = "only one line of numbers: a road needs two or more"
        raise refusal(file, fault, first[0])
    x = _stations(file, table, request, units)
    roads = []
    for z, (i, name) in zip(table.values[len(stations) :], picked, strict=True):
        unit = units[1 + i]
        z *= UNITS[unit]
        require_gentle_track(file, x, z, table.line, unit, _remedy(units[0], unit))
        # Checked already, with the line of the file, and copies would double the memory.
        roads.append(RoadProfile._trusted(x, z, name))
    return roads


def _preamble(file: str, texts: Iterator[str]) -> tuple[Line | None, Line | None, Line]:
    """Return the header, the last comment, and the first line of numbers."""
    header: Line | None = None
    comment: Line | None = None
    empty = True
    for line, text in enumerate(texts, 1):
        if is_blank(text):
            continue
        empty = False
        if is_comment(text):
            comment = (line, text.lstrip().lstrip("".join(COMMENTS)))
        elif header is None and _names_columns(text):
            header = (line, text)
        else:
            return header, comment, (line, text)
    fault = "the file is empty: expected lines of" if empty else "no line of numbers: expected a"
    raise refusal(file, f"{fault} station and {'' if empty else 'an '}elevation on each line")


def _names_columns(text: str) -> bool:
    words = re.split(r"[,;\s\"']+", text)
    if not any(map(_NUMBER_LIKE.match, words)):
        return any(c.isalpha() for c in text)
    # A track may be called 2, the stations not.
    first_word = text.lstrip(" \t\"'")
    return re.search(_BRACKETED, text) is not None and not _NUMBER_LIKE.match(first_word)


def _headers(
    header: Line | None, comment: Line | None, width: int, request: Request
) -> tuple[_Header, _Header]:
    """Return what names the columns and what states their units, often one line.

    A comment counts only if it states what is needed: it may be about anything.
    """
    named, remark = _header(header, width), _header(comment, width)
    stating = named
    if not _is_complete(named, request) and _is_complete(remark, request):
        stating = remark
    return (named if named.names else stating), stating


def _header(line: Line | None, width: int) -> _Header:
    if line is None:
        return _Header()
    by_mark = re.split("[,;\t]", line[1])
    by_space = re.findall(r"[^\s\[(]+\s*(?:[\[(][^\])]*[\])])?", line[1])
    names = by_mark if len(by_mark) == width else by_space
    if len(names) != width:
        return _Header()
    found = [_UNIT.search(name) for name in names]
    labels = [name[: m.start()] if m else name for name, m in zip(names, found, strict=True)]
    return _Header(
        line[0],
        tuple(printable(label.strip(" \t\"'")) for label in labels),
        tuple(m and (m[1] or m[2]) for m in found),
    )


def _is_complete(header: _Header, request: Request) -> bool:
    columns = _columns(request, header, len(header.units))
    stated = [header.unit(column) for column in range(len(header.units))]
    place = columns.station
    return any(stated[c] for c in columns.elevations if c < len(stated)) and (
        place is None or (place < len(stated) and stated[place] is not None)
    )


def _columns(request: Request, stating: _Header, width: int) -> _Columns:
    """Return the columns asked for, or else those that the file gives a unit of length."""
    given = request.columns
    if request.step is not None:
        stated = tuple(c for c in range(width) if stating.unit(c))
        return _Columns(None, given or stated or (0,))
    if given is not None:
        return _Columns(given[0], given[1:])
    return _Columns(0, tuple(c for c in range(1, width) if stating.unit(c)) or (1,))


def _require_columns(file: str, columns: _Columns, delimiter: str, width: int, first: Line) -> None:
    last = max(*columns.elevations, columns.station or 0)
    if last < width:
        return
    missing = (
        f"column {last} (counted from 0) does not exist, found {width} separated by "
        f"{DELIMITERS[delimiter]} in {quoted(first[1])}: {passing('columns', 'delimiter')}"
    )
    if columns.station is not None:
        missing += ", or step= (--step) if there are no stations"
    raise refusal(file, wrong_separator(first[1], delimiter) or missing, first[0])


def _units(file: str, columns: _Columns, stating: _Header, request: Request) -> tuple[str, ...]:
    """Return the unit of the stations and of each column of elevations."""
    asked = _asked(file, request)
    places = (columns.station, *columns.elevations)
    stated = ["m" if c is None else stating.unit(c) for c in places]
    wished = [asked[min(i, 1)] for i in range(len(places))]
    if any(s and w and s != w for s, w in zip(stated, wished, strict=True)):
        shown = stated if columns.station is not None else stated[1:]
        advice = "these" if len({*stated[1:]}) == 1 else "none"
        fault = f"the units stated here are {','.join(s or '?' for s in shown)}: pass {advice}"
        raise refusal(file, f"{fault} or correct this line", stating.line)
    units = tuple(s or w for s, w in zip(stated, wished, strict=True))
    if not all(units):
        raise refusal(file, f"the file does not state its units: {_tell_units(request)}")
    return tuple(unit for unit in units if unit)


def _asked(file: str, request: Request) -> tuple[str | None, str | None]:
    """Return the units that the caller says the stations and the elevations are in."""
    units, count = request.units, 2 if request.step is None else 1
    if units is None:
        return None, None
    if len(units) != count:
        number = "two units" if count == 2 else "one unit, since step= is in metres"
        fault = f"units must name {number}, got {len(units)}"
        raise refusal(file, f"{fault}: {_tell_units(request)}")
    return (units[0], units[1]) if count == 2 else (None, units[0])


def _tell_units(request: Request) -> str:
    if request.step is None:
        return TELL_UNITS
    return TELL_UNITS.replace("m,mm", "mm").replace("(station, elevation)", "(elevation)")


def _stations(file: str, table: Table, request: Request, units: tuple[str, ...]) -> FloatArray:
    if request.step is not None:
        return even_stations(0.0, request.step, table.values.shape[1])
    x: FloatArray = table.values[0]
    x *= UNITS[units[0]]
    if (i := first_unsorted(x)) is not None:
        raise refusal(file, _disorder(x, i, table), table.line(i))
    step = float(np.median(np.diff(x)))
    if odd_step(step):
        raise refusal(file, _odd_unit(step, units))
    if (i := widest_gap(x)) is not None:
        raise refusal(file, _gap(x, i, step, table), table.line(i))
    return x


def _disorder(x: FloatArray, i: int, table: Table) -> str:
    here, before = f"station {x[i]:.10g} m", f"{x[i - 1]:.10g} m on line {table.line(i - 1)}"
    if x[i] == x[i - 1]:
        return f"{here} repeats {before}: remove one of the two lines"
    if np.all(x[1:] < x[:-1]):
        return f"{here} lies before {before}, and so on: reverse the order of the lines"
    return f"{here} lies before {before}: sort the lines by station"


def _odd_unit(step: float, units: tuple[str, ...]) -> str:
    low, high = STEPS
    sizes = {unit: step / UNITS[units[0]] * UNITS[unit] for unit in UNITS}
    none = f"none: then {passing('columns', 'step')}"
    fitting = [f"{unit} ({size:.3g} m)" for unit, size in sizes.items() if low <= size <= high]
    finer = "; average readings that are so close over 1 mm" if step < low else ""
    return (
        f"the stations in {units[0]} have a median {odd_step(step)}: "
        f'pass units="UNIT,{units[1]}" (--units UNIT,{units[1]}) with the unit they are in, which '
        f"may be {' or '.join(fitting) or none}{finer}"
    )


def _gap(x: FloatArray, i: int, step: float, table: Table) -> str:
    return (
        f"station {x[i]:.10g} m comes {x[i] - x[i - 1]:.6g} m after {x[i - 1]:.10g} m on line "
        f"{table.line(i - 1)}, where the median step is {step:.4g} m: correct the station, or cut "
        "the file here and read the part before or after the gap"
    )


def _remedy(station: str, elevation: str) -> str:
    finer = "mm" if UNITS[elevation] > UNITS["mm"] else "mil"
    return (
        f"correct it, or if the elevations are in {finer}, pass "
        f'units="{station},{finer}" (--units {station},{finer})'
    )
