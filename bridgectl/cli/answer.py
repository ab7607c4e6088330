"""What the commands that answer a question share: short or --full, stress, what to type next."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import bridgectl as bc
from bridgectl import _checks as check
from bridgectl.cli.bridge_file import section_modulus
from bridgectl.cli.commands.shared import VEHICLE
from bridgectl.cli.effects import Asked

MODULI = 1e-5, 1e3
"""Section moduli that a bridge may have [m^3]: a footbridge's rail to a box girder's deck."""

ROAD, FILE, BRIDGE, TRUCK, STRESS, FULL = (
    ("your road", "ROAD.csv --units m,mm --station 1250"),
    ("your road", "ROAD.csv --units m,mm"),
    ("your bridge", "--spans 25,25 --mass-per-length 18e3 --frequency 4.1"),
    ("your truck", "--truck T5air"),
    ("stress", "--section-modulus 1.1"),
    ("every table", "--full"),
)
"""What to add to a command, and what for."""


def checked_modulus(args: argparse.Namespace, asked: Sequence[Asked]) -> float | None:
    """Return --section-modulus, or that of --bridge [m^3], if it makes sense for what is asked."""
    stated, where = args.section_modulus, "--section-modulus"
    of_moment = any(isinstance(each.effect, bc.Moment) for each in asked)
    if stated is None and args.bridge is not None:
        stated, where = section_modulus(args.bridge), f"{args.bridge}: section_modulus"
        stated = stated if of_moment else None
    if stated is None:
        return None
    modulus = check.positive(where, stated, unit="m^3")
    if not MODULI[0] <= modulus <= MODULI[1]:
        raise ValueError(
            f"{where} must be in m^3, {MODULI[0]:g} to {MODULI[1]:g}, got {modulus:g}: "
            "type 0.35 for 350e6 mm^3"
        )
    if not of_moment:
        raise ValueError(
            f"--section-modulus gives the stress of a moment, and {asked[0].name} is none: leave "
            "it out, or type --effect moment"
        )
    return modulus


def next_steps(
    args: argparse.Namespace, *more: tuple[str, str], modulus: float | None = None
) -> str:
    """Return what may be added to a command: what is not given yet, and then `more`.

    `modulus` is that of `checked_modulus`, of commands that tell stresses.
    """
    given = vars(args)
    own_bridge = any(given.get(name) for name in ("bridge", "length", "spans", "span", "deck"))
    own_truck = any(given.get(name) for name in ("truck", *VEHICLE, "weighed", "fleet"))
    steps = [
        (ROAD if "station" in given else FILE, given.get("file") or given.get("roads")),
        (BRIDGE, own_bridge or "bridge" not in given),
        (TRUCK, own_truck or "truck" not in given),
        *((each, False) for each in more),
        (STRESS, modulus is not None or "section_modulus" not in given),
        (FULL, args.full),
    ]
    lines = [f"  {what:<14} {words}" for (what, words), done in steps if not done]
    return "\n".join(["", "Next, add to this command for", *lines]) if lines else ""
