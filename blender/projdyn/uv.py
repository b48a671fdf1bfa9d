"""Texture coordinates of a surface, from NAME.obj in the directory of a run: triangles in the order
of the frames, each corner `vertex/texture`."""
import numpy as np

from .vtk_legacy import FileError


def read_uv(path, triangles):
    """Coordinates of the corners of `triangles` (t x 3), 3 t x 2; None without the file or without
    coordinates in it."""
    if not path.exists():
        return None
    points, corners = [], []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        words = line.split()
        try:
            if words[:1] == ["vt"]:
                points.append((float(words[1]), float(words[2])))
            elif words[:1] == ["f"]:
                corners += [[int(n) for n in word.split("/")[:2]] for word in words[1:]]
        except (ValueError, IndexError) as error:
            text = f"{path}:{number}: expected `vt U V` or `f V/T V/T V/T`, found {line[:80]!r}"
            raise FileError(text) from error
    if not points:
        return None
    if [c[0] - 1 for c in corners] != triangles.ravel().tolist() or any(
            len(c) != 2 or not 1 <= c[1] <= len(points) for c in corners):
        raise FileError(f"{path}: expected the {len(triangles)} triangles of the frames, with "
                        f"texture coordinates from 1 to {len(points)}")
    return np.array(points, np.float32)[[c[1] - 1 for c in corners]]
