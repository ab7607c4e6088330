"""Warnings that point at the line of whoever called the package."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from types import FrameType

HERE = Path(__file__).parent

COMMAND_LINE = tuple(
    str(HERE / "cli" / f"{name}.py")
    for name in (
        "assess", "bridge_file", "bridges", "dae", "options", "profile", "roads", "score", "trucks",
        "validate",
    )
)  # fmt: skip
"""Modules that call the package as a user does."""

PASSING = ("_plausible.py", "_threads.py", "plots/style.py")
OWN = (__file__, *(str(HERE / file) for file in PASSING))
PLUMBING = ("dataclasses", "functools", "contextlib", "copy")
"""Modules that pass calls on; so does the `__init__` that `dataclass` generates."""


def warn(message: str, category: type[Warning] = UserWarning) -> None:
    """Warn with the line that called the package, however many functions lie between."""
    outside = (frame for frame in _frames() if not _in_package(frame))
    frame = next(outside, sys._getframe(1))
    names, file = frame.f_globals, frame.f_code.co_filename
    warnings.warn_explicit(  # of code without a name, as exec() runs it, Python would tell nothing
        message, category, file, frame.f_lineno, names.get("__name__", file),
        names.setdefault("__warningregistry__", {}),
    )  # fmt: skip


def asker(depth: int = 1) -> str:
    """Tell who called the public function that asks: 'user', 'command line' or 'package'.

    What the package gives itself comes from arguments that were judged when a user gave them.
    `depth` counts the public function and those between it and this one.
    """
    frame = next(islice(_frames(), depth, None), None)
    if frame is None or not _in_package(frame):
        return "user"
    return "command line" if frame.f_code.co_filename in COMMAND_LINE else "package"


def _frames() -> Iterator[FrameType]:
    """Frames from the innermost one out, without this module's and those that pass calls on."""
    frame: FrameType | None = sys._getframe(1)
    while frame is not None:
        code = frame.f_code
        generated = code.co_filename == "<string>" and code.co_name == "__init__"
        passing = generated or frame.f_globals.get("__name__") in PLUMBING
        if not passing and code.co_filename not in OWN:
            yield frame
        frame = frame.f_back


def _in_package(frame: FrameType) -> bool:
    return frame.f_code.co_filename.startswith(f"{HERE}{os.sep}")
