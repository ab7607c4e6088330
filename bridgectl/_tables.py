"""Tables of numbers in text: one look for all that is printed."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

WIDTH = 100
"""Columns of the tables where there is no terminal to tell."""


class _Console(Console):
    def on_broken_pipe(self) -> None:
        """Leave a closed pipe to the command line: it is no failure."""
        raise BrokenPipeError


def make_console() -> Console:
    """Return where to print: not narrower than the tables are wide."""
    # Notebooks get text, which `print` can then return too.
    plain: Any = {"highlight": False, "markup": False, "force_jupyter": False}
    console = _Console(**plain)
    # Piped tables are not cut to the terminal that is not there.
    return console if console.is_terminal else _Console(**plain, width=WIDTH)


def make_table(
    title: str, columns: Sequence[str], words: Sequence[str] = (), *, short: bool = False
) -> Table:
    """Print a title and return a table of numbers, but for the columns of `words`.

    A short one, beside a verdict, takes little room.
    """
    # The title apart, so that it does not wrap in a narrow table.
    make_console().print(Text(title, style="bold"), soft_wrap=True)
    table = Table(box=box.SIMPLE_HEAD, collapse_padding=short, show_edge=not short)
    for name in columns:
        # A Text, since [m] in plain text would be read as markup.
        justify: Any = "left" if name in words else "right"
        table.add_column(Text(name), justify=justify, overflow="fold")
    return table


def printed(show: Callable[..., None], *what: Any) -> str:
    """Return what a function prints of something, as text of 100 columns."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text):
        show(*what)
    return text.getvalue()
