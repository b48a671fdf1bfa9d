#!/usr/bin/python3
"""How far the volume of a body of tetrahedra goes from that of its first frame.

    scripts/volume_of_tets.py out/soft_ball/ball scenes/meshes/ball.ele
"""
import glob
import sys

import numpy as np

body, mesh = sys.argv[1:]
tet = np.loadtxt(mesh, skiprows=1, dtype=int)[:, 1:5] - 1


def volumes(path):
    data = open(path, "rb").read()
    line = data.index(b"POINTS")
    begin = data.index(b"\n", line) + 1
    count, kind = data[line:begin].split()[1:3]
    x = np.frombuffer(data, ">f4" if kind == b"float" else ">f8", 3 * int(count), begin).reshape(-1, 3).astype(float)
    a, b, c, d = (x[tet[:, k]] for k in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


frames = sorted(glob.glob(body + "_*.vtk"))
rest = volumes(frames[0])
change = [volumes(f) @ np.sign(rest) / np.abs(rest).sum() - 1 for f in frames]
inverted = max(np.count_nonzero(volumes(f) * rest <= 0) for f in frames)
print(f"{len(frames)} frames: volume from {100 * min(change):+.3f} % to {100 * max(change):+.3f} %, "
      f"at most {inverted} of {len(tet)} tetrahedra inside out")
