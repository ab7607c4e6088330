"""What `bridgectl paper` takes."""

from __future__ import annotations

import argparse

HELP = """\
Print every number that Li, OBrien and Gonzalez (2006) print, beside the computed one and with the
difference; --plot draws their Figs. 2, 5 and 6.

examples:
  bridgectl paper
  bridgectl paper --plot figures.png"""


def add_options(_: argparse.ArgumentParser) -> None:
    """Add nothing: those of the output are all."""
