"""What the command line prints: tables for people, JSON for programs."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_smoothness
from bridgectl._tables import make_console, make_table
from bridgectl._units import to_kmh
from bridgectl._version import __version__
from bridgectl.model.beam import Beam
from bridgectl.model.quarter_car import QuarterCar
from bridgectl.paper.printed import PaperResults
from bridgectl.road import RoadProfile
from bridgectl.road.iri import BASE, GOOD
from bridgectl.road.limits import evenly_spaced, mean_step
from bridgectl.road.psd import PsdFit
from bridgectl.road.sampling import too_coarse
from bridgectl.surface.surface import RampSurface

SHOWN_KMH = 10
"""The speeds of the printed table are multiples of this [km/h]."""

LARGEST = 10
"""How many ramps are listed."""

MOST_SEGMENTS = 200
"""How many segments of a road are listed."""


@dataclass(frozen=True)
class DaeStudy:
    """What `bridgectl dae` computes: a road, a surface, and the amplification at its speeds."""

    surface: RampSurface
    vehicle: QuarterCar
    road: RoadProfile
    station: float
    dae: FloatArray
    superposed: FloatArray
    simulated: FloatArray

    @property
    def critical(self) -> int:
        """Index of the speed of the largest simulated DAF."""
        return int(np.argmax(self.simulated))

    def largest(self) -> list[tuple[float, float, float]]:
        """Start [m], rise [m] and contribution of the largest ramps at the critical speed."""
        parts = self.surface.contributions(self.road)[self.critical]
        rises = -self.surface.ramps(self.road) * self.surface.ramp_height
        order = np.argsort(-np.abs(parts), kind="stable")[:LARGEST]
        return [(float(self.surface.positions[i]), float(rises[i]), float(parts[i])) for i in order]


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


def print_dae(study: DaeStudy) -> None:
    """Print the amplification by speed, the critical speed, and the largest ramps."""
    surface, console = study.surface, make_console()
    kmh, critical = to_kmh(surface.speeds), study.critical
    console.print(_dae_heading(study))
    columns = ["speed [km/h]", "DAF smooth", "DAE", "superposed DAF", "simulated DAF", "DAE error"]
    table = make_table("Dynamic amplification by speed", columns)
    shown = np.isclose(kmh % SHOWN_KMH, 0, atol=1e-6) | np.isclose(kmh % SHOWN_KMH, SHOWN_KMH)
    shown |= len(kmh) <= 2 * SHOWN_KMH
    for i in range(len(kmh)):
        if shown[i] or i == critical:
            row = [surface.daf_smooth[i], study.dae[i], study.superposed[i], study.simulated[i]]
            cells = [f"{value:.4f}" for value in row] + [f"{row[1] - row[3]:+.4f}"]
            mark = " <" if i == critical else "  "
            table.add_row(f"{kmh[i]:g}{mark}", *cells, style="bold" if i == critical else None)
    console.print(table)
    worst = int(np.argmax(np.abs(study.dae - study.simulated)))
    smooth = int(np.argmax(surface.daf_smooth))
    estimate = int(np.argmax(study.dae))
    console.print(
        f"Critical speed: {kmh[critical]:g} km/h, DAF {study.simulated[critical]:.4f} "
        f"(smooth road: {kmh[smooth]:g} km/h, {surface.daf_smooth[smooth]:.4f}).\n"
        f"Largest DAE: {study.dae[estimate]:.4f} at {kmh[estimate]:g} km/h. The DAE is an "
        f"estimate: it is furthest off, by {study.dae[worst] - study.simulated[worst]:+.4f}, at "
        f"{kmh[worst]:g} km/h.\n",
        soft_wrap=True,
    )
    title = f"The {LARGEST} ramps that contribute most at {kmh[critical]:g} km/h"
    table = make_table(title, ["from x [m]", "x / l", "rise [mm]", "contribution to DAE"])
    for x, rise, part in study.largest():
        place = f"{x / surface.beam.length:.3f}"
        table.add_row(f"{x:.1f}", place, f"{rise * 1e3:+.2f}", f"{part:+.5f}")
    console.print(table)


def _dae_heading(study: DaeStudy) -> str:
    surface, road = study.surface, study.road
    return (
        f"Road: {road.name or 'unnamed'}, bridge from station {study.station:g} m, "
        f"{surface.approach:g} m of approach, in ramps of {surface.ramp_length * 1e3:g} mm\n"
        f"Bridge: {surface.beam!r}\nVehicle: {surface.vehicle!r}\n"
    )


def dae_json(study: DaeStudy) -> dict[str, Any]:
    """Give everything of a study, at every speed, with units in the keys."""
    surface, vehicle = study.surface, study.vehicle
    beam = cast(Beam, surface.beam)  # the command line has no other bridges
    critical = study.critical
    return {
        "bridgectl": __version__,
        "road": {"name": study.road.name, "bridge_station_m": study.station,
                 "approach_m": surface.approach},
        "bridge": {"length_m": beam.length, "mass_per_length_kg_per_m": beam.mass_per_length,
                   "flexural_rigidity_N_m2": beam.flexural_rigidity, "n_modes": beam.n_modes,
                   "damping_ratio": beam.damping_ratio, "section": surface.section,
                   "recovery": surface.recovery},
        "vehicle": {"sprung_mass_kg": vehicle.sprung_mass,
                    "unsprung_mass_kg": vehicle.unsprung_mass,
                    "suspension_stiffness_N_per_m": vehicle.suspension_stiffness,
                    "tire_stiffness_N_per_m": vehicle.tire_stiffness,
                    "damping_N_s_per_m": vehicle.damping},
        "speed_km_per_h": to_kmh(surface.speeds).tolist(),
        "daf_smooth": surface.daf_smooth.tolist(),
        "dae": study.dae.tolist(),
        "daf_superposed": study.superposed.tolist(),
        "daf_simulated": study.simulated.tolist(),
        "critical_speed_km_per_h": float(to_kmh(surface.speeds[critical])),
        "critical_daf": float(study.simulated[critical]),
        "largest_contributions": [
            {"x_m": x, "rise_m": rise, "contribution": part} for x, rise, part in study.largest()
        ],
    }  # fmt: skip


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
