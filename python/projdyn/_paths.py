"""Texts, paths and flags that functions take."""
from __future__ import annotations

import os
from typing import Any, Union

import numpy as np

from .errors import InputError, wrong_type

Path = Union[str, "os.PathLike[str]"]


def text(value: Any, what: str) -> str:
    """The text. TypeError: it is none. InputError: it has a NUL, where C would end it."""
    if not isinstance(value, str):
        raise wrong_type(what, "a text", value)
    return _whole(value, "\0", what)


def path(value: Any, what: str) -> bytes:
    """The path as the library takes it. Errors as of text."""
    if not isinstance(value, (str, bytes, os.PathLike)):
        raise wrong_type(what, "a path", value)
    return _whole(os.fsencode(value), b"\0", what)


def _whole(value: Any, end: Any, what: str) -> Any:
    if end in value:
        raise InputError(f"{what}: expected no NUL character, found {value!r}")
    return value


def flag(value: Any, what: str) -> bool:
    """True or False, of numpy too, or 1 or 0. TypeError: anything else; a text such as "no" counts as
    true in Python."""
    if not isinstance(value, (bool, int, np.bool_)) or value not in (0, 1):
        raise wrong_type(what, "True or False", value)
    return bool(value)
