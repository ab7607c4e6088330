"""Read roads from OpenCRG files, through the optional package pyopencrg.

A curved regular grid holds elevations over u along a reference line and v across it, positive to
the left. Each of its long sections, at one v, is a track, and its stations are the u.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._warn import warn
from bridgectl.road.files.lines import passing, refusal
from bridgectl.road.files.tracks import Pick, Request, listed, odd_step, require_gentle_track
from bridgectl.road.profile import RoadProfile

MARK = re.compile(rb"^\$(CT|ROAD_CRG\w*|KD_DEFINITION)\b", re.IGNORECASE | re.MULTILINE)
DOUBTFUL = re.compile("cannot read|header")
"""Notes of pyopencrg that leave the stations or the elevations in doubt."""

INSTALL = 'pip install "bridgectl[crg]"'

NO_CHANGE = {
    "scale_z_grid": 1.0, "scale_slope": 1.0, "scale_banking": 1.0, "scale_length": 1.0,
    "scale_width": 1.0, "refline_offset_z": 0.0, "refpoint_z": 0.0,
}  # fmt: skip
"""Modifiers that change elevations or their places, unless they have these values.

The others bend and move the reference line in the plane, which leaves the elevations over u as they
are, or fill holes of the grid, which are no measurement and stay holes here.
"""


def read_crg(file: str, request: Request, pick: Pick) -> list[RoadProfile]:
    """Return the tracks wanted of an OpenCRG file, those without holes if there are several."""
    request.require_nothing_but_units(file, "an OpenCRG file")
    if request.units not in (None, ("m",), ("m", "m")):
        raise refusal(file, 'OpenCRG files are in metres: leave out units, or pass units="m,m"')
    grid = _grid(file)
    mods = grid.mods or {}
    if changing := [name for name, value in mods.items() if value != NO_CHANGE.get(name, value)]:
        fault = f"modifiers ($ROAD_CRG_MODS: {', '.join(changing)}) would change the elevations"
        advice = "apply them and save, for example by pyopencrg.convert(..., apply_mods=True)"
        raise refusal(file, f"{fault}: {advice}")
    if fault := odd_step(float(grid.u_inc)):
        raise refusal(file, f"a {fault}: correct REFERENCE_LINE_INCREMENT")
    # Adding 0 makes a zero of -0.
    labels = [f"v={v + 0.0:g}" for v in grid.v]
    elevations = grid.surface_z()
    faults = [_fault(grid.u, z) for z in elevations.T]
    wanted = pick(labels)
    whole = [(i, name) for i, name in wanted if not faults[i]]
    if not whole:
        raise refusal(file, _no_track(wanted[0][0], faults, labels))
    if left := [f"track {labels[i]} has {faults[i]}" for i, _ in wanted if faults[i]]:
        warn(f"{file}: left out {len(left)} of {len(wanted)} tracks with holes: {left[0]}")
    return [_road(file, grid.u, elevations[:, i], name, labels[i]) for i, name in whole]


def _grid(file: str) -> Any:
    try:
        import pyopencrg
    except ImportError:
        fault = f"OpenCRG files need the package pyopencrg: type {INSTALL}"
        raise refusal(file, fault) from None
    try:
        with warnings.catch_warnings(action="ignore", category=pyopencrg.CrgCheckWarning):
            grid = pyopencrg.read(file)
            notes = grid.check().warnings
    except Exception as error:  # of any kind: it parses what may be no OpenCRG file at all
        raise refusal(file, f"pyopencrg cannot read this: {_reason(file, error)}") from None
    if doubts := list(filter(DOUBTFUL.search, notes)):
        raise refusal(file, f"pyopencrg cannot read this: {_short('; '.join(doubts))}")
    # Holes matter only in the tracks that are wanted, and are told of there.
    if notes := [note for note in notes if "NaN" not in note]:
        warn(f"{file}: pyopencrg notes: {_short('; '.join(notes))}")
    return grid


def _reason(file: str, error: Exception) -> str:
    report = getattr(error, "report", None)
    text = "; ".join(report.errors or report.warnings) if report else str(error)
    return _short(text.replace(f"{file}:", "")) or type(error).__name__


def _short(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= 300 else f"{text[:300]}..."


def _fault(u: FloatArray, z: FloatArray) -> str:
    """Say what one long section lacks, if anything, but for its ends where it holds nothing."""
    finite = np.isfinite(z)
    known = _known(z)
    if known.stop - known.start < 2:
        return "no elevations"
    if finite[known].all():
        return ""
    return f"no elevation at u = {u[known.start + int(np.argmin(finite[known]))]:.10g} m"


def _known(z: FloatArray) -> slice:
    """Return where a long section begins and ends to hold elevations."""
    known = np.flatnonzero(np.isfinite(z))
    return slice(known[0], known[-1] + 1) if known.size else slice(0, 0)


def _no_track(i: int, faults: Sequence[str], labels: Sequence[str]) -> str:
    """Say that a track has holes, and what to do."""
    fault = f"track {labels[i]} has {faults[i]}"
    if all(faults):
        others = ", and no other track is whole" if len(faults) > 1 else ""
        return f"{fault}{others}: fill the holes and save, for example by fill_holes of pyopencrg"
    return f"{fault}: {passing('track')} with another of {listed(labels)}"


def _road(file: str, u: FloatArray, z: FloatArray, name: str, label: str) -> RoadProfile:
    """Return one long section, without the ends where it holds nothing."""
    known = _known(z)
    x, heights = np.array(u[known], dtype=np.float64), np.array(z[known], dtype=np.float64)
    require_gentle_track(file, x, heights, lambda row: None, "m", f"correct track {label}")
    return RoadProfile._trusted(x, heights, name)
