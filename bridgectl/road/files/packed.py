"""Road files that gzip has packed: told by their content, read as a stream, within bounds."""

from __future__ import annotations

import gzip
import os
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO, cast

from bridgectl.road.files import lines

MAGIC = b"\x1f\x8b"
SUFFIX = ".gz"
FEW_BYTES = 2**24  # which any file may become
MAX_RATIO = 100  # roads as text shrink to a third or a tenth, and a bomb to a thousandth


class Unpacked(gzip.GzipFile):
    """The content of a packed file, which may not become out of proportion to it."""

    def __init__(self, file: str, packed: BinaryIO) -> None:
        super().__init__(fileobj=packed, mode="rb")
        self._file = file
        size = os.fstat(packed.fileno()).st_size
        self._most = min(lines.MAX_BYTES, max(FEW_BYTES, MAX_RATIO * size))

    def read(self, size: int | None = -1) -> bytes:
        """Read bytes, all of them by default."""
        return self._bounded(super().read(size))

    def read1(self, size: int = -1) -> bytes:
        """Read bytes with at most one look at the packed file."""
        return self._bounded(super().read1(size))

    def _bounded(self, data: bytes) -> bytes:
        if self.tell() <= self._most:
            return data
        fault = f"the gz file holds more than {self._most >> 20} MiB"
        raise lines.refusal(self._file, f"{fault}: unpack it with gunzip if it is a road")


def unpacked(file: str, handle: BinaryIO) -> BinaryIO:
    """Return what to read a file from, packed or not."""
    packed = lines.read(file, handle, len(MAGIC)) == MAGIC
    handle.seek(0)
    return cast(BinaryIO, Unpacked(file, handle)) if packed else handle


@contextmanager
def unpacked_copy(file: str, handle: BinaryIO, remarks: list[str]) -> Iterator[str]:
    """Yield the name of a file that a library can open itself.

    Errors and warnings speak of the packed one; the latter become remarks.
    """
    if not isinstance(cast(object, handle), Unpacked):
        yield file
        return
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        copy = Path(folder, "road.crg")
        with copy.open("wb") as target:
            while block := lines.read(file, handle, lines.CHUNK):
                target.write(block)
        try:
            yield str(copy)
        except lines.ProfileFileError as error:
            fault = str(error).replace(str(copy), lines.printable(file))
            raise lines.ProfileFileError(fault) from None
        remarks += [str(one.message).replace(str(copy), file) for one in told]
