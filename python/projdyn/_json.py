"""Values of Python as JSON text."""
from __future__ import annotations

import json
import math
import os
from typing import Any

import numpy as np

from ._paths import text
from .errors import InputError, wrong_type


def json_text(path: str, value: Any) -> str:
    """A value as JSON text; path: of the value, for messages."""
    return json.dumps(_plain(path, value), allow_nan=False)


def _plain(path: str, value: Any) -> Any:
    """A value as JSON has it: paths are texts, numpy's arrays are lists."""
    if value is None or isinstance(value, (str, bool)):
        return value
    if isinstance(value, (int, float)):
        return _checked(path, value)
    if isinstance(value, dict):
        return {text(key, f"{path}: a key"): _plain(f"{path}.{key}", part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(f"{path}.{k}", part) for k, part in enumerate(value)]
    return os.fspath(value) if isinstance(value, os.PathLike) else _plain(path, _unpacked(path, value))


def _checked(path: str, value: float) -> float:
    """The number. InputError: JSON or the library does not have it."""
    if not math.isfinite(value) if isinstance(value, float) else not -2**63 <= value < 2**63:
        raise InputError(f"{path}: expected a finite number below 2^63, found {value}")
    return value


def _unpacked(path: str, value: Any) -> Any:
    """An array of numpy, or one of its numbers, as Python has it."""
    array = np.asarray(value)
    if array.dtype.kind not in "biufU":
        raise wrong_type(path, "numbers, texts, lists or dictionaries", value)
    if np.ma.is_masked(value):
        raise InputError(f"{path}: expected numbers, found masked ones")
    return (array.astype(float) if array.dtype.kind == "f" else array).tolist()
