"""Runs random legal scenes and checks that nothing goes wrong in silence.

Usage: random_scenes.py PROJDYN COUNT SEED [--first K] [--keep DIR]

Scene k is a function of SEED and k; --first K begins with scene K. --keep DIR keeps scenes and results. A run
ends with exit code 0, with 1 and an error that names step, time and reason, or with 2 and the place in the
scene, or what intersects at the start. The checks read metrics.csv and the frames, and expect what they find
in the warnings of report.json:

    unsolved, retries, compressed   the number of steps in metrics.csv
    energy      the energy of a closed scene rises in a solved step
    leak        water is outside of a closed tank, or beyond a sheet that spans it

Every number is finite, and the number of particles changes by inlets and outlets alone.
"""
import argparse
import array
import collections
import csv
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import time

BALL = pathlib.Path(__file__).resolve().parent.parent / "scripts/ball_of_tets.sh"
SOLVERS = ["cholesky", "dual", "hybrid", "cg", "auto"]
SECONDS = 120  # a run that takes longer hangs; the sizes are chosen for about one second
MOST = 700  # particles of a body of water
CONTACT_WORK = 200000  # particles x iterations of all steps, at most, in a scene with contact
WORK = 4e7  # particles x linear iterations of all steps, at most
KINDS = ["water", "sheet", "soft", "water sheet", "water sheet", "water soft", "sheet sheet", "soft sheet",
         "water water", "water sheet sheet", "water sheet soft", "sheet sheet sheet"]

SLOW = 1e-3  # m/s; the energy of such a motion is none

# ---- scenes --------------------------------------------------------------------------------------


def log_uniform(r, low, high):
    return math.exp(r.uniform(math.log(low), math.log(high)))


def direction(r, length=1):
    v = [r.gauss(0, 1) for _ in range(3)]
    return [length * a / math.hypot(*v) for a in v]


class Scene:
    """Bodies and obstacles above each other, each in its layer, in a tank or above a floor."""

    def __init__(self, seed, k, directory):
        self.random = r = random.Random(f"{seed}/{k}")
        self.times = random.Random(f"times {seed}/{k}")  # of constraints
        self.directory = directory
        self.width = log_uniform(r, 0.01, 20)  # m, of the tank
        self.layer = self.width * r.uniform(0.3, 0.8)
        self.radius = self.width / r.randint(14, 28)
        self.points, self.mass = 0, 0  # of all bodies; kg
        self.open_system = False  # something gives or takes energy
        self.middle = 0  # m, height of the current layer
        self.streams = False  # inlets or outlets
        self.spanning = None  # name of a sheet that spans the tank below water
        layers = r.choice(KINDS).split() + (["obstacle"] if r.random() < 0.3 else [])
        r.shuffle(layers)
        self.height = len(layers) * self.layer
        self.json = {"name": f"random {seed}/{k}", "bodies": [], "solids": []}
        self.add_time()
        self.add_gravity()
        if r.random() < 0.5 and set(layers) & {"sheet", "soft"}:
            self.add_contact()
        self.touching = "contact" in self.json and r.random() < 0.5  # sheets lie upon each other
        self.tank = self.add_tank()
        for level, kind in enumerate(layers):
            above = layers[level + 1:].count("water")
            if self.touching and layers[max(0, level - 1):level + 1] == ["sheet", "sheet"]:
                self.middle += self.json["contact"]["thickness"] * log_uniform(r, 0.1, 1)
            else:
                self.middle = (level + 0.5) * self.layer
            {"water": self.add_water, "sheet": lambda: self.add_sheet(above > 0), "soft": self.add_soft,
             "obstacle": self.add_obstacle}[kind]()
        self.add_attachment()
        if r.random() < 0.1:
            self.json["boundary"] = "points"  # compresses water that begins close to a plane or a mesh
        elif r.random() < 0.2:
            self.json["kernel"] = "wendland"
        self.add_solver()

    def add_time(self):
        r = self.random
        if r.random() < 0.6:
            h, steps = log_uniform(r, 1e-4, 5e-2), r.randint(3, 12)
            self.json["time_step"], self.steps = {"fixed": h}, steps
        else:
            h = log_uniform(r, 1e-3, 2e-2)
            steps = r.randint(5, max(5, min(30, int(0.2 / h))))
            self.json["time_step"] = {"maximum": h, "minimum": h / 8, "cfl": log_uniform(r, 0.2, 2)}
            self.steps = 4 * steps
        self.json["time_step"]["integrator"] = r.choice(["bdf2", "euler"])
        self.json["duration"] = h * steps
        self.json["frame_interval"] = h * steps / r.randint(1, 3)

    def add_gravity(self):
        r = self.random
        gravity = r.choice([[0, -9.81, 0]] * 7 + [[0, 0, 0], direction(r, 9.81), direction(r, 100)])
        self.gravity = math.hypot(*gravity)
        self.down = gravity == [0, -9.81, 0]
        self.json["gravity"] = gravity

    def add_contact(self):
        r = self.random
        self.json["contact"] = {"thickness": self.width / 10 * log_uniform(r, 0.01, 0.6),
                                "friction": r.choice([0, 0.3, 1]), "stiffness": log_uniform(r, 1e1, 1e6),
                                "self": r.random() < 0.8}

    def motion(self):
        """Of a solid, in one of six cases."""
        r, duration = self.random, self.json["duration"]
        if r.random() > 1 / 6:
            return {}
        self.open_system = True
        end = {"time": duration, "translate": direction(r, self.width * log_uniform(r, 0.01, 1))}
        if r.random() < 0.4:
            end["rotate"] = direction(r, r.uniform(1, 90))
        return {"motion": [{"time": 0}, end]}

    def add_tank(self):
        """A tank, or a floor; its bounds if it is closed and rests."""
        r, w = self.random, self.width
        if r.random() < 0.2:
            self.json["solids"].append({"name": "floor", "plane": {"center": [0, 0, 0], "normal": [0, 1, 0],
                                                                   "size": 4 * w}})
            return None
        low, high = [-w / 2, 0, -w / 2], [w / 2, self.height, w / 2]
        sides = r.choice([[], [], ["+y"], ["+y"], ["+x", "+y"]])
        tank = {"name": "tank", "box": {"minimum": low, "maximum": high}, "open": sides} | self.motion()
        self.json["solids"].append(tank)
        return (low, high) if not sides and "motion" not in tank else None

    def add_obstacle(self):
        r, y, size = self.random, self.middle, self.width * self.random.uniform(0.05, 0.14)
        shape = r.choice([{"sphere": {"center": [0, y, 0], "radius": size}},
                          {"capsule": {"from": [-size, y, 0], "to": [size, y, 0], "radius": size / 2}}])
        self.json["solids"].append({"name": "obstacle"} | shape | self.motion())

    def add_body(self, name, kind, value, points, mass, constraints):
        r = self.random
        body = {"name": f"{name}{len(self.json['bodies'])}", kind: value, "constraints": constraints}
        if r.random() < 0.3:
            body["velocity"] = direction(r, log_uniform(r, 0.01, 30))
        self.json["bodies"].append(body)
        self.points += points
        self.mass += mass
        return body

    def add_water(self):
        r, radius, w, y = self.random, self.radius, self.width, self.middle
        half = [max(radius, w / 2 * r.uniform(0.4, 0.98)), max(radius, self.layer / 2 * r.uniform(0.4, 0.9)),
                max(radius, w / 2 * r.uniform(0.4, 0.98))]
        low, high = y - half[1], y + half[1]
        if r.random() < 0.3:  # around the bodies above or below, too
            low, high = max(0, low - r.choice([0, self.layer])), min(self.height, high + r.choice([0, self.layer]))
        box = {"minimum": [-half[0], low, -half[2]], "maximum": [half[0], high, half[2]]}
        ball = {"sphere": {"center": [0, y, 0], "radius": half[1]}}
        fill = r.choices([[{"box": box}], [ball], [{"box": box}, ball]], [6, 3, 1])[0]
        count = 4 * half[0] * (high - low) * half[2] / (2 * radius) ** 3
        if count > MOST:
            radius *= (count / MOST) ** (1 / 3)
        water = {"radius": radius, "rest_density": log_uniform(r, 500, 2000), "fill": fill}
        if r.random() < 0.05:
            water["overlap"] = "keep"
        if r.random() < 0.12:
            inlet = {"rectangle": {"center": [0, y, 0], "size": [4 * radius, 4 * radius]},
                     "direction": direction(r), "speed": log_uniform(r, 0.1, 10)}
            if r.random() < 0.3:
                inlet["speed"] = [{"time": self.json["duration"] * t, "speed": r.choice([0, 1]) * inlet["speed"]}
                                  for t in (0, r.uniform(0.1, 0.5), r.uniform(0.6, 1))]
            water["inlets"] = [inlet | self.motion()]
            water["budget"] = r.randint(5, 200)
            self.open_system = self.streams = True
        if r.random() < 0.1:
            around = {"minimum": [-w, -w, -w], "maximum": [w, self.height + w, w]}
            self.json["outlets"] = [r.choice([{"box": box}, {"box": around, "outside": True}])]
            self.open_system = self.streams = True
        first = not any("particles" in body for body in self.json["bodies"])
        count = min(count, MOST)
        self.add_body("water", "particles", water, count, count * (2 * radius) ** 3 * water["rest_density"],
                      [self.fluid()] if first else [])

    def fluid(self):
        r = self.random
        how = r.choice([{"stiffness": log_uniform(r, 1e1, 1e9)}, {"sound_speed": log_uniform(r, 5, 300)},
                        {"compression": log_uniform(r, 1e-4, 0.05)} if self.gravity else {}])
        return {"type": "fluid", "viscosity": r.choice([0, 0.02, 0.5])} | how

    def add_sheet(self, below_water):
        r, w = self.random, self.width
        spans = below_water and "contact" not in self.json and r.random() < 0.5
        size = [1.3 * w] * 2 if spans else [w * r.uniform(0.4, 0.9), w * r.uniform(0.4, 0.9)]
        vertices = [r.randint(2, 13), r.randint(5, 13)]
        surface = {"grid": {"size": size, "vertices": vertices}, "translate": [0, self.middle, 0],
                   "area_density": log_uniform(r, 0.02, 20)}
        if not spans and not self.touching and r.random() < 0.3:
            surface["grid"]["size"] = size = [0.7 * a for a in size]
            surface["rotate"] = [r.uniform(-10, 10), r.uniform(0, 90), r.uniform(-10, 10)]
        if r.random() < 0.1:
            surface["fluid_friction"] = log_uniform(r, 0.1, 100)
        if not spans and r.random() < 0.2:
            surface["permeability"] = log_uniform(r, 1e-5, 10)
        last = vertices[0] * vertices[1] - 1
        choice = {"border": True} if spans else r.choice(
            [None, None, {"border": True}, {"all": True}, {"vertices": [0, vertices[0] - 1]}, {"vertices": [last]}])
        body = self.add_body("sheet", "surface", surface, last + 1, size[0] * size[1] * surface["area_density"],
                             self.stretching() + self.pin(choice, spans) + self.wind())
        if spans:
            self.spanning = body["name"]

    def stretching(self):
        r = self.random
        kind = r.choice(["spring", "triangle"])
        found = [{"type": kind, "stretching_stiffness": log_uniform(r, 1e1, 1e9)}]
        if kind == "triangle" and r.random() < 0.3:
            found[0] |= {"shortest": r.choice([0, 0.9]), "longest": r.choice([1, 1.05])}
        if r.random() < 0.5:
            found.append({"type": "bending", "bending_rigidity": log_uniform(r, 1e-6, 1e2)})
        for constraint in found:
            if r.random() < 0.2:
                constraint["damping"] = log_uniform(r, 1e-4, 1)
        return found

    def pin(self, choice, rests):
        r, duration = self.random, self.json["duration"]
        if not choice:
            return []
        pin = {"type": "pin", "vertices": choice, "stiffness": log_uniform(r, 1e4 if rests else 1e1, 1e9)}
        if not rests and r.random() < 0.15:
            kind, most = r.choice([("path", self.width), ("turn", 90)])
            pin[kind] = [[0, 0, 0, 0], [duration] + direction(r, most * log_uniform(r, 0.01, 1))]
            self.open_system = True
        elif not rests and self.times.random() < 0.3:
            pin["until"] = duration * self.times.uniform(0.1, 0.9)
        return [pin]

    def wind(self):
        r = self.random
        if r.random() > 0.15:
            return []
        self.open_system = True
        wind = {"type": "wind", "velocity": direction(r, log_uniform(r, 0.1, 100))}
        if self.times.random() < 0.5:
            wind["from"] = self.json["duration"] * self.times.uniform(0.1, 0.5)
        return [wind]

    def add_soft(self):
        r, w = self.random, self.width
        size = min(w, self.layer) * r.uniform(0.3, 0.8)
        density = log_uniform(r, 100, 5000)
        if r.random() < 0.5:
            cells = [r.randint(1, 4) for _ in range(3)]
            volume, points = {"grid": {"size": [size] * 3, "cells": cells}}, math.prod(c + 1 for c in cells)
        else:
            n = r.choice([2, 4])
            subprocess.run(["sh", BALL, self.directory / "ball", str(n)], check=True)
            volume, points = {"mesh": "ball.node", "scale": size / 2}, (n + 1) ** 3
        volume |= {"density": density, "translate": [0, self.middle, 0]}
        tet = {"type": "tet", "stiffness": log_uniform(r, 1e2, 1e9)}
        if r.random() < 0.5:
            tet["volume_stiffness"] = log_uniform(r, 1e2, 1e9)
        if r.random() < 0.2:
            tet["damping"] = log_uniform(r, 1e-4, 1)
        choice = {"vertices": [0]} if r.random() < 0.2 else None
        self.add_body("soft", "volume", volume, points, density * size ** 3, [tet] + self.pin(choice, False))

    def add_attachment(self):
        r = self.random
        found = [body for body in self.json["bodies"] if "particles" not in body]
        if len(found) > 1 and r.random() < 0.2:
            found[0]["constraints"].append(
                {"type": "attachment", "to": found[1]["name"], "vertices": {"vertices": [0, 1]},
                 "stiffness": log_uniform(r, 1e1, 1e6), "length": r.choice([1, 1, 0.5, 2]),
                 "tension_only": self.times.random() < 0.5})

    def add_solver(self):
        r = self.random
        solver = {"step": r.choice(["newton", "newton", "projective"]), "type": r.choice(["auto"] + SOLVERS),
                  "tolerance": 0 if r.random() < 0.03 else log_uniform(r, 1e-5, 10),
                  "linear_tolerance": log_uniform(r, 1e-4, 0.1), "retries": r.choice([0, 4, 4, 4])}
        outer, linear = r.choice([1, 2, 5, 20, 100]), r.choice([1, 10, 100, 500])
        if "contact" in self.json:
            outer = max(1, min(outer, CONTACT_WORK // int(self.steps * self.points)))
        while outer * linear * self.steps * self.points > WORK and outer * linear > 1:
            outer, linear = max(1, outer // 2), max(1, linear // 2)
        if solver["type"] == "cholesky":
            if self.points > 500:  # a factorisation of such a fluid takes seconds
                solver["type"] = "dual"
            outer = min(outer, 5)
        self.json["solver"] = solver | {"outer_iterations": outer, "linear_iterations": linear}

    def wrong_solver(self):
        """Takes the next solver instead of one that does not fit the scene; "auto" is the last."""
        solver = self.json["solver"]
        solver["type"] = SOLVERS[SOLVERS.index(solver["type"]) + 1]


# ---- results -------------------------------------------------------------------------------------


def numbers_of_frame(path):
    """Points and all numbers of points of a VTK file, in the order of the file."""
    data, arrays = path.read_bytes(), []
    count = int(re.search(rb"POINTS (\d+) float\n", data)[1])
    heads = rb"POINTS \d+ float\n|SCALARS \w+ float 1\nLOOKUP_TABLE default\n|VECTORS \w+ float\n"
    for head in re.finditer(heads, data):
        size = count * (1 if head[0].startswith(b"SCALARS") else 3)
        values = array.array("f", data[head.end():head.end() + 4 * size])
        values.byteswap()
        arrays.append(values)
    flat = arrays[0]
    return [tuple(flat[k:k + 3]) for k in range(0, len(flat), 3)], arrays


def nulls(value, path=""):
    """Paths of the numbers of a report that are not finite."""
    if isinstance(value, dict):
        return [p for key, item in value.items() for p in nulls(item, f"{path}.{key}")]
    if isinstance(value, list):
        return [p for k, item in enumerate(value) for p in nulls(item, f"{path}.{k}")]
    return [path] if value is None else []


class Result:
    def __init__(self, scene, directory):
        self.scene, self.directory = scene, directory
        self.tolerance = scene.json["solver"]["tolerance"]
        self.report = json.loads((directory / "report.json").read_text())
        self.warnings = {(w["code"], w["subject"]): w["count"] for w in self.report["warnings"]}
        with open(directory / "metrics.csv", newline="") as file:
            self.rows = list(csv.DictReader(file))

    def frames(self, body):
        return sorted(self.directory.glob(f"{body['name']}_??????.vtk"))

    def points(self, body, frame):
        return numbers_of_frame(self.frames(body)[frame])[0]

    def column(self, name):
        return [float(row[name]) for row in self.rows]

    def water(self):
        return [body for body in self.scene.json["bodies"] if "particles" in body]


# ---- checks; each yields what is wrong -----------------------------------------------------------


def check_finite(result):
    for number, row in enumerate(result.rows, 1):
        bad = [key for key, text in row.items() if not text or not math.isfinite(float(text))]
        if bad:
            yield f"metrics.csv, step {number}: {bad} not finite"
    for body in result.scene.json["bodies"]:
        for path in result.frames(body):
            if not all(map(math.isfinite, (x for values in numbers_of_frame(path)[1] for x in values))):
                yield f"{path.name}: a number is not finite"
    bad = [path for path in nulls(result.report) if path != ".failed"]
    if result.report["failed"]:
        bad = [path for path in bad if not path.startswith(".solids")]  # the loads after a failed step
    unknown = [".energy.start.constraint", ".energy.start.total"] if result.scene.open_system else []
    bad = [path for path in bad if path not in unknown]
    if bad and result.rows:
        yield f"report.json: {bad[:4]} not finite"


def check_counts(result):
    """Warnings that count what metrics.csv shows."""
    expected = {("retries", ""): sum(result.column("retries"))}
    for body in result.scene.json["bodies"]:
        residuals = result.column(f"residual_{body['name']}")
        expected["unsolved", body["name"]] = sum(value > result.tolerance for value in residuals)
    for key, count in expected.items():
        if result.warnings.get(key, 0) != count:
            yield f"{key}: metrics.csv has {count}, the warning counts {result.warnings.get(key, 0)}"
    compressed = [error > 0.1 for error in result.column("density_error_mean")]
    if sum(compressed[1:]) > result.warnings.get(("compressed", ""), 0):
        yield f"{sum(compressed)} steps with a mean density error above 10 %, fewer warnings"


def check_energy(result):
    """The energy of a closed scene falls. It may rise by 5 % of the energy in motion, and where a step is unsolved."""
    scene = result.scene
    if scene.open_system or ("energy", "") in result.warnings:
        return
    parts = zip(*map(result.column, ["kinetic_J", "potential_J", "constraint_J", "step_residual"]))
    start = result.report["energy"]["start"]
    lowest, largest = start["total"], start["kinetic"] + start["constraint"]
    for number, (kinetic, potential, stored, residual) in enumerate(parts, 1):
        total = kinetic + potential + stored
        largest = max(largest, kinetic + stored + abs(potential - start["potential"]))
        gain = total - lowest
        if residual > result.tolerance:
            lowest = total
        elif gain > 0.05 * largest + scene.mass * (1e-3 * scene.gravity * scene.height + SLOW ** 2 / 2):
            yield f"the energy rises by {gain:.3g} J of {largest:.3g} J in the solved step {number}: no warning"
            return
        lowest = min(lowest, total)


def sheets_and_tanks(result):
    """Name of a surface that holds water, and two functions of a point: it starts inside; it ends outside."""
    scene = result.scene
    if scene.tank:
        low, high = scene.tank
        tiny = 1e-5 * scene.width
        is_outside = lambda x: any(not a - tiny <= c <= b + tiny for a, c, b in zip(low, x, high))
        yield "tank", lambda x: not is_outside(x), is_outside
    if scene.spanning:
        sheet = next(body for body in scene.json["bodies"] if body["name"] == scene.spanning)
        begin, end = ([x[1] for x in result.points(sheet, frame)] for frame in (0, -1))
        level = min(end) - scene.radius
        yield (scene.spanning, lambda x: x[1] > max(begin),
               lambda x: x[1] < level and max(abs(x[0]), abs(x[2])) < scene.width / 2)


def check_leaks(result):
    if result.scene.streams:
        return
    for name, starts_inside, ends_outside in sheets_and_tanks(result):
        count = sum(starts_inside(begin) and ends_outside(end) for body in result.water()
                    for begin, end in zip(result.points(body, 0), result.points(body, -1)))
        told = result.warnings.get(("leak", name), 0)
        if told < 0.8 * count - 1:
            yield f"{count} particles pass {name}, the warning counts {told}"


def check_particles(result):
    if result.scene.streams:
        return
    found = set(result.column("particles"))
    for body in result.water():
        found |= {sum(len(result.points(other, -1)) for other in result.water())}
    if len(found) > 1:
        yield f"the number of particles changes: {sorted(found)}"


CHECKS = [check_finite, check_counts, check_energy, check_leaks, check_particles]

# ---- runs ----------------------------------------------------------------------------------------


def run(scene, directory):
    """Exit code and error text; the code is None where the run does not end."""
    path = directory / "scene.json"
    path.write_text(json.dumps(scene.json, indent=1))
    command = [PROJDYN, "run", path, "-o", directory / "out", "--threads", "1", "--quiet"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return None, ""
    if done.returncode == 2 and "does not fit this scene" in done.stderr:
        scene.wrong_solver()
        return run(scene, directory)
    return done.returncode, done.stderr


def failures_of(scene, directory, code, errors):
    if code is None:
        return [f"the run takes longer than {SECONDS} s"]
    if code not in (0, 1, 2):
        return [f"exit code {code}: {errors[-300:]}"]
    if code == 2:
        named = re.search(r"scene\.json:\d+|contact: .*\"", errors)
        return [] if named else [f"exit code 2 without a place: {errors[-300:]}"]
    found = []
    if code == 1 and not re.search(r"step \d+ of \S+ s at \S+ s: \w", errors):
        found.append(f"exit code 1 without step, time and reason: {errors[-300:]}")
    if not (directory / "out/report.json").exists():
        return found + ["no report.json"]
    result = Result(scene, directory / "out")
    return found + [text for check in CHECKS for text in check(result)]


def codes_of(directory):
    path = directory / "out/report.json"
    return {w["code"] for w in json.loads(path.read_text())["warnings"]} if path.exists() else set()


def main():
    count, bad, slowest = collections.Counter(), 0, (0, 0)
    for k in range(OPTIONS.first, OPTIONS.first + OPTIONS.count):
        with tempfile.TemporaryDirectory() as name:
            directory = pathlib.Path(OPTIONS.keep or name) / f"{OPTIONS.seed}_{k}"
            directory.mkdir(parents=True, exist_ok=True)
            scene = Scene(OPTIONS.seed, k, directory)
            start = time.monotonic()
            code, errors = run(scene, directory)
            slowest = max(slowest, (time.monotonic() - start, k))
            (directory / "errors.txt").write_text(errors)
            for text in failures_of(scene, directory, code, errors):
                bad += 1
                print(f"scene {OPTIONS.seed}/{k}: {text}\n  repeat: random_scenes.py {PROJDYN} 1 {OPTIONS.seed} "
                      f"--first {k} --keep DIR", flush=True)
            count.update({f"exit code {code}"} | codes_of(directory))
    print(f"{OPTIONS.count} scenes, {bad} failures, slowest scene {slowest[1]} in {slowest[0]:.1f} s")
    print(", ".join(f"{key}: {number}" for key, number in sorted(count.items())))
    return bad > 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("projdyn")
    parser.add_argument("count", type=int)
    parser.add_argument("seed", type=int)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--keep")
    OPTIONS = parser.parse_args()
    PROJDYN = OPTIONS.projdyn
    sys.exit(main())
