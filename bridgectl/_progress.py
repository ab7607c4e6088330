"""A progress bar on the terminal for work that takes a while."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from time import monotonic
from typing import TypeVar

T = TypeVar("T")

PATIENCE = 2.0
"""Work that takes less [s] shows no bar."""


def shows(wanted: bool = True) -> bool:
    """Tell whether a bar that is wanted is seen: on standard error if that is a terminal."""
    return wanted and sys.stderr.isatty()


def track(items: Iterable[T], description: str, total: int, *, show: bool = True) -> Iterator[T]:
    """Yield the items, with a bar on the terminal from the third second on while they last."""
    if not shows(show):
        yield from items
        return
    # Imported late: most uses of the library never draw a bar.
    from rich.console import Console
    from rich.progress import Progress

    begin = monotonic()
    bar = Progress(console=Console(stderr=True), transient=True)
    task = bar.add_task(description, total=total)
    try:
        for item in items:
            yield item
            bar.advance(task)
            if not bar.live.is_started and monotonic() - begin > PATIENCE:
                bar.start()
    finally:
        bar.stop()
