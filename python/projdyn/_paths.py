"""The type of paths that functions take."""
import os
from typing import Union

Path = Union[str, "os.PathLike[str]"]
