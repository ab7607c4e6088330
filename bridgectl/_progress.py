"""A progress bar on the terminal for work that takes a while, with its rate and the time left."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from datetime import timedelta
from time import monotonic
from typing import TypeVar

T = TypeVar("T")

PATIENCE = 2.0
"""Work that takes less [s] shows no bar."""


def shows(wanted: bool = True) -> bool:
    """Tell whether a bar that is wanted is seen: on standard error if that is a terminal."""
    return wanted and sys.stderr.isatty()


def track(
    items: Iterable[T],
    description: str,
    total: float,
    *,
    show: bool = True,
    before: float = 0,
    unit: str = "",
    weight: Callable[[T], float] = lambda _: 1,
) -> Iterator[T]:
    """Yield the items, with a bar on the terminal from the third second on while they last.

    Of the total, `before` was done earlier, and says nothing of the rate. The rate is of units,
    if they have a name; an item is `weight` of them.
    """
    if not shows(show):
        yield from items
        return
    # Imported late: most uses of the library never draw a bar.
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

    begin, done = monotonic(), before
    bar = Progress(
        TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(),
        TextColumn("{task.fields[pace]}"), console=Console(stderr=True), transient=True,
    )  # fmt: skip
    task = bar.add_task(description, total=total, pace="")
    bar.update(task, completed=before)
    try:
        for item in items:
            yield item
            done, spent = done + weight(item), monotonic() - begin
            bar.update(task, completed=done, pace=_pace(done - before, total - done, spent, unit))
            if not bar.live.is_started and spent > PATIENCE:
                bar.start()
    finally:
        bar.stop()


def _pace(done: float, left: float, spent: float, unit: str) -> str:
    """Tell the rate at which work is done, if it has a unit, and the time that is left."""
    if not done or not spent:
        return ""
    rate = done / spent
    per_second = f"{rate:.3g} {unit}/s, " if unit and rate >= 1 else ""
    slowly = f"{60 * rate:.3g} {unit}/min, " if unit and rate < 1 else ""
    return f"{per_second}{slowly}{timedelta(seconds=round(left / rate))} left"
