"""Texts, paths and flags that functions take."""
from __future__ import annotations

import os
from typing import Any, Union

import numpy as np

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


def flag(value: Any, what: str) -> bool:
    """True or False, of numpy too, or 1 or 0. TypeError: anything else; a text such as "no" counts as
    true in Python."""
    if not isinstance(value, (bool, int, np.bool_)) or value not in (0, 1):
        raise wrong_type(what, "True or False", value)
    return bool(value)
