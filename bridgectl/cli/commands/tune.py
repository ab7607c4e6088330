"""What `bridgectl tune` takes."""

from __future__ import annotations

import argparse

from bridgectl.cli.commands import bridge, shared

RANDOM = 50
"""Random training roads: with 25 a program fits them, and gains nothing elsewhere."""

HELP = """\
Tune the gains of a damper strategy, or a program of dampings over the place, for a bridge: on the
simulated dynamic amplification factor (DAF) of training roads, or on the class DAE (--objective
class_dae). Prints the gains before and after, and the mean DAF of the training roads and of roads
held out, which the search does not see, with 95 % confidence intervals over the roads: gains that
fit the training roads alone do not help elsewhere, and a warning says so.

NAME is a strategy of the library with gains (skyhook, continuous skyhook, groundhook, tire
groundhook, extended groundhook, selective groundhook, hybrid, ADD, SH-ADD, PDD, clipped LQR), or
'program': dampings at --places places, from 20 m before the bridge to its end, with straight lines
between, that begin as the vehicle's own. A program is tuned by exact gradients, others by
differential evolution, for their DAF is rough.

Training roads are the files ROAD, read as by `bridgectl score`, and --random N roads of --class;
--held-out N more of the class are held out, the same every time. It takes a minute, of laws on the
class DAE some minutes; Ctrl-C ends the search and keeps the best so far.

examples:
  bridgectl tune --strategy hybrid --plot hybrid.png
  bridgectl tune --strategy program --places 12 --random 100 --json > program.json
  bridgectl tune --strategy "clipped LQR" --gains body_gain,axle_gain --objective class_dae
  bridgectl tune east.csv west.csv --units m,mm --random 0 --strategy "extended groundhook\""""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add every option but those of the output."""
    shared.add_file_options(parser, many=True)
    shared.add_place_options(parser, approach=60.0, speeds="70,90,108")
    text = f"random training roads (default {RANDOM})"
    shared.add_option(parser, "--random", "N", text, shared.as_whole, RANDOM)
    text = "random roads that are held out (default 40)"
    shared.add_option(parser, "--held-out", "N", text, shared.as_whole, 40)
    shared.add_option(
        parser, "--class", "A", "ISO 8608 class of the random roads (default A)", default="A"
    )
    _add_search_options(parser)
    group = parser.add_argument_group("semi-active damper")
    shared.add_hardware_options(group)
    bridge.add_bridge_options(parser)
    shared.add_vehicle_options(parser)
    work = parser.add_argument_group("work")
    text = "processes (default: one for each core)"
    shared.add_option(work, "--workers", "N", text, shared.as_whole)


def _add_search_options(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("tuning")
    shared.add_option(group, "--strategy", "NAME", "what is tuned: see above", default=None)
    text = "which gains vary, as share,gain (default all)"
    shared.add_option(group, "--gains", "NAME,NAME", text)
    text = "places of a program (default 20)"
    shared.add_option(group, "--places", "N", text, shared.as_whole, 20)
    text = "daf, or class_dae (default daf)"
    shared.add_option(group, "--objective", "WHAT", text, default="daf")
    text = "take the soft maximum over the speeds, of DAFs that far apart, as 0.01 (default mean)"
    shared.add_option(group, "--softness", "X", text, shared.as_number)
    text = "generations, or gradient (default: as the strategy needs)"
    shared.add_option(group, "--method", "WHAT", text)
    text = "generations or gradients at most (default 30)"
    shared.add_option(group, "--iterations", "N", text, shared.as_whole, 30)
