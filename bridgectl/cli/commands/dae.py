"""What `bridgectl dae` takes."""

from __future__ import annotations

import argparse

from bridgectl.cli.commands import bridge, shared

HELP = """\
Place a bridge in a road and say how much the road amplifies the bending moment of a truck's
crossing, or other load effects (--effect), at every speed:

  DAF smooth      dynamic amplification factor (DAF) of a smooth road
  DAE             that, plus what each 100 mm ramp of the road adds on its own: the dynamic
                  amplification estimate of Li, OBrien and Gonzalez (2006), Eq. (15)
  superposed DAF  the same ramps, superposed as moment histories: exact while tires stay down
  simulated DAF   the crossing itself

FILE is delimited text, ERD text or OpenCRG: stations and elevations (positive upward), whose units
the file states ('x [m], z [mm]') or --units tells. Of several tracks the first counts, or --track.
Accelerations have no static peak: their peaks are told in m/s^2, and called so. JSON of several
effects has a list of them.
Without FILE: a measured road of 544 m that comes with the program.

examples:
  bridgectl dae
  bridgectl dae road.csv --units m,mm --station 1250 --span 35 --plot dae.png
  bridgectl dae --truck T5air --effect hogging@25 --spans 25,25 --mass-per-length 18e3 --frequency 4
  bridgectl dae --spans 25,25 --mass-per-length 18e3 --frequency 4.1 --effect sagging@10,hogging@25
  bridgectl dae --bridge example --effect reaction@50,deflection@12.5,tire_force
  bridgectl dae survey.erd --track RElev.
  bridgectl dae --speeds 60,80,100 --acceleration -3
  bridgectl dae road.txt --units m,m --speeds 60:120:2 --damping 12e3 --json > dae.json"""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add every option but those of the output."""
    shared.add_file_options(parser)
    shared.add_place_options(parser)
    bridge.add_bridge_options(parser, effects=True)
    shared.add_vehicle_options(parser)
    shared.add_option(
        parser, "--acceleration", "A",
        "simulate what brakes (negative) or speeds up so from the start of the bridge on [m/s^2]; "
        "speeds are those there (default 0)", shared.as_number, 0.0,
    )  # fmt: skip
