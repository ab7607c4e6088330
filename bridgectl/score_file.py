"""The file of a score in progress: one line of JSON for each part of the work that is done."""

from __future__ import annotations

import json
import os
from types import TracebackType
from typing import Any, TextIO

import numpy as np

import bridgectl

FORMAT = "bridgectl score"
VERSION = 1


class Parts:
    """Parts of a score, by name and key; kept in a file, if there is one.

    Parameters
    ----------
    path : path-like or None
        The file. What it holds of the same study is read, and new parts are added at its end.
    header : dict
        What tells the study from others.

    Raises
    ------
    ValueError
        If the file is none of these, or of another study: the message says what differs.
    """

    def __init__(self, path: str | os.PathLike[str] | None, header: dict[str, Any]) -> None:
        self.path = None if path is None else os.fsdecode(path)
        self.header = {"format": FORMAT, "version": VERSION, **json.loads(json.dumps(header))}
        self.found: dict[tuple[str, str], dict[str, Any]] = {}
        self.handle: TextIO | None = None

    def __enter__(self) -> Parts:
        if self.path is None:
            return self
        whole = self._read() if os.path.exists(self.path) else 0
        self.handle = open(self.path, "a", encoding="utf-8")
        # An interruption may have cut the last line short.
        self.handle.truncate(whole)
        if whole == 0:
            self._write({**self.header, "bridgectl": bridgectl.__version__})
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self.handle is not None:
            self.handle.close()

    def __contains__(self, part: tuple[str, str]) -> bool:
        return part in self.found

    def __getitem__(self, part: tuple[str, str]) -> dict[str, Any]:
        return self.found[part]

    def keep(self, name: str, key: str, part: dict[str, Any]) -> None:
        """Keep a part, in the file at once."""
        self.found[name, key] = part
        self._write({"part": name, "key": key, **{k: v.tolist() for k, v in part.items()}})

    def _write(self, line: dict[str, Any]) -> None:
        if self.handle is not None:
            self.handle.write(json.dumps(line) + "\n")
            self.handle.flush()
            os.fsync(self.handle.fileno())

    def _read(self) -> int:
        """Read the file; return the length of its whole lines [bytes]."""
        assert self.path is not None
        with open(self.path, "rb") as handle:
            content = handle.read()
        whole = content[: content.rfind(b"\n") + 1]
        if not whole and not content:
            return 0
        try:
            header, *parts = [json.loads(line) for line in whole.decode().splitlines()]
        except ValueError:
            header, parts = None, []
        if not isinstance(header, dict) or header.get("format") != FORMAT:
            raise ValueError(
                f"{self.path} is no file of a score: type the name of one, or of a new file"
            )
        for name, value in self.header.items():
            if header.get(name) != value:
                raise ValueError(
                    f"{self.path} holds another study: its {name} is {_short(header.get(name))}, "
                    f"not {_short(value)}; type the name of a new file"
                )
        for part in parts:
            arrays = {k: np.array(v) for k, v in part.items() if k not in ("part", "key")}
            self.found[part["part"], part["key"]] = arrays
        return len(whole)


def _short(value: Any) -> str:
    text = str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
