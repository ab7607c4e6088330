"""One thread for the products of small matrices.

A linear-algebra library that splits a product of a few thousand numbers over threads loses
more than it gains, and where several processes share the cores its waiting threads stall them
all: the paper's ramp surface then takes many times as long.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
T = TypeVar("T")


@cache
def _controller() -> ThreadpoolController:
    # Made once, when numpy and scipy have loaded their libraries: looking for them is slow.
    return ThreadpoolController()


def on_one_thread(function: Callable[P, T]) -> Callable[P, T]:
    """Keep linear algebra on one thread while a function runs."""

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> T:
        with _controller().limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited
