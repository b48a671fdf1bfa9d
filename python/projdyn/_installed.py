"""Files of the installed wheel: the shared library and the program."""
from __future__ import annotations

from importlib import metadata
from typing import Optional


def installed_file(name: str) -> Optional[str]:
    """Path of the file whose name starts with `name` beside the modules of the wheel that this
    package was installed from; None: the package was not installed from a wheel."""
    try:
        files = metadata.files("projdyn") or []
    except metadata.PackageNotFoundError:
        return None
    for file in files:
        if file.name.startswith(name) and not file.name.endswith(".h"):
            return str(file.locate())
    return None
