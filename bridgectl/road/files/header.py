"""What stands above the numbers of delimited text: the names and units of its columns."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from bridgectl.road.files import lines
from bridgectl.road.files.dialect import checked_delimiter, delimiter_in, is_numeric, separator_line
from bridgectl.road.files.tracks import UNITS, Request

_NUMBER_LIKE = re.compile(r"[+-]?(\.?\d|(nan|inf|infinity)$)", re.IGNORECASE)
_KNOWN = "|".join([*UNITS, r"km\+m"])
_BRACKETED = rf"[\[(]\s*({_KNOWN})\s*[\])]"
_UNIT = re.compile(rf"""(?:{_BRACKETED}|_({_KNOWN}))["']?\s*$""")


@dataclass(frozen=True)
class Header:
    """What one line says of the columns."""

    line: int = 0
    names: tuple[str, ...] = ()
    units: tuple[str | None, ...] = ()

    def unit(self, column: int) -> str | None:
        """Return the unit of a column, if it is stated."""
        return self.units[column] if self.units else None

    def label(self, column: int) -> str:
        """Return the name of a column, "" if it has none."""
        return self.names[column] if self.names else ""

    @property
    def lengths(self) -> tuple[int, ...]:
        """The columns with a unit of length."""
        return tuple(column for column, unit in enumerate(self.units) if unit)


@dataclass(frozen=True)
class Columns:
    """Which columns hold what; no station where the steps are equal and told by the caller."""

    station: int | None
    elevations: tuple[int, ...]

    @property
    def all(self) -> tuple[int, ...]:
        """The station, if any, and the elevations."""
        return self.elevations if self.station is None else (self.station, *self.elevations)


@dataclass(frozen=True)
class Preamble:
    """The lines above the numbers, and the first of those."""

    header: lines.Line | None
    comment: lines.Line | None
    first: lines.Line
    separator: str | None = None
    """The delimiter that a line ``sep=;`` states."""

    @property
    def above(self) -> tuple[lines.Line | None, lines.Line | None]:
        """The lines that may name the columns."""
        return self.header, self.comment


def columns_of(request: Request, stating: Header) -> Columns:
    """Return the columns asked for, or else those that the file gives a unit of length."""
    given = request.columns
    if request.step is not None:
        return Columns(None, given or stating.lengths or (0,))
    if given is not None:
        return Columns(given[0], given[1:])
    return Columns(0, tuple(c for c in stating.lengths if c > 0) or (1,))


def read_preamble(
    file: str, texts: Iterator[str], head: Sequence[str], request: Request
) -> Preamble:
    """Return the lines above the numbers, of which `texts` then has those that follow.

    `head` holds the first lines once more. Lines above one that names the columns and their units
    are passed over, and the caller is told so.
    """
    skipped = request.skip_lines or 0
    separator = None
    numbered = enumerate(texts, 1)
    for line, text in enumerate(head[skipped:], skipped + 1):
        if not lines.is_blank(text):
            if mark := separator_line(text):
                separator, skipped = checked_delimiter(file, mark, line), line
            break
    above = _lines_above(file, head, skipped, separator, request)
    if above > skipped:
        passed = [line for line in lines_after(head, skipped) if line[0] <= above]
        request.remarks.append(
            f"{file}: {len(passed)} line{'s' * (len(passed) > 1)} above the names and units on "
            f"line {above + 1} passed over, the first {lines.quoted(passed[0][1])}: pass "
            f"skip_lines={above} (--skip-lines {above}) if that is right"
        )
    return _classic(file, numbered, above, separator)


def _classic(
    file: str, numbered: Iterator[lines.Line], skipped: int, separator: str | None
) -> Preamble:
    """Return the header, the last comment and the first line of numbers."""
    header: lines.Line | None = None
    comment: lines.Line | None = None
    empty = True
    for line, text in numbered:
        if lines.is_blank(text):
            continue
        empty = False
        if line <= skipped:
            continue
        if lines.is_comment(text):
            comment = (line, text.lstrip().lstrip("".join(lines.COMMENTS)))
        elif header is None and _names_columns(text):
            header = (line, text)
        else:
            return Preamble(header, comment, (line, text), separator)
    fault = "the file is empty: expected lines of" if empty else "no line of numbers: expected a"
    raise lines.refusal(file, f"{fault} station and {'' if empty else 'an '}elevation on each line")


def lines_after(head: Sequence[str], skipped: int) -> Iterator[lines.Line]:
    """Yield those of the first lines after some that are neither blank nor comments."""
    for line, text in enumerate(head[skipped:], skipped + 1):
        if not lines.is_blank(text) and not lines.is_comment(text):
            yield line, text


def _lines_above(
    file: str, head: Sequence[str], skipped: int, separator: str | None, request: Request
) -> int:
    """Return how many lines to pass over: all above one that names columns and their units."""
    kept = list(lines_after(head, skipped))
    for i, (line, text) in enumerate(kept[:-1]):
        if not _names_columns(text):
            continue
        row = kept[i + 1][1]
        delimiter = request.delimiter or separator or delimiter_in(row, request.decimal)
        header = make_header((line, text), len(lines.split(row, delimiter)), delimiter)
        if is_complete(header, request):
            rows = [above for above in kept[:i] if _is_row(above[1], separator, request)]
            if rows and request.units is None:
                fault = f"numbers stand above the names and units on line {line}"
                advice = f"remove them, or {tell_skip_lines(line - 1)}"
                raise lines.refusal(
                    file, f"{fault}, {lines.quoted(rows[0][1])}: {advice}", rows[0][0]
                )
            return skipped if rows or not i else line - 1
    return skipped


def _is_row(text: str, separator: str | None, request: Request) -> bool:
    """Tell whether a line looks like one of numbers, which nobody passes over."""
    delimiter = request.delimiter or separator or delimiter_in(text, request.decimal)
    return sum(map(is_numeric, lines.split(text, delimiter))) >= (2 if request.step is None else 1)


def _names_columns(text: str) -> bool:
    words = re.split(r"[,;\s\"']+", text)
    if not any(map(_NUMBER_LIKE.match, words)):
        return any(c.isalpha() for c in lines.printable(text))
    # A track may be called 2, the stations not.
    first_word = text.lstrip(" \t\"'")
    return re.search(_BRACKETED, text) is not None and not _NUMBER_LIKE.match(first_word)


def headers(
    preamble: Preamble, width: int, delimiter: str, request: Request
) -> tuple[Header, Header]:
    """Return what names the columns and what states their units, often one line.

    A comment counts only if it states what is needed: it may be about anything.
    """
    named, remark = (make_header(line, width, delimiter) for line in preamble.above)
    stating = named
    if not is_complete(named, request) and is_complete(remark, request):
        stating = remark
    return (named if named.names else stating), stating


def make_header(line: lines.Line | None, width: int, delimiter: str) -> Header:
    """Return what a line says of so many columns, nothing if it is not about so many."""
    if line is None:
        return Header()
    ways = (
        lines.split(line[1], delimiter),
        re.split("[,;\t]", line[1]),
        re.findall(r"[^\s\[(]+\s*(?:[\[(][^\])]*[\])])?", line[1]),
    )
    names = next((names for names in ways if len(names) == width), [])
    found = [_UNIT.search(name) for name in names]
    labels = [name[: m.start()] if m else name for name, m in zip(names, found, strict=True)]
    return Header(
        line[0],
        tuple(lines.printable(label.strip(" \t\"'")) for label in labels),
        tuple(m and (m[1] or m[2]).replace("km+m", "m") for m in found),
    )


def is_complete(header: Header, request: Request) -> bool:
    """Tell whether a line states every unit that is needed."""
    columns = columns_of(request, header)
    place = columns.station
    stated = header.lengths
    return any(c in stated for c in columns.elevations) and (place is None or place in stated)


def states_both(header: Header, columns: Columns) -> bool:
    """Tell whether a line states the unit of the stations and of every elevation."""
    return all(column in header.lengths for column in columns.all)


def n_names(line: lines.Line | None) -> int:
    """Return how many names a header has between its commas, semicolons or tabs."""
    return 0 if line is None else len(re.split("[,;\t]", line[1]))


def tell_skip_lines(line: int) -> str:
    """Say how to pass over the lines up to one."""
    return f"{lines.passing('skip_lines')} with {line} or more if the road begins below"
