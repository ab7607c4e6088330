"""What laws measure, by name: at their own leg, and at others of a vehicle."""

from __future__ import annotations

from collections.abc import Sequence

SIGNALS = (
    "body_velocity",
    "axle_velocity",
    "suspension_travel",
    "suspension_velocity",
    "body_acceleration",
    "axle_acceleration",
    "tire_force",
    "tire_force_rate",
    "position",
    "speed",
)
"""What a strategy may measure: m/s, m/s, m, m/s, m/s^2, m/s^2, N, N/s, m from the bridge's start,
m/s. Each leg of a vehicle has its own: of its ends, its tires (summed) and their place. That of
another leg is called by the leg's name or number, too: 'body_velocity_rear', 'body_velocity_2'.

Displacements are positive downward, the suspension's are body minus axle, as in the crossing. The
rate of the tire force is its change since the last sample over the sample time (0 at the first).
"""

LONGEST_FIRST = sorted(SIGNALS, key=len, reverse=True)


def parts_of(name: str) -> tuple[str, str]:
    """Return the signal that a name is, and the leg that it is of: '' for a law's own.

    What is no signal at all gives ('', '').
    """
    if name in SIGNALS:
        return name, ""
    for signal in LONGEST_FIRST:
        if name.startswith(f"{signal}_") and name != f"{signal}_":
            return signal, name.removeprefix(f"{signal}_")
    return "", ""


def others_of(law: str, signals: Sequence[str], legs: Sequence[str]) -> list[tuple[str, str, int]]:
    """Return the names of what a law measures by leg, each with its signal and the leg from 0.

    A number counts the legs from 1, before names.
    """
    found = []
    for name in signals:
        signal, leg = parts_of(name)
        if not leg:
            continue
        if leg.isdecimal() and 1 <= int(leg) <= len(legs):
            found.append((name, signal, int(leg) - 1))
        elif leg in legs:
            found.append((name, signal, legs.index(leg)))
        else:
            raise ValueError(
                f"{law} measures {name!r}, which the vehicle has not: its dampers are "
                f"{', '.join(map(repr, legs))}; type for example s.{signal}_{legs[-1]}, or "
                f"s.{signal} for that of the law's own"
            )
    return found
