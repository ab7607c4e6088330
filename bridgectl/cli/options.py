"""What the options mean that several commands share, and where their results go."""

from __future__ import annotations

import argparse
import io
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import bridgectl as bc
from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._files import is_regular, replacing
from bridgectl._places import SAME_PLACE, even_places, whole_pieces
from bridgectl._plausible import judge_kmh
from bridgectl._shares import WorkersLostError
from bridgectl._workers import check_scheduler
from bridgectl.cli.commands.shared import VEHICLE
from bridgectl.surface.compute import RAMP_LENGTH

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SPEEDS_KMH = (1.0, 1000.0)
"""Speeds that make sense [km/h]: a crawling vehicle needs cells, and memory, without end."""


SPEEDS_LOOK = "50:150:1 or 80,90,100"


def refuse_file_options(args: argparse.Namespace) -> None:
    """Refuse what tells how a file is read where there is none: it would count for nothing."""
    for name, value in (file_arguments(args) | {"track": args.track}).items():
        if value is not None:
            raise ValueError(
                f"--{name.replace('_', '-')} is about a road file, and none is given: name the file"
            )


def file_arguments(args: argparse.Namespace) -> dict[str, Any]:
    """Return what the file options say, as arguments of `read_profile` but for the track."""
    columns = None
    if args.columns is not None:
        columns = tuple(numbers("--columns", args.columns, int))
    return {
        "units": args.units, "columns": columns, "delimiter": args.delimiter, "step": args.step,
        "decimal": args.decimal, "missing": args.missing, "skip_lines": args.skip_lines,
    }  # fmt: skip


def check_work(args: argparse.Namespace) -> None:
    """Check the options of `add_resume_option` and `add_work_options`."""
    check_output("--resume", args.resume)
    if args.workers is not None:
        _checks.integer("--workers", args.workers, at_least=1)
    try:
        check_scheduler(args.scheduler)
    except (ValueError, ModuleNotFoundError) as error:
        raise ValueError(f"--{error}") from None
    if args.workers is not None and args.scheduler not in (None, "local"):
        raise ValueError("--workers are of this machine, and a scheduler has its own: leave it out")


@contextmanager
def resumed(path: Path | None) -> Iterator[None]:
    """Say where the work goes on if it is interrupted, and a file keeps it."""
    try:
        yield
    except WorkersLostError as error:
        if path is None:
            raise
        raise WorkersLostError(
            f"{error}; {path} keeps what is done, the same command goes on from there"
        ) from None
    except KeyboardInterrupt:
        if path is not None:
            print(
                f"bridgectl: interrupted: {path} keeps what is done, the same command "
                "goes on from there",
                file=sys.stderr,
            )
        raise


def make_vehicle(args: argparse.Namespace) -> bc.Vehicle | bc.QuarterCar:
    """Make the vehicle of --truck, or the quarter-car of the other options."""
    told = {name: value for name in VEHICLE if (value := getattr(args, name)) is not None}
    if args.truck is None:
        return replace(bc.li2006.car(), **told)
    if told:
        option = f"--{next(iter(told)).replace('_', '-')}"
        raise ValueError(f"--truck and {option} exclude each other: leave one out")
    try:
        return bc.trucks.load(args.truck)
    except ValueError as error:
        raise ValueError(f"--truck: {error}") from None


def place_road(
    args: argparse.Namespace, whole: bc.RoadProfile, what: str, span: float, *,
    station: float | None = None, departure: float = 0.0,
) -> tuple[bc.RoadProfile, float]:  # fmt: skip
    """Return the road under approach, bridge and departure, in ramps, and the bridge's station.

    `what` names the road in errors; `station` [m] is that of the bridge if --station is not given.
    """
    if station is None:
        station = float(whole.x[0]) + args.approach
    station = station if args.station is None else args.station
    end = span + departure
    of_thesis = args.length is args.spans is args.bridge is None
    shorter = "--span" if of_thesis else "take a shorter bridge"
    first, last = float(whole.x[0]) + args.approach, float(whole.x[-1]) - end
    if not first - SAME_PLACE <= station <= last + SAME_PLACE:
        room = (
            f"--station must lie between {first:g} and {last:g} m"
            if first <= last
            else f"{args.approach + end:g} m are needed: pass a smaller --approach or {shorter}"
        )
        after = f", {departure:g} m of departure" if departure else ""
        raise ValueError(
            f"the road {what} ({whole.x[0]:g} to {whole.x[-1]:g} m) does not hold "
            f"{args.approach:g} m of approach and {span:g} m of bridge{after} at station "
            f"{station:g} m: {room}"
        )
    road = whole.place_bridge(station)
    # Station arithmetic must not lose the ends to round-off.
    start, stop = max(-args.approach, float(road.x[0])), min(end, float(road.x[-1]))
    road = road.crop(start, stop)
    if not args.no_detrend:
        road = road.detrend()
    return road.resample(RAMP_LENGTH).level(start), station


def check_ramps(option: str, length: float) -> None:
    """Find out whether a length [m] is one of whole ramps."""
    if not 0 <= length < np.inf:
        raise ValueError(f"{option} must be 0 m or more, got {length:g}")
    if not np.isclose(length, round(length / RAMP_LENGTH) * RAMP_LENGTH, 0, SAME_PLACE):
        raise ValueError(
            f"{option} must be a whole number of {RAMP_LENGTH:g} m ramps, got {length:.10g}"
        )


def working(what: str) -> Any:
    """Return a spinner on standard error, if that is a terminal."""
    from rich.console import Console

    return Console(stderr=True).status(what)


def figure(name: str, results: Any) -> Figure:
    """Draw results by a function of `plots`, told by module and name: matplotlib is loaded now."""
    module, _, what = name.partition(".")
    drawn: Figure = getattr(import_module(f"bridgectl.plots.{module}"), f"{what}_figure")(results)
    return drawn


def save_figure(figure: Figure, path: Path) -> None:
    """Save a figure, whole or not at all."""
    drawn = io.BytesIO()  # where drawing cannot fail half-way, each format with an error of its own
    figure.savefig(drawn, format=path.suffix.lower().removeprefix("."))
    with replacing(path) as file:
        file.write(drawn.getbuffer())


def deliver(
    args: argparse.Namespace,
    draw: Callable[[], Figure | dict[Path, Figure]],
    results: Callable[[], str],
    show: Callable[[], None],
) -> None:
    """Draw what figures are asked for, and print results for programs or for people."""
    figures: dict[Path, Figure] = {}
    if args.plot is not None:
        with working("drawing"):
            drawn = draw()
            figures = drawn if isinstance(drawn, dict) else {args.plot: drawn}
            for path, figure in figures.items():
                save_figure(figure, path)
    if args.json:
        print(results())
        return
    show()
    if figures:
        print(f"Drawn: {', '.join(map(str, figures))}")


def parse_speeds(text: str) -> FloatArray:
    """Speeds [km/h] from 'A:B:D' or 'A,B,C'."""
    if ":" not in text:
        speeds = np.array(numbers("--speeds", text, float, SPEEDS_LOOK))
    else:
        parts = text.split(":")
        if len(parts) != 3:
            raise ValueError(f"--speeds must look like {SPEEDS_LOOK}, got {text!r}")
        first, last, step = numbers("--speeds", ",".join(parts), float)
        if not (0 < first <= last and step > 0 and np.isfinite([first, last, step]).all()):
            raise ValueError(f"--speeds must rise from above 0 km/h, as 50:150:1, got {text!r}")
        if (last - first) / step > 10_000:
            raise ValueError(f"--speeds must be at most 10000 speeds, got {text!r}")
        speeds = even_places(first, step, whole_pieces(last - first, step) + 1)
    if not (np.isfinite(speeds).all() and (speeds > 0).all()):
        raise ValueError(f"--speeds must be above 0 km/h, got {text!r}")
    slowest, fastest = SPEEDS_KMH
    if speeds.min() < slowest or speeds.max() > fastest:
        raise ValueError(f"--speeds must be {slowest:g} to {fastest:g} km/h, got {text!r}")
    judge_kmh("--speeds", speeds)
    return np.unique(speeds)


def numbers(option: str, text: str, kind: type, look: str = "") -> list[Any]:
    """Numbers separated by commas."""
    try:
        return [kind(part) for part in text.split(",")]
    except ValueError:
        remedy = f": type {look}" if look else ""
        raise ValueError(
            f"{option} must be numbers separated by commas, got {text!r}{remedy}"
        ) from None


def check_plot(path: Path | None) -> None:
    """Find out before the work that the figure cannot be written."""
    if path is not None and path.suffix.lower() not in (".png", ".pdf", ".svg"):
        raise ValueError(f"--plot must end in .png, .pdf or .svg, got {str(path)!r}")
    check_output("--plot", path)


def check_output(option: str, path: Path | None) -> None:
    """Find out before the work that a file cannot be written."""
    if path is None:
        return
    if not path.absolute().parent.is_dir():
        raise ValueError(f"{option}: the folder {str(path.parent)!r} does not exist")
    if path.exists() and not is_regular(path):
        what = "folder" if path.is_dir() else "pipe or device"
        raise ValueError(f"{option} must name a file, got the {what} {str(path)!r}")
    if not os.access(path if path.exists() else path.absolute().parent, os.W_OK):
        raise ValueError(f"{option}: no permission to write {str(path)!r}")
