"""The printed results of Li, OBrien and Gonzalez (2006), each beside the computed one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bridgectl._checks import FloatArray
from bridgectl._units import from_kmh
from bridgectl.paper import li2006
from bridgectl.simulate import daf, ramp_surface
from bridgectl.surface.surface import RampSurface

RECOVERY = "li2006"
"""How the paper recovers the moment: see `bridgectl.Crossing`."""

SPEEDS_KMH = np.arange(50.0, 151.0)
"""Speeds of the paper's figures [km/h]."""

EXAMPLE_KMH, CRITICAL_KMH = 110, 105
"""Speeds of the example (Section 3.3) and of the remark on Fig. 6 (Section 3.1) [km/h]."""

SEGMENT = 0.1
"""Length of a ramp [m]. The printed values leave open on which side of its place it lies."""


class Row(NamedTuple):
    """One result beside the printed one, found by `paper_results`."""

    what: str
    """What it is, and where."""
    unit: str
    """'km/h', 'x/l' (a place on the bridge) or '' (an amplification)."""
    printed: float | None
    """As printed, in the unit `unit`; None if it is not."""
    computed: float
    """As computed, in the unit `unit`."""
    note: str = ""
    """What else there is to say of it."""

    def __repr__(self) -> str:
        unit = f" {self.unit}" if self.unit else ""
        printed = "nothing" if self.printed is None else f"{self.printed:g}{unit}"
        note = f" ({self.note})" if self.note else ""
        return f"Row({self.what}: printed {printed}, computed {self.computed:.5g}{unit}{note})"

    @property
    def difference(self) -> float | None:
        """Computed minus printed, in the unit `unit`; None if nothing is printed."""
        return None if self.printed is None else self.computed - self.printed


@dataclass(frozen=True, eq=False)
class PaperResults:
    """The results of the paper, computed; made by `paper_results`."""

    rows: tuple[Row, ...]
    """Every printed number beside the computed one."""
    unit: RampSurface
    """Surface of the 1 mm ramp (Fig. 5)."""
    tall: RampSurface
    """Surface of the 10 mm ramp (Fig. 6)."""

    def __repr__(self) -> str:
        return (
            f"PaperResults({len(self.rows)} results, ramps of {self.unit.ramp_height * 1e3:g} mm "
            f"and {self.tall.ramp_height * 1e3:g} mm, {SPEEDS_KMH[0]:g} to {SPEEDS_KMH[-1]:g} km/h)"
        )

    @property
    def smooth_daf(self) -> list[tuple[float, float]]:
        """Speed [km/h] and DAF of a smooth road every 10 km/h, read off Fig. 2."""
        pairs = zip(SPEEDS_KMH, self.unit.daf_smooth, strict=True)
        return [(float(kmh), float(value)) for kmh, value in list(pairs)[::10]]

    @property
    def printed_smooth(self) -> tuple[float, float]:
        """Speed [km/h] and DAF of a smooth road as printed, a point of Fig. 2."""
        return EXAMPLE_KMH, li2006.PRINTED["daf_smooth_110"]


def paper_results() -> PaperResults:
    """Compute what the paper prints: Figs. 2, 5, 6 and 7 and the numbers in the text.

    The bridge and truck of Table 1, three modes, no damping, the paper's own moment recovery,
    and a vehicle in equilibrium at the start of the bridge.
    """
    unit, tall = _surface(1e-3), _surface(1e-2)
    rows = _smooth_rows(unit) + _unit_ramp_rows(unit) + _fig7_rows(unit) + _tall_ramp_rows(tall)
    return PaperResults(tuple(rows), unit, tall)


def _surface(ramp_height: float) -> RampSurface:
    beam, car, speeds = li2006.beam(), li2006.car(), from_kmh(SPEEDS_KMH)
    return ramp_surface(
        beam, car, speeds, ramp_length=SEGMENT, ramp_height=ramp_height, recovery=RECOVERY
    )


def _at(kmh: float) -> int:
    return int(np.searchsorted(SPEEDS_KMH, kmh))


def _smooth_rows(surface: RampSurface) -> list[Row]:
    smooth = surface.daf_smooth
    printed, computed = li2006.PRINTED["daf_smooth_110"], float(smooth[_at(EXAMPLE_KMH)])
    rows = [Row(f"smooth road, {EXAMPLE_KMH} km/h: DAF", "", printed, computed)]
    inner = smooth[1:-1]
    peaks = 1 + np.flatnonzero((inner > smooth[:-2]) & (inner > smooth[2:]))
    twins = np.sort(peaks[np.argsort(smooth[peaks])[-2:]])
    printed = li2006.PRINTED["critical_speed_kmh"]
    for which, peak in zip(("first", "second"), twins, strict=True):
        what, note = f"critical speed, {which} of two", f"DAF {smooth[peak]:.4f}"
        rows.append(Row(what, "km/h", printed, float(SPEEDS_KMH[peak]), note))
    return rows


def _unit_ramp_rows(surface: RampSurface) -> list[Row]:
    speed, span = _at(EXAMPLE_KMH), surface.beam.length
    effect = surface.daf_difference[speed]
    rows = []
    for place in li2006.FIG7_RAMPS:
        printed = li2006.PRINTED[f"unit_ramp_{place:g}l_{EXAMPLE_KMH}"]
        start = round(place * span / SEGMENT)
        what = f"1 mm ramp at {place:g} l, {EXAMPLE_KMH} km/h"
        for ramp in (start, start - 1):
            note = f"from {ramp * SEGMENT:.1f} m to {(ramp + 1) * SEGMENT:.1f} m"
            rows.append(Row(what, "", printed, float(effect[ramp]), note))
    return rows


def _fig7_rows(surface: RampSurface) -> list[Row]:
    speed, rows = _at(EXAMPLE_KMH), []
    notes = {0.0: "ramps start at their places", SEGMENT: "ramps end at their places"}
    for earlier, note in notes.items():
        road = li2006.fig7_road(earlier)
        simulated = daf(
            surface.beam, surface.vehicle, surface.speeds[speed], road, recovery=RECOVERY
        )
        for what, computed in (("DAE", surface.dae(road)[speed]), ("DAF", simulated[0])):
            printed = li2006.PRINTED[f"fig7_{what.lower()}"]
            rows.append(Row(f"Fig. 7: {what}", "", printed, float(computed), note))
    return sorted(rows, key=lambda row: row.what)


def _tall_ramp_rows(surface: RampSurface) -> list[Row]:
    speed, places = _at(CRITICAL_KMH), surface.positions / surface.beam.length
    lowest = int(surface.daf_unit[speed].argmin())
    effect = np.abs(surface.daf_difference)[:, places > 0.5 - 1e-9]
    latest = f"at {SPEEDS_KMH[effect.max(axis=1).argmax()]:.0f} km/h, a later peak"
    printed, note = li2006.PRINTED["tall_ramp_lowest"], f"DAF {surface.daf_unit[speed, lowest]:.4f}"
    what = f"10 mm ramp, {CRITICAL_KMH} km/h: low at"
    return [
        Row(what, "x/l", printed, float(places[lowest]), note),
        _right_half(f"{CRITICAL_KMH} km/h", effect[speed : speed + 1], "largest effect"),
        _right_half("any speed", effect, latest),
    ]


def _right_half(where: str, effect: FloatArray, note: str) -> Row:
    printed = li2006.PRINTED["tall_ramp_right_half"]
    return Row(f"10 mm, right half, {where}", "", printed, float(effect.max()), note)
