"""Dictionaries of the parts of a simulation by name."""
from __future__ import annotations

from typing import NoReturn, TypeVar

Key = TypeVar("Key")
Part = TypeVar("Part")


class Names(dict[Key, Part]):
    """A dictionary whose KeyError says which keys there are."""

    def __missing__(self, key: Key) -> NoReturn:
        raise KeyError(f"{key!r}: the simulation has {', '.join(map(repr, self)) or 'none'}")
