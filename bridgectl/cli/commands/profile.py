"""What `bridgectl profile` takes."""

from __future__ import annotations

import argparse

from bridgectl.cli.commands import shared

SEGMENT = 100.0
"""Segments of a road that get an IRI each [m]."""

HELP = """\
Measure the tracks of a road file:

  IRI             International Roughness Index (ASTM E1926), of all and of each segment;
                  a road is good, in the sense of Li, OBrien and Gonzalez (2006), below 7 m/km
  G_d(n0), w      line of ISO 8608 through the spectrum: roughness at n0 = 0.1 cycles/m, waviness
  class           ISO 8608 class of that roughness, A to H
  coarse          measured at steps above one foot: the IRI is too low, and there is no class

FILE is delimited text, ERD text or OpenCRG; all its tracks are measured, or the one of --track.
Without FILE: a measured road of 544 m that comes with the program.

examples:
  bridgectl profile
  bridgectl profile survey.erd --plot survey.png
  bridgectl profile levels.csv --step 0.25 --units mm --segment 50 --json"""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add every option but those of the output."""
    shared.add_file_options(parser)
    text = f"length over which IRIs are taken [m] (default {SEGMENT:g})"
    shared.add_option(parser, "--segment", "M", text, shared.as_number, SEGMENT)
