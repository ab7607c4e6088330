"""`bridgectl profile`: what is measured of roads; tables for people, JSON for programs."""

from __future__ import annotations

import argparse
import json
import shlex
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import bridgectl as bc
from bridgectl import _checks as check
from bridgectl._checks import FloatArray
from bridgectl._plausible import judge_smoothness
from bridgectl._tables import make_console, make_table
from bridgectl._version import __version__
from bridgectl.cli import options
from bridgectl.cli.answer import next_steps
from bridgectl.road import RoadProfile
from bridgectl.road.iri import BASE, GOOD
from bridgectl.road.limits import evenly_spaced, mean_step
from bridgectl.road.psd import PsdFit
from bridgectl.road.sampling import too_coarse

MOST_SEGMENTS, FEW_TRACKS = 200, 8
"""How many segments of a road are listed, and how many tracks without --full."""


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


def run_profile(args: argparse.Namespace) -> None:
    """Do what the command asks for."""
    options.check_plot(args.plot)
    if args.file is None:
        options.refuse_file_options(args)
        roads = [bc.utia_road()]
    elif args.track is not None:
        roads = [bc.read_profile(args.file, track=args.track, **options.file_arguments(args))]
    else:
        roads = bc.read_tracks(args.file, **options.file_arguments(args))
    tracks = [measure_track(road, args.segment) for road in roads]
    first, *others = (track.road for track in tracks)
    options.deliver(
        args, lambda: first.plot_roughness(*others, segment=args.segment),
        lambda: json.dumps(profile_json(tracks, args.segment), indent=1),
        lambda: _show(args, tracks),
    )  # fmt: skip


def _show(args: argparse.Namespace, tracks: Sequence[TrackMeasures]) -> None:
    """Print the verdict, what was measured, and what to type next."""
    console = make_console()
    for line in verdict(tracks, args.segment):
        console.print(line)
    console.print()
    print_tracks(tracks if args.full else tracks[:FEW_TRACKS], full=args.full)
    if args.full:
        print_segments(tracks, args.segment)
    elif (more := len(tracks) - FEW_TRACKS) > 0:
        console.print(f"... and {more} more; --full has all")
    if steps := next_steps(args):
        print(steps)
    given = [] if args.file is None else [args.file]
    given += [] if args.units is None else ["--units", args.units]
    print("\nWhat it does to a bridge:", shlex.join(["bridgectl", "dae", *given]))


def verdict(tracks: Sequence[TrackMeasures], segment: float) -> list[str]:
    """Return what is to be said first, of one track or of all."""
    known = [track for track in tracks if track.good is not None]
    good = [track for track in known if track.good]
    if len(tracks) == 1 and known:
        (track,) = known
        of_class = f"ISO 8608 class {track.fit.iso_class}" if track.fit else "too short for a class"
        lines = [
            f"{track.road.name} is {track.verdict}: its IRI is {track.iri:.2f} m/km, and good "
            f"roads stay below {GOOD:g}; {of_class}."
        ]
    elif known:
        worst = max(known, key=lambda track: track.iri)
        lines = [
            f"{len(good) or 'None'} of {len(tracks)} tracks {'is' if len(good) < 2 else 'are'} "
            f"good (an IRI below {GOOD:g} m/km); the roughest is {worst.road.name} with "
            f"{worst.iri:.2f} m/km."
        ]
    else:
        lines = []
    if any(track.segments.size > 1 for track in known):
        worst = max(known, key=lambda track: track.segments.max(initial=-1.0))
        start = worst.road.x[0] + segment * int(worst.segments.argmax())
        of = f" of {worst.road.name}" if len(tracks) > 1 else ""
        lines.append(
            f"The roughest {segment:g} m{of} begin at {start:.6g} m: {worst.segments.max():.2f} "
            f"m/km."
        )
    if len(known) < len(tracks):
        coarse = [track.road.name for track in tracks if track.good is None]
        lines.append(
            f"Measured too coarsely for an IRI or a class: {', '.join(coarse[:FEW_TRACKS])}."
        )
    return lines


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


def print_tracks(tracks: Sequence[TrackMeasures], *, full: bool = True) -> None:
    """Print what was measured of every track; in full, with its spectrum."""
    columns = ["track", "from [m]", "to [m]", "step [m]", "IRI [m/km]", "", "class"]
    title = "Roughness"
    if full:
        columns, title = [*columns, "G_d [1e-6 m3]", "waviness"], f"{title}; G_d at 0.1 cycles/m"
    table = make_table(title, columns, ["track", "", "class"], short=not full)
    for track in tracks:
        road, fit = track.road, track.fit
        spectrum = ["-"] * 3
        if fit is not None:
            spectrum = [fit.iso_class, f"{1e6 * fit.roughness:.3g}", f"{fit.waviness:.2f}"]
        cells = [
            road.name, f"{road.x[0]:.6g}", f"{road.x[-1]:.6g}", f"{mean_step(road.x):.5g}",
            f"{track.iri:.3f}", track.verdict, *spectrum,
        ]  # fmt: skip
        table.add_row(*cells[: len(columns)])
    make_console().print(table)


def print_segments(tracks: Sequence[TrackMeasures], segment: float) -> None:
    """Print the IRI of all segments, if there are several."""
    console = make_console()
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
