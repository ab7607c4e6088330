"""`bridgectl dae`: its options, and what becomes of them: tables for people, JSON for programs."""

from __future__ import annotations

import argparse
import json
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

import bridgectl as bc
from bridgectl._checks import FloatArray
from bridgectl._units import from_kmh, in_name, to_kmh
from bridgectl._version import __version__
from bridgectl.cli import bridges, options, roads
from bridgectl.cli.answer import checked_modulus, next_steps
from bridgectl.cli.dae_text import LARGEST, print_full, print_short, print_verdict
from bridgectl.cli.effects import Asked, asked_effects
from bridgectl.cli.trucks import vehicle_json

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bridgectl.surface.trust import DaeTrust


@dataclass(frozen=True)
class DaeStudy:
    """What is computed of one effect: a surface, and factors or peaks of a road at its speeds."""

    asked: Asked
    surface: bc.RampSurface
    road: bc.RoadProfile
    station: float
    place: str
    dae: FloatArray
    superposed: FloatArray
    simulated: FloatArray
    acceleration: float = 0.0
    trust: DaeTrust | None = None

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
    pictures, modulus = _pictures(args.plot, asked), checked_modulus(args, asked)
    road = _road(args, bridge.length)
    studies = [_study(args, each, speeds, road) for each in asked]

    def draw() -> dict[Path, Figure]:
        return {path: study.figure() for path, study in zip(pictures, studies, strict=True)}

    def show() -> None:
        print_verdict(studies, modulus)
        if args.full:
            print_full(studies)
        else:
            print_short(studies, modulus)
        print(next_steps(args, modulus=modulus))

    options.deliver(args, draw, lambda: json.dumps(dae_json(studies, modulus), indent=1), show)


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


class Placed(NamedTuple):
    """The road under approach and bridge, in ramps, and where the bridge stands in it."""

    road: bc.RoadProfile
    station: float
    place: str


def _road(args: argparse.Namespace, length: float) -> Placed:
    """The road of the file, or the measured one."""
    options.check_ramps("--approach", args.approach)
    if args.file is None:
        options.refuse_file_options(args)
        whole, what = bc.utia_road(), "that comes with the program"
        name = f"{whole.name}, which ships"
    else:
        whole = bc.read_profile(args.file, track=args.track, **options.file_arguments(args))
        what = name = args.file
    road, station = options.place_road(args, whole, what, length)
    return Placed(road, station, roads.place_in_words(name, whole, station, length))


def _study(args: argparse.Namespace, asked: Asked, speeds: FloatArray, placed: Placed) -> DaeStudy:
    bridge, vehicle, effect = asked.crossing.beam, asked.crossing.vehicle, asked.effect
    road = placed.road
    with options.working("computing the ramp surface"):
        surface = bc.ramp_surface(bridge, vehicle, speeds, approach=args.approach, effect=effect)
    simulate = bc.daf if asked.is_factor else bc.peak_effect
    passing = [bc.Motion(c, [0.0, args.acceleration], [0.0]) for c in speeds]
    simulated = simulate(bridge, vehicle, passing, road, start=-args.approach, effect=effect)
    # The simulation has told of tires that leave the road.
    with warnings.catch_warnings(action="ignore", category=bc.LiftOffWarning):
        superposed = surface.superposed_daf(road)
        trust = bc.dae_trust(surface, road) if asked.is_factor else None
    return DaeStudy(
        asked, surface, *placed, surface.dae(road), superposed, simulated, args.acceleration, trust
    )  # fmt: skip


def dae_json(studies: Sequence[DaeStudy], modulus: float | None = None) -> dict[str, Any]:
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
        return shared | {"effects": [_effect_json(study, modulus) for study in studies]}
    shared["bridge"] |= {"section": surface.section, "recovery": surface.recovery}
    return shared | _effect_json(first, modulus)


def _effect_json(study: DaeStudy, modulus: float | None) -> dict[str, Any]:
    """What there is of one effect; of peaks, that are no factors, with their unit in the keys."""
    asked, surface, critical = study.asked, study.surface, study.critical
    keys = ["daf_smooth", "dae", "daf_superposed", "daf_simulated", "critical_daf"]
    unit = in_name(asked.effect.unit)
    if not asked.is_factor:
        keys = [f"{name}_{unit}" for name in ("peak_smooth", "estimate", "peak_superposed",
                "peak_simulated", "critical_peak")]  # fmt: skip
    values = [surface.daf_smooth, study.dae, study.superposed, study.simulated]
    more: dict[str, Any] = {}
    if asked.is_factor:
        peaks = study.simulated * asked.crossing.static_peak
        more[f"peak_simulated_{unit}"] = peaks.tolist()
        if modulus is not None and isinstance(asked.effect, bc.Moment):
            more["stress_simulated_N_per_m2"] = (peaks / modulus).tolist()
    return {
        "effect": asked.content,
        **{key: value.tolist() for key, value in zip(keys, values, strict=False)},
        "critical_speed_km_per_h": float(to_kmh(surface.speeds[critical])),
        keys[-1]: float(study.simulated[critical]),
        **more,
        "largest_contributions": [
            {"x_m": x, "rise_m": rise, "contribution": part} for x, rise, part in study.largest()
        ],
    }  # fmt: skip
