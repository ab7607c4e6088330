"""What `bridgectl validate` takes."""

from __future__ import annotations

import argparse

from bridgectl.cli.commands import shared

HELP = """\
Do Section 4 of Li, OBrien and Gonzalez (2006) again: compare DAE and superposed DAF with the
simulated DAF of eight good roads (IRI below 7 m/km) on bridges of 15, 25 and 35 m. The truck starts
at rest where the bridge begins (Figs. 8 and 9) or 200 m before it (Fig. 11). Roads 1 and 2 are
measured, 3 to 6 random, 7 and 8 made for the largest and smallest DAF. It takes a minute.

With --dampers: does the DAE of second order, over a road class, order dampers as simulation does?
34 of them, 11 of which had no part in finding its formula, cross the same bridges after 60 m of
approach, on 60 random roads of class A and of class B and on their mirror images. It takes some ten
minutes on two cores; --resume FILE keeps what is done (in files with the span in their names).

examples:
  bridgectl validate --plot validation.png
  bridgectl validate --dampers --resume dampers.jsonl --plot dampers.png
  bridgectl validate --spans 25 --speeds 60:120:5 --json"""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add what a validation may leave out."""
    text = "spans [m], odd, 9 to 35 (default 15,25,35)"
    shared.add_option(parser, "--spans", "A,B,C", text, default="15,25,35")
    shared.add_speeds(parser, None, "50:150:1; of dampers 60:120:5")
    dampers = parser.add_argument_group("dampers")
    dampers.add_argument(
        "--dampers", action="store_true", help="put the DAE of second order to the test instead"
    )
    text = "random roads of each class, with a mirror image each (default 60)"
    shared.add_option(dampers, "--pairs", "N", text, shared.as_whole)
    shared.add_resume_option(dampers)
    shared.add_work_options(parser.add_argument_group("work"))
