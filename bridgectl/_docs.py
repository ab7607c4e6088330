"""Parts of docstrings that several functions share, written once."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])


def filled(**texts: str) -> Callable[[F], F]:
    """Return a decorator that puts texts in place of their names in braces, as ``{bounds}``."""

    def fill(function: F) -> F:
        found = inspect.cleandoc(function.__doc__ or "")
        for name, text in texts.items():
            found = found.replace(f"{{{name}}}", text)
        function.__doc__ = found
        return function

    return fill
