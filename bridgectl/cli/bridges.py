"""Options of the bridge: a deck of the thesis, a bridge of one's own, or one in a file."""

from __future__ import annotations

import argparse
import re
from typing import Any

import numpy as np

import bridgectl as bc
from bridgectl.cli.bridge_file import bridge_of_spans, read_bridge
from bridgectl.cli.commands.bridge import N_MODES
from bridgectl.cli.commands.shared import OWN
from bridgectl.cli.options import numbers
from bridgectl.model.bridge import BridgeModel, described


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
