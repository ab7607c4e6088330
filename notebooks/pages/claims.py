"""How a page's claims are checked: each has a value, what the text says, and a tolerance."""

from __future__ import annotations

from collections.abc import Iterable


def hold(claims: Iterable[tuple[str, float, float, float]]) -> None:
    """Assert claims of (words, value, expected, tolerance), and say that all of them hold."""
    for words, value, expected, tolerance in claims:
        # Not the other way round, which would let a value that is not a number pass.
        assert abs(value - expected) <= tolerance, f"{words}: {value:g}, not {expected:g}"
    print("All claims of this page checked.")
