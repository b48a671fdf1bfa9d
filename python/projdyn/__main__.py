"""python3 -m projdyn: the program projdyn of the wheel, with all its commands."""
import os
import sys

from ._program import program_path

if __name__ == "__main__":
    path = program_path()
    os.execv(path, [path, *sys.argv[1:]])
