"""`bridgectl trucks`: the catalog of trucks, or one of them, from there or from a file."""

from __future__ import annotations

import argparse
import json
from typing import Any

import numpy as np

import bridgectl as bc
from bridgectl._tables import make_console, make_table
from bridgectl._version import __version__
from bridgectl.cli import options
from bridgectl.model.trucks.file import truck_path


def run_trucks(args: argparse.Namespace) -> None:
    """Do what the command asks for."""
    options.check_plot(args.plot)
    for option in ("plot", "toml"):
        if getattr(args, option) and args.truck is None:
            raise ValueError(f"--{option} needs a truck: type its name, as T5air")
    if args.truck is not None:
        vehicle = bc.trucks.load(args.truck)
        if args.toml:
            print(truck_path(args.truck).read_text(encoding="utf-8"), end="")
            return
        names = {name.lower(): name for name in bc.trucks.catalog()}
        trucks = {names.get(args.truck.lower(), args.truck): vehicle}
    else:
        trucks = {name: bc.trucks.load(name) for name in bc.trucks.catalog()}

    def draw() -> Any:
        (vehicle,) = trucks.values()
        figure: Any = bc.plots.vehicle_plot(vehicle).figure
        return figure

    options.deliver(
        args, draw, lambda: json.dumps(trucks_json(trucks), indent=1), lambda: print_trucks(trucks)
    )


def trucks_json(trucks: dict[str, bc.Vehicle | bc.QuarterCar]) -> dict[str, Any]:
    """Give what each truck is, with units in the keys."""
    told = bc.trucks.catalog()
    return {
        "bridgectl": __version__,
        "trucks": [
            {"name": name, "description": told.get(name), **vehicle_json(vehicle)}
            for name, vehicle in trucks.items()
        ],
    }


def vehicle_json(vehicle: bc.Vehicle | bc.QuarterCar) -> dict[str, Any]:
    """Give what a vehicle is, with units in the keys; a quarter-car by its parameters, too."""
    car = vehicle.linear
    found = {
        "mass_kg": car.mass,
        "static_loads_N": car.static_loads.tolist(),
        "axles_behind_first_m": car.tire_offsets.tolist(),
        "natural_frequencies_Hz": car.frequencies.tolist(),
    }
    if not isinstance(vehicle, bc.QuarterCar):
        return found
    return {
        "sprung_mass_kg": vehicle.sprung_mass,
        "unsprung_mass_kg": vehicle.unsprung_mass,
        "suspension_stiffness_N_per_m": vehicle.suspension_stiffness,
        "tire_stiffness_N_per_m": vehicle.tire_stiffness,
        "damping_N_s_per_m": vehicle.damping,
        **found,
    }


def print_trucks(trucks: dict[str, bc.Vehicle | bc.QuarterCar]) -> None:
    """Print loads, distances and frequencies, and what each truck is."""
    columns = ["truck", "mass [t]", "axle loads [kN]", "distances [m]", "frequencies [Hz]"]
    table = make_table("Trucks: static axle loads, natural frequencies on a rigid road", columns,
                       [columns[0], *columns[2:]])  # fmt: skip
    for name, vehicle in trucks.items():
        car = vehicle.linear
        lists = car.static_loads / 1e3, np.diff(car.tire_offsets), car.frequencies
        shown = (" ".join(f"{value:.3g}" for value in values) for values in lists)
        table.add_row(name, f"{car.mass / 1e3:.3g}", *shown)
    console = make_console()
    console.print(table)
    told = bc.trucks.catalog()
    for name in trucks:
        if name in told:
            console.print(f"{name}: {told[name]}", soft_wrap=True)
