"""Exceptions: one per kind of status of the library."""
from __future__ import annotations

from typing import Any


class Error(Exception):
    """A call failed and had no effect. The text is that of the library."""


class InputError(Error, ValueError):
    """A value, an array or a scene is not valid; the text tells what was expected."""


class StepError(Error):
    """A step failed: it diverged, or the linear solver failed. The state is that of the last step
    that succeeded; later steps fail, too."""


def wrong_type(what: str, expected: str, found: Any) -> TypeError:
    """The exception for an argument `what` of another type."""
    return TypeError(f"{what}: expected {expected}, found {type(found).__name__}")


_BAD_INPUT = 1


def error_of(status: int, text: str) -> Error:
    """The exception for a status of the library that is not 0."""
    if status < 0:
        return StepError(text)
    return InputError(text) if status == _BAD_INPUT else Error(text)
