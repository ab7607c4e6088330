"""Write road profiles to files that `read_tracks` reads back: delimited text (CSV) and ERD text."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._files import replacing
from bridgectl._places import SAME_PLACE, even_places
from bridgectl.road.files.erd import FREE_TEXT, LONG_WIDTH, SIGNATURE, WIDTH
from bridgectl.road.files.lines import LARGEST
from bridgectl.road.files.missing import marker_in
from bridgectl.road.files.tracks import odd_step, widest_gap
from bridgectl.road.limits import first_too_steep
from bridgectl.road.profile import RoadProfile

__all__ = ["write_profile"]

BLOCK = 4096  # lines made at once
DIGITS = 17  # significant ones that tell any two floats apart


def write_profile(
    path: str | os.PathLike[str],
    roads: RoadProfile | Sequence[RoadProfile],
    *,
    format: str | None = None,
) -> None:
    """Write one road, or the tracks of one, to a file that `read_tracks` reads back.

    A file that is there is replaced when the new one is complete, and not before.

    Parameters
    ----------
    path : str or path-like
        The file, ``.csv`` or ``.erd``.
    roads : RoadProfile or sequence of RoadProfile
        Tracks with the same stations. Their names become labels; a CSV label has blanks for
        commas, semicolons, double quotes and line breaks, an ERD label 32 characters.
    format : {"csv", "erd"}, optional
        The suffix of `path` if omitted. CSV keeps every digit. So does ERD of the elevations, but
        it holds one step for all stations: they agree within 1e-9 m, or exactly where they are
        ``start + i * step``.

    Raises
    ------
    TypeError, ValueError
        If `roads` are no roads, have different stations, stations at uneven steps (ERD only), or
        stations, slopes or elevations that `read_profile` refuses as those of no road.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> from bridgectl import RoadProfile, read_profile
    >>> road = RoadProfile([-0.1, 0, 0.1], [0, 0.001, 0], name="A1")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_profile(pathlib.Path(folder, "lane.csv"), road)
    ...     print(pathlib.Path(folder, "lane.csv").read_text())
    ...     read_profile(pathlib.Path(folder, "lane.csv")) == road
    x [m],A1 [m]
    -0.1,0.0
    0.0,0.001
    0.1,0.0
    <BLANKLINE>
    True
    """
    tracks = _checked_tracks(roads)
    suffix = Path(path).suffix.lower().removeprefix(".")
    kind = suffix if format is None else check.choice("format", format, tuple(_FORMATS))
    if kind not in _FORMATS:
        raise ValueError(
            f"path must end in .csv or .erd, got {os.fspath(path)!r}: type path='road.csv', or "
            "pass format='csv' or format='erd'"
        )
    with replacing(path) as handle:
        handle.writelines(part.encode() for part in _FORMATS[kind](tracks))


def _csv(tracks: Sequence[RoadProfile]) -> Iterator[str]:
    only = len(tracks) == 1
    labels = [_label(road.name) for road in tracks]
    labels = [label or ("z" if only else f"track {i}") for i, label in enumerate(labels)]
    yield ",".join(f"{label} [m]" for label in ["x", *labels]) + "\n"
    yield from _rows([tracks[0].x, *(road.elevation for road in tracks)], ",")


def _erd(tracks: Sequence[RoadProfile]) -> Iterator[str]:
    x = tracks[0].x
    step = _step(x)
    names = [_label(road.name) for road in tracks]
    yield (
        f"{SIGNATURE}2.00\n{len(tracks)}, {x.size}, -1, 1, {FREE_TEXT}, {step!r}, -1,\n"
        f"TITLE   {', '.join(filter(None, names))[:80]}\n"
        f"SHORTNAM{_cells(names, WIDTH)}\n"
        f"LONGNAME{_cells(names, LONG_WIDTH)}\n"
        f"UNITSNAM{_cells(['m'] * len(tracks), WIDTH)}\n"
        f"XLABEL  Distance\nXUNITS  m\nXSTART  {float(x[0])!r}\nEND\n"
    )
    yield from _rows([road.elevation for road in tracks], " ")


_FORMATS: dict[str, Callable[[Sequence[RoadProfile]], Iterator[str]]] = {"csv": _csv, "erd": _erd}


def _step(x: FloatArray) -> float:
    """Return the one step between stations, with the fewest digits that give them exactly."""
    mean = float(x[-1] - x[0]) / (x.size - 1)
    best, least = mean, np.inf
    for digits in range(1, DIGITS + 1):
        step = float(f"{mean:.{digits}g}")
        error = float(np.abs(even_places(float(x[0]), step, x.size) - x).max())
        if error < least:
            best, least = step, error
        if least == 0:
            break
    if least > SAME_PLACE:
        raise ValueError(
            f"an ERD file holds one step for all stations, but these are up to {least:.3g} m off "
            "even ones: type road.resample(0.1), or write .csv"
        )
    return best


def _label(name: str) -> str:
    """Return a name without what separates the columns or ends the line."""
    kept = (c if c.isprintable() and c not in ',;"' else " " for c in name)
    return " ".join("".join(kept).split()).strip("'")


def _cells(words: Sequence[str], width: int) -> str:
    return "".join(word[:width].ljust(width) for word in words)


def _rows(columns: Sequence[FloatArray], delimiter: str) -> Iterator[str]:
    for start in range(0, columns[0].size, BLOCK):
        block = [map(repr, column[start : start + BLOCK].tolist()) for column in columns]
        yield "\n".join(map(delimiter.join, zip(*block, strict=True))) + "\n"


def _checked_tracks(roads: RoadProfile | Sequence[RoadProfile]) -> Sequence[RoadProfile]:
    tracks = [roads] if isinstance(roads, RoadProfile) else list(roads)
    if not tracks or not all(isinstance(road, RoadProfile) for road in tracks):
        raise TypeError(f"roads must be one RoadProfile or a list of them, got {roads!r}")
    x = tracks[0].x
    if not all(np.array_equal(road.x, x) for road in tracks):
        raise ValueError("roads must have the same stations: type road.resample(0.1) for each")
    if fault := odd_step(float(np.median(np.diff(x)))):
        raise ValueError(f"read_profile would refuse a median {fault}: type road.resample(0.1)")
    if (i := widest_gap(x)) is not None:
        raise ValueError(
            f"read_profile would refuse the gap between {x[i - 1]:.10g} m and {x[i]:.10g} m: "
            "type road.resample(0.1)"
        )
    for road in tracks:
        if first_too_steep(x, road.elevation) is not None:
            raise ValueError("read_profile would refuse a road steeper than 1 m/m: smooth it")
        if (i := marker_in(road.elevation)) is not None:
            raise ValueError(
                f"read_profile would take the elevation {road.elevation[i]:g} m at {x[i]:.10g} m "
                "for the marker of a missing one: leave it out, or shift the road by a millimetre"
            )
        if max(np.abs(x).max(), np.abs(road.elevation).max()) >= LARGEST:
            raise ValueError(f"read_profile would refuse numbers of {LARGEST:g} m and more")
    return tracks
