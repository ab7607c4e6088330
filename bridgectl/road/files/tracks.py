"""What every format of road files has in common: units, tracks, and what a track must be."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bridgectl._checks import FloatArray
from bridgectl.road.files.lines import ProfileFileError, passing, quoted, refusal
from bridgectl.road.files.missing import UNTOLD, Missing, absent, require_no_marker
from bridgectl.road.limits import MAX_SLOPE, first_too_steep
from bridgectl.road.profile import RoadProfile

UNITS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "ft": 0.3048, "in": 0.0254, "mil": 2.54e-5}
MAX_GAP = 5.0  # [m]; a straight line over more hides bumps that a vehicle would feel
MAX_GAP_STEPS = 100  # but a road at coarse steps may have gaps of this many median steps
STEPS = (0.001, 5.0)  # [m]; a median step outside is a unit mistaken for another
FINEST = 0.0005  # [m]; but lasers that look at texture read so densely
ROUND_OFF = 1e-3  # of a step, as stations far from 0 and rounded ones have
WINDOW = 2**16  # points whose slopes are compared at once

TELL_UNITS = (
    'pass units="m,mm" (station, elevation) in Python or --units m,mm on the command line; known '
    f"units: {', '.join(UNITS)}"
)

Pick = Callable[[Sequence[str]], Sequence[tuple[int, str]]]
"""Given the labels of a file's tracks, returns the number and the name of each one wanted."""


@dataclass(frozen=True)
class Request:
    """What the caller says of a file."""

    units: tuple[str, ...] | None = None
    columns: tuple[int, ...] | None = None
    delimiter: str | None = None
    step: float | None = None
    decimal: str | None = None
    skip_lines: int | None = None
    missing: Missing | None = None
    remarks: list[str] = field(default_factory=list)
    """What the caller is to be warned of, once the file is read."""

    def require_nothing_but_units(self, file: str, kind: str, *but: str) -> None:
        """Refuse arguments that only delimited text can need."""
        text_only = ("columns", "delimiter", "step", "decimal", "skip_lines", "missing")
        names = [n for n in text_only if n not in but and getattr(self, n) is not None]
        if names:
            options = " and ".join(f"{name}= (--{name.replace('_', '-')})" for name in names)
            raise refusal(file, f"{kind} states this itself: leave out {options}")


def known_units(file: str, units: str | Sequence[str] | None) -> tuple[str, ...] | None:
    """Return the names of units passed by a caller, however many."""
    if units is None:
        return None
    names = units.split(",") if isinstance(units, str) else units
    if not isinstance(names, list | tuple) or not all(isinstance(name, str) for name in names):
        raise TypeError(f'units must be a string like "m,mm" or a pair of strings, got {units!r}')
    names = [name.strip() for name in names]
    if unknown := [name for name in names if name not in UNITS]:
        raise refusal(file, f"unknown unit {quoted(unknown[0])} in units: {TELL_UNITS}")
    return tuple(names)


def track_names(stem: str, labels: Sequence[str]) -> list[tuple[int, str]]:
    """Return number and name of every track; the only one of a file needs no label."""
    if len(labels) == 1:
        return [(0, stem)]
    return [(i, f"{stem} {label or f'track {i}'}") for i, label in enumerate(labels)]


def track_index(file: str, track: str | int | None, labels: Sequence[str]) -> int:
    """Return the number of the track that a caller asks for by number or label."""
    if track is None:
        return 0
    word = str(track).strip().casefold()
    same = [i for i, label in enumerate(labels) if label.casefold() == word]
    if isinstance(track, str) and word and same:
        if len(same) == 1:
            return same[0]
        numbers = " and ".join(map(str, same))
        raise refusal(file, f"tracks {numbers} are both labelled {quoted(word)}: pass a number")
    if word.isdecimal() and word.isascii() and len(word) < 10 and int(word) < len(labels):
        return int(word)
    fault = f"no track {quoted(str(track))}, there are {listed(labels)}"
    raise refusal(file, f"{fault}: {passing('track')} with one of these")


def listed(labels: Sequence[str], most: int = 20) -> str:
    """Return the tracks by number and label."""
    words = [f"{i}: {quoted(label)}" if label else str(i) for i, label in enumerate(labels[:most])]
    return ", ".join(words) + (", ..." if len(labels) > most else "")


@dataclass(frozen=True)
class Track:
    """The elevations of one track, as a file has them."""

    name: str
    z: FloatArray
    unit: str
    remedy: str
    """What to do if they are too steep."""


def make_roads(
    file: str, x: FloatArray, tracks: Sequence[Track], line: Callable[[int], int], request: Request,
) -> list[RoadProfile]:  # fmt: skip
    """Return the roads of tracks at stations [m], without missing readings.

    Of several tracks, those that miss too many readings are left out, and the caller is told.
    """
    roads, faults = [], []
    for track in tracks:
        rows, told = None, len(request.remarks)
        try:
            rows = _present_rows(file, x, track, line, request)
        except ProfileFileError as fault:
            faults.append(fault)
            request.remarks[told:] = [f"{fault}; {track.name} is left out"]
            continue
        roads.append(_make_road(file, x, track, line, rows, request))
    if not roads:
        raise faults[0]
    return roads


def _present_rows(
    file: str, x: FloatArray, track: Track, line: Callable[[int], int], request: Request
) -> NDArray[np.int_] | None:
    """Return the rows of the readings that are there, None for all of them."""
    if not request.missing or not (gone := absent(track.z, request.missing)).any():
        return None
    kept, first = np.flatnonzero(~gone), line(int(np.argmax(gone)))
    if kept.size < 2:
        fault = f"{track.name}: without the missing readings {kept.size} of {gone.size} are left"
        raise refusal(file, f"{fault}: a road needs two or more", first)
    request.remarks.append(_absence(file, track.name, gone.size - kept.size, first, x[kept]))
    require_no_gap(file, x[kept], lambda row: line(int(kept[row])))
    return kept


def _make_road(
    file: str, x: FloatArray, track: Track, line: Callable[[int], int],
    rows: NDArray[np.int_] | None, request: Request,
) -> RoadProfile:  # fmt: skip
    z = track.z
    if rows is not None:
        x, z = x[rows], z[rows]

    def line_of(row: int) -> int:
        return line(row if rows is None else int(rows[row]))

    require_no_marker(file, z, track.unit, line_of, request.missing or UNTOLD)
    z *= UNITS[track.unit]
    require_gentle_track(file, x, z, line_of, track.unit, track.remedy)
    # Checked already, with the line of the file, and copies would double the memory.
    return RoadProfile._trusted(x, z, track.name)


def _absence(file: str, name: str, n_missing: int, first: int, x: FloatArray) -> str:
    i = int(np.argmax(np.diff(x)))
    readings = "1 missing reading" if n_missing == 1 else f"{n_missing} missing readings"
    return (
        f"{file}: {name}: {readings} left out, the first on line {first}; the widest gap is now "
        f"{x[i + 1] - x[i]:.6g} m, after station {x[i]:.10g} m"
    )


def require_gentle_track(
    file: str, x: FloatArray, z: FloatArray, line: Callable[[int], int | None], unit: str,
    remedy: str,
) -> None:  # fmt: skip
    """Refuse a track steeper than any road, which is often one in another unit."""
    for start in range(0, x.size - 1, WINDOW):  # so that long roads need little memory
        window = slice(start, start + WINDOW + 1)
        if (i := first_too_steep(x[window], z[window])) is None:
            continue
        i += start
        raise refusal(
            file,
            f"the elevation in {unit} changes by {abs(z[i] - z[i - 1]):.6g} m over "
            f"{x[i] - x[i - 1]:.6g} m, steeper than {MAX_SLOPE:g} m/m: {remedy}",
            line(i),
        )


def odd_step(step: float) -> str:
    """Say that a step [m] is none of a road, if so."""
    low, high = STEPS
    if FINEST * (1 - ROUND_OFF) <= step <= high * (1 + ROUND_OFF):
        return ""
    return f"step of {step:.6g} m, expected {low:g} m to {high:g} m"


def widest_gap(x: FloatArray) -> int | None:
    """Return the index of the station after the longest gap, if it is too long for a road."""
    steps = np.diff(x)
    widest = int(np.argmax(steps))
    too_wide = steps[widest] > max(MAX_GAP, MAX_GAP_STEPS * float(np.median(steps)))
    return widest + 1 if too_wide else None


def require_no_gap(file: str, x: FloatArray, line: Callable[[int], int]) -> None:
    """Refuse stations with a gap too long for a road."""
    if (i := widest_gap(x)) is None:
        return
    raise refusal(
        file,
        f"station {x[i]:.10g} m comes {x[i] - x[i - 1]:.6g} m after {x[i - 1]:.10g} m on line "
        f"{line(i - 1)}, where the median step is {float(np.median(np.diff(x))):.4g} m: correct "
        "the station, or cut the file here and read the part before or after the gap",
        line(i),
    )
