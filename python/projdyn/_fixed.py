"""Objects whose attributes are set once: a later assignment would change nothing in the library."""
from __future__ import annotations

from typing import Any


class Fixed:
    """After fix(), only properties can be assigned; another name is an AttributeError."""

    _is_fixed = False

    def fix(self) -> None:
        """Called at the end of the constructor."""
        object.__setattr__(self, "_is_fixed", True)

    def __setattr__(self, name: str, value: Any) -> None:
        if self._is_fixed and not isinstance(getattr(type(self), name, None), property):
            raise AttributeError(f"{name} of {self!r} cannot be assigned: methods make changes")
        object.__setattr__(self, name, value)
