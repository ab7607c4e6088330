"""TOML files that people write: read, and wrong keys told with the right ones."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bridgectl._files import is_regular


def parsed(path: Path, what: str, look: str, otherwise: str) -> dict[str, Any]:
    """Content of a file of something; lines look so, and what else may be typed."""
    if path.exists() and not is_regular(path):
        raise ValueError("is no file but a folder, pipe or device: type the name of a TOML file")
    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except FileNotFoundError:
        raise ValueError(
            f"no such file: check the name and the folder, or type {otherwise}"
        ) from None
    except UnicodeDecodeError:
        raise ValueError("is no UTF-8 text: type the name of a TOML file") from None
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"is no TOML: {error}; lines look like {look}") from None
    except RecursionError:
        raise ValueError(f"is no TOML of a {what}: its brackets are too deep") from None


def require_known(
    where: str, given: Mapping[str, Any], known: Sequence[str], others: Sequence[str] = ()
) -> None:
    """Refuse keys that are not known; `others` are those of another kind of file."""
    for key in given:
        if key not in known:
            wrong = f"{where} has {key!r}" if where else f"has the key {key!r}"
            why = f"which does not go with {known[0]}" if key in others else "which is none"
            raise ValueError(f"{wrong}, {why}: type one of {', '.join(known)}")


def require_keys(
    where: str, given: Mapping[str, Any], keys: Sequence[str], looks: Mapping[str, str]
) -> None:
    """Refuse a table without one of some keys, which look so."""
    for key in keys:
        if key not in given:
            raise ValueError(f"{where + ' ' if where else ''}lacks {key}: type {looks[key]}")
