#!/usr/bin/env python3
"""Plots the energies of a run while it runs; without a display it saves live_plot.png."""
import matplotlib.pyplot as plt

import projdyn

SHOWN = plt.get_backend().lower() != "agg"  # what matplotlib takes without a display
scene = projdyn.Scene(duration=1)
scene.add_cloth(grid={"size": [1, 1], "vertices": [25, 25]}, name="sheet", area_density=0.2,
                spring={"stretching_stiffness": 500}, pin={"vertices": {"vertices": [0, 24]}})
sim = scene.load()
names = ["kinetic", "potential", "constraint"]
figure, axes = plt.subplots()
lines = [axes.plot([], [], label=f"{name} energy")[0] for name in names]
axes.set(xlabel="time, s", ylabel="energy, J")
axes.legend()
times, energies = [], []
for info in sim.run():
    times.append(info.time)
    energies.append([getattr(info, f"{name}_energy") for name in names])
    if info.frame and SHOWN:
        for line, column in zip(lines, zip(*energies)):
            line.set_data(times, column)
        axes.relim(), axes.autoscale_view(), plt.pause(0.001)
for line, column in zip(lines, zip(*energies)):
    line.set_data(times, column)
axes.relim(), axes.autoscale_view()
plt.show() if SHOWN else figure.savefig("live_plot.png")
print(f"{len(times)} steps; energy at the end {sum(energies[-1]):.3f} J")
