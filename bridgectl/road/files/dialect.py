"""How the numbers of delimited text are written: what separates them, and their decimal mark.

Nothing is guessed: a decimal comma is read where the first lines cannot mean anything else.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from bridgectl.road.files.lines import (
    DELIMITERS,
    Line,
    delimiter_of,
    is_number,
    quoted,
    refusal,
    split,
)

POINT, COMMA = ".", ","

_COMMA_NUMBER = re.compile(r"[+-]?(\d+\s*\+\s*)?\d*,\d+(e[+-]?\d+)?", re.IGNORECASE)
_WHOLE = re.compile(r"[+-]?\d+")
_GROUPS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+")
_THOUSANDS = re.compile(
    r"[+-]?\d{1,3}(([.,'\u2019 \xa0\u202f])\d{3}(\2\d{3})*[.,]\d+"
    r"|(['\u2019 \xa0\u202f])\d{3}(\4\d{3})*|([.,])\d{3}(\6\d{3})+)"
)
_CHAINAGE = re.compile(r"\s*([+-]?\d+)\s*\+\s*(\d+)((?:[.,]\d*)?)\s*")
_SEPARATOR_LINE = re.compile(r"\s*\"?sep=(.)\"?\s*", re.IGNORECASE)

CHAINAGE_DIGITS = {"m": 3, "km": 3, "ft": 2}
"""Digits after the plus: 12+345.6 is 12345.6 m, and 12+34.5 is 1234.5 ft."""


def separator_line(text: str) -> str | None:
    """Return what a first line like ``sep=;``, which spreadsheets write and read, states."""
    found = _SEPARATOR_LINE.fullmatch(text)
    return found and found[1]


def delimiter_in(text: str, decimal: str | None) -> str:
    """Return what separates the numbers of the first line."""
    if decimal == COMMA:
        return delimiter_of(text.replace(COMMA, POINT))
    found, words = delimiter_of(text), text.split()
    if found == COMMA and len(words) > 1 and all(map(is_numeric, words)):
        return " "
    return found


def is_numeric(field: str) -> bool:
    """Tell whether a field holds a number of any dialect."""
    return any(
        way(field.strip()) for way in (is_number, _COMMA_NUMBER.fullmatch, _CHAINAGE.fullmatch)
    )


def decimal_mark(file: str, rows: Sequence[Line], delimiter: str, columns: Sequence[int]) -> str:
    """Return the decimal mark of the wanted columns, as the first lines have it."""
    if delimiter == COMMA:
        return POINT
    found: list[tuple[int, str]] = []
    for line, text in rows:
        fields = split(text, delimiter)
        words = [fields[c].strip() for c in columns if c < len(fields)]
        if any(POINT in word and is_number(word) for word in words):
            return POINT  # commas among points are told of on their lines
        found += [(line, word) for word in words if _COMMA_NUMBER.fullmatch(word)]
    if found and all(_GROUPS.fullmatch(word) for _, word in found):
        line, word = found[0]
        fault = f"{quoted(word)} may be {_pointed(word)} or {word.replace(COMMA, '')}"
        raise refusal(file, f'{fault}: pass decimal="," (--decimal ,) or leave out the comma', line)
    return COMMA if found else POINT


def _pointed(word: str) -> str:
    return word.replace(COMMA, POINT, 1)


def is_one_column(rows: Iterable[Line]) -> bool:
    """Tell whether each line may be one number with a decimal comma as well as two whole ones."""
    return all(_COMMA_NUMBER.fullmatch(text.strip()) for _, text in rows)


def has_comma_twice(rows: Iterable[Line], n_names: int, with_units: bool) -> bool:
    """Tell whether commas may be decimal marks and separators at once, as in 0,25,1,3.

    So it looks where whole numbers stand in pairs that no header names, or where there are more
    numbers than the header has names and units.
    """
    fields = [split(text, COMMA) for _, text in rows]
    width = len(fields[0])
    if with_units and 2 <= n_names < width:
        return all(is_number(word) for word in fields[0])
    whole = all(_WHOLE.fullmatch(word.strip()) for row in fields for word in row)
    return width >= 4 and width % 2 == 0 and whole and all(len(row) == width for row in fields)


def chainage_digits(file: str, first: Line, delimiter: str, column: int | None, unit: str) -> int:
    """Return how many digits follow the plus of stations like 12+345.6, 0 if they are plain."""
    if column is None:
        return 0
    line, text = first
    word = split(text, delimiter)[column]
    found = _CHAINAGE.fullmatch(word)
    if not found:
        return 0
    if CHAINAGE_DIGITS.get(unit) == len(found[2]):
        return CHAINAGE_DIGITS[unit]
    raise refusal(
        file,
        f"the station {quoted(word)} is no chainage in {unit}: expected 12+345.6 with the unit m "
        "(12345.6 m) or 12+34.5 with the unit ft (1234.5 ft): pass the unit, or write stations as "
        "plain numbers",
        line,
    )


def without_plus(field: str, digits: int) -> str:
    """Return a chainage as the digits of a number, 12345.6 for 12+345.6."""
    found = _CHAINAGE.fullmatch(field)
    if found is None or len(found[2]) != digits:
        raise ValueError(field)
    return found[1] + found[2] + found[3]


def odd_mark(field: str, decimal: str) -> str:
    """Say that a number has separated thousands, or the other decimal mark, if it has."""
    word = field.strip()
    if _THOUSANDS.fullmatch(word):
        advice = "write 1234.5 for 1,234.5" if decimal == POINT else "write 1234,5 for 1.234,5"
        return f"thousands separators are not understood, found {quoted(word)}: {advice}"
    if decimal == POINT and _COMMA_NUMBER.fullmatch(word):
        return (
            f"a decimal comma or a separator of thousands in {quoted(word)}, where a decimal point "
            'is expected: pass decimal="," (--decimal ,) if all numbers have decimal commas'
        )
    if decimal == COMMA and POINT in word and is_number(word):
        return (
            f"a decimal point or a separator of thousands in {quoted(word)}, where a decimal comma "
            'is expected: pass decimal="." (--decimal .) if all numbers have decimal points'
        )
    return ""


def checked_delimiter(file: str, mark: str, line: int) -> str:
    """Return the delimiter that a line ``sep=`` states."""
    if mark in DELIMITERS:
        return mark
    known = " ".join(map(repr, DELIMITERS))
    raise refusal(file, f"sep={mark} is no delimiter known here, which are {known}", line)
