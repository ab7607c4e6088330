"""Columns that are no elevations: the numbers of points, and stations in the elevations' place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl.road.files.header import Columns
from bridgectl.road.files.lines import ProfileFileError, passing, refusal
from bridgectl.road.files.tracks import UNITS, Track

FEW = 8  # points; fewer may rise evenly by chance
EVEN = 0.2  # stations of one step: no rise differs from the mean one by more than this part of it,
EXACT = 0.01  # and the mean one from the step by no more than this
LABELS = ("", "n", "no", "no.", "nr", "nr.", "#", "i", "id", "idx", "index", "point", "number")


def require_elevations(
    file: str, columns: Columns, values: FloatArray, width: int, step: float | None = None,
    label: str | None = None,
) -> None:  # fmt: skip
    """Refuse columns that nobody chose where they count points or repeat the stations.

    `values`, one row for each of `columns`, are in the units of the file, the `step` in metres,
    and `label` is what a header calls the stations.
    """
    if values.shape[1] < FEW:
        return
    elevation = columns.elevations[0]
    z = values[len(columns.all) - len(columns.elevations)]
    rise = _even_rise(z, EVEN)
    if columns.station is None:
        steps = [1.0, *((step or 0.0) / size for size in UNITS.values())]
        if _is_one_of(rise, steps):
            raise _mistaken(file, elevation, width, ())
        return
    x = values[0]
    counted = bool(x[0] in (0, 1) and np.all(np.diff(x) == 1))
    if counted and label is not None and label.casefold() in LABELS:
        raise _mistaken(file, columns.station, width, (elevation,), elevation)
    repeated = _is_one_of(rise, [1.0, float(np.diff(x).mean())])
    if repeated or (elevation + 1 < width and _even_rise(z, EXACT)):
        first = columns.station if repeated and not counted else elevation
        raise _mistaken(file, elevation, width, (first,))


def require_no_stations(
    file: str, columns: Columns, x: FloatArray, tracks: Sequence[Track], width: int
) -> None:
    """Refuse tracks that rise as the stations [m] do, also where their unit is stated."""
    if columns.station is None or x.size < FEW:
        return
    step = float(np.diff(x).mean())
    for column, track in zip(columns.elevations, tracks, strict=True):
        if _is_one_of(_even_rise(track.z, EVEN) * UNITS[track.unit], [step]):
            raise _mistaken(file, column, width, (columns.station,))


def _even_rise(z: FloatArray, tolerance: float) -> float:
    """Return the mean rise from point to point where all are alike, or else 0."""
    rises = np.diff(z)
    mean = float(rises.mean())
    return abs(mean) if np.all(np.abs(rises - mean) <= tolerance * abs(mean)) else 0.0


def _is_one_of(rise: float, steps: list[float]) -> bool:
    return rise > 0 and any(abs(rise - step) <= EXACT * step for step in steps)


def _mistaken(
    file: str, column: int, width: int, stations: tuple[int, ...], before: int | None = None
) -> ProfileFileError:
    """Return the refusal of a column, with those to pass instead."""
    following = (column if before is None else before) + 1
    fault = f"column {column} (counted from 0) counts the lines or holds stations: "
    if following < width:
        fault += f"{passing_columns((*stations, following))} for those after it, or "
    elif before is not None:
        fault += f"{passing('step')} and {passing_columns((before,))[5:]} if there are none, or "
    kept = (0, 1) if stations else (0,)
    return refusal(file, f"{fault}{passing_columns(kept)} if it is right all the same")


def passing_columns(columns: tuple[int, ...]) -> str:
    """Return what to type to pass columns, in Python and on the command line."""
    given = ", ".join(map(str, columns)) + "," * (len(columns) == 1)
    return f"pass columns=({given}) (--columns {','.join(map(str, columns))})"
