"""The text of road files: its lines, the numbers on them, and how a file is refused.

`number` and `split` define what a valid line of numbers is, for every format.
"""

from __future__ import annotations

import codecs
import gzip
import io
import os
import re
import stat
import zlib
from collections.abc import Iterator
from itertools import islice
from typing import IO, AnyStr, BinaryIO

__all__ = ["ProfileFileError"]

DELIMITERS = {";": "semicolon", "\t": "tab", ",": "comma", " ": "white space"}
COMMENTS = ("#", "%", "//")
LARGEST = 1e12  # in any unit; no station or elevation is larger
MAX_BYTES = 2**30  # 1000 km of road at 20 mm steps
MAX_LINE = 2**16  # characters; a line of more is no line of a road, and fills the memory
CHUNK = 2**18  # characters decoded at once

MARKS = {  # in this order: the mark of UTF-32 begins as that of UTF-16
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}

# Bytes that are not UTF-8 become U+DC80 to U+DCFF (surrogateescape). Words may hold them, as the
# letters of Western Windows, a superset of Latin-1; numbers may not.
_NOT_UTF8 = re.compile("[\udc80-\udcff]")
_CONTROLS = "\0\x1c\x1d\x1e\x1f"  # the latter are blanks to some functions, and not to others
_NO_LETTER = re.compile(f"[{_CONTROLS}\udc81\udc8d\udc8f\udc90\udc9d]")
_WINDOWS = {0xDC00 + byte: bytes([byte]).decode("cp1252", "replace") for byte in range(128, 256)}

Line = tuple[int, str]


class ProfileFileError(ValueError):
    """A road profile file that cannot be read; one line says where, why and what to type."""


def refusal(file: str, fault: str, line: int | None = None) -> ProfileFileError:
    """Return the error that refuses a file, in one printable line."""
    place = file if line is None else f"{file}:{line}"
    return ProfileFileError(printable(f"{place}: {fault}"))


def not_text(character: str) -> str:
    """Say that a byte is no text."""
    return f"the byte 0x{ord(character) & 0xFF:02x} is not text: save the file as UTF-8 text (csv)"


def byte_in(field: str) -> str:
    """Say that a field holds a byte that is not UTF-8, if so."""
    bad = _NOT_UTF8.search(field)
    return not_text(bad[0]) if bad else ""


def quoted(text: str) -> str:
    """Return text in quotes, escaped and cut to what fits in a message."""
    shown = printable(text.strip()[:60])
    return f"'{shown}'" if len(shown) <= 40 else f"'{shown[:40]}...'"


def lettered(text: str) -> str:
    """Return text with the letters that bytes mean which are not UTF-8."""
    return text.translate(_WINDOWS)


def printable(text: str) -> str:
    """Return text with the letters that its bytes mean and its control characters escaped."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in lettered(text))


def passing(*arguments: str) -> str:
    """Return what to type to pass arguments, in Python and on the command line."""
    options = " or ".join(f"--{argument.replace('_', '-')}" for argument in arguments)
    return f"pass {' or '.join(f'{a}=' for a in arguments)} ({options} on the command line)"


def opened(file: str) -> BinaryIO:
    """Open a regular file of a size that can be read."""
    try:
        status = os.stat(file)  # first: to open a pipe may wait for ever
        if stat.S_ISREG(status.st_mode) and status.st_size <= MAX_BYTES:
            return open(file, "rb")
        fault = f"expected a file of at most {MAX_BYTES >> 20} MiB: save the profile in one"
        if stat.S_ISDIR(status.st_mode):
            fault = "this is a folder: type the name of a file in it"
    except FileNotFoundError:
        fault = "no such file: check the name and the folder"
    except PermissionError:
        fault = "permission denied: make the file readable, for example with chmod u+r"
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        fault = f"cannot be opened ({getattr(error, 'strerror', None) or error}): check the name"
    raise refusal(file, fault)


def read(file: str, handle: IO[AnyStr], size: int) -> AnyStr:
    """Return up to `size` characters or bytes, or say that the file cannot be read."""
    try:
        return handle.read(size)
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise refusal(file, f"the gz file is damaged ({error}): copy it again") from None
    except OSError as error:
        fault = f"cannot be read ({error.strerror or error}): check the disk or copy the file"
        raise refusal(file, fault) from None


def encoding_of(head: bytes) -> str:
    """Return the encoding that the first bytes of a file state by a mark, or else UTF-8."""
    return next((name for mark, name in MARKS.items() if head.startswith(mark)), "utf-8")


def text_lines(file: str, handle: BinaryIO, encoding: str = "utf-8") -> Iterator[str]:
    """Yield the lines of a file without their ends, and refuse it at the first one not text."""
    line, rest = 1, ""
    errors = "surrogateescape" if encoding.startswith("utf-8") else "replace"
    with io.TextIOWrapper(handle, encoding=encoding, errors=errors) as text:
        while chunk := read(file, text, CHUNK):
            plain = chunk.isascii() and not any(mark in chunk for mark in _CONTROLS)
            bad = None if plain else _NO_LETTER.search(chunk)
            found = (rest + (chunk[: bad.start()] if bad else chunk)).split("\n")
            _refuse_long(file, line, found)
            rest = found.pop()
            yield from found
            line += len(found)
            if bad:
                raise refusal(file, not_text(bad[0]), line)
    if rest:
        yield rest


def ahead(texts: Iterator[str], n: int) -> tuple[list[str], Iterator[str]]:
    """Return the first lines, and all of them again; a fault on them is told in its turn."""
    head: list[str] = []
    fault: ProfileFileError | None = None
    try:
        head.extend(islice(texts, n))
    except ProfileFileError as error:
        fault = error

    def again() -> Iterator[str]:
        yield from head
        if fault is not None:
            raise fault
        yield from texts

    return head, again()


def _refuse_long(file: str, line: int, texts: list[str]) -> None:
    lengths = list(map(len, texts))
    if (longest := max(lengths)) > MAX_LINE:
        fault = f"more than {MAX_LINE} characters: expected a station and elevations on each line"
        raise refusal(file, fault, line + lengths.index(longest))


def number(field: str) -> float:
    """Return the number in a field: the one definition of what counts as one."""
    value = float(field)
    # float() also takes 1_000 and the digits of every alphabet; the comparison refuses NaN.
    if "_" in field or not field.isascii() or not -LARGEST < value < LARGEST:
        raise ValueError(field)
    return value


def is_number(field: str) -> bool:
    """Tell whether a field holds a number."""
    try:
        number(field)
    except ValueError:
        return False
    return True


def is_blank(text: str) -> bool:
    """Tell whether a line is empty."""
    return not text or text.isspace()


def is_comment(text: str) -> bool:
    """Tell whether a line of delimited text is a comment."""
    return text.lstrip().startswith(COMMENTS)


def delimiter_of(text: str) -> str:
    """Return what separates the numbers of a line."""
    return next((mark for mark in DELIMITERS if mark in text.strip()), " ")


def split(text: str, delimiter: str) -> list[str]:
    """Return the fields of a line."""
    return text.split() if delimiter == " " else text.split(delimiter)


def wrong_separator(text: str, delimiter: str) -> str:
    """Say that a line uses another delimiter, if it does."""
    other = delimiter_of(text)
    parts = split(text, other)
    if other == delimiter or len(parts) < 2 or not all(map(is_number, parts)):
        return ""
    return (
        f"expected {DELIMITERS[delimiter]}, found {DELIMITERS[other]}: use one delimiter throughout"
    )
