"""Files of the installed wheel: the shared library and the program."""
from __future__ import annotations

from importlib import metadata
from typing import Optional


def installed_file(pattern: str) -> Optional[str]:
    """Path of the first file of the wheel whose name matches the pattern; None: the package was not
    installed from a wheel."""
    try:
        files = metadata.files("projdyn") or []
    except metadata.PackageNotFoundError:
        return None
    for file in files:
        if file.match(pattern):
            return str(file.locate())
    return None
