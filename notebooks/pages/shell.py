"""What is typed in a shell, run from a page: the same anywhere, whatever the PATH."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from typing import Any


def shell(command: str) -> None:
    """Run a command of bridgectl as if it were typed, and print what it says."""
    print(_said(command).rstrip())


def told(command: str) -> Any:
    """Run a command of bridgectl with ``--json``, and return what it tells."""
    return json.loads(_said(f"{command} --json"))


def _said(command: str) -> str:
    name, *words = shlex.split(command)
    if name != "bridgectl":
        raise ValueError(f"command must be one of bridgectl, got {name!r}")
    # A kernel asks for colours, and tells no width.
    plain = {name: each for name, each in os.environ.items() if "COLOR" not in name}
    run = subprocess.run(
        [sys.executable, "-m", "bridgectl", *words], capture_output=True, encoding="utf-8",
        env=plain | {"COLUMNS": "100", "PYTHONIOENCODING": "utf-8"}, check=False,
    )  # fmt: skip
    if run.returncode:
        raise RuntimeError(f"{command}: {run.stderr}")
    return run.stdout
