"""Options of the bridge: a deck of the thesis, a bridge of one's own, or one in a file."""

from __future__ import annotations

import argparse
import re
from typing import Any

import numpy as np

import bridgectl as bc
from bridgectl.cli.bridge_file import EXAMPLE, N_MODES, bridge_of_spans, read_bridge
from bridgectl.cli.effects import EFFECT_HELP
from bridgectl.cli.options import OWN, add_option, as_number, as_whole, numbers
from bridgectl.model.bridge import BridgeModel, described
from bridgectl.model.recovery import RECOVERIES

FILE_HELP = """\
In place of a deck of the thesis: --length or --spans, with --mass-per-length, and
--flexural-rigidity or --frequency; or --bridge. A FILE.toml of --bridge looks like the example
that ships, which '--bridge example' takes:

{example}
Or it has modes = "modes.csv", a table with a column a mode, and [[effects]] that they tell:
quantity = "moment", at = 12.5, places, influence, modal. See bridgectl/cli/bridge_file.py."""


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
    ways = ", ".join(RECOVERIES)
    add_option(modes, "--recovery", "HOW", f"of the moment from the modes: {ways} (default exact)",
               default="exact")  # fmt: skip


def make_bridge(args: argparse.Namespace) -> bc.Beam | bc.Bridge | bc.ModalBridge:
    """Make the bridge of the bridge options."""
    _require_compatible(args)
    if args.bridge is not None:
        return read_bridge(args.bridge)
    damping = _numbers(args, "damping_ratio")
    if args.length is None and args.spans is None:
        return bc.li2006.beam(
            25 if args.span is None else args.span, args.deck,
            n_modes=N_MODES if args.modes is None else args.modes,
            damping_ratio=0.0 if damping is None else damping,
        )  # fmt: skip
    spans = [args.length] if args.spans is None else numbers("--spans", args.spans, float)
    words = None if args.supports is None else [word.strip() for word in args.supports.split(",")]
    given = {
        "spans": spans, "mass_per_length": _numbers(args, "mass_per_length", len(spans)),
        "flexural_rigidity": _numbers(args, "flexural_rigidity", len(spans)),
        "frequency": args.frequency, "supports": words, "n_modes": args.modes,
        "damping_ratio": damping,
    }  # fmt: skip
    given = {name: value for name, value in given.items() if value is not None}
    try:
        return bridge_of_spans(given, damped_in_mode_1=args.length is not None)
    except (TypeError, ValueError) as error:
        options = "|".join((*OWN, "spans"))
        text = re.sub(rf"^({options})\b", lambda found: _option(found[1]), str(error))
        raise ValueError(text) from None


def _numbers(args: argparse.Namespace, name: str, n_spans: int | None = None) -> Any:
    """The number of an option, or its numbers, of which there may be one a span."""
    text = getattr(args, name)
    if text is None:
        return None
    found = numbers(_option(name), text, float)
    if n_spans is not None and len(found) not in (1, n_spans):
        each = f", or one of each of the {n_spans} spans" if n_spans > 1 else ""
        raise ValueError(f"{_option(name)} must be one number{each}, got {len(found)}")
    return tuple(found) if len(found) > 1 else found[0]


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _require_compatible(args: argparse.Namespace) -> None:
    """Refuse options of which one says what another says, too, or that lack another."""

    def given(*names: str) -> list[str]:
        return [_option(name) for name in names if getattr(args, name) is not None]

    ways = given("bridge", "length", "spans", "span", "deck")
    if len(ways) > 1 and ways != ["--span", "--deck"]:
        raise ValueError(f"{ways[0]} and {ways[1]} exclude each other: leave one out")
    own = given(*OWN[1:])
    if args.bridge is not None and (told := [*own, *given("modes", "damping_ratio")]):
        raise ValueError(f"--bridge and {told[0]} exclude each other: the file tells it")
    if args.length is None and args.spans is None:
        if own:
            raise ValueError(f"{own[0]} goes with --length or --spans: type one of them, too")
        return
    if args.length is not None and args.supports is not None:
        raise ValueError(f"--supports goes with --spans: type --spans {args.length:g}")
    if args.mass_per_length is None:
        raise ValueError(f"{ways[0]} needs --mass-per-length: type it in kg/m, as 18e3")
    rigidities = given("flexural_rigidity", "frequency")
    if len(rigidities) > 1:
        raise ValueError(f"{' and '.join(rigidities)} exclude each other: leave one out")
    if not rigidities:
        raise ValueError(
            f"{ways[0]} needs --flexural-rigidity [N m^2], as 4.9e10, or --frequency [Hz], as 4.1: "
            "type one of them"
        )


def bridge_json(bridge: BridgeModel) -> dict[str, Any]:
    """Give what a bridge is, with units in the keys."""
    if isinstance(bridge, bc.ModalBridge):
        told = [name if isinstance(name, str) else list(name) for name in bridge.effects]
        return {
            "length_m": bridge.length, "n_modes": bridge.n_modes,
            "frequencies_Hz": bridge.frequencies.tolist(),
            "modal_masses_kg": bridge.modal_masses.tolist(),
            "damping_ratio": bridge.damping_ratios.tolist(), "effects": told,
        }  # fmt: skip
    units = {"length": "_m", "spans": "_m", "mass_per_length": "_kg_per_m",
             "flexural_rigidity": "_N_m2"}  # fmt: skip
    found = {f"{name}{units.get(name, '')}": value for name, value in described(bridge).items()}
    more = {} if isinstance(bridge, bc.Beam) else {"length_m": bridge.length}
    return found | more | {"frequencies_Hz": (bridge.omega / (2 * np.pi)).tolist()}
