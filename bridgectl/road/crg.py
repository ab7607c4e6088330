"""Read roads from OpenCRG files, through the optional package pyopencrg.

A curved regular grid holds elevations over u along a reference line and v across it, positive to
the left. Each of its long sections, at one v, is a track, and its stations are the u.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from typing import Any, NoReturn

import numpy as np

from .lines import passing, refusal
from .profile import RoadProfile
from .tracks import Pick, Request, listed, odd_step, require_gentle_track

MARK = re.compile(rb"^\$(CT|ROAD_CRG\w*|KD_DEFINITION)\b", re.IGNORECASE | re.MULTILINE)
INSTALL = 'pip install "bridgectl[crg]"'


def read_crg(file: str, request: Request, pick: Pick) -> list[RoadProfile]:
    """Return the tracks wanted of an OpenCRG file."""
    request.require_nothing_but_units(file, "an OpenCRG file")
    if request.units not in (None, ("m",), ("m", "m")):
        raise refusal(file, 'OpenCRG files are in metres: leave out units, or pass units="m,m"')
    grid = _grid(file)
    if grid.mods:
        fault = f"modifiers ($ROAD_CRG_MODS: {', '.join(grid.mods)}) would change the elevations"
        advice = "apply them and save, for example by pyopencrg.convert(..., apply_mods=True)"
        raise refusal(file, f"{fault}: {advice}")
    if fault := odd_step(float(grid.u_inc)):
        raise refusal(file, f"a {fault}: correct REFERENCE_LINE_INCREMENT")
    # Adding 0 makes a zero of -0.
    labels = [f"v={v + 0.0:g}" for v in grid.v]
    elevations = grid.surface_z()
    return [_road(file, grid.u, elevations, i, name, labels) for i, name in pick(labels)]


def _grid(file: str) -> Any:
    try:
        import pyopencrg
    except ImportError:
        fault = f"OpenCRG files need the package pyopencrg: type {INSTALL}"
        raise refusal(file, fault) from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return pyopencrg.read(file)
    except Exception as error:  # of any kind: it parses what may be no OpenCRG file at all
        raise refusal(file, f"pyopencrg cannot read this: {_reason(file, error)}") from None


def _reason(file: str, error: Exception) -> str:
    report = getattr(error, "report", None)
    text = "; ".join(report.errors or report.warnings) if report else str(error)
    text = " ".join(text.replace(f"{file}:", "").split()) or type(error).__name__
    return text if len(text) <= 300 else f"{text[:300]}..."


def _road(
    file: str, u: Any, elevations: Any, i: int, name: str, labels: Sequence[str]
) -> RoadProfile:
    """Return one long section, without the ends where it holds nothing."""
    finite = np.isfinite(elevations[:, i])
    known = np.flatnonzero(finite)
    if known.size < 2:
        _refuse_holes(file, "no elevations", i, labels)
    inside = slice(known[0], known[-1] + 1)
    if not finite[inside].all():
        hole = known[0] + int(np.argmin(finite[inside]))
        _refuse_holes(file, f"no elevation at u = {u[hole]:.10g} m", i, labels)
    x, z = np.array(u[inside], dtype=np.float64), np.array(elevations[inside, i], dtype=np.float64)
    require_gentle_track(file, x, z, lambda row: None, "m", f"correct track {labels[i]}")
    return RoadProfile(x, z, name=name)


def _refuse_holes(file: str, fault: str, i: int, labels: Sequence[str]) -> NoReturn:
    advice = f"{passing('track')} with another of {listed(labels)}"
    raise refusal(file, f"track {labels[i]} has {fault}: {advice}")
