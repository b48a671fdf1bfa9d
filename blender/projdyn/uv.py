"""Texture coordinates of a surface, from NAME.obj in the directory of a run: its vertices have the
order of the frames, its faces are those of the scene's OBJ file, polygons among them."""
import numpy as np

from .vtk_legacy import FileError


def number(text, count):
    """Index from 0 of an OBJ reference; negative ones count back from the last of `count`."""
    value = int(text)
    if not 0 < abs(value) <= count:
        raise ValueError(text)
    return value - 1 if value > 0 else count + value


def read_faces(lines):
    """Texture points, and faces: lists of (vertex, texture point or None)."""
    vertices, points, faces = 0, [], []
    for keyword, *words in filter(None, (line.split("#")[0].split() for line in lines)):
        if keyword == "v":
            vertices += 1
        elif keyword == "vt":
            points.append((float(words[0]), float(words[1]) if len(words) > 1 else 0.0))
        elif keyword == "f":
            corners = [(word.split("/") + [""])[:2] for word in words]
            faces.append([(number(v, vertices), number(t, len(points)) if t else None)
                          for v, t in corners])
    return points, faces


def read_uv(path, triangles):
    """Coordinates of the corners of `triangles` (t x 3), 3 t x 2; (0, 0) for those without. None
    without the file or without coordinates in it."""
    if not path.exists():
        return None
    try:
        points, faces = read_faces(path.read_text(errors="replace").splitlines())
    except (ValueError, IndexError) as error:
        raise FileError(f"{path}: expected an OBJ file: {error}") from error
    if not points:
        return None
    fans = ((face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1))
    texture = {frozenset(v for v, _ in corners): dict(corners) for corners in fans}
    points.append((0.0, 0.0))
    try:
        chosen = [texture[frozenset(corners)][v] for corners in triangles.tolist() for v in corners]
    except KeyError as error:
        raise FileError(f"{path}: expected the {len(triangles)} triangles of the frames") from error
    return np.array(points, np.float32)[[-1 if t is None else t for t in chosen]]
