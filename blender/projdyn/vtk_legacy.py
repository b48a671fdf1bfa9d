"""Reader for the VTK files of a run: legacy VTK 4.2, BINARY, UNSTRUCTURED_GRID, big endian.

    POINTS n float | CELLS c k | CELL_TYPES c
    POINT_DATA n, then any of SCALARS (float 1) and VECTORS

app/vtk_frame.c reads the same layout."""
import pathlib
from dataclasses import dataclass, field

import numpy as np

VERTEX_CELL, TRIANGLE_CELL = 1, 5  # cell types of VTK
HEADER = (b"# vtk DataFile Version 4.2", None, b"BINARY", b"DATASET UNSTRUCTURED_GRID")


class FileError(Exception):
    """A file of a run that is missing or damaged; the text names the file."""


@dataclass
class Frame:
    """Points of a body at one time, in the axes of the file."""
    points: np.ndarray  # m, n x 3
    triangles: np.ndarray  # corners, t x 3; t = 0 for particles
    arrays: dict = field(default_factory=dict)  # name -> n, or n x 3


class Reader:
    """A position in the bytes of a file."""

    def __init__(self, path):
        self.path, self.at = path, 0
        try:
            self.data = pathlib.Path(path).read_bytes()
        except OSError as error:
            raise FileError(f"{path}: {error.strerror}") from error

    def fail(self, expected):
        found = self.data[self.at:self.at + 40]
        raise FileError(f"{self.path}: byte {self.at}: expected {expected}, found {found!r}")

    def at_end(self):
        return self.at == len(self.data)

    def line(self, expected):
        end = self.data.find(b"\n", self.at, self.at + 300)
        if end < 0:
            self.fail(expected)
        line, self.at = self.data[self.at:end], end + 1
        return line

    def words(self, expected):
        """A line that begins with the words of `expected`; capitals N and NAME match anything."""
        at = self.at
        found = self.line(expected).decode("ascii", "replace").split()
        wanted = expected.split()
        if len(found) != len(wanted) or any(
                w != f and w not in ("N", "NAME") for w, f in zip(wanted, found)):
            self.at = at
            self.fail(f"the line {expected!r}")
        return found

    def numbers(self, count, kind):
        size = 4 * count
        if len(self.data) < self.at + size + 1:
            self.fail(f"{count} numbers")
        values = np.frombuffer(self.data, kind, count, self.at)
        self.at += size + 1  # a newline ends the block
        return values.astype(kind.replace(">", "="))


def read_cells(reader, points):
    """Corners of triangles, t x 3; none for vertex cells."""
    _, cells, size = reader.words("CELLS N N")
    cells, size = int(cells), int(size)
    corners = reader.numbers(size, ">i4")
    reader.words(f"CELL_TYPES {cells}")
    types = reader.numbers(cells, ">i4")
    if not cells or (types == VERTEX_CELL).all():
        return np.empty((0, 3), np.int32)
    if size != 4 * cells or (types != TRIANGLE_CELL).any():
        reader.fail("cells that are all vertices or all triangles")
    corners = corners.reshape(cells, 4)
    if (corners[:, 0] != 3).any() or corners[:, 1:].min() < 0 or corners[:, 1:].max() >= points:
        reader.fail(f"triangles with corners below {points}")
    return np.ascontiguousarray(corners[:, 1:])


def read_array(reader, points):
    """One array of POINT_DATA: (name, values)."""
    at = reader.at
    vectors = reader.line("SCALARS or VECTORS").startswith(b"VECTORS")
    reader.at = at
    if vectors:
        name = reader.words("VECTORS NAME float")[1]
        return name, reader.numbers(3 * points, ">f4").reshape(points, 3)
    name = reader.words("SCALARS NAME float 1")[1]
    reader.words("LOOKUP_TABLE default")
    return name, reader.numbers(points, ">f4")


def read_frame(path):
    """Reads a Frame; FileError if the file is missing or has another layout."""
    reader = Reader(path)
    for expected in HEADER:
        at = reader.at
        if reader.line("a VTK header") != expected and expected is not None:
            reader.at = at
            reader.fail(f"the line {expected.decode()!r}")
    points = int(reader.words("POINTS N float")[1])
    frame = Frame(reader.numbers(3 * points, ">f4").reshape(points, 3), read_cells(reader, points))
    if not reader.at_end():
        reader.words(f"POINT_DATA {points}")
    while not reader.at_end():
        name, values = read_array(reader, points)
        frame.arrays[name] = values
    return frame
