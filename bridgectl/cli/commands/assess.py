"""What `bridgectl assess` takes."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from bridgectl.cli.commands import bridge, shared

CLASSES = "A,B"
"""ISO 8608 classes of the random roads, if there are no others."""

HELP = """\
Let random or weighed trucks cross a bridge, each at its speed on one of the roads, and say what the
bridge has to bear: the total effect against the static one.

  distribution     of static and total effect and of the dynamic amplification factor (DAF), which
                   falls as the static effect rises
  characteristic   effects of a return period, with 95 % confidence intervals, and their ratio, the
                   assessment dynamic ratio (ADR), which stands for this bridge's dynamic factor
  influence        of the quality of the road, and of semi-active dampers in a share of the trucks

The trucks: --fleet, distributions in a TOML file, of which two ship (air_sprung, monte_carlo); or
--weighed, a table of a weigh-in-motion station with times, speeds, axle loads and spacings, whose
units are in the names of its columns (speed_kmh, load_1_kN, spacing_1_m, ...) or in
--weighed-units.

The roads: ROAD files, and --random N roads of each class of --classes. Each truck crosses once on
each quality: on one of the files, on one of class A, ...

It shows how far it is; --resume FILE keeps what is done when it is interrupted, and goes on from
there with more trucks, too.

examples:
  bridgectl assess --trucks 2000 --trucks-a-day 1500 --plot bridge.png
  bridgectl assess --weighed station.csv --classes A --span 35 --table crossings.parquet
  bridgectl assess road.csv --units m,mm --spans 25,25 --mass-per-length 18e3 --frequency 4.1 \\
                   --effect sagging@10,hogging@25 --trucks 5000 --trucks-a-day 2000
  bridgectl assess --trucks 200 --trucks-a-day 1500 --damper bridgehook --damper-share 0.2
  bridgectl assess --trucks 1000000 --trucks-a-day 4000 --resume big.jsonl \\
                   --scheduler tcp://HOST:8786"""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add every option but those of the output."""
    trucks = parser.add_argument_group("trucks")
    add = partial(shared.add_option, trucks)
    add("--fleet", "F", "a name that ships, or FILE.toml (default air_sprung)")
    add("--weighed", "FILE", "a table of weighed trucks, or 'example'")
    add("--weighed-units", "U,U", "of columns whose names state none, as speed=km/h,load=kN")
    trucks.add_argument(
        "--leave-out-bad", action="store_true", help="leave out bad rows of the table, and say so"
    )
    add("--trucks", "N", "how many cross (default 2000; all that were weighed)", shared.as_whole)
    add("--trucks-a-day", "N", "for return periods (default: as weighed)", shared.as_number)
    add("--meeting", "N", "trucks an hour from the other end, at random times (default 0)",
        shared.as_number, 0.0)  # fmt: skip
    add("--lane-factor", "X", "share of what trucks in the other lane do (default 1)",
        shared.as_number, 1.0)  # fmt: skip
    add("--damper", "NAME", "of the strategies of 'bridgectl score', made for each truck")
    add("--damper-share", "X", "of the trucks, that cross with it, too: a second each (default "
        "0.1)", shared.as_number, 0.1)  # fmt: skip
    add("--seed", "N", "of all that is drawn (default 0)", shared.as_whole, 0)
    shared.add_file_options(parser, many=True)
    shared.add_place_options(parser, approach=100.0, speeds=None)
    random = parser.add_argument_group("random roads")
    shared.add_option(random, "--classes", "A,B", f"of ISO 8608 (default {CLASSES}, without ROAD)")
    shared.add_option(random, "--random", "N", "of each class (default 20)", shared.as_whole, 20)
    bridge.add_bridge_options(parser, effects=True)
    period = parser.add_argument_group("characteristic values")
    add = partial(shared.add_option, period)
    add("--return-period", "Y", "years (default 1000, of EN 1991-2; AASHTO has 75)",
        shared.as_number, 1000.0)  # fmt: skip
    add("--days-a-year", "N", "on which trucks drive (default 250)", shared.as_number, 250.0)
    method = "peaks over threshold"
    add("--method", "HOW", f"block maxima or {method} (default {method})", default=method)
    work = parser.add_argument_group("work")
    shared.add_resume_option(work)
    shared.add_work_options(work)
    shared.add_option(work, "--table", "FILE", "keep a row for each crossing (csv, parquet)", Path)
