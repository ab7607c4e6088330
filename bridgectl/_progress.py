"""A progress bar on the terminal for work that takes a while."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from typing import TypeVar

T = TypeVar("T")


def track(items: Iterable[T], description: str, total: int, *, show: bool = True) -> Iterator[T]:
    """Yield the items, with a bar on standard error while they last if that is a terminal."""
    if not (show and sys.stderr.isatty()):
        yield from items
        return
    # Imported late: most uses of the library never draw a bar.
    from rich.console import Console
    from rich.progress import track as rich_track

    console = Console(stderr=True)
    yield from rich_track(items, description, total=total, console=console, transient=True)
