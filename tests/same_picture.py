"""Checks that two pictures show the same, up to the rounding of their triangles. Usage: same_picture.py A.png B.png"""
import pathlib
import sys

from read_png import read_png

a, b = (read_png(pathlib.Path(name)) for name in sys.argv[1:])
apart = sum(max(abs(u - v) for u, v in zip(p, q)) >= 16 for p, q in zip(a, b))
print(f"{apart} of {len(a)} pixels differ, expected at most 1 %")
sys.exit(len(a) != len(b) or apart > 0.01 * len(a))
