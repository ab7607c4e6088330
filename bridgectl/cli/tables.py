"""What the command line prints: tables for people, JSON for programs."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_smoothness
from bridgectl._tables import make_console, make_table
from bridgectl._version import __version__
from bridgectl.paper.printed import PaperResults
from bridgectl.road import RoadProfile
from bridgectl.road.iri import BASE, GOOD
from bridgectl.road.limits import evenly_spaced, mean_step
from bridgectl.road.psd import PsdFit
from bridgectl.road.sampling import too_coarse

MOST_SEGMENTS = 200
"""How many segments of a road are listed."""


@dataclass(frozen=True)
class TrackMeasures:
    """What `bridgectl profile` measures of one track; the numbers that its length allows."""

    road: RoadProfile
    iri: float
    segments: FloatArray
    fit: PsdFit | None

    @property
    def step(self) -> float:
        """Distance between the stations that were measured [m]."""
        return max(mean_step(self.road.x), self.road.measured_step)

    @property
    def good(self) -> bool | None:
        """Whether the road is good in the paper's sense; None if it is too coarse to tell."""
        return None if too_coarse(self.step) else self.iri < GOOD

    @property
    def verdict(self) -> str:
        """`good` in words."""
        return {None: "coarse", True: "good", False: "not good"}[self.good]


def measure_track(road: RoadProfile, segment: float) -> TrackMeasures:
    """Measure a track; of uneven stations, at even ones no farther apart than 0.25 m.

    A track that was measured too coarsely has no class.
    """
    if not evenly_spaced(road.x):
        step = min(float(np.median(np.diff(road.x))), BASE)
        warnings.warn(
            f"{road.name}: the stations are unevenly spaced: measured after interpolation every "
            f"{step:.6g} m",
            UserWarning,
            stacklevel=2,
        )
        road = road.resample(step)
    whole = road.x[-1] - road.x[0] + mean_step(road.x) / 2  # as `RoadProfile.iri` rounds
    segments = road.iri(segment) if whole >= check.positive("segment", segment) else np.array([])
    track = TrackMeasures(road, road.iri(), segments, None)
    if track.good is None:
        return track
    judge_smoothness(road.name, track.iri)
    try:
        fit = road.psd().fit()
    except ValueError:  # too short for a line
        return track
    return replace(track, fit=fit)


def print_profile(tracks: Sequence[TrackMeasures], segment: float) -> None:
    """Print what was measured of every track, and the IRI of its segments."""
    console = make_console()
    columns = ["track", "from [m]", "to [m]", "step [m]", "IRI [m/km]", "", "class",
               "G_d [1e-6 m3]", "waviness"]  # fmt: skip
    table = make_table("Roughness; G_d at 0.1 cycles/m", columns, ["track", "", "class"])
    for track in tracks:
        road, fit = track.road, track.fit
        spectrum = ["-"] * 3
        if fit is not None:
            spectrum = [fit.iso_class, f"{1e6 * fit.roughness:.3g}", f"{fit.waviness:.2f}"]
        table.add_row(
            road.name, f"{road.x[0]:.6g}", f"{road.x[-1]:.6g}", f"{mean_step(road.x):.5g}",
            f"{track.iri:.3f}", track.verdict, *spectrum,
        )  # fmt: skip
    console.print(table)
    longest = max(tracks, key=lambda track: track.segments.size)
    if longest.segments.size < 2:
        return
    names = [track.road.name for track in tracks]
    table = make_table(f"IRI [m/km] of each {segment:g} m", ["from [m]", "to [m]", *names])
    for i in range(min(longest.segments.size, MOST_SEGMENTS)):
        start = longest.road.x[0] + i * segment
        cells = [f"{t.segments[i]:.3f}" if i < t.segments.size else "-" for t in tracks]
        table.add_row(f"{start:.6g}", f"{start + segment:.6g}", *cells)
    console.print(table)
    if (more := longest.segments.size - MOST_SEGMENTS) > 0:
        console.print(f"... and {more} more; --json has all")


def profile_json(tracks: Sequence[TrackMeasures], segment: float) -> dict[str, Any]:
    """Give what was measured of every track, with units in the keys."""
    return {
        "bridgectl": __version__,
        "segment_m": segment,
        "tracks": [
            {
                "name": track.road.name, "from_m": float(track.road.x[0]),
                "to_m": float(track.road.x[-1]), "points": track.road.x.size,
                "measured_step_m": track.step, "iri_m_per_km": track.iri, "good": track.good,
                "segment_iri_m_per_km": track.segments.tolist(),
                "iso_class": track.fit and track.fit.iso_class,
                "roughness_m3": track.fit and track.fit.roughness,
                "waviness": track.fit and track.fit.waviness,
            }
            for track in tracks
        ],
    }  # fmt: skip


def paper_json(results: PaperResults) -> dict[str, Any]:
    """Give the paper's numbers and the computed ones."""
    return {
        "bridgectl": __version__,
        "results": [{**row._asdict(), "difference": row.difference} for row in results.rows],
        "smooth_road": [{"speed_km_per_h": kmh, "daf": value} for kmh, value in results.smooth_daf],
    }


def print_paper(results: PaperResults) -> None:
    """Print the paper's numbers beside the computed ones, and Fig. 2."""
    console = make_console()
    title = "Li, OBrien and Gonzalez (2006), printed and computed"
    columns = ["what", "printed", "computed", "difference", "note"]
    table = make_table(title, columns, ["what", "note"])
    for row in results.rows:
        digits = {"km/h": 0, "x/l": 3}.get(row.unit, 5)
        unit = f" {row.unit}" if row.unit else ""
        printed = "-" if row.printed is None else f"{row.printed:g}{unit}"
        difference = "-" if row.difference is None else f"{row.difference:+.{digits}f}"
        table.add_row(row.what, printed, f"{row.computed:.{digits}f}{unit}", difference, row.note)
    console.print(table)
    table = make_table("Fig. 2: DAF of a smooth road, computed", ["speed [km/h]", "DAF"])
    for kmh, value in results.smooth_daf:
        table.add_row(f"{kmh:g}", f"{value:.5f}")
    console.print(table)
