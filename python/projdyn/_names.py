"""Dictionaries of the parts of a simulation by name."""
from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn, TypeVar

Key = TypeVar("Key")
Part = TypeVar("Part")


class Names(dict[Key, Part]):
    """A dictionary whose KeyError says which keys there are."""

    def __missing__(self, key: Key) -> NoReturn:
        raise KeyError(f"{key!r}: the simulation has {', '.join(map(repr, self)) or 'none'}")

    if not TYPE_CHECKING:  # for which every name would be an attribute
        def __getattr__(self, name: str) -> NoReturn:
            raise AttributeError(f'no attribute {name}: parts are items, as in sim.bodies["sheet"]')
