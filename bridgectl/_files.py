"""Files that are replaced whole or not at all."""

from __future__ import annotations

import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import BinaryIO


@contextmanager
def replacing(file: str) -> Iterator[BinaryIO]:
    """Open a file beside the one it then replaces, which stays as it is if anything fails."""
    beside = os.path.join(os.path.dirname(file), f".{secrets.token_hex(8)}.tmp")
    try:
        with open(beside, "xb") as handle:
            yield handle
        if os.path.exists(file):
            shutil.copymode(file, beside)
        os.replace(beside, file)
    except OSError as error:  # named after the file that was asked for
        raise OSError(error.errno, error.strerror, file) from None
    finally:
        if os.path.exists(beside):
            os.remove(beside)
