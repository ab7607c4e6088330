"""The file of a study in progress: one line of JSON for each part of the work that is done.

The first line tells the study and the version of bridgectl. Each line begins with a sum of its own
bytes; into those of parts goes the sum of the study, too. So what was damaged, edited, or computed
for another study or by another version is never taken for a part of this one.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from io import FileIO
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bridgectl import _version
from bridgectl._files import is_regular
from bridgectl._warn import warn

if sys.platform != "win32":
    import fcntl

START = b'{"check": "'
"""What each line begins with: the sum follows."""

LONGEST = 2**28
"""Bytes of a line: one of more is none of a study, and would fill the memory."""

OF_LINES = "check", "part", "key"
"""What a part's line has beside arrays."""

Part = dict[str, NDArray[Any]]
Shapes = Mapping[str, tuple[int, ...]]


class Kind(NamedTuple):
    """What kind of study files are of."""

    one: str
    """A study of it, with its article: 'a score'."""
    version: int
    """Version of the format: files of another one are refused."""
    finite: bool = True
    """Whether numbers that are not finite are a mistake, and are not kept in files."""

    @property
    def noun(self) -> str:
        """What a study is called: 'score'."""
        return self.one.partition(" ")[2]


def check_resume(resume: object, example: str) -> None:
    """Check that the file of a study is named, if there is one; `example` is a name."""
    if resume is not None and not isinstance(resume, str | os.PathLike):
        raise TypeError(
            f'resume must name a file, got {type(resume).__name__}: type resume="{example}"'
        )


class Parts:
    """Parts of a study, by name and key; kept in a file, if there is one.

    What the file holds of the same study, as the header tells, is read, and new parts are added at
    its end. Damaged lines do not count, and draw a warning; a file of another study, or in use, is
    refused. `shapes` has the names and shapes of the arrays of each part that is asked for, which
    are of floats, whole numbers or truth values. Parts that are not `in_memory` are left in the
    file until they are asked for.
    """

    def __init__(
        self,
        path: str | os.PathLike[str] | None,
        header: dict[str, Any],
        shapes: Mapping[tuple[str, str], Shapes],
        kind: Kind,
        *,
        in_memory: bool = True,
    ) -> None:
        self.path = "" if path is None else os.fsdecode(path)
        self.kind, self.in_memory = kind, in_memory
        self.header = {
            "format": f"bridgectl {kind.noun}", "version": kind.version,
            "bridgectl": _version.__version__, **json.loads(json.dumps(header)),
        }  # fmt: skip
        self.study = _line(self.header)
        self.shapes = shapes
        self.found: dict[tuple[str, str], Part] = {}
        self.places: dict[tuple[str, str], int] = {}
        self.handle: FileIO | None = None

    def __enter__(self) -> Parts:
        if not self.path:
            return self
        self.handle = _locked(self.path, self.kind)
        try:
            if damaged := self._read(self.handle):
                warn(_damage(self.path, damaged))
        except BaseException:
            self.handle.close()
            raise
        return self

    def __exit__(self, *error: object) -> None:
        if self.handle is not None:
            self.handle.close()

    def __contains__(self, part: tuple[str, str]) -> bool:
        return part in self.found or part in self.places

    def __getitem__(self, part: tuple[str, str]) -> Part:
        if part in self.found:
            return self.found[part]
        with open(self.path, "rb") as handle:
            handle.seek(self.places[part])
            line = handle.readline().strip()
        if not _is_sound(line, self.study):  # it was when it was read first
            raise ValueError(f"{self.path} was changed while it was in use: do the same again")
        return _arrays(_parsed(line))

    def keep(self, name: str, key: str, part: Part) -> None:
        """Keep a part, in the file at once; there only if its numbers are what they must be."""
        if self.handle is None or (self.kind.finite and not _are_finite(part)):
            self.found[name, key] = part
            return
        arrays = {measure: values.tolist() for measure, values in part.items()}
        line = _line({"part": name, "key": key, **arrays}, self.study)
        self._place((name, key), part, self._write(self.handle, line))

    def _place(self, name: tuple[str, str], part: Part, at: int) -> None:
        """Keep a part that is in the file, or where it is there."""
        if self.in_memory:
            self.found[name] = part
        else:
            self.places[name] = at

    def _write(self, handle: FileIO, line: bytes) -> int:
        """Write a line to the disk, or nothing of it; return where it begins."""
        end = os.fstat(handle.fileno()).st_size
        try:
            left = memoryview(line + b"\n")
            while left:
                left = left[handle.write(left) :]
            os.fsync(handle.fileno())
        except OSError as error:
            with suppress(OSError):
                handle.truncate(end)
            raise OSError(error.errno, error.strerror, self.path) from None
        return end

    def _read(self, handle: FileIO) -> list[int]:
        """Read the file, and make its end fit for new lines; return which lines are damaged."""
        sound, damaged, end = False, list[int](), 0
        taken, last = False, b""
        for number, last in enumerate(_lines(self.path, self.kind), start=1):
            taken, whole = self._take(last.strip(), number, end), last.endswith(b"\n")
            sound |= taken
            if whole and last.strip() and not taken:
                damaged.append(number)
            if whole or taken:  # else an interruption cut it short: it is the last
                end += len(last)
        if not sound and (end or not _begins_a_file(last)):
            raise ValueError(
                f"line 1 of {self.path} is damaged, or it is no file of {self.kind.one}: type the "
                "name of one, or of a new file"
            )
        handle.truncate(end)
        if not sound:
            self._write(handle, self.study)
        elif taken and not last.endswith(b"\n"):
            self._write(handle, b"")
        return damaged

    def _take(self, line: bytes, number: int, at: int) -> bool:
        """Take what a line says, if it is a sound one of this study."""
        said = _parsed(line)
        if _is_sound(line, self.study):
            return self._take_part(said, at)
        if said.get("format") != self.header["format"]:
            return False
        of_old = "check" not in said and said.get("version") != self.kind.version
        if of_old or _is_sound(line):
            self._require_same_study(said, number)
            return True
        return False

    def _take_part(self, said: dict[str, Any], at: int) -> bool:
        """Take a part, if it is asked for; return whether it is one."""
        name = str(said.get("part", "")), str(said.get("key", ""))
        if name not in self.shapes:
            return True
        try:
            part = _arrays(said)
        except ValueError:  # rows of different lengths
            return False
        fits = _fits(part, self.shapes[name]) and (not self.kind.finite or _are_finite(part))
        if fits:
            self._place(name, part, at)
        return fits

    def _require_same_study(self, header: dict[str, Any], number: int) -> None:
        place = self.path if number == 1 else f"line {number} of {self.path}"
        for name, value in self.header.items():
            found = header.get(name)
            if found == value:
                continue
            if name == "bridgectl":
                raise ValueError(
                    f"{place} is by bridgectl {_short(found)}, not {value}, and parts of two "
                    "versions are not mixed: type the name of a new file, or install "
                    f"bridgectl=={_short(found)} to go on"
                )
            of_format = " of the format" if name == "version" else ""
            raise ValueError(
                f"{place} holds another study: its {name} is {_short(found)}{of_format}, "
                f"not {_short(value)}; type the name of a new file"
            )


def _locked(path: str, kind: Kind) -> FileIO:
    """Open a file to add to its end, which no other process may do until it is closed."""
    if os.path.exists(path) and not is_regular(path):
        raise ValueError(
            f"{path} is no file but a folder, pipe or device: type the name of a file of "
            f"{kind.one}, or of a new file"
        )
    handle = FileIO(path, "ab")
    if sys.platform != "win32":
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            handle.close()
            raise ValueError(
                f"{path} is in use by another {kind.noun}: wait for its end, or type the name of "
                "a new file"
            ) from None
        except OSError:  # a file system without locks
            pass
    return handle


def _lines(path: str, kind: Kind) -> Iterator[bytes]:
    with open(path, "rb") as handle:
        while line := handle.readline(LONGEST):
            if len(line) == LONGEST:
                raise ValueError(
                    f"{path} is no file of {kind.one}, for none has lines of {LONGEST >> 20} "
                    "MiB: type the name of one, or of a new file"
                )
            yield line


def _line(said: dict[str, Any], study: bytes = b"") -> bytes:
    """Return a line that says it, of a study unless it is the study's own."""
    return _summed(json.dumps(said).encode(), study)


def _summed(text: bytes, study: bytes) -> bytes:
    """Put the sum of a JSON object and its study into it."""
    digest = hashlib.sha256(study + text).hexdigest()[:32]
    return START + digest.encode() + b'", ' + text[1:]


def _is_sound(line: bytes, study: bytes = b"") -> bool:
    return line == _summed(b"{" + line[len(_summed(b"{", b"")) :], study)


def _begins_a_file(text: bytes) -> bool:
    """Tell whether text is what an interruption may leave of a file's first line."""
    return not _parsed(text) and text[: len(START)] == START[: len(text)]


def _parsed(line: bytes) -> dict[str, Any]:
    """Return the JSON object that a line is, an empty one if it is none."""
    try:
        said = json.loads(line)
    except (ValueError, RecursionError):
        return {}
    return said if isinstance(said, dict) else {}


def _arrays(said: dict[str, Any]) -> Part:
    """Return the arrays of a part's line."""
    return {name: np.array(each) for name, each in said.items() if name not in OF_LINES}


def _fits(part: Part, shapes: Shapes) -> bool:
    """Tell whether a part has all its arrays, of numbers and of the right shapes."""
    found = {name: a.shape if a.dtype.kind in "fib" else None for name, a in part.items()}
    return found == shapes


def _are_finite(part: Part) -> bool:
    return all(np.isfinite(values).all() for values in part.values())


def _damage(path: str, lines: list[int]) -> str:
    listed = ", ".join(map(str, lines[:5])) + (", ..." if len(lines) > 5 else "")
    which = f"lines {listed} of {path} are" if len(lines) > 1 else f"line {listed} of {path} is"
    return f"{which} damaged and not used: what no other line holds is done again"


def _short(value: Any) -> str:
    text = str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
