"""Objects whose attributes are set once: a later assignment would change nothing in the library."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._unique import Unique


class Vector(property):
    """A property of numbers that is read as an array, and that any numbers can be assigned to. mypy
    expects one type for both of an ordinary property."""

    if TYPE_CHECKING:
        def __get__(self, instance: Any, owner: Any = None) -> np.ndarray: ...
        def __set__(self, instance: Any, value: Any) -> None: ...


class Fixed(Unique):
    """After _fix(), only properties with a setter can be assigned; another name is an
    AttributeError, which lists the methods that set something."""

    _is_fixed = False
    _instead: dict[str, str] = {}  # what to use for an attribute that a similar class has

    def _fix(self) -> None:
        """Called at the end of the constructor."""
        object.__setattr__(self, "_is_fixed", True)

    def __setattr__(self, name: str, value: Any) -> None:
        if self._is_fixed and getattr(getattr(type(self), name, None), "fset", None) is None:
            raise AttributeError(f"{name} of {self!r} cannot be assigned: {self._way(name)}")
        object.__setattr__(self, name, value)

    def _way(self, name: str) -> str:
        """How to change the object instead."""
        setters = ", ".join(word for word in dir(self) if word.startswith("set_"))
        if hasattr(type(self), "__setitem__"):
            return f'parameters are items: ["{name}"]'
        return "methods make changes" + (setters and f", such as {setters}")

    def _hint(self, name: str) -> str:
        return self._instead[name]

    if not TYPE_CHECKING:  # for which every name would be an attribute
        def __getattr__(self, name: str) -> Any:
            if hasattr(type(self), "__setitem__") and not name.startswith("_"):
                raise AttributeError(f"{self!r} has no attribute {name}: {self._way(name)}")
            if name in self._instead:
                raise AttributeError(f"{self!r} has no {name}: {self._hint(name)}")
            return object.__getattribute__(self, name)  # the usual AttributeError
