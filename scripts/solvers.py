#!/usr/bin/env python3
"""Measures the solvers of coupled scenes with the program build/app/projdyn and prints one table of
docs/results/solvers.md. Times are processor time of one thread, those of `threads` wall-clock time.

Usage: solvers.py shaken SECONDS           a bag of water, shaken
       solvers.py cost SECONDS [SCENE...]  coupled scenes and their bodies alone
       solvers.py stiffness SECONDS [N/M...]
       solvers.py sizes MMxSECONDSxSECONDS...  water_on_cloth with particles of this radius, from and
                                               to a time
       solvers.py threads THREADS...           scenes on so many threads
"""
import copy
import csv
import json
import math
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
OUT = ROOT / "out/solvers"
COUPLED = ["water_on_cloth", "pool_in_cloth", "hammock", "curtain", "underwater_curtain", "dragged_cloth",
           "sinking_cloth", "flag_in_stream", "taut_bag", "balloon", "ball_on_water", "soft_ball",
           "floating_block", "rafts"]
SOLVERS = ["auto", "hybrid", "dual", "cg"]


class Run:
    """Steps of a run and its report."""

    def __init__(self, name, scene, seconds, *settings, start=0.0, threads=1):
        path = ROOT / "scenes" / f"{scene}.json"
        if not isinstance(scene, str):
            path = OUT / f"{name}.json"
            path.write_text(json.dumps(scene))
        out = OUT / name
        command = [ROOT / "build/app/projdyn", "run", path, "-o", out, "--threads", str(threads), "--no-frames",
                   "--quiet", "--save", "0", "--time", str(seconds)]
        for setting in settings:
            command += ["--set", setting]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        self.report = json.loads((out / "report.json").read_text())
        with open(out / "metrics.csv", newline="") as file:
            rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
        self.steps = [row for row in rows if row["time_s"] > start]

    def mean(self, key):
        return sum(row[key] for row in self.steps) / len(self.steps)

    def largest(self, key):
        return max(row[key] for row in self.steps)

    def ms(self):
        return self.mean("ms_cpu")

    def wall_ms(self):
        return sum(self.mean(f"ms_{part}") for part in ("neighbours", "local", "contact", "global"))

    def unsolved(self):
        """Unsolved steps of the whole run."""
        return f"{self.report['unsolved_steps']} of {self.report['steps']}"


def print_head(*names):
    print("| " + " | ".join(names) + " |")
    print("|---" * len(names) + "|", flush=True)


def print_row(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def percent(value, digits=2):
    return f"{100.0 * value:.0f} %" if value > 0.99 else f"{100.0 * value:.{digits}g} %"


def load_scene(name):
    scene = json.loads((ROOT / f"scenes/{name}.json").read_text())
    scene.pop("$schema", None)
    for body in scene["bodies"] + scene.get("solids", []):
        for shape in (body.get("surface"), body.get("volume"), body.get("rigid"), body):
            if shape and isinstance(shape.get("mesh"), str):
                shape["mesh"] = str(ROOT / "scenes" / shape["mesh"])
    return scene


# ---- a shaken bag -----------------------------------------------------------------------------


def shaken_bag(fill, pins):
    """taut_bag with settings of the solver left at their defaults, its top shaken along x by 0.15 m at 2.5 Hz."""
    scene = load_scene("taut_bag")
    del scene["solver"]
    water, bag = scene["bodies"]
    water["particles"]["fill"][0]["sphere"]["radius"] = fill
    for constraint in bag["constraints"]:
        if constraint["type"] == "pin":
            constraint["stiffness"] = pins
            constraint["path"] = [[k / 80.0, 0.15 * math.sin(math.pi * k / 16.0), 0, 0] for k in range(161)]
    return scene


def shaken(seconds):
    print_head("bag", "particles", "pins, N/m", "steps", "ms a step", "linear", "outer", "unsolved",
               "largest residual", "density error, mean", "worst mean", "largest", "outside")
    for name, fill in ("three quarters full", 0.094), ("taut", 0.1058):
        for pins in 1e5, 1e7:
            run = Run("shaken", shaken_bag(fill, pins), seconds)
            print_row(name, run.report["particles"]["fluid"], f"{pins:.0e}", len(run.steps), f"{run.ms():.0f}",
                      f"{run.mean('linear_iterations'):.0f}", f"{run.mean('outer_iterations'):.1f}",
                      run.unsolved(), f"{run.largest('step_residual'):.2g}",
                      percent(run.mean("density_error_mean")), percent(run.largest("density_error_mean")),
                      percent(run.largest("density_error_max")), run.report["leaked"])


# ---- coupled scenes and their bodies alone ----------------------------------------------------


def split(scene, report):
    """The scene with its fluid alone, at the same stiffness, and with its other bodies alone."""
    scene.pop("probes", None)
    fluid, others = copy.deepcopy(scene), copy.deepcopy(scene)
    fluid["bodies"] = [body for body in fluid["bodies"] if "particles" in body]
    others["bodies"] = [body for body in others["bodies"] if "particles" not in body]
    fluid.pop("contact", None)
    for constraint in fluid["bodies"][0]["constraints"]:
        if constraint.pop("compression", None):
            constraint["stiffness"] = report["parameters"][0]["numbers"]["stiffness"]
    return fluid, others


def shares(report):
    ms = {key: value for key, value in report["ms"].items() if key != "output"}
    return [percent(ms[key] / sum(ms.values())) for key in ("neighbours", "local", "contact", "global")]


def cost(seconds, names):
    print_head("scene", "particles", "vertices", "ms a step", "fluid alone", "others alone",
               "over the sum", "linear", "outer", "unsolved", "steps in pressures", "lists and sides", "local", "contact", "global")
    for name in names or COUPLED:
        run = Run(name, name, seconds)
        alone = [Run(f"{name}_alone", scene, seconds).ms() for scene in split(load_scene(name), run.report)]
        vertices = sum(body["count"] for body in run.report["bodies"] if body["kind"] != "particles")
        print_row(name, run.report["particles"]["end"], vertices, f"{run.ms():.1f}", f"{alone[0]:.1f}",
                  f"{alone[1]:.1f}", f"{run.ms() / sum(alone):.1f}", f"{run.mean('linear_iterations'):.0f}",
                  f"{run.mean('outer_iterations'):.1f}", run.unsolved(),
                  percent(run.report["solver"]["dual_steps"] / len(run.steps)), *shares(run.report))


# ---- stiffness of the fluid and mass of the sheet -------------------------------------------------


def basin(stiffness, mass, stretching):
    """Water, 192 particles of 20 mm, falls into a sheet of 0.3 m that is pinned along its border."""
    return {"duration": 1, "time_step": {"fixed": 0.005}, "contact": {"thickness": 0.002}, "bodies": [
        {"name": "water",
         "particles": {"radius": 0.01, "fill": [{"box": {"minimum": [-0.06, -0.06, -0.06],
                                                         "maximum": [0.06, 0.02, 0.06]}}]},
         "constraints": [{"type": "fluid", "stiffness": stiffness}]},
        {"name": "sheet",
         "surface": {"grid": {"size": [0.3, 0.3], "vertices": [16, 16], "sag": 0.1}, "area_density": mass},
         "constraints": [{"type": "triangle", "stretching_stiffness": stretching},
                         {"type": "bending", "bending_rigidity": 1e-4},
                         {"type": "pin", "vertices": {"border": True}}]}]}


def stiffness(seconds, weights):
    print_head("kg/m²", "K, N/m", "w, N/m", "ms a step", "over the first w", "linear", "outer", "unsolved",
               "largest residual", "density error, mean", "largest")
    for mass in 0.05, 0.3, 10.0:
        for stretching in 1e3, 1e5:
            first = None
            for weight in weights or [1e4, 1e5, 1e6, 1e7]:
                run = Run("stiffness", basin(weight, mass, stretching), seconds)
                first = first or run.ms()
                print_row(f"{mass:g}", f"{stretching:.0e}", f"{weight:.0e}", f"{run.ms():.1f}",
                          f"{run.ms() / first:.1f}", f"{run.mean('linear_iterations'):.0f}",
                          f"{run.mean('outer_iterations'):.1f}", run.unsolved(),
                          f"{run.largest('step_residual'):.2g}", percent(run.mean("density_error_mean")),
                          percent(run.largest("density_error_max")))


# ---- sizes ----------------------------------------------------------------------------------------


def sizes(runs):
    print_head("radius, mm", "particles", "from, to, s", "solver", "ms a step", "µs a particle", "linear", "outer", "unsolved",
               "density error, mean", "kB a particle")
    for text in runs:
        radius, start, end = (float(part) for part in text.split("x"))
        for solver in SOLVERS:
            run = Run("sizes", "water_on_cloth", end, f"bodies.water.particles.radius={1e-3 * radius:g}",
                      f"solver.type={solver}", start=start)
            count = run.report["particles"]["fluid"]
            print_row(f"{radius:g}", count, f"{start:g}, {end:g}", solver, f"{run.ms():.0f}", f"{1e3 * run.ms() / count:.1f}",
                      f"{run.mean('linear_iterations'):.0f}", f"{run.mean('outer_iterations'):.1f}",
                      run.unsolved(), percent(run.mean("density_error_mean")),
                      f"{1e-3 * run.report['peak_memory_bytes'] / count:.2g}")


# ---- threads --------------------------------------------------------------------------------------

THREADED = [
    ("water of `water_on_cloth`, 21,600 particles, on its sheet", "water_on_cloth", 0.06,
     "bodies.water.particles.radius=0.0048"),
    ("the same, 98,400 particles, `dual`", "water_on_cloth", 0.05, "bodies.water.particles.radius=0.00287",
     "solver.type=dual"),
    ("`dam_break`", "dam_break", 0.2),
    ("`soft_ball`", "soft_ball", 0.1),
    ("`rafts`", "rafts", 0.2),
    ("`hanging_cloth`, 129 x 129 vertices", "hanging_cloth", 0.2, "bodies.sheet.surface.grid.vertices=[129,129]"),
    ("`cloth_on_sphere`, 65 x 65 vertices", "cloth_on_sphere", 0.18, "bodies.sheet.surface.grid.vertices=[65,65]"),
]


def threads(counts):
    """The lesser time of two runs."""
    print_head("scene", *[f"{count} thread{'s' if count > 1 else ''}, ms" for count in counts], "speed-up")
    for title, scene, seconds, *settings in THREADED:
        ms = [min(Run("threads", scene, seconds, *settings, threads=count).wall_ms() for _ in range(2))
              for count in counts]
        print_row(title, *[f"{value:.3g}" for value in ms], f"{ms[0] / min(ms):.1f}")


def main():
    command, arguments = (sys.argv + [""])[1], sys.argv[2:]
    OUT.mkdir(parents=True, exist_ok=True)
    if command == "shaken" and len(arguments) == 1:
        shaken(float(arguments[0]))
    elif command == "cost" and arguments:
        cost(float(arguments[0]), arguments[1:])
    elif command == "stiffness" and arguments:
        stiffness(float(arguments[0]), [float(weight) for weight in arguments[1:]])
    elif command == "sizes" and arguments:
        sizes(arguments)
    elif command == "threads" and arguments:
        threads([int(count) for count in arguments])
    else:
        sys.exit(__doc__)


main()
