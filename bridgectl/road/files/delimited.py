"""Read roads from delimited text: a column of stations, and one or more of elevations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._places import even_places
from bridgectl.road.files import dialect
from bridgectl.road.files.counters import passing_columns, require_elevations, require_no_stations
from bridgectl.road.files.header import (
    Columns,
    Header,
    Preamble,
    columns_of,
    headers,
    is_complete,
    lines_after,
    make_header,
    n_names,
    read_preamble,
    states_both,
    tell_skip_lines,
)
from bridgectl.road.files.lines import (
    DELIMITERS,
    Line,
    ahead,
    passing,
    quoted,
    refusal,
    split,
    wrong_separator,
)
from bridgectl.road.files.missing import UNTOLD, marker_station
from bridgectl.road.files.table import Layout, Table, read_table
from bridgectl.road.files.tracks import (
    STEPS,
    TELL_UNITS,
    UNITS,
    Pick,
    Request,
    Track,
    make_roads,
    odd_step,
    require_no_gap,
)
from bridgectl.road.limits import first_unsorted
from bridgectl.road.profile import RoadProfile

ROUNDED_AWAY = 20  # of so many stations, one may repeat another by a slip
PEEK = 1000  # lines that show how the numbers are written


def read_delimited(
    file: str, texts: Iterator[str], request: Request, pick: Pick
) -> list[RoadProfile]:
    """Return the tracks wanted of a file of delimited text."""
    head, texts = ahead(texts, PEEK)
    preamble = read_preamble(file, texts, head, request)
    first = preamble.first
    rows = [first, *lines_after(head, first[0])]
    delimiter = _delimiter(file, rows, preamble, request)
    width = len(split(first[1], delimiter))
    named, stating = headers(preamble, width, delimiter, request)
    columns = columns_of(request, stating)
    _require_numbers(file, rows, delimiter, request)
    _require_columns(file, columns, delimiter, width, first, request)
    units = _units(file, columns, stating, request)
    picked = pick([named.label(column) for column in columns.elevations])
    wanted = Columns(columns.station, tuple(columns.elevations[i] for i, _ in picked))
    layout = _layout(file, rows, delimiter, wanted, units[0], request)
    if layout.chainage == dialect.CHAINAGE_DIGITS["m"]:
        units = ("m", *units[1:])  # also where "km" tells what stands before the plus
    table = read_table(layout, first, texts)
    if table.values.shape[1] < 2:
        fault = "only one line of numbers: a road needs two or more"
        raise refusal(file, fault, first[0])
    if request.columns is None and not (request.step is None and states_both(stating, wanted)):
        label = named.label(0) if named.names else None
        require_elevations(file, wanted, table.values, width, request.step, label)
    x = _stations(
        file, table, request, units, stating.line if stating.unit(wanted.station or 0) else 0
    )
    tracks = [
        Track(name, z, units[1 + i], _remedy(units[0], units[1 + i]))
        for z, (i, name) in zip(table.values[layout.stations :], picked, strict=True)
    ]
    if request.columns is None:
        require_no_stations(file, wanted, x, tracks, width)
    return make_roads(file, x, tracks, table.line, request)


def _delimiter(file: str, rows: Sequence[Line], preamble: Preamble, request: Request) -> str:
    """Return what separates the columns, where that is beyond doubt."""
    line, text = rows[0]
    told = request.delimiter or preamble.separator
    delimiter = told or dialect.delimiter_in(text, request.decimal)
    if delimiter != dialect.COMMA:
        return delimiter
    if request.decimal == dialect.COMMA:  # of a line sep=,
        fault = "commas cannot separate columns and be decimal marks"
        raise refusal(file, f'{fault}: pass delimiter=";" (--delimiter ";") or no decimal', line)
    if request.decimal is not None or request.columns is not None:
        return delimiter
    width, names = len(split(text, dialect.COMMA)), n_names(preamble.header)
    if names == width or make_header(preamble.comment, width, dialect.COMMA).lengths:
        return delimiter
    if dialect.has_comma_twice(
        rows, names, bool(make_header(preamble.header, names, dialect.COMMA).lengths)
    ):
        fault = f"commas may separate columns or be decimal marks in {quoted(text)}"
        advice = "save the file with semicolons between columns, or with decimal points"
        remedy = f"{advice}; {passing('columns')} if they separate columns"
        raise refusal(file, f"{fault}: {remedy}", line)
    if told is None and request.step is not None and dialect.is_one_column(rows):
        if any(is_complete(make_header(about, 1, " "), request) for about in preamble.above):
            return " "  # for that is about one column
        advice = 'pass decimal="," (--decimal ,) or columns=(0,) (--columns 0)'
        fault = f"{quoted(text)} may be one number with a decimal comma or two"
        raise refusal(file, f"{fault}: {advice}", line)
    return delimiter


def _layout(
    file: str, rows: Sequence[Line], delimiter: str, wanted: Columns, unit: str, request: Request,
) -> Layout:  # fmt: skip
    """Return how the numbers stand on the lines, as the first of them show."""
    width, stations = len(split(rows[0][1], delimiter)), 0 if wanted.station is None else 1
    missing = request.missing or UNTOLD
    plain = Layout(file, wanted.all, delimiter, width, stations=stations, missing=missing)
    return replace(
        plain,
        decimal=request.decimal or dialect.decimal_mark(file, rows, delimiter, wanted.all),
        chainage=dialect.chainage_digits(file, rows[0], delimiter, wanted.station, unit),
    )


def _require_numbers(file: str, rows: Sequence[Line], delimiter: str, request: Request) -> None:
    """Refuse words where the numbers should begin, also such as 0.25 m above one column."""
    line, text = rows[0]
    numeric = [dialect.is_numeric(field) for field in split(text, delimiter)]
    words = any(c.isalpha() for c in text) and not any(numeric) and request.missing is None
    width, *others = (len(split(row, delimiter)) for _, row in rows[:3])
    unlike = len(others) == 2 and len({*others}) == 1 and width not in others
    if words or (unlike and not all(numeric)):
        fault = "expected a finite number in each column, or their names and units, found"
        advice = f"correct or remove the line, or {tell_skip_lines(line)}"
        raise refusal(file, f"{fault} {quoted(text)}: {advice}", line)


def _require_columns(
    file: str, columns: Columns, delimiter: str, width: int, first: Line, request: Request
) -> None:
    last = max(*columns.elevations, columns.station or 0)
    if last < width:
        return
    missing = (
        f"column {last} (counted from 0) does not exist, found {width} separated by "
        f"{DELIMITERS[delimiter]} in {quoted(first[1])}: {passing('columns', 'delimiter')}"
    )
    if columns.station is not None:
        missing += ", or step= (--step) if there are no stations"
    other = "" if request.decimal == dialect.COMMA else wrong_separator(first[1], delimiter)
    raise refusal(file, other or missing, first[0])


def _units(file: str, columns: Columns, stating: Header, request: Request) -> tuple[str, ...]:
    """Return the unit of the stations and of each column of elevations."""
    asked = _asked(file, request)
    places = (columns.station, *columns.elevations)
    numbered = _point_number_first(columns, stating, request)
    stated = ["m" if c is None else stating.unit(c) for c in places]
    wished = [asked[min(i, 1)] for i in range(len(places))]
    if any(s and w and s != w for s, w in zip(stated, wished, strict=True)):
        shown = stated if columns.station is not None else stated[1:]
        advice = "these" if len({*stated[1:]}) == 1 else "none"
        fault = f"the units stated here are {','.join(s or '?' for s in shown)}: "
        advice = numbered or f"pass {advice} or correct this line"
        raise refusal(file, fault + advice, stating.line)
    units = tuple(s or w for s, w in zip(stated, wished, strict=True))
    if not all(units):
        fault = f"the file does not state its units: {numbered or _tell_units(request)}"
        raise refusal(file, fault, stating.line if numbered else None)
    return tuple(unit for unit in units if unit)


def _point_number_first(columns: Columns, stating: Header, request: Request) -> str:
    """Tell what to pass where a header states no unit for the first column, but for two others."""
    if columns.station is None or request.columns is not None:
        return ""
    if 0 in stating.lengths or len(stating.lengths) < 2:
        return ""
    first = f"column 0 has none ({quoted(stating.label(0))})"
    return f"{first}, {passing_columns(stating.lengths)} for those that have"


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


def _stations(
    file: str, table: Table, request: Request, units: tuple[str, ...], stated: int
) -> FloatArray:
    if request.step is not None:
        return even_places(0.0, request.step, table.values.shape[1])
    x: FloatArray = table.values[0]
    i = first_unsorted(x)
    if i is not None and (j := marker_station(x, i)) is not None:
        fault = f"the station {x[j]:.12g} {units[0]} looks like the marker of a missing one"
        raise refusal(file, f"{fault}: correct or remove the line", table.line(j))
    x *= UNITS[units[0]]
    if i is not None:
        raise refusal(file, _disorder(x, i, table), table.line(i))
    step = float(np.median(np.diff(x)))
    if odd_step(step):
        raise refusal(file, _odd_unit(step, units, stated))
    require_no_gap(file, x, table.line)
    return x


def _disorder(x: FloatArray, i: int, table: Table) -> str:
    here, before = f"station {x[i]:.10g} m", f"{x[i - 1]:.10g} m on line {table.line(i - 1)}"
    if x[i] == x[i - 1]:
        others = np.count_nonzero(np.diff(x) == 0) - 1
        if others > x.size // ROUNDED_AWAY:
            fault = f"{here} repeats {before}, as {others} others do: they are rounded too coarsely"
            return (
                f"{fault}, pass step= and columns= (--step and --columns) of the elevations alone"
            )
        return f"{here} repeats {before}: remove one of the two lines"
    if np.all(x[1:] < x[:-1]):
        return f"{here} lies before {before}, and so on: reverse the order of the lines"
    return f"{here} lies before {before}: sort the lines by station, or {passing('columns')}"


def _odd_unit(step: float, units: tuple[str, ...], line: int) -> str:
    """Say that the stations are in no unit of a road, be it told or stated on a line."""
    low, high = STEPS
    sizes = {unit: step / UNITS[units[0]] * UNITS[unit] for unit in UNITS}
    none = f"none: then {passing('columns', 'step')}"
    fitting = [f"{unit} ({size:.3g} m)" for unit, size in sizes.items() if low <= size <= high]
    other = "; average readings that are so close over 1 mm"
    if step > high:
        other = "; a road measured so far apart has lost the bumps that vehicles feel"
    change = f'pass units="UNIT,{units[1]}" (--units UNIT,{units[1]})'
    if line:
        change = f"correct line {line}"
    return (
        f"the stations in {units[0]} have a median {odd_step(step)}: {change} with the unit they "
        f"are in, which may be {' or '.join(fitting) or none}{other}"
    )


def _remedy(station: str, elevation: str) -> str:
    finer = "mm" if UNITS[elevation] > UNITS["mm"] else "mil"
    return (
        f"correct it, or if the elevations are in {finer}, pass "
        f'units="{station},{finer}" (--units {station},{finer})'
    )
