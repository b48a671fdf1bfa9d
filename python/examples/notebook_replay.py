#!/usr/bin/env python3
"""Writes a run and packs it into the page that a notebook shows when it is the last line of a cell."""
import tempfile

import projdyn

scene = projdyn.Scene(duration=0.5)
scene.add_cloth(grid={"size": [1, 1], "vertices": [25, 25]}, name="sheet", area_density=0.2,
                spring={"stretching_stiffness": 500}, pin={"vertices": {"vertices": [0, 24]}})
sim = scene.load()
directory = tempfile.mkdtemp()
with sim.write(directory) as writer:
    for info in sim.run():
        writer.step(info)
page = projdyn.replay(directory)
print(f"{page.path}: {len(page._repr_html_()) / 1e6:.1f} MB")
page
