"""The program projdyn."""
from __future__ import annotations

import os
import shutil

from ._installed import installed_file
from .errors import Error


def program_path() -> str:
    """PROJDYN_PROGRAM of the environment, the program of the wheel, or that in PATH."""
    path = (os.environ.get("PROJDYN_PROGRAM") or installed_file("projdyn")
            or shutil.which("projdyn"))
    if not path:
        raise Error("the program projdyn is neither in the wheel nor in PATH")
    return path
