"""The program projdyn."""
from __future__ import annotations

import logging
import os
import shutil
import subprocess
from typing import Any

from ._installed import installed_file
from ._paths import path as path_of
from .errors import Error, InputError

_BAD_INPUT = 2


def program_path() -> str:
    """PROJDYN_PROGRAM of the environment, the program of the wheel, or that in PATH."""
    given = os.environ.get("PROJDYN_PROGRAM")
    path = shutil.which(given) if given else installed_file("projdyn") or shutil.which("projdyn")
    if given and not path:
        raise Error(f"PROJDYN_PROGRAM: {given}: there is no such program")
    if not path:
        raise Error("the program projdyn is neither in the wheel nor in PATH: set PROJDYN_PROGRAM "
                    "to that of a build, build/app/projdyn")
    return path


def run_program(command: str, directory: Any, **options: Any) -> None:
    """Runs a command of the program on the directory of a run. options: --NAME=VALUE, without those that
    are None. Notes of the program go to the logger "projdyn". InputError, Error: it failed, in its words."""
    path_of(directory, "directory")
    arguments = [f"--{name}={value}" for name, value in options.items() if value is not None]
    with subprocess.Popen([program_path(), command, *arguments, "--", os.fspath(directory)], text=True,
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as process:
        try:
            said = process.communicate()[1].strip().replace("projdyn: ", "")
        except BaseException:  # such as Ctrl-C: the program removes its temporary files
            process.terminate()
            raise
    if process.returncode:
        raise (InputError if process.returncode == _BAD_INPUT else Error)(said)
    if said:
        logging.getLogger("projdyn").warning(said)
