"""Values of Python as JSON text."""
from __future__ import annotations

import json
import os
from typing import Any

import numpy as np

from .errors import InputError


def json_text(path: str, value: Any) -> str:
    """A value as JSON text; path: of the value, for messages."""
    try:
        return json.dumps(value, default=_plain, allow_nan=False)
    except TypeError as error:
        raise TypeError(f"{path}: {error}") from None
    except ValueError as error:
        raise InputError(f"{path}: {error}") from None


def _plain(value: Any) -> Any:
    """Paths and numpy's arrays and numbers as JSON has them."""
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    array = np.asarray(value)
    if array.dtype.kind not in "biufU":
        raise TypeError(f"expected numbers, texts, lists or dictionaries, found {type(value).__name__}")
    return array.tolist()
