"""The numbers of a road file: quickly where its lines are plain, carefully where they are not."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import chain, islice

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.road.files.dialect import COMMA, POINT, odd_mark, without_plus
from bridgectl.road.files.lines import (
    LARGEST,
    Line,
    byte_in,
    is_blank,
    is_comment,
    number,
    passing,
    quoted,
    refusal,
    split,
    wrong_separator,
)
from bridgectl.road.files.missing import UNTOLD, Missing, maybe_missing

BLOCK = 4096  # lines converted at once


@dataclass(frozen=True)
class Layout:
    """How the numbers stand on the lines of one file."""

    file: str
    columns: tuple[int, ...]
    """The columns wanted, counted from 0; the others may hold anything."""
    delimiter: str
    width: int
    """How many columns there are."""
    comments: bool = True
    """Whether lines may be comments, and the caller may name the delimiter."""
    decimal: str = POINT
    stations: int = 0
    """How many of the wanted columns, the first ones, hold stations."""
    chainage: int = 0
    """How many digits follow the plus of stations like 12+345.6; 0 for plain ones."""
    missing: Missing = UNTOLD
    """What elevations are missing; they become NaN."""

    def numbers(self, line: int, text: str) -> tuple[float, ...]:
        """Return the wanted numbers of one line, in the units of the file."""
        fields = split(text, self.delimiter)
        if len(fields) == self.width:
            try:
                return tuple(
                    self._number(fields[column], place) for place, column in enumerate(self.columns)
                )
            except ValueError:
                pass
        raise refusal(self.file, self._fault(text, fields), line)

    def _number(self, field: str, place: int) -> float:
        try:
            return number(self._plain_field(field, place))
        except ValueError:
            if place >= self.stations and self.missing.marks(self._pointed(field)):
                return np.nan
            raise

    def _plain_field(self, field: str, place: int) -> str:
        """Return a number of any dialect as `float` understands it."""
        if self.decimal == COMMA and POINT in field:
            raise ValueError(field)
        field = self._pointed(field)
        if self.chainage and place < self.stations:
            field = without_plus(field, self.chainage)
        return field

    def _pointed(self, text: str) -> str:
        return text.replace(COMMA, POINT) if self.decimal == COMMA else text

    def rows(self, line: int, texts: list[str]) -> tuple[NDArray[np.int_], FloatArray]:
        """Return the lines and the numbers, shape (n, columns), of consecutive lines."""
        if (plain := self._plain(texts)) is not None:
            return np.arange(line, line + len(texts)), plain
        kept = [(n, text) for n, text in enumerate(texts, line) if not self._skips(text)]
        lines = np.array([n for n, _ in kept], dtype=np.int_)
        fewer = [text for _, text in kept]
        if 0 < len(fewer) < len(texts) and (plain := self._plain(fewer)) is not None:
            return lines, plain
        values = [self.numbers(n, text) for n, text in kept]
        return lines, np.array(values, dtype=np.float64).reshape(-1, len(self.columns))

    def _skips(self, text: str) -> bool:
        return is_blank(text) or (self.comments and is_comment(text))

    def _plain(self, texts: list[str]) -> FloatArray | None:
        # Faster than `numbers` and stricter: None wherever the two might disagree.
        if not all(texts) or any(map(str.isspace, texts)) or not all(map(str.isascii, texts)):
            return None
        if self.comments and 0 not in self.columns and any(map(is_comment, texts)):
            return None
        try:
            texts = self._plain_texts(texts)
            if self.delimiter == " ":
                table = np.loadtxt(texts, comments=None, ndmin=2)
                fits = table.shape == (len(texts), self.width)
                table = table[:, self.columns] if fits else table
            else:  # columns that are not wanted need not be numbers
                fits = all(text.count(self.delimiter) == self.width - 1 for text in texts)
                table = np.loadtxt(
                    texts, delimiter=self.delimiter, comments=None, ndmin=2, usecols=self.columns
                )
        except (ValueError, IndexError):
            return None
        fits = fits and table.shape == (len(texts), len(self.columns))
        return table if fits and np.all(np.abs(table) < LARGEST) else None

    def _plain_texts(self, texts: list[str]) -> list[str]:
        if self.decimal == COMMA:
            joined = "\n".join(texts)
            if POINT in joined:
                raise ValueError
            texts = joined.replace(COMMA, POINT).split("\n")
        if self.chainage:
            mark = None if self.delimiter == " " else self.delimiter
            rows = [text.split(mark) for text in texts]
            for row in rows:
                row[self.columns[0]] = without_plus(row[self.columns[0]], self.chainage)
            texts = list(map(self.delimiter.join, rows))
        return texts

    def _fault(self, text: str, fields: list[str]) -> str:
        whole = len(fields) == self.width
        for word in (fields[column] for column in self.columns if column < len(fields)):
            if fault := byte_in(word) or (self.comments and whole and odd_mark(word, self.decimal)):
                return fault
        if fault := wrong_separator(self._pointed(text), self.delimiter):
            advised = self.comments and fault.endswith("throughout")
            return f"{fault}, or {passing('delimiter')}" if advised else fault
        if len(fields) != self.width:
            return f"expected {self.width} columns, found {len(fields)}: correct or remove the line"
        place = next(i for i, c in enumerate(self.columns) if not self._holds(fields[c], i))
        column = self.columns[place]
        word = fields[column].strip()
        found = quoted(word) if word else "nothing"
        what = "chainage" if self.chainage and place < self.stations else "finite number"
        fault = f"expected a {what} in column {column} (counted from 0), found {found}"
        comment = ", or begin it with # if it is a comment" if self.comments else ""
        absence = ""
        if place >= self.stations:
            absence = maybe_missing(self._pointed(word), self.missing)
        return f"{fault}: correct or remove the line{comment}{absence}"

    def _holds(self, field: str, place: int) -> bool:
        try:
            self._number(field, place)
        except ValueError:
            return False
        return True


@dataclass
class Table:
    """The columns of a file, and the line that each row stands on."""

    values: FloatArray
    """Shape (columns, rows), in the units of the file."""
    _rows: list[int] = field(default_factory=list)
    _lines: list[int] = field(default_factory=list)

    def line(self, row: int) -> int:
        """Return the line of a row."""
        i = bisect_right(self._rows, row) - 1
        return self._lines[i] + row - self._rows[i]


def read_table(layout: Layout, first: Line, texts: Iterator[str]) -> Table:
    """Read the rest of a file from its first line of numbers on."""
    # The lines are kept as the rows after which they jump: most files have one such row.
    rows, lines, blocks, n_rows = [], [], [], 0
    line, last = first[0], first[0] - 2
    for texts_of_block in _blocks(chain([first[1]], texts)):
        numbered, values = layout.rows(line, texts_of_block)
        jumps = np.flatnonzero(np.diff(numbered, prepend=last) != 1)
        rows += (n_rows + jumps).tolist()
        lines += numbered[jumps].tolist()
        last = int(numbered[-1]) if numbered.size else last
        blocks.append(values)
        n_rows += len(values)
        line += len(texts_of_block)
    return Table(_joined(blocks, len(layout.columns), n_rows), rows, lines)


def _blocks(texts: Iterable[str]) -> Iterator[list[str]]:
    remaining = iter(texts)
    while block := list(islice(remaining, BLOCK)):
        yield block


def _joined(blocks: list[FloatArray], n_columns: int, n_rows: int) -> FloatArray:
    """Return the blocks as columns, shape (columns, rows), and free each on the way."""
    columns = np.empty((n_columns, n_rows))
    while blocks:
        block = blocks.pop()
        columns[:, n_rows - len(block) : n_rows] = block.T
        n_rows -= len(block)
    return columns
