"""What `bridgectl score` takes."""

from __future__ import annotations

import argparse

from bridgectl.cli.commands import bridge, shared

HELP = """\
Score damper strategies for a bridge: the library of 14, and constant dampers between the same
bounds, over the same roads and speeds. Prints, for each strategy:

  the bridge      mean dynamic amplification factor (DAF) of the bending moment, its difference to
                  the vehicle's own passive damper with a 95 % confidence interval over the roads,
                  and the worst speed
  road and ride   dynamic load coefficient, fourth power of the tire force, least tire force, body
                  acceleration (plain and weighted by ISO 2631-1 W_k), suspension travel, switches
  the DAE         the dynamic amplification estimate (DAE) from the strategy's own unit ramps beside
                  the simulated DAF: of Eq. (15), and of second order over the class of the roads;
                  how either orders the strategies

The effect is the bending moment at --section alone; `bridgectl dae` takes others.

With --robust the study is another one: what each strategy, made for this bridge and vehicle, gains
or loses when something is wrong (frequency and damping of the bridge, load, the speed and position
that it is told, lag, samples, noise, filters for velocities, or all at once), for each road class
beside the vehicle's own damper; harm is marked. It takes two minutes on two cores. There are two
more strategies: careful bridgehook (made for 10 ms of lag and a position known to 1.5 m) and simple
bridgehook (the same without feedback).

The library: passive (the vehicle's own), preset, skyhook, continuous skyhook, groundhook, tire
groundhook, extended groundhook, selective groundhook, hybrid, ADD, SH-ADD, PDD, clipped LQR,
bridgehook. Slower ones by --strategies alone, of a quarter-car: rollout, which predicts the peak of
what it commands, and 'preview 10 m', which sees the road as far ahead.

ROAD is delimited text, ERD text or OpenCRG, whose units the file states ('x [m], z [mm]') or
--units tells; the file options hold for all of them. Without ROAD: a measured road that comes with
the program. Beside the files there are --random N roads of ISO 8608 class A and N of class B, the
same every time. Without options it takes a minute on two cores; --resume FILE keeps what is done
when it is interrupted.

examples:
  bridgectl score --plot score.png
  bridgectl score east.csv west.csv --units m,mm --station 1250 --span 35 --random 0
  bridgectl score --strategies skyhook,groundhook,bridgehook --lag 0.01 --max-force 20e3
  bridgectl score --spans 25,25 --mass-per-length 18e3 --frequency 4.1 --section 0.2
  bridgectl score --robust --plot robust.png
  bridgectl score --robust --strategies bridgehook,hybrid --errors position,lag --random 40
  bridgectl score --random 50 --resume score.jsonl --json > score.json"""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add every option but those of the output."""
    shared.add_file_options(parser, many=True)
    shared.add_place_options(parser, approach=60.0, speeds="60:120:10")
    text = "road after the bridge that is driven, for ride and tire force [m] (default 0)"
    shared.add_option(parser, "--departure", "M", text, shared.as_number, 0.0)
    text = "random roads of ISO 8608 class A, and as many of class B (default 6; --robust 20)"
    shared.add_option(parser, "--random", "N", text, shared.as_whole)
    text = "find the optimum with all of the road known, too, and the share of the gap to it that "
    text += "each strategy closes: some seconds for each; with --approach 0 a proven bound, too"
    parser.add_argument("--clairvoyant", action="store_true", help=text)
    _add_damper_options(parser)
    robust = parser.add_argument_group("robustness")
    text = "what is left of each strategy's gain when something is wrong"
    robust.add_argument("--robust", action="store_true", help=text)
    shared.add_option(robust, "--errors", "KIND,KIND", "what is wrong, as 'position,lag' (default "
                       "all that are known)")  # fmt: skip
    bridge.add_bridge_options(parser)
    shared.add_vehicle_options(parser)
    work = parser.add_argument_group("work")
    shared.add_resume_option(work)
    shared.add_work_options(work)


def _add_damper_options(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group(
        "semi-active damper", "Force limit, lag and noise leave constant dampers as they are."
    )
    shared.add_option(
        group, "--strategies", "NAME,NAME", "those of the library to score beside the vehicle's "
        "own damper; 'constant' for the constant dampers (default all)",
    )  # fmt: skip
    shared.add_hardware_options(group)
