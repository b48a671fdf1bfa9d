"""numpy arrays: views of the library's memory, and arrays that are passed to it."""
from __future__ import annotations

from decimal import Decimal
from numbers import Real
from typing import Any, Iterator, Optional

import numpy as np

from .errors import InputError


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


def numbers(values: Any, what: str) -> np.ndarray:
    """Contiguous array of double precision, of the shape that they have."""
    try:
        given = np.asarray(values)
    except ValueError:
        raise InputError(f"{what}: expected an array of numbers, found rows of different lengths") from None
    if np.ma.is_masked(values):
        raise InputError(f"{what}: expected numbers, found masked ones")
    if given.dtype.kind not in "iufO" or (given.dtype.kind == "O" and not all(map(_is_number, given.flat))):
        raise TypeError(f"{what}: expected numbers, found {_type(values)}")
    try:
        return np.asarray(given, np.float64, order="C")
    except OverflowError:
        raise InputError(f"{what}: a number is too large") from None


def _is_number(value: Any) -> bool:
    return isinstance(value, (Real, Decimal)) and not isinstance(value, (bool, np.bool_))


def _type(values: Any) -> str:
    """The type of values that are not all numbers, such as "str", "ndarray of bool", "list with str"."""
    name = type(values).__name__
    if isinstance(values, np.ndarray):
        return f"{name} of {values.dtype}"
    wrong = next((part for part in _parts(values) if not _is_number(part)), None) if _is_list(values) else values
    return name if wrong is values else f"{name} with {_type(wrong)}"


def _is_list(values: Any) -> bool:
    return isinstance(values, (list, tuple))


def _parts(values: Any) -> Iterator[Any]:
    """The parts of lists in lists."""
    for part in values:
        yield from _parts(part) if _is_list(part) else (part,)


def doubles(values: Any, shape: tuple[Optional[int], ...], what: str) -> np.ndarray:
    """Contiguous array of double precision of this shape; None in the shape: any number of rows."""
    return _shaped(numbers(values, what), shape, what)


def rows(values: Any, count: int, what: str) -> np.ndarray:
    """count x 3 numbers, or three for every row."""
    found = numbers(values, what)
    return _shaped(np.tile(found, (count, 1)) if found.shape == (3,) else found, (count, 3), what)


def number(value: Any, what: str) -> float:
    """One number."""
    found = numbers(value, what)
    if found.size != 1:
        raise InputError(f"{what}: expected one number, found {found.size} numbers")
    return float(found.flat[0])


def indices(values: Any, shape: tuple[Optional[int], ...], what: str) -> np.ndarray:
    """Contiguous array of C integers of this shape. InputError: numbers that are not whole, or are
    out of the range of a C integer."""
    found = _shaped(numbers(values, what), shape, what)
    if not np.all((found == np.floor(found)) & (np.abs(found) < 2**31)):
        raise InputError(f"{what}: expected whole numbers below 2^31")
    return found.astype(np.intc)


def _shaped(found: np.ndarray, shape: tuple[Optional[int], ...], what: str) -> np.ndarray:
    if len(shape) != found.ndim or any(n not in (None, m) for n, m in zip(shape, found.shape)):
        wanted = " x ".join("n" if n is None else str(n) for n in shape)
        raise InputError(f"{what}: expected the shape {wanted}, found "
                         f"{' x '.join(map(str, found.shape)) or 'one number'}")
    return found


def address(array: Optional[np.ndarray]) -> Optional[int]:
    """Address of the first element; None for None. The caller keeps the array until the call ends."""
    return None if array is None else array.ctypes.data
