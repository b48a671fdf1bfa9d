"""Checks the light of two pictures. Usage: studio_light.py BALL.png SHEET.png

BALL: a red ball just above the ground, which takes the sky from the ground below it. SHEET: a sheet of the first colour
of the palette in full light, which must not bleach it."""
import pathlib
import sys

from read_png import read_png

ball, sheet = (read_png(pathlib.Path(name)) for name in sys.argv[1:])
ground = [p for p in ball if max(p) - min(p) < 25 and p[2] >= p[0]]
deep = sum(max(p) < 135 for p in ground)  # the lamp's shadow alone has 150
bright = [p for p in sheet if p[0] > 200 and p[2] < p[0] - 25]
sand = sum(p[1] < 0.94 * p[0] for p in bright)  # 0.90 in the palette; each channel compressed for itself: 0.96
print(f"{deep} pixels of deep shadow, expected 400 or more; {sand} of {len(bright)} pixels of the sheet in its colour, "
      "expected 95 % of 5000 or more")
sys.exit(not (deep >= 400 and len(bright) >= 5000 and sand > 0.95 * len(bright)))
