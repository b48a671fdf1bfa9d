#!/usr/bin/env python3
"""Runs one scene with several stiffnesses in parallel processes, one thread each."""
import multiprocessing

import projdyn


def stretch(stiffness):
    """m: how far a sheet that is held by a border hangs after a second."""
    scene = projdyn.Scene(duration=1, threads=1)
    scene.add_cloth(grid={"size": [1, 1], "vertices": [25, 25]}, name="sheet", area_density=2,
                    spring={"stretching_stiffness": stiffness, "damping": 0.1},
                    pin={"vertices": {"border": True}})
    sim = scene.load()
    for info in sim.run():
        pass
    return -sim.bodies["sheet"].x[:, 1].min()


if __name__ == "__main__":
    stiffnesses = [50, 100, 200, 400, 800]
    with multiprocessing.Pool() as pool:
        for stiffness, depth in zip(stiffnesses, pool.map(stretch, stiffnesses)):
            print(f"{stiffness:4d} N/m: {depth:.4f} m")
