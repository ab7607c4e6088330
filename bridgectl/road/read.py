"""Read road profiles from delimited text.

Nothing about a file is guessed that could change the road: its units are stated in the file or by
the caller, one delimiter holds throughout, and what does not fit is refused with the file, the line
and what to type instead. `_number` and `_Layout.numbers` define what a valid line is.
"""

from __future__ import annotations

import io
import os
import re
import stat
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib import resources
from itertools import chain, islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bridgectl import _checks as check
from bridgectl._checks import FloatArray

from .limits import MAX_SLOPE, first_too_steep, first_unsorted
from .profile import RoadProfile

__all__ = ["ProfileFileError", "read_profile", "utia_road"]

UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "ft": 0.3048, "in": 0.0254, "mil": 2.54e-5}
DELIMITERS = {";": "semicolon", "\t": "tab", ",": "comma", " ": "white space"}
COMMENTS = ("#", "%", "//")
STEPS = (0.001, 5.0)  # [m]; a median step outside is a unit mistaken for another
LARGEST = 1e12  # in any unit; no station or elevation is larger
MAX_BYTES = 2**30  # 1000 km of road at 20 mm steps
BLOCK = 4096  # lines converted at once

_TELL_UNITS = (
    'pass units="m,mm" (station, elevation) in Python or --units m,mm on the command line; known '
    f"units: {', '.join(UNITS)}"
)
_NUMBER_LIKE = re.compile(r"[+-]?(\.?\d|(nan|inf|infinity)$)", re.IGNORECASE)
_DECIMAL_COMMA = re.compile(r"\d,\d+\s*[;\t ]\s*[+-]?\d|(?<![,\s])[;\t ]\s*[+-]?\d+,\d")
_KNOWN = "|".join(UNITS)
_UNIT = re.compile(rf"""(?:[\[(]\s*({_KNOWN})\s*[\])]|_({_KNOWN}))["']?\s*$""")

Line = tuple[int, str]
Units = tuple[str, str]
Columns = tuple[int, int]


class ProfileFileError(ValueError):
    """A road profile file that cannot be read; one line says where, why and what to type."""


def read_profile(
    path: str | os.PathLike[str],
    *,
    units: str | Sequence[str] | None = None,
    columns: Columns = (0, 1),
    delimiter: str | None = None,
    name: str | None = None,
) -> RoadProfile:
    r"""Return the road profile in a text file of stations and elevations.

    Numbers are separated by commas, semicolons, tabs or white space, with a decimal point. Blank
    lines and lines that begin with ``#``, ``%`` or ``//`` are skipped, and one line may name the
    columns before the first numbers. Elevations are positive up; stations increase.

    Parameters
    ----------
    path : str or path-like
        The file: UTF-8 text.
    units : str or pair of str, optional
        Station and elevation unit, ``"m,mm"`` or ``("m", "mm")``, out of m, mm, cm, km, ft, in and
        mil. May be omitted when the line that names the columns, or the last comment before the
        numbers, states them as ``x [m], z [mm]``, ``x (m); z (mm)`` or ``x_m,z_mm``.
    columns : pair of int
        The columns of stations and elevations, counted from 0.
    delimiter : {",", ";", "\t", " "}, optional
        What separates the columns, a blank for any white space. Found from the first line of
        numbers if omitted.
    name : str, optional
        Name of the road; the file name without its suffix if omitted.

    Raises
    ------
    ProfileFileError
        If the file cannot be read as a road profile, whatever is in it.
    TypeError, ValueError
        If an argument is not what is described above.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "lane.csv")
    ...     _ = path.write_text("x [m], z [mm]\n0.0, 0\n0.1, 2\n0.2, 3\n")
    ...     read_profile(path)
    RoadProfile('lane', 3 points, x from 0 m to 0.2 m, elevation from 0 m to 0.003 m, step 0.1 m)
    """
    file = _checked_path(path)
    wanted = _checked_columns(columns)
    asked = _checked_units(file, units)
    if delimiter is not None:
        check.choice("delimiter", delimiter, tuple(DELIMITERS))
    texts = iter(_text(file, _content(file)))
    labels, first = _preamble(file, texts)
    layout = _layout(file, wanted, delimiter, first)
    rows = _rows(layout, first, texts)
    pair = _units(layout, labels, asked)
    return _profile(file, rows, pair, Path(file).stem if name is None else name)


def utia_road() -> RoadProfile:
    """Return a measured road: stations 478 m to 1022 m every 0.25 m, elevations near 583 m.

    It is profile_1.txt of github.com/michalsorel/iri, MIT License, Copyright (c) 2023 Michal Sorel,
    Filip Sroubek (notice beside the data file). It has a grade and an elevation above sea level,
    and stations of its own: `RoadProfile.place_bridge` puts a bridge on it.
    """
    data = resources.files(__package__) / "data" / "utia_profile_1.txt"
    with resources.as_file(data) as path:
        return read_profile(path, units="m,m", name="UTIA road")


@dataclass(frozen=True)
class _Layout:
    """How the numbers stand on the lines of one file."""

    file: str
    columns: Columns
    delimiter: str
    width: int

    def numbers(self, line: int, text: str) -> tuple[float, float]:
        """Return station and elevation of one line, in the units of the file."""
        fields = _split(text, self.delimiter)
        if len(fields) == self.width:
            try:
                return _number(fields[self.columns[0]]), _number(fields[self.columns[1]])
            except ValueError:
                pass
        raise _refusal(self.file, self._fault(text, fields), line)

    def rows(self, line: int, texts: list[str]) -> FloatArray:
        """Return line, station and elevation of consecutive lines, shape (n, 3)."""
        if (plain := self._plain(texts)) is not None:
            return np.column_stack([np.arange(line, line + len(texts)), plain])
        numbered = enumerate(texts, line)
        found = [(n, *self.numbers(n, text)) for n, text in numbered if not _is_note(text)]
        return np.array(found, dtype=np.float64).reshape(-1, 3)

    def _plain(self, texts: list[str]) -> FloatArray | None:
        # Faster than `numbers` and stricter: None wherever the two might disagree.
        if any(map(str.isspace, texts)) or not all(map(str.isascii, texts)):
            return None
        mark = None if self.delimiter == " " else self.delimiter
        try:
            table = np.loadtxt(texts, delimiter=mark, comments=None, ndmin=2)
        except ValueError:
            return None
        valid = table.shape == (len(texts), self.width) and np.all(np.abs(table) < LARGEST)
        return table[:, self.columns] if valid else None

    def _fault(self, text: str, fields: list[str]) -> str:
        if fault := _wrong_separator(text, self.delimiter):
            return fault
        if len(fields) != self.width:
            return f"expected {self.width} columns, found {len(fields)}: correct or remove the line"
        column = next(c for c in self.columns if not _is_number(fields[c]))
        word = fields[column].strip()
        found = _quoted(word) if word else "nothing"
        return (
            f"expected a finite number in column {column} (counted from 0), found {found}: correct "
            "or remove the line, or begin it with # if it is a comment"
        )


def _rows(layout: _Layout, first: Line, texts: Iterator[str]) -> FloatArray:
    line, remaining, blocks = first[0], chain([first[1]], texts), []
    while block := list(islice(remaining, BLOCK)):
        blocks.append(layout.rows(line, block))
        line += len(block)
    return np.concatenate(blocks)


def _preamble(file: str, texts: Iterator[str]) -> tuple[list[Line], Line]:
    """Return the lines that may state the units, and the first line of numbers."""
    header: list[Line] = []
    comment: list[Line] = []
    for line, text in enumerate(texts, 1):
        if _is_note(text):
            comment = comment if text.isspace() else [(line, text.lstrip().lstrip("#%/"))]
        elif not header and _names_columns(text):
            header = [(line, text)]
        else:
            return header + comment, (line, text)
    raise _refusal(file, "no line of numbers: expected a station and an elevation on each line")


def _layout(file: str, columns: Columns, delimiter: str | None, first: Line) -> _Layout:
    line, text = first
    chosen = delimiter or _delimiter_of(text)
    width = len(_split(text, chosen))
    if max(columns) < width:
        return _Layout(file, columns, chosen, width)
    missing = (
        f"column {max(columns)} (counted from 0) does not exist, found {width} separated by "
        f"{DELIMITERS[chosen]} in {_quoted(text)}: pass columns=(station, elevation) or delimiter="
    )
    raise _refusal(file, _wrong_separator(text, chosen) or missing, line)


def _units(layout: _Layout, labels: list[Line], asked: Units | None) -> Units:
    """Return station and elevation unit, as asked for or as the file states them."""
    for line, text in labels:
        stated = _stated_units(text, layout)
        if stated and asked not in (None, stated):
            fault = f"the units stated here are {','.join(stated)}: pass these or correct this line"
            raise _refusal(layout.file, fault, line)
        if stated:
            return stated
    if asked is None:
        raise _refusal(layout.file, f"the file does not state its units: {_TELL_UNITS}")
    return asked


def _stated_units(text: str, layout: _Layout) -> Units | None:
    by_mark = re.split("[,;\t]", text)
    by_space = re.findall(r"[^\s\[(]+\s*(?:[\[(][^\])]*[\])])?", text)
    names = by_mark if len(by_mark) == layout.width else by_space
    if len(names) != layout.width:
        return None
    station, elevation = (_UNIT.search(names[column]) for column in layout.columns)
    if station is None or elevation is None:
        return None
    return station[1] or station[2], elevation[1] or elevation[2]


def _profile(file: str, rows: FloatArray, units: Units, name: str) -> RoadProfile:
    """Convert to metres and refuse what is not a road."""
    lines = rows[:, 0].astype(int)
    x, z = rows[:, 1] * UNITS[units[0]], rows[:, 2] * UNITS[units[1]]
    if x.size < 2:
        raise _refusal(file, "only one line of numbers: a road needs two or more", lines[0])
    if (i := first_unsorted(x)) is not None:
        raise _refusal(file, _disorder(x, i, lines), lines[i])
    step = float(np.median(np.diff(x)))
    if not STEPS[0] <= step <= STEPS[1]:
        raise _refusal(file, _odd_step(step, units))
    if (i := first_too_steep(x, z)) is not None:
        raise _refusal(file, _odd_slope(x, z, i, units), lines[i])
    return RoadProfile(x, z, name=name)


def _disorder(x: FloatArray, i: int, lines: NDArray[np.int_]) -> str:
    here, before = f"station {x[i]:.10g} m", f"{x[i - 1]:.10g} m on line {lines[i - 1]}"
    if x[i] == x[i - 1]:
        return f"{here} repeats {before}: remove one of the two lines"
    if np.all(x[1:] < x[:-1]):
        return f"{here} lies before {before}, and so on: reverse the order of the lines"
    return f"{here} lies before {before}: sort the lines by station"


def _odd_step(step: float, units: Units) -> str:
    low, high = STEPS
    sizes = {unit: step / UNITS[units[0]] * UNITS[unit] for unit in UNITS}
    fitting = [f"{unit} ({size:.3g} m)" for unit, size in sizes.items() if low <= size <= high]
    return (
        f"the stations in {units[0]} have a median step of {step:.6g} m, expected {low:g} m to "
        f'{high:g} m: pass units="UNIT,{units[1]}" with the unit they are in, which may be '
        f"{' or '.join(fitting) or 'none: then pass columns=(station, elevation)'}"
    )


def _odd_slope(x: FloatArray, z: FloatArray, i: int, units: Units) -> str:
    finer = "mm" if UNITS[units[1]] > UNITS["mm"] else "mil"
    return (
        f"the elevation in {units[1]} changes by {abs(z[i] - z[i - 1]):.6g} m over "
        f"{x[i] - x[i - 1]:.6g} m, steeper than {MAX_SLOPE:g} m/m: correct it, or if the "
        f'elevations are in {finer}, pass units="{units[0]},{finer}"'
    )


def _checked_path(path: str | os.PathLike[str]) -> str:
    if isinstance(path, str | os.PathLike) and isinstance(file := os.fspath(path), str):
        return file
    raise TypeError(f'path must be a string or a Path, got {path!r}: type path="road.csv"')


def _checked_columns(columns: Columns) -> Columns:
    if not isinstance(columns, Sequence) or len(columns) != 2 or columns[0] == columns[1]:
        raise ValueError(f"columns must be two different numbers like (0, 1), got {columns!r}")
    station, elevation = (check.integer("columns", column, at_least=0) for column in columns)
    return station, elevation


def _checked_units(file: str, units: str | Sequence[str] | None) -> Units | None:
    if units is None:
        return None
    names = units.split(",") if isinstance(units, str) else units
    if not isinstance(names, list | tuple) or not all(isinstance(name, str) for name in names):
        raise TypeError(f'units must be a string like "m,mm" or a pair of strings, got {units!r}')
    names = [name.strip() for name in names]
    if unknown := [name for name in names if name not in UNITS]:
        raise _refusal(file, f"unknown unit {_quoted(unknown[0])} in units: {_TELL_UNITS}")
    if len(names) != 2:
        raise _refusal(file, f"units must name two units, got {len(names)}: {_TELL_UNITS}")
    return names[0], names[1]


def _content(file: str) -> bytes:
    try:
        status = os.stat(file)
        if stat.S_ISREG(status.st_mode) and status.st_size <= MAX_BYTES:
            return Path(file).read_bytes()
        fault = f"expected a file of at most {MAX_BYTES >> 20} MiB: save the profile in one"
        if stat.S_ISDIR(status.st_mode):
            fault = "this is a folder: type the name of a file in it"
    except FileNotFoundError:
        fault = "no such file: check the name and the folder"
    except PermissionError:
        fault = "permission denied: make the file readable, for example with chmod u+r"
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        fault = f"cannot be opened ({getattr(error, 'strerror', None) or error}): check the name"
    raise _refusal(file, fault)


def _text(file: str, data: bytes) -> Iterable[str]:
    """Return the lines of a file of text, or say why it is not one."""
    if not data or data.isspace():
        raise _refusal(file, "the file is empty: expected lines of station and elevation")
    try:
        data.replace(b"\0", b"\xff").decode("utf-8")  # no text holds either byte
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        fault = f"the byte 0x{data[error.start]:02x} is not text: save the file as UTF-8 text (csv)"
        raise _refusal(file, fault, line) from None
    return io.TextIOWrapper(io.BytesIO(data), encoding="utf-8-sig")


def _delimiter_of(text: str) -> str:
    return next((mark for mark in DELIMITERS if mark in text.strip()), " ")


def _split(text: str, delimiter: str) -> list[str]:
    return text.split() if delimiter == " " else text.split(delimiter)


def _number(field: str) -> float:
    """Return the number in a field: the one definition of what counts as one."""
    value = float(field)
    # float() also takes 1_000 and the digits of every alphabet; the comparison refuses NaN.
    if "_" in field or not field.isascii() or not -LARGEST < value < LARGEST:
        raise ValueError(field)
    return value


def _is_number(field: str) -> bool:
    try:
        _number(field)
    except ValueError:
        return False
    return True


def _is_note(text: str) -> bool:
    return text.isspace() or text.lstrip().startswith(COMMENTS)


def _names_columns(text: str) -> bool:
    words = re.split(r"[,;\s\"']+", text)
    return any(c.isalpha() for c in text) and not any(map(_NUMBER_LIKE.match, words))


def _wrong_separator(text: str, delimiter: str) -> str:
    if _DECIMAL_COMMA.search(text):
        return f"decimal commas are not understood, found {_quoted(text)}: write 0.25 for 0,25"
    other = _delimiter_of(text)
    parts = _split(text, other)
    if other == delimiter or len(parts) < 2 or not all(map(_is_number, parts)):
        return ""
    expected, found = DELIMITERS[delimiter], DELIMITERS[other]
    return f"expected {expected}, found {found}: use one delimiter throughout, or pass delimiter="


def _quoted(text: str) -> str:
    shown = _printable(text.strip())
    return f"'{shown}'" if len(shown) <= 40 else f"'{shown[:40]}...'"


def _printable(text: str) -> str:
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def _refusal(file: str, fault: str, line: int | None = None) -> ProfileFileError:
    place = file if line is None else f"{file}:{line}"
    return ProfileFileError(_printable(f"{place}: {fault}"))
