"""Roads of a study on the command line: files, the measured road, random ones of a class."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

import bridgectl as bc
from bridgectl._work import Work, at_most, require_feasible
from bridgectl.cli import options
from bridgectl.surface.compute import RAMP_LENGTH

STATION = 678.0
"""Where the bridge is in the measured road that comes with the program [m]."""


def file_roads(
    args: argparse.Namespace, span: float, departure: float
) -> tuple[list[bc.RoadProfile], list[str]]:
    """Roads of the files, under approach, bridge and departure [m], with names of their own.

    And where the bridge stands in each.
    """
    roads, places = [], []
    for path in _different(args.roads):
        whole = bc.read_profile(path, track=args.track, **options.file_arguments(args))
        road, station = options.place_road(args, whole, str(path), span, departure=departure)
        roads.append(road)
        places.append(place_in_words(str(path), whole, station, span))
    return _named_apart(roads, args.roads), places


def measured_road(
    args: argparse.Namespace, span: float, departure: float
) -> tuple[list[bc.RoadProfile], list[str]]:
    """The road that comes with the program, under approach, bridge and departure [m].

    And where the bridge stands in it.
    """
    options.refuse_file_options(args)
    whole = bc.utia_road()
    station = max(STATION, float(whole.x[0]) + args.approach)
    road, station = options.place_road(
        args, whole, "that comes with the program", span, station=station, departure=departure
    )
    return [road], [place_in_words(f"{whole.name}, which ships", whole, station, span)]


def place_in_words(name: str, whole: bc.RoadProfile, station: float, span: float) -> str:
    """Return where a bridge stands in a road."""
    return (
        f"Bridge at {station:g} to {station + span:g} m of {name} (measured from {whole.x[0]:g} "
        f"to {whole.x[-1]:g} m)"
    )


def random_roads(
    classes: Sequence[str], number: int, approach: float, length: float
) -> dict[str, list[bc.RoadProfile]]:
    """Random roads of classes, of which the first ones stay the same when more are asked for.

    From `approach` [m] before the bridge on, `length` [m] in all.
    """

    def work(**given: float) -> Work:
        roads = len(classes) * given["--random"]
        return Work(4 * 8 * roads * length / RAMP_LENGTH, 2e-3 * roads)

    require_feasible(work, {"--random": at_most(number, 100)})
    found: dict[str, list[bc.RoadProfile]] = {}
    for iso_class in classes:
        found[iso_class] = []
        for k in range(1, number + 1):
            rng = np.random.default_rng((ord(iso_class), k))
            road = bc.iso8608_profile(iso_class, length, seed=rng, start=-approach)
            name = f"class {iso_class}, {k}"
            found[iso_class].append(road._measured_as(road.measured_step, name))
    return found


def _different(paths: Sequence[Path]) -> Sequence[Path]:
    """Check that no file is given twice: it would look like more evidence than there is."""
    whole = [path.resolve() for path in paths]
    for path, found in zip(paths, whole, strict=True):
        if whole.count(found) > 1:
            raise ValueError(f"{path} is given twice: each road counts once")
    return paths


def _named_apart(roads: list[bc.RoadProfile], paths: Sequence[Path]) -> list[bc.RoadProfile]:
    """Name roads by their paths where files of different folders have one name."""
    names = [road.name for road in roads]
    if len(set(names)) == len(names):
        return roads
    return [
        road._measured_as(road.measured_step, str(path))
        for road, path in zip(roads, paths, strict=True)
    ]
