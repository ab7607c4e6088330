"""What `bridgectl dae` prints: the verdict, a short table, and all tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from bridgectl._checks import FloatArray
from bridgectl._tables import make_console, make_table
from bridgectl._units import to_kmh
from bridgectl.model.bridge_effects import Moment
from bridgectl.model.words import Amounts, crossing_in_words

# DaeStudy, whose module imports this one.
Study: TypeAlias = Any

SHOWN_KMH, FEW_KMH = 10, 20
"""The speeds of the printed table are multiples of this [km/h], and those of the short one."""

LARGEST = 10
"""How many ramps are listed."""


def print_verdict(studies: Sequence[Study], section_modulus: float | None = None) -> None:
    """Print what is to be said first: three sentences of one effect, or one of each."""
    console = make_console()
    for study in studies:
        lines = [_critical_sentence(study, amounts_of(study, section_modulus))]
        if len(studies) > 1:
            lines = [f"{study.asked.name}: {lines[0][0].lower()}{lines[0][1:]}"]
        else:
            lines += [_estimate_sentence(study), _ramp_sentence(study)]
        for line in lines:
            console.print(line)
    console.print()


def print_short(studies: Sequence[Study], section_modulus: float | None = None) -> None:
    """Print the table that comes with the verdict, and what crosses what."""
    console, first = make_console(), studies[0]
    if len(studies) == 1:
        table = _few_speeds(first, amounts_of(first, section_modulus))
    else:
        table = _effects_table(studies, section_modulus)
    console.print(
        table,
        "",
        crossing_in_words(first.surface.beam, first.surface.vehicle),
        f"{first.place}, {first.surface.approach:g} m of approach",
        *_motion_words(first),
        sep="\n",
    )


def _motion_words(study: Study) -> list[str]:
    """Say of what brakes or speeds up where it does so."""
    if not study.acceleration:
        return []
    return [
        f"Simulated with {study.acceleration:g} m/s^2 from the start of the bridge on, the speeds "
        "those there; all else at constant speed"
    ]


def amounts_of(study: Study, section_modulus: float | None) -> Amounts:
    """Return how the effect of a study is told: of moments alone there is a stress."""
    effect = study.asked.effect
    return Amounts(effect.unit, section_modulus if isinstance(effect, Moment) else None)


def _critical_sentence(study: Study, amounts: Amounts) -> str:
    """Say at which speed the effect is worst, and how much it is."""
    asked, smooth = study.asked, study.surface.daf_smooth
    kmh, at, at_smooth = to_kmh(study.surface.speeds), study.critical, study.asked.worst(smooth)
    what, unit = ("DAF ", "") if asked.is_factor else ("", f" {asked.effect.unit}")
    line = (
        f"Critical speed: {kmh[at]:g} km/h, {what}{study.simulated[at]:.4f}{unit} "
        f"(smooth road: {kmh[at_smooth]:g} km/h, {smooth[at_smooth]:.4f}{unit})"
    )
    if not asked.is_factor:
        return f"{line}, the {asked.told}."
    static = asked.crossing.static_peak
    return (
        f"{line}: the {asked.told} is {amounts.told(study.simulated[at] * static)}, static "
        f"{amounts.told(static, units=False)}."
    )


def _estimate_sentence(study: Study) -> str:
    """Say what the estimate has, how far it is off, and where it is to be trusted."""
    asked, kmh = study.asked, to_kmh(study.surface.speeds)
    worst = int(np.argmax(np.abs(study.dae - study.simulated)))
    at, name, unit = asked.worst(study.dae), "DAE", ""
    if not asked.is_factor:
        name, unit = "estimate", f" {asked.effect.unit}"
    line = (
        f"{'Least' if asked.least else 'Largest'} {name}: {study.dae[at]:.4f}{unit} at "
        f"{kmh[at]:g} km/h; it is furthest off, by "
        f"{study.dae[worst] - study.simulated[worst]:+.4f}{unit}, at {kmh[worst]:g} km/h"
    )
    if study.trust is None:
        return f"{line}."
    doubted = int((~study.trust.trusted).sum())
    if not doubted:
        return f"{line}, and nothing speaks against it at any speed."
    return f"{line}. Against it speak, at {doubted} of {kmh.size} speeds: {_doubts(study)}."


def _doubts(study: Study) -> str:
    """What speaks against the DAE."""
    trust = study.trust
    moves, lifts = int(trust.peak_moves.sum()), int(trust.lift_off.sum())
    reasons = {
        f"peaks that compete (at {moves})": moves, f"tires that nearly leave the road (at {lifts})":
        lifts, f"ramps up to {1e3 * float(trust.tallest_ramp):.3g} mm": trust.tall,
        f"an IRI of {float(trust.iri):.2g} m/km": trust.rough,
    }  # fmt: skip
    return ", ".join(reason for reason, holds in reasons.items() if holds)


def _ramp_sentence(study: Study) -> str:
    """Say which ramp does most at the critical speed."""
    x, rise, part = study.largest()[0]
    way, to = ("rise" if rise > 0 else "fall"), "DAE" if study.asked.is_factor else "estimate"
    where = f"{-x:.1f} m before" if x < 0 else f"{x:.1f} m behind"
    return (
        f"The 100 mm of road that do most at that speed begin {where} the bridge's start (station "
        f"{study.station + x:.1f} m): they {way} by {1e3 * abs(rise):.2f} mm and change the {to} "
        f"by {part:+.4f}."
    )


def _names(study: Study) -> list[str]:
    """What there is of each speed."""
    if study.asked.is_factor:
        return ["DAF smooth", "DAE", "superposed DAF", "simulated DAF", "DAE error"]
    return ["smooth road", "estimate", "superposed", "simulated", "error"]


def _title(study: Study) -> str:
    asked = study.asked
    if asked.is_factor:
        return f"Dynamic amplification by speed: {asked.told}"
    return f"Peaks by speed [{asked.effect.unit}]: {asked.told}"


def _shown(kmh: FloatArray, every: int, critical: int) -> NDArray[np.intp]:
    """Indices of round speeds, and of the critical one; of all if they are few."""
    shown = np.isclose(kmh % every, 0, atol=1e-6) | np.isclose(kmh % every, every)
    shown |= len(kmh) <= 2 * SHOWN_KMH * SHOWN_KMH / every
    shown[critical] = True
    return np.flatnonzero(shown)


def _few_speeds(study: Study, amounts: Amounts) -> Table:
    """The short table of one effect: factors, and what they come to."""
    kmh, critical, asked = to_kmh(study.surface.speeds), study.critical, study.asked
    smooth, dae, _, simulated, off = _names(study)
    units = amounts.units if asked.is_factor else []
    columns = ["speed [km/h]", smooth, dae, simulated, *(f"[{unit}]" for unit in units), off]
    table = make_table(_title(study), columns, short=True)
    for i in _shown(kmh, FEW_KMH, critical):
        row = study.surface.daf_smooth[i], study.dae[i], study.simulated[i]
        size = amounts.cells(row[-1] * asked.crossing.static_peak) if units else []
        error = f"{round(row[1] - row[2], 3) + 0.0:+.3f}"  # no negative zero
        mark, style = (" <", "bold") if i == critical else ("  ", None)
        cells = [*(f"{value:.3f}" for value in row), *size, error]
        table.add_row(f"{kmh[i]:g}{mark}", *cells, style=style)
    return table


def _effects_table(studies: Sequence[Study], section_modulus: float | None) -> Table:
    """The short table of several effects, each at its critical speed."""
    factors = any(study.asked.is_factor for study in studies)
    names = ["DAE", "DAF", "static", "peak"] if factors else ["estimate", "peak"]
    table = make_table("At the critical speeds", ["effect", "km/h", *names], ["effect"], short=True)
    for study in studies:
        at, asked, amounts = study.critical, study.asked, amounts_of(study, section_modulus)
        kmh, value = f"{to_kmh(study.surface.speeds[at]):g}", study.simulated[at]
        if asked.is_factor:
            static = asked.crossing.static_peak
            cells = [f"{study.dae[at]:.3f}", f"{value:.3f}", amounts.told(static),
                     amounts.told(value * static)]  # fmt: skip
        else:
            unit = asked.effect.unit
            cells = [f"{study.dae[at]:.3f} {unit}", f"{value:.3f} {unit}"]
            cells = ["-", "-", "-", cells[1]] if factors else cells
        table.add_row(asked.name, kmh, *cells)
    return table


def print_full(studies: Sequence[Study]) -> None:
    """Print, of each effect, values by speed, and the largest ramps."""
    console, first = make_console(), studies[0]
    surface = first.surface
    console.print(
        f"Road: {first.road.name or 'unnamed'}, bridge from station {first.station:g} m, "
        f"{surface.approach:g} m of approach, in ramps of {surface.ramp_length * 1e3:g} mm\n"
        f"{first.place}\n"
        f"Bridge: {surface.beam!r}\nVehicle: {surface.vehicle!r}\n"
    )
    for words in _motion_words(first):
        console.print(f"{words}\n", soft_wrap=True)
    for study in studies:
        _print_speeds(console, study)
        _print_largest(console, study)


def _print_speeds(console: Console, study: Study) -> None:
    surface, critical = study.surface, study.critical
    kmh = to_kmh(surface.speeds)
    table = make_table(_title(study), ["speed [km/h]", *_names(study)])
    for i in _shown(kmh, SHOWN_KMH, critical):
        row = [surface.daf_smooth[i], study.dae[i], study.superposed[i], study.simulated[i]]
        cells = [f"{value:.4f}" for value in row] + [f"{row[1] - row[3]:+.4f}"]
        mark = " <" if i == critical else "  "
        table.add_row(f"{kmh[i]:g}{mark}", *cells, style="bold" if i == critical else None)
    console.print(table)


def _print_largest(console: Console, study: Study) -> None:
    asked, surface = study.asked, study.surface
    kmh = to_kmh(surface.speeds[study.critical])
    title = f"The {LARGEST} ramps that contribute most at {kmh:g} km/h"
    to = "DAE" if asked.is_factor else f"estimate [{asked.effect.unit}]"
    table = make_table(title, ["from x [m]", "x / l", "rise [mm]", f"contribution to {to}"])
    for x, rise, part in study.largest():
        place = f"{x / surface.beam.length:.3f}"
        table.add_row(f"{x:.1f}", place, f"{rise * 1e3:+.2f}", f"{part:+.5f}")
    console.print(table)
