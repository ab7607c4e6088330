"""Options that several commands share; nothing heavy is imported to declare them."""

from __future__ import annotations

import argparse
import math
import re
from pathlib import Path
from typing import Any

VEHICLE = {
    "sprung_mass": "[kg] (default 9000)", "unsprung_mass": "[kg] (default 1000)",
    "suspension_stiffness": "[N/m] (default 80000)", "tire_stiffness": "[N/m] (default 1.8e+06)",
    "damping": "[N s/m] (default 7000)",
}  # fmt: skip
"""Parameters of the quarter-car, each an option, and what they are of the paper's."""

OWN = "length", "mass_per_length", "flexural_rigidity", "frequency", "supports"
"""Parameters of a bridge of one's own, each an option."""


def add_option(
    group: argparse._ActionsContainer, name: str, metavar: str, text: str, kind: Any = None,
    default: Any = None,
) -> None:  # fmt: skip
    """Add an option that takes a value, text if it has no kind."""
    group.add_argument(name, metavar=metavar, help=text, type=kind, default=default)


def add_file_options(parser: argparse.ArgumentParser, *, many: bool = False) -> None:
    """Add FILE, or any number of ROAD, and how they are to be read."""
    file = parser.add_argument_group("road files" if many else "road file")
    name, shown, kind = ("roads", "ROAD", Path) if many else ("file", "FILE", str)
    file.add_argument(name, nargs="*" if many else "?", metavar=shown, type=kind,
                      help="delimited text, ERD or OpenCRG")  # fmt: skip
    add_option(file, "--units", "X,Z", "units of station and elevation, as m,mm")
    add_option(file, "--columns", "I,J,...", "columns of the stations and of elevations, from 0 "
               "(default: the first, and those whose unit the header states, or else the "
               "second)")  # fmt: skip
    add_option(file, "--delimiter", "C", "what separates the columns, as ';'")
    add_option(file, "--step", "M", "distance between lines without stations [m]", as_number)
    add_option(file, "--decimal", "C", "decimal mark, as ',' (default: as found)")
    add_option(file, "--missing", "V,...", "what marks missing readings, to be left out, as "
               "--missing=-999 or --missing=-999,nan")  # fmt: skip
    add_option(file, "--skip-lines", "N", "lines at the top that are no part of it", as_whole)
    add_option(file, "--track", "NAME", "which elevations of several, by label or number from 0")


def add_place_options(
    parser: argparse.ArgumentParser, *, approach: float = 200.0, speeds: str | None = "50:150:1"
) -> None:
    """Add where the bridge is in the road, and the speeds if any, with their defaults."""
    road = parser.add_argument_group("place of the bridge")
    add_option(road, "--station", "M", "station of the start of the bridge [m]; default: the first "
               "after the approach", as_number)  # fmt: skip
    add_option(road, "--approach", "M", "road before the bridge that counts [m]; the vehicle "
               f"starts there (default {approach:g})", as_number, approach)  # fmt: skip
    road.add_argument(
        "--no-detrend", action="store_true",
        help="keep the grade; by default the straight line through the road is taken off, "
        "as a vehicle that starts in equilibrium is not on a grade",
    )  # fmt: skip
    if speeds is not None:
        add_speeds(parser, speeds, speeds)


def add_speeds(parser: argparse.ArgumentParser, default: str | None, told: str) -> None:
    """Add the speeds."""
    add_option(parser, "--speeds", "A:B:D", "speeds [km/h], from A to B in steps of D, or a list "
               f"A,B,C (default {told})", default=default)  # fmt: skip


def add_resume_option(work: argparse._ArgumentGroup) -> None:
    """Add where work is kept."""
    add_option(work, "--resume", "FILE", "keep what is done in FILE, and go on from what it holds",
               Path)  # fmt: skip


def add_work_options(work: argparse._ArgumentGroup) -> None:
    """Add who does the work."""
    add_option(work, "--workers", "N", "processes (default: one for each core)", as_whole)
    add_option(work, "--scheduler", "ADDRESS", "of a Dask scheduler whose workers do it, as "
               "tcp://HOST:8786; 'local' for processes of this machine under Dask")  # fmt: skip


def add_vehicle_options(parser: argparse.ArgumentParser) -> None:
    """Add the truck by name or file, and the parameters of the quarter-car."""
    vehicle = parser.add_argument_group("vehicle: any truck, or a quarter-car (the paper's)")
    add_option(vehicle, "--truck", "T", "a name that 'bridgectl trucks' lists, or FILE.toml")
    for name, text in VEHICLE.items():
        add_option(vehicle, f"--{name.replace('_', '-')}", "X", text, as_number)


def add_output_options(parser: argparse.ArgumentParser) -> None:
    """Add what becomes of the results."""
    add_option(parser, "--plot", "FILE", "draw (png, pdf, svg)", Path)
    parser.add_argument("--json", action="store_true", help="print one JSON object instead")


def add_hardware_options(group: argparse._ArgumentGroup) -> None:
    """Add the damper's range, and what makes it less than ideal."""
    for option, default, text in (
        ("--c-min", 1e3, "least damping [N s/m] (default 1000)"),
        ("--c-max", 30e3, "largest damping [N s/m] (default 30000)"),
        ("--lag", 0.0, "time constant with which the damping follows [s] (default 0)"),
        ("--sample-time", 2e-3, "time between samples of the controller [s] (default 0.002)"),
        ("--max-force", math.inf, "largest damper force [N] (default none)"),
        ("--velocity-noise", 0.0, "noise on measured velocities, rms [m/s] (default 0)"),
    ):
        add_option(group, option, "X", text, as_number, default)
    add_option(group, "--seed", "N", "of the noise (default 0)", as_whole, 0)


def as_options(advice: str) -> str:
    """Advice to type an argument of the library, for the command line."""
    names = "|".join((*VEHICLE, "damping_ratio", *OWN))
    return re.sub(
        rf"\btype ({names})=", lambda found: f"type --{found[1].replace('_', '-')} ", advice
    )


def as_number(text: str) -> float:
    """Read the value of an option that takes a number."""
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a number, as 12e3, got {text!r}") from None


def as_whole(text: str) -> int:
    """Read the value of an option that takes a whole number."""
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a whole number, as 3, got {text!r}") from None
