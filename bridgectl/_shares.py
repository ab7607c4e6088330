"""Shares of a study: which are left, under way or lost with their workers, and how one is done."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeVar

from bridgectl import _version
from bridgectl._threads import on_one_thread

T = TypeVar("T")

MOST_DEATHS = 5
"""How often workers may die, or take a share with them, until a study is given up."""

_ALONE = threading.Lock()
"""Keeps threads of one process apart: what catches warnings does so for all threads."""


class WorkersLostError(ConnectionError):
    """Workers, or their scheduler, are gone in the middle of a study."""


class Shares:
    """Jobs with their numbers, taken one by one; those that are under way can be taken again."""

    def __init__(self, jobs: Iterable[tuple[Any, ...]]) -> None:
        self.rest, self.lock = enumerate(jobs), threading.Lock()
        self.under_way: dict[int, tuple[Any, ...]] = {}
        self.lost: deque[tuple[int, tuple[Any, ...]]] = deque()
        self.deaths = 0

    def __iter__(self) -> Iterator[tuple[int, tuple[Any, ...]]]:
        return self

    def __next__(self) -> tuple[int, tuple[Any, ...]]:
        with self.lock:  # joblib takes them from threads of its own
            index, job = self.lost.popleft() if self.lost else next(self.rest)
            self.under_way[index] = job
            return index, job

    def done(self, index: int) -> None:
        """Forget a job."""
        with self.lock:
            del self.under_way[index]

    def again(self, *indices: int, deaths: int = 1) -> None:
        """Have jobs done again that died with their workers: those, or all that are under way."""
        self.deaths += deaths
        if self.deaths > MOST_DEATHS:
            raise WorkersLostError(
                f"workers died {self.deaths} times, as they do where memory runs out: take fewer "
                "workers, or machines with more memory"
            )
        with self.lock:
            for index in indices or tuple(self.under_way):
                self.lost.append((index, self.under_way.pop(index)))


def share(version: str, work: Callable[..., T], *job: Any) -> T:
    """Do a job where a worker is: by the same version, alone in its process, on one thread."""
    if version != _version.__version__:
        raise ValueError(
            f"a worker has bridgectl {_version.__version__}, not {version}, and results of two "
            "versions are not mixed: install the same everywhere"
        )
    with _ALONE:
        return on_one_thread(work)(*job)
