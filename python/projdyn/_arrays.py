"""numpy arrays: views of the library's memory, and arrays that are passed to it."""
from __future__ import annotations

from typing import Any, Optional

import numpy as np

from .errors import InputError, wrong_type


class _Memory:
    """Memory of the library; the array that is made of it keeps the owner alive."""

    def __init__(self, address: int, shape: tuple[int, ...], dtype: Any, owner: object) -> None:
        self.owner = owner
        self.__array_interface__ = {"data": (address, True), "shape": shape,
                                    "typestr": np.dtype(dtype).str, "version": 3}


def view(address: Optional[int], shape: tuple[int, ...], owner: object,
         dtype: Any = np.float64) -> np.ndarray:
    """Read-only array of the memory at an address, without a copy; no address: an empty array."""
    if not address:
        return np.empty((0, *shape[1:]), dtype)
    return np.asarray(_Memory(address, shape, dtype, owner))


def doubles(values: Any, shape: tuple[Optional[int], ...], what: str) -> np.ndarray:
    """Contiguous array of double precision of this shape; None in the shape: any number of rows."""
    return _array(values, shape, what, np.float64)


def number(value: Any, what: str) -> float:
    """One number."""
    return float(doubles(value, (1,), what)[0])


def indices(values: Any, shape: tuple[Optional[int], ...], what: str) -> np.ndarray:
    """Contiguous array of C integers of this shape. InputError: numbers that are not whole, or are
    out of the range of a C integer."""
    found = _array(values, shape, what, np.intc)
    if not np.array_equal(found, values):
        raise InputError(f"{what}: expected whole numbers below 2^31")
    return found


def _array(values: Any, shape: tuple[Optional[int], ...], what: str, dtype: Any) -> np.ndarray:
    try:
        given = np.asarray(values)
        if given.dtype.kind not in "biufO" or (given.dtype.kind == "O" and None in given.flat):
            raise TypeError
        found = np.ascontiguousarray(given, dtype)
    except TypeError:
        raise wrong_type(what, "numbers", values) from None
    except ValueError as error:
        raise InputError(f"{what}: expected an array of numbers: {error}") from None
    if len(shape) != found.ndim or any(n not in (None, m) for n, m in zip(shape, found.shape)):
        wanted = " x ".join("n" if n is None else str(n) for n in shape)
        raise InputError(f"{what}: expected the shape {wanted}, found "
                         f"{' x '.join(map(str, found.shape)) or 'one number'}")
    return found


def address(array: Optional[np.ndarray]) -> Optional[int]:
    """Address of the first element; None for None. The caller keeps the array until the call ends."""
    return None if array is None else array.ctypes.data
