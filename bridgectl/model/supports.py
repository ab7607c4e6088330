"""What holds a bridge, and what it is made of: supports, spans, and tables of pieces, checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from bridgectl import _checks
from bridgectl._checks import FloatArray
from bridgectl._places import SAME_PLACE

Along: TypeAlias = float | tuple[float, ...] | tuple[tuple[float, float], ...]
"""One number, one a span, or pieces (length, value) from the start of the bridge."""


@dataclass(frozen=True)
class Support:
    """How a bridge is held at one place.

    Parameters
    ----------
    vertical : float, optional
        Stiffness against deflection [N/m]: infinite for a rigid support, 0 for none.
    rotational : float, optional
        Stiffness against rotation [N m/rad]: infinite if clamped, 0 if free to rotate.

    Raises
    ------
    TypeError, ValueError
        If a stiffness is no number of 0 or more.

    Examples
    --------
    >>> from bridgectl.model.supports import Support
    >>> Support(vertical=5e8)
    Support(vertical=500000000.0, rotational=0.0)
    """

    vertical: float = np.inf
    rotational: float = 0.0

    def __post_init__(self) -> None:
        for name in ("vertical", "rotational"):
            value = getattr(self, name)
            if not (isinstance(value, float) and value == np.inf):
                object.__setattr__(self, name, _checks.not_negative(name, value))

    def __str__(self) -> str:
        return f"{self.vertical:g} N/m and {self.rotational:g} N m/rad"


KINDS = {
    "simple": Support(),
    "clamped": Support(np.inf, np.inf),
    "free": Support(0.0, 0.0),
}
"""Supports that have a name."""


def checked_spans(value: Any) -> tuple[float, ...]:
    """Spans [m] from one length or several."""
    if not _is_sequence(value):
        return (_checks.positive("spans", value, unit="m"),)
    if len(value) == 0:
        raise ValueError("spans must hold at least one length in m, got none: type spans=[25, 30]")
    _checks.refuse_masked("spans", value)
    return tuple(_checks.positive(f"spans[{i}]", span, unit="m") for i, span in enumerate(value))


def checked_along(name: str, value: Any, spans: tuple[float, ...], unit: str) -> Along:
    """A property along the bridge: one number, one a span, or pieces that cover the bridge."""
    if not _is_sequence(value):
        return _checks.positive(name, value, unit=unit)
    _checks.refuse_masked(name, value)
    table = [_is_sequence(entry) for entry in value]
    if any(table):
        return _checked_table(name, value, sum(spans), unit)
    if len(value) != len(spans):
        raise ValueError(
            f"{name} must be one number, one a span ({len(spans)}), or pieces (length, value) "
            f"over {sum(spans):g} m, got {len(value)} numbers: type for example "
            f"{name}=[({spans[0]:g}, {value[0] if len(value) else 1}), ...]"
        )
    return tuple(_checks.positive(f"{name}[{i}]", v, unit=unit) for i, v in enumerate(value))


def _checked_table(name: str, value: Any, length: float, unit: str) -> Along:
    pieces = []
    for i, entry in enumerate(value):
        if not (_is_sequence(entry) and len(entry) == 2):
            raise ValueError(
                f"{name}[{i}] must be a pair (length [m], value [{unit}]), got {entry!r}: pieces "
                f"follow each other from the start of the bridge, as [(10, {1e10:g}), (15, 2e10)]"
            )
        pieces.append(
            (
                _checks.positive(f"{name}[{i}][0]", entry[0], unit="m"),
                _checks.positive(f"{name}[{i}][1]", entry[1], unit=unit),
            )
        )
    covered = sum(piece[0] for piece in pieces)
    if abs(covered - length) > SAME_PLACE * max(length, 1.0):
        last = pieces[-1][0] + length - covered
        remedy = f": type {last:g} for the length of the last piece" if last > 0 else ""
        raise ValueError(
            f"{name} has pieces up to {covered:g} m, the bridge is {length:g} m long{remedy}"
        )
    return tuple(pieces)


def steps(value: Along, spans: tuple[float, ...]) -> tuple[FloatArray, FloatArray]:
    """Ends of the pieces of a property [m], and its value before each."""
    if not isinstance(value, tuple):
        return np.array([sum(spans)]), np.array([value])
    if isinstance(value[0], tuple):
        lengths, values = np.array(value).T
        return np.cumsum(lengths), values
    return np.cumsum(spans), np.array(value)


def checked_supports(value: Any, n_spans: int) -> tuple[str | Support, ...]:
    """Supports from words, mappings or `Support`, by default all simple; words where there are."""
    count = n_spans + 1
    if value is None:
        return ("simple",) * count
    if isinstance(value, str | Mapping | Support) or not _is_sequence(value):
        one = repr(value) if isinstance(value, str) else '"simple"'
        raise TypeError(
            f"supports must be a list of {count}, one an end of each span, got {value!r}: type "
            f"supports=[{', '.join([one] * min(count, 3))}{', ...' * (count > 3)}]"
        )
    if len(value) != count:
        raise ValueError(
            f"supports must be {count} for {n_spans} span{'s' * (n_spans > 1)}, got {len(value)}"
        )
    supports = [_checked_support(i, support) for i, support in enumerate(value)]
    _refuse_mechanism(supports)
    return tuple(_named(support) for support in supports)


def _checked_support(i: int, value: Any) -> Support:
    if isinstance(value, Support):
        return value
    if isinstance(value, Mapping):
        if unknown := set(value) - {"vertical", "rotational"}:
            raise ValueError(
                f"supports[{i}] has {sorted(map(str, unknown))[0]!r}, not one of 'vertical' [N/m] "
                "and 'rotational' [N m/rad]: type {'vertical': 5e8, 'rotational': 0}"
            )
        return Support(**value)
    return KINDS[_checks.choice(f"supports[{i}]", value, tuple(KINDS))]


def _named(support: Support) -> str | Support:
    """The word for a support that has one."""
    return next((word for word, kind in KINDS.items() if kind == support), support)


def _refuse_mechanism(supports: Sequence[Support]) -> None:
    held = sum(support.vertical > 0 for support in supports)
    turned = sum(support.rotational > 0 for support in supports)
    if held == 0:
        raise ValueError(
            "supports leave the bridge free to fall: make two of them 'simple', or one 'clamped'"
        )
    if held == 1 and turned == 0:
        at = next(i for i, support in enumerate(supports) if support.vertical > 0)
        raise ValueError(
            f"supports leave the bridge free to turn about supports[{at}]: make that one "
            "'clamped', or another one 'simple'"
        )


def checked_rayleigh(value: Any, n_modes: int) -> tuple[tuple[int, float], ...] | None:
    """Two pairs (mode, ratio) from a mapping or from such pairs, None of anything else."""
    pairs = list(value.items()) if isinstance(value, Mapping) else value
    if not (_is_sequence(pairs) and len(pairs) and all(_is_sequence(pair) for pair in pairs)):
        return None
    modes = [_checks.integer("damping_ratio's mode", pair[0], at_least=1) for pair in pairs]
    if len(set(modes)) != 2 or len(modes) != 2 or max(modes) > n_modes:
        raise ValueError(
            f"damping_ratio as a mapping must have the ratios of two modes from 1 to {n_modes}, "
            f"got modes {modes}: type damping_ratio={{1: 0.02, 2: 0.02}}"
        )
    ratios = [_checks.not_negative("damping_ratio", pair[1]) for pair in pairs]
    return tuple(sorted(zip(modes, ratios, strict=True)))


def rayleigh(pairs: Sequence[tuple[int, float]], omega: FloatArray) -> FloatArray:
    """Damping ratios a / w + b w that are given at two modes."""
    modes = [mode - 1 for mode, _ in pairs]
    of_two, given = omega[modes], np.array([ratio for _, ratio in pairs])
    if np.ptp(of_two) <= 1e-9 * of_two[0]:
        raise ValueError(
            "damping_ratio: both modes have the same frequency: give the ratios of two others"
        )
    terms = np.linalg.solve(np.column_stack([1 / of_two, of_two]), given)
    ratios = terms[0] / omega + terms[1] * omega
    ratios[modes] = given  # without round-off below 0
    if wrong := [j for j, ratio in enumerate(ratios) if not 0 <= ratio < 1]:
        j = wrong[0]
        raise ValueError(
            f"damping_ratio gives mode {j + 1} the ratio {ratios[j]:.3g}, which must be from 0 to "
            "1: give ratios at modes further apart, or one number for all modes"
        )
    return np.asarray(ratios)


def merged(*ends: FloatArray) -> FloatArray:
    """Ends of pieces from 0 on [m], those that only round-off keeps apart taken as the first's."""
    kept = [0.0, *ends[0]]
    for place in np.concatenate(ends[1:]):
        if min(abs(place - other) for other in kept) > SAME_PLACE * max(kept[-1], 1.0):
            kept.append(float(place))
    return np.sort(kept)


def _is_sequence(value: Any) -> bool:
    """Whether a value is a list of values; text, numbers and sets are none."""
    return isinstance(value, list | tuple) or (isinstance(value, np.ndarray) and value.ndim > 0)
