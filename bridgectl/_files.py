"""Files: read only if they are regular ones, and replaced whole or not at all."""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from typing import BinaryIO


def is_regular(path: str | os.PathLike[str]) -> bool:
    """Tell whether a file that is there is a regular one: a pipe or device may never end."""
    return stat.S_ISREG(os.stat(path).st_mode)


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Open a file beside the one it then replaces, which stays as it is if anything fails.

    An OSError, of a full disk for example, names the file that was asked for.
    """
    file = os.path.realpath(path)
    beside = os.path.join(os.path.dirname(file), f".{secrets.token_hex(8)}.tmp")
    try:
        if os.path.exists(file) and not is_regular(file):
            code = errno.EISDIR if os.path.isdir(file) else errno.EINVAL
            raise OSError(code, "No regular file, type another name")
        with open(beside, "xb") as handle:
            yield handle
        if os.path.exists(file):
            shutil.copymode(file, beside)
        os.replace(beside, file)
    except OSError as error:
        # Libraries of pictures raise some that have a text alone.
        reason = error.strerror or str(error)
        raise OSError(error.errno or errno.EIO, reason, os.fspath(path)) from None
    finally:
        if os.path.exists(beside):
            os.remove(beside)
