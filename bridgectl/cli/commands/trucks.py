"""What `bridgectl trucks` takes."""

from __future__ import annotations

import argparse

HELP = """\
List the trucks that --truck takes by name, with the static loads of their axles, the distances
between these and the natural frequencies on a rigid road; or tell one of them, or the one of a TOML
file. --plot draws it from the side; --toml prints its file, from which to make one of your own.

examples:
  bridgectl trucks
  bridgectl trucks T5air --plot T5air.png
  bridgectl trucks T5air --toml > mine.toml
  bridgectl dae --truck mine.toml"""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add every option but those of the output."""
    parser.add_argument("truck", nargs="?", metavar="TRUCK", help="a name, or FILE.toml")
    parser.add_argument("--toml", action="store_true", help="print the file of TRUCK instead")
