"""Read roads from ERD files, the text that inertial profilers write (Sayers, UMTRI-87-2).

The first line is ``ERDFILEV2.00``, the second counts channels and samples, lines of a keyword of
eight characters and its text follow up to ``END``, and then one line of numbers for each sample.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from bridgectl._places import even_places
from bridgectl.road.files import tracks
from bridgectl.road.files.lines import (
    Line,
    delimiter_of,
    is_blank,
    number,
    printable,
    quoted,
    refusal,
    split,
)
from bridgectl.road.files.missing import UNTOLD
from bridgectl.road.files.table import Layout, Table, read_table
from bridgectl.road.profile import RoadProfile

SIGNATURE = "ERDFILEV"
WIDTH = 8  # characters of a keyword, and of each channel's short name and unit
LONG_WIDTH = 32  # characters of each channel's long name
FREE_TEXT = 5  # the KEYNUM of numbers as text, separated by blanks or commas
COUNTS = ("NCHAN", "NSAMP", "NRECS", "NBYTES", "KEYNUM", "STEP")
KEPT = ("SHORTNAM", "LONGNAME", "UNITSNAM", "XUNITS", "XSTART")

# What channels beside the elevations measure: slopes, speeds, accelerations, time, angles.
_NO_LENGTH = re.compile(
    r".*[/%^*'].*|deg.*|[cfgsv]|ms|sec|rad|hz|mph|kph|k?n|lbs?|psi|k?pa|volts?|-|none",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class _Header:
    """The lines of a file up to END."""

    file: str
    counts: Line
    fields: dict[str, Line]
    last: int
    """The line of END."""

    def count(self, name: str) -> float:
        """Return a number of the second line."""
        line, text = self.counts
        words = re.split(r"\s*,\s*|\s+", text.strip())
        try:
            return number(words[COUNTS.index(name)])
        except (ValueError, IndexError):
            fault = f"expected numbers for {', '.join(COUNTS)}, found {quoted(text)}"
            raise refusal(self.file, f"{fault}: correct the line", line) from None

    def whole(self, name: str, at_least: int) -> int:
        """Return a whole number of the second line."""
        value = self.count(name)
        if value == int(value) and value >= at_least:
            return int(value)
        fault = f"{name} must be a whole number of at least {at_least}, found {value:g}"
        raise refusal(self.file, f"{fault}: correct the line", self.counts[0])

    def part(self, name: str, channel: int, width: int = WIDTH) -> str:
        """Return what a line of the header says of one channel, if anything."""
        text = self.fields.get(name, (0, ""))[1]
        return text[width * channel : width * (channel + 1)].strip()

    def unit(self, name: str, channel: int = 0) -> str:
        """Return a unit, "" if none is stated; old files have capitals."""
        word = self.part(name, channel)
        unit = word.lower()
        if not word or unit in tracks.UNITS or (name == "UNITSNAM" and _NO_LENGTH.fullmatch(word)):
            return unit
        fault = f"unknown unit {quoted(word)} in {name}, known units: {', '.join(tracks.UNITS)}"
        raise refusal(self.file, f"{fault}: correct the line", self.fields[name][0])

    def label(self, channel: int) -> str:
        """Return the name of a channel."""
        long_name = self.part("LONGNAME", channel, LONG_WIDTH)
        return printable(long_name or self.part("SHORTNAM", channel))


def read_erd(
    file: str, texts: Iterator[str], request: tracks.Request, pick: tracks.Pick
) -> list[RoadProfile]:
    """Return the tracks wanted of an ERD file."""
    request.require_nothing_but_units(file, "an ERD file", "missing")
    header = _header(file, texts)
    n_channels, n_samples = header.whole("NCHAN", 1), header.whole("NSAMP", 2)
    first = _first_row(header, n_channels, texts)
    channels = _channels(header, n_channels)
    station, elevations = _units(header, channels, request)
    origin, step = _stations(header, station)
    picked = pick([header.label(channel) for channel in channels])
    wanted = tuple(channels[i] for i, _ in picked)
    mark = delimiter_of(first[1])
    missing = request.missing or UNTOLD
    layout = Layout(file, wanted, mark, n_channels, comments=False, missing=missing)
    table = read_table(layout, first, texts)
    _require_all(header, table, n_samples)
    x = even_places(origin, step, n_samples)
    remedy = "correct it, or the unit in UNITSNAM or XUNITS"
    found = [
        tracks.Track(name, z, elevations[i], remedy)
        for z, (i, name) in zip(table.values, picked, strict=True)
    ]
    return tracks.make_roads(file, x, found, table.line, request)


def _header(file: str, texts: Iterator[str]) -> _Header:
    next(texts)
    counts = (2, next(texts, ""))
    fields: dict[str, Line] = {}
    header = _Header(file, counts, fields, 2)
    if header.count("KEYNUM") != FREE_TEXT:
        fault = f"KEYNUM {header.count('KEYNUM'):g} says that the numbers of this ERD file are"
        advice = f"export it as ERD text (KEYNUM {FREE_TEXT}) or CSV"
        raise refusal(file, f"{fault} binary or of fixed format: {advice}", 2)
    line = 2
    for line, text in enumerate(texts, 3):
        name = text[:WIDTH].strip().upper()
        if name == "END":
            return _Header(file, counts, fields, line)
        if name in fields:
            fault = f"{name} repeats line {fields[name][0]}: remove one of the two lines"
            raise refusal(file, fault, line)
        if name in KEPT:
            fields[name] = (line, text[WIDTH:])
    raise refusal(file, "the header has no line END: the file is cut short, copy it again", line)


def _first_row(header: _Header, n_channels: int, texts: Iterator[str]) -> Line:
    """Return the first line of numbers, which must be one for each channel."""
    for line, text in enumerate(texts, header.last + 1):
        if is_blank(text):
            continue
        found = len(split(text, delimiter_of(text)))
        if found == n_channels:
            return line, text
        fault = f"expected NCHAN = {n_channels} numbers (line 2), found {found}"
        raise refusal(header.file, f"{fault}: correct line 2 or the numbers", line)
    raise refusal(header.file, "no numbers follow END: the file is cut short, copy it again")


def _channels(header: _Header, n_channels: int) -> list[int]:
    """Return the channels that hold lengths: those are elevations."""
    units = [header.unit("UNITSNAM", channel) for channel in range(n_channels)]
    lengths = [channel for channel, unit in enumerate(units) if unit in tracks.UNITS or not unit]
    if not lengths:
        fault = f"no channel is an elevation, the units are {', '.join(map(quoted, units[:10]))}"
        advice = f"expected one in {', '.join(tracks.UNITS)}"
        raise refusal(header.file, f"{fault}: {advice}", header.fields["UNITSNAM"][0])
    return lengths


def _units(header: _Header, channels: list[int], request: tracks.Request) -> tuple[str, list[str]]:
    """Return the unit of the stations and of each elevation, stated or asked for."""
    asked = request.units or ("", "")
    if len(asked) > 2:
        fault = f"units must name two units, got {len(asked)}"
        raise refusal(header.file, f"{fault}: {tracks.TELL_UNITS}")
    stations = [_agreed(header, "XUNITS", 0, asked[0] if len(asked) == 2 else "")]
    return stations[0], [_agreed(header, "UNITSNAM", c, asked[-1]) for c in channels]


def _agreed(header: _Header, name: str, channel: int, asked: str) -> str:
    stated = header.unit(name, channel)
    if stated and asked and stated != asked:
        fault = f"the unit stated here is {stated}, not {asked}: pass {stated} or correct this line"
        raise refusal(header.file, fault, header.fields[name][0])
    if not (stated or asked):
        fault = f"the file does not state its units in {name}: {tracks.TELL_UNITS}"
        raise refusal(header.file, fault)
    return stated or asked


def _stations(header: _Header, unit: str) -> tuple[float, float]:
    """Return the first station and the step between stations [m]."""
    step = header.count("STEP") * tracks.UNITS[unit]
    if fault := tracks.odd_step(step):
        raise refusal(header.file, f"a {fault}: correct STEP or XUNITS", header.counts[0])
    line, text = header.fields.get("XSTART", (0, "0"))
    try:
        return number(text) * tracks.UNITS[unit], step
    except ValueError:
        fault = f"expected a number in XSTART, found {quoted(text)}: correct or remove the line"
        raise refusal(header.file, fault, line) from None


def _require_all(header: _Header, table: Table, n_samples: int) -> None:
    found = table.values.shape[1]
    if found > n_samples:
        fault = f"more than the {n_samples} samples (NSAMP) of line 2"
        raise refusal(header.file, f"{fault}: correct line 2 or remove them", table.line(n_samples))
    if found < n_samples:
        fault = f"{found} samples end here, line 2 has {n_samples} (NSAMP)"
        advice = "the file is cut short, copy it again"
        raise refusal(header.file, f"{fault}: {advice}", table.line(found - 1))
