"""Texts and paths that functions take."""
from __future__ import annotations

import os
from typing import Any, Union

from .errors import wrong_type

Path = Union[str, "os.PathLike[str]"]


def text(value: Any, what: str) -> str:
    """The text. TypeError: it is none."""
    if not isinstance(value, str):
        raise wrong_type(what, "a text", value)
    return value


def path(value: Any, what: str) -> bytes:
    """The path as the library takes it. TypeError: it is none."""
    if not isinstance(value, (str, bytes, os.PathLike)):
        raise wrong_type(what, "a path", value)
    return os.fsencode(value)
