"""`bridgectl dae`: its options, and what becomes of them: tables for people, JSON for programs."""

from __future__ import annotations

import argparse
import json
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import bridgectl as bc
from bridgectl._checks import FloatArray
from bridgectl._tables import make_console, make_table
from bridgectl._units import from_kmh, to_kmh
from bridgectl._version import __version__
from bridgectl.cli import bridges, options
from bridgectl.cli.effects import Asked, asked_effects
from bridgectl.cli.trucks import vehicle_json

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import Console

SHOWN_KMH = 10
"""The speeds of the printed table are multiples of this [km/h]."""

LARGEST = 10
"""How many ramps are listed."""


@dataclass(frozen=True)
class DaeStudy:
    """What is computed of one effect: a surface, and factors or peaks of a road at its speeds."""

    asked: Asked
    surface: bc.RampSurface
    road: bc.RoadProfile
    station: float
    dae: FloatArray
    superposed: FloatArray
    simulated: FloatArray
    acceleration: float = 0.0

    @property
    def critical(self) -> int:
        """Index of the speed of the worst simulated crossing."""
        return self.asked.worst(self.simulated)

    def largest(self) -> list[tuple[float, float, float]]:
        """Start [m], rise [m] and contribution of the largest ramps at the critical speed."""
        parts = self.surface.contributions(self.road)[self.critical]
        rises = -self.surface.ramps(self.road) * self.surface.ramp_height
        order = np.argsort(-np.abs(parts), kind="stable")[:LARGEST]
        return [(float(self.surface.positions[i]), float(rises[i]), float(parts[i])) for i in order]

    def figure(self) -> Figure:
        """The figure of the road on the bridge."""
        from bridgectl.plots.dae import dae_figure

        figure = dae_figure(
            self.surface, self.road, superposed=self.superposed, simulated=self.simulated
        )
        figure.suptitle(f"{figure.get_suptitle()}, {self.asked.told}", parse_math=False)
        return figure


def run_dae(args: argparse.Namespace) -> None:
    """Do what the command asks for."""
    speeds = from_kmh(options.parse_speeds(args.speeds))
    options.check_plot(args.plot)
    bridge, vehicle = bridges.make_bridge(args), options.make_vehicle(args)
    asked = asked_effects(args, bridge, vehicle)
    pictures = _pictures(args.plot, asked)
    road, station = _road(args, bridge.length)
    studies = [_study(args, each, speeds, road, station) for each in asked]

    def draw() -> dict[Path, Figure]:
        return {path: study.figure() for path, study in zip(pictures, studies, strict=True)}

    options.deliver(
        args, draw, lambda: json.dumps(dae_json(studies), indent=1), lambda: print_dae(studies)
    )


def _pictures(path: Path | None, asked: Sequence[Asked]) -> list[Path]:
    """The file of the figure of each effect; with their names of several."""
    if path is None:
        return []
    for each in asked:
        if each.least or not each.is_factor:
            raise ValueError(
                f"--plot draws factors whose largest is the worst, and {each.name} has none: leave "
                "out --plot, or it"
            )
    if len(asked) == 1:
        return [path]
    names = [each.name.replace("@", "_") for each in asked]
    paths = [path.with_name(f"{path.stem}_{name}{path.suffix}") for name in names]
    for picture in paths:
        options.check_plot(picture)
    return paths


def _road(args: argparse.Namespace, length: float) -> tuple[bc.RoadProfile, float]:
    """The road under approach and bridge, in ramps, and the station of the bridge."""
    options.check_ramps("--approach", args.approach)
    if args.file is None:
        options.refuse_file_options(args)
        return options.place_road(args, bc.utia_road(), "that comes with the program", length)
    whole = bc.read_profile(args.file, track=args.track, **options.file_arguments(args))
    return options.place_road(args, whole, args.file, length)


def _study(
    args: argparse.Namespace, asked: Asked, speeds: FloatArray, road: bc.RoadProfile, station: float
) -> DaeStudy:
    bridge, vehicle, effect = asked.crossing.beam, asked.crossing.vehicle, asked.effect
    with options.working("computing the ramp surface"):
        surface = bc.ramp_surface(bridge, vehicle, speeds, approach=args.approach, effect=effect)
    simulate = bc.daf if asked.is_factor else bc.peak_effect
    passing = [bc.Motion(c, [0.0, args.acceleration], [0.0]) for c in speeds]
    simulated = simulate(bridge, vehicle, passing, road, start=-args.approach, effect=effect)
    # The simulation has told of tires that leave the road.
    with warnings.catch_warnings(action="ignore", category=bc.LiftOffWarning):
        superposed = surface.superposed_daf(road)
    return DaeStudy(
        asked, surface, road, station, surface.dae(road), superposed, simulated, args.acceleration
    )  # fmt: skip


def print_dae(studies: Sequence[DaeStudy]) -> None:
    """Print, of each effect, values by speed, the critical speed, and the largest ramps."""
    console, first = make_console(), studies[0]
    surface = first.surface
    console.print(
        f"Road: {first.road.name or 'unnamed'}, bridge from station {first.station:g} m, "
        f"{surface.approach:g} m of approach, in ramps of {surface.ramp_length * 1e3:g} mm\n"
        f"Bridge: {surface.beam!r}\nVehicle: {surface.vehicle!r}\n"
    )
    if first.acceleration:
        console.print(
            f"Simulated with {first.acceleration:g} m/s^2 from the start of the bridge on, the "
            "speeds those there; all else at constant speed\n", soft_wrap=True,
        )  # fmt: skip
    for study in studies:
        _print_speeds(console, study)
        _print_sentences(console, study)
        _print_largest(console, study)


def _print_speeds(console: Console, study: DaeStudy) -> None:
    asked, surface = study.asked, study.surface
    kmh, critical = to_kmh(surface.speeds), study.critical
    title = f"Dynamic amplification by speed: {asked.told}"
    names = ["DAF smooth", "DAE", "superposed DAF", "simulated DAF", "DAE error"]
    if not asked.is_factor:
        title = f"Peaks by speed [{asked.effect.unit}]: {asked.told}"
        names = ["smooth road", "estimate", "superposed", "simulated", "error"]
    table = make_table(title, ["speed [km/h]", *names])
    shown = np.isclose(kmh % SHOWN_KMH, 0, atol=1e-6) | np.isclose(kmh % SHOWN_KMH, SHOWN_KMH)
    shown |= len(kmh) <= 2 * SHOWN_KMH
    for i in range(len(kmh)):
        if shown[i] or i == critical:
            row = [surface.daf_smooth[i], study.dae[i], study.superposed[i], study.simulated[i]]
            cells = [f"{value:.4f}" for value in row] + [f"{row[1] - row[3]:+.4f}"]
            mark = " <" if i == critical else "  "
            table.add_row(f"{kmh[i]:g}{mark}", *cells, style="bold" if i == critical else None)
    console.print(table)


def _print_sentences(console: Console, study: DaeStudy) -> None:
    asked, surface = study.asked, study.surface
    kmh, critical = to_kmh(surface.speeds), study.critical
    worst = int(np.argmax(np.abs(study.dae - study.simulated)))
    smooth, estimate = asked.worst(surface.daf_smooth), asked.worst(study.dae)
    size = "Least" if asked.least else "Largest"
    what, name, unit = ("DAF ", "DAE", "") if asked.is_factor else (
        "", "estimate", f" {asked.effect.unit}"
    )  # fmt: skip
    console.print(
        f"Critical speed: {kmh[critical]:g} km/h, {what}{study.simulated[critical]:.4f}{unit} "
        f"(smooth road: {kmh[smooth]:g} km/h, {surface.daf_smooth[smooth]:.4f}{unit}).\n"
        f"{size} {name}: {study.dae[estimate]:.4f}{unit} at {kmh[estimate]:g} km/h. The {name} is "
        f"{'an' if asked.is_factor else 'one'} "
        f"{'estimate' if asked.is_factor else 'of first order'}: it is furthest off, by "
        f"{study.dae[worst] - study.simulated[worst]:+.4f}{unit}, at {kmh[worst]:g} km/h.\n",
        soft_wrap=True,
    )


def _print_largest(console: Console, study: DaeStudy) -> None:
    asked, surface = study.asked, study.surface
    kmh = to_kmh(surface.speeds[study.critical])
    title = f"The {LARGEST} ramps that contribute most at {kmh:g} km/h"
    to = "DAE" if asked.is_factor else f"estimate [{asked.effect.unit}]"
    table = make_table(title, ["from x [m]", "x / l", "rise [mm]", f"contribution to {to}"])
    for x, rise, part in study.largest():
        place = f"{x / surface.beam.length:.3f}"
        table.add_row(f"{x:.1f}", place, f"{rise * 1e3:+.2f}", f"{part:+.5f}")
    console.print(table)


def dae_json(studies: Sequence[DaeStudy]) -> dict[str, Any]:
    """Give everything of the studies, at every speed, with units in the keys."""
    first = studies[0]
    surface = first.surface
    shared = {
        "bridgectl": __version__,
        "road": {"name": first.road.name, "bridge_station_m": first.station,
                 "approach_m": surface.approach},
        "bridge": bridges.bridge_json(surface.beam),
        "vehicle": vehicle_json(surface.vehicle),
        "speed_km_per_h": to_kmh(surface.speeds).tolist(),
        "simulated_acceleration_m_per_s2": first.acceleration,
    }  # fmt: skip
    if len(studies) > 1:
        return shared | {"effects": [_effect_json(study) for study in studies]}
    shared["bridge"] |= {"section": surface.section, "recovery": surface.recovery}
    return shared | _effect_json(first)


def _effect_json(study: DaeStudy) -> dict[str, Any]:
    """What there is of one effect; of peaks, that are no factors, with their unit in the keys."""
    asked, surface, critical = study.asked, study.surface, study.critical
    keys = ["daf_smooth", "dae", "daf_superposed", "daf_simulated", "critical_daf"]
    if not asked.is_factor:
        unit = asked.effect.unit.replace("/", "_per_").replace("^", "").replace(" ", "_")
        keys = [f"{name}_{unit}" for name in ("peak_smooth", "estimate", "peak_superposed",
                "peak_simulated", "critical_peak")]  # fmt: skip
    values = [surface.daf_smooth, study.dae, study.superposed, study.simulated]
    return {
        "effect": asked.content,
        **{key: value.tolist() for key, value in zip(keys, values, strict=False)},
        "critical_speed_km_per_h": float(to_kmh(surface.speeds[critical])),
        keys[-1]: float(study.simulated[critical]),
        "largest_contributions": [
            {"x_m": x, "rise_m": rise, "contribution": part} for x, rise, part in study.largest()
        ],
    }  # fmt: skip
