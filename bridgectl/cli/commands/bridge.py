"""Options of the bridge: a deck of the thesis, a bridge of one's own, or one in a file."""

from __future__ import annotations

import argparse
from pathlib import Path

from bridgectl.cli.commands.shared import add_option, as_number, as_whole

EXAMPLE = Path(__file__).parents[1] / "data" / "two_spans.toml"
"""What the word 'example' stands for."""

N_MODES = 3
"""Modes of one simply supported span, as of the decks of the thesis."""

FILE_HELP = """\
In place of a deck of the thesis: --length or --spans, with --mass-per-length, and
--flexural-rigidity or --frequency; or --bridge. A FILE.toml of --bridge looks like the example
that ships, which '--bridge example' takes:

{example}
Or it has modes = "modes.csv", a table with a column a mode, and [[effects]] that they tell:
quantity = "moment", at = 12.5, places, influence, modal. section_modulus = 1.1 gives stresses, as
--section-modulus does. See bridgectl/cli/bridge_file.py."""

EFFECT_HELP = """\
NAME@METRES, several separated by commas; the place counts from the start of the bridge, halfway if
left out: moment (also sagging), hogging (the smallest moment), shear, reaction, deflection,
bridge_acceleration, tire_force, body_acceleration; least_shear, least_tire_force, ... of the
smallest value (default moment, at --section)"""


def add_bridge_options(parser: argparse.ArgumentParser, *, effects: bool = False) -> None:
    """Add the bridge and how its moment is found, or other effects."""
    deck = parser.add_argument_group("bridge (Li's thesis, 2006; default the paper's 25 m)")
    add_option(deck, "--span", "M", "odd, 9 to 43 [m]", as_number)
    deck.add_argument("--deck", help="solid, Y or super-Y, for spans that have several")
    shown = EXAMPLE.read_text(encoding="utf-8")
    indented = "".join(f"  {line}\n" for line in shown.splitlines())
    own = parser.add_argument_group("bridge of your own", FILE_HELP.format(example=indented))
    add_option(own, "--length", "M", "of one simply supported beam [m]", as_number)
    add_option(own, "--spans", "M,M,...", "lengths of the spans [m]")
    add_option(own, "--mass-per-length", "X", "[kg/m], one number, or one a span")
    add_option(own, "--flexural-rigidity", "X", "E J [N m^2], one number, or one a span")
    add_option(own, "--frequency", "HZ", "the first one, which E J is made for", as_number)
    add_option(own, "--supports", "S,S,...", "of --spans, one at each end of a span: simple, "
               "clamped, free (default simple)")  # fmt: skip
    add_option(own, "--bridge", "FILE", "a TOML file of all that")
    modes = parser.add_argument_group("modes and effect")
    add_option(modes, "--modes", "N", f"number (default {N_MODES}; of several spans, or not simply "
               "supported, 6 a span)", as_whole)  # fmt: skip
    add_option(modes, "--damping-ratio", "Z", "of mode 1, from which others fall as 1 / f; of all "
               "modes with --spans; or A,B,C of each (default 0)")  # fmt: skip
    add_option(modes, "--section", "S", "section of the moment, as a fraction of the length "
               "(default 0.5)", as_number, 0.5)  # fmt: skip
    if effects:
        add_option(modes, "--effect", "E,E", EFFECT_HELP)
    add_option(modes, "--recovery", "HOW", "of the moment from the modes: exact, li2006, modal "
               "(default exact)", default="exact")  # fmt: skip
