"""python3 -m projdyn.splishsplash SCENE: a scene of SPlisHSPlasH as one of projdyn.

Converts fluid blocks, fluid models, emitters, walls, static and dynamic rigid bodies. Blocks have
the particles of SPlisHSPlasH in dense mode 0, a cubic lattice: their first centre is a diameter
from the start. What has no equal here is named in a list of notes: viscosity and surface tension,
whose quantities differ, elasticity, joints, other dense modes, particles in .bgeo files. Parameters
of the solvers and of pictures are left out without a note.
"""
import argparse
import json
import math
import os
import sys
from typing import Any

IDENTITY = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
STOP = 4.0  # s, of a scene without "stopAt"
CONVERTED = {"Configuration", "Materials", "FluidBlocks", "FluidModels", "Emitters", "RigidBodies"}
BOXES: dict[str, list[str]] = {"UnitBox.obj": [], "UnitBoxOpened.obj": ["+y"]}  # and open sides
SOLVER = {"Simulation"}  # parameters alone
MATERIAL = {  # key of a model of SPlisHSPlasH, and what to do instead
    "viscosity": "viscosity is left out; the constraint \"viscosity\" (Pa s) adds it",
    "surfaceTension": "surface tension is left out; the constraint \"surface_tension\" (N/m) adds it",
    "elasticity": "elasticity is left out, and the body is a liquid; a \"volume\" with \"tet\" is elastic",
    "vorticity": "the vorticity model is left out",
    "drag": "the drag of the air is left out"}


def rotation(entry: dict[str, Any]) -> list[list[float]]:
    """The matrix of "rotationAxis" and "rotationAngle", rad (Rodrigues)."""
    axis, angle = entry.get("rotationAxis", [0, 0, 0]), entry.get("rotationAngle", 0.0)
    length = math.hypot(*axis)
    if not length or not angle:
        return IDENTITY
    x, y, z = (a / length for a in axis)
    c, s = math.cos(angle), math.sin(angle)
    return [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)]]


def euler(matrix: list[list[float]]) -> list[float]:
    """Angles, degrees, about x, then y, then z, that give the same rotation."""
    y = math.asin(max(-1.0, min(1.0, -matrix[2][0])))
    if abs(matrix[2][0]) > 1.0 - 1e-12:  # x and z turn about one axis: all of it is x
        x, z = math.atan2(-matrix[1][2], matrix[1][1]), 0.0
    else:
        x, z = math.atan2(matrix[2][1], matrix[2][2]), math.atan2(matrix[1][0], matrix[0][0])
    return [round(math.degrees(a), 9) + 0.0 for a in (x, y, z)]


class Converter:
    """One scene: data is its JSON, folder that of its file; models: a folder of meshes, or None."""

    def __init__(self, data: dict[str, Any], folder: str, models: Any = None) -> None:
        self.data, self.folder, self.models = data, folder, models
        if not CONVERTED & set(data):
            raise ValueError("expected a scene of SPlisHSPlasH, found none of its keys: " +
                             ", ".join(sorted(CONVERTED)))
        self.settings = data.get("Configuration", {})
        self.radius = self.settings.get("particleRadius", 0.025)
        self.notes: list[str] = []

    def path(self, name: str) -> str:
        """The absolute path of a file that the scene names."""
        places = [os.path.join(self.folder, name)]
        if self.models:
            places.append(os.path.join(self.models, os.path.basename(name)))
        for place in places:
            if os.path.exists(place):
                return os.path.abspath(place)
        self.notes.append(f"{name}: no such file; --models names the folder that has it")
        return name

    def placed(self, entry: dict[str, Any]) -> dict[str, Any]:
        """scale, rotate and translate of an entry."""
        scale = entry.get("scale", [1, 1, 1])
        return {"scale": scale, "rotate": euler(rotation(entry)),
                "translate": entry.get("translation", [0, 0, 0])}

    def block(self, entry: dict[str, Any]) -> dict[str, Any]:
        """A fluid block: n = round(edge / 2r) - 1 particles along each edge."""
        scale, shift = entry.get("scale", [1, 1, 1]), entry.get("translation", [0, 0, 0])
        low = [a * b + c for a, b, c in zip(entry["start"], scale, shift)]
        high = [a * b + c for a, b, c in zip(entry["end"], scale, shift)]
        size = 2.0 * self.radius
        if entry.get("denseMode", 0):
            self.notes.append("a fluid block with a denseMode: its particles are a cubic lattice")
        least = [a + self.radius for a in low]
        most = [a + size * (round((b - c) / size) - 1) for a, b, c in zip(least, high, low)]
        return self.moving(entry, {"box": {"minimum": [round(a, 9) for a in least],
                                           "maximum": [round(a, 9) for a in most]}})

    def model(self, entry: dict[str, Any]) -> dict[str, Any]:
        """A fluid model: particles of a file, or the inside of a mesh."""
        name = entry["particleFile"]
        if name.endswith(".bgeo"):
            self.notes.append(f"{name}: .bgeo cannot be read; convert it to .ply or .vtk")
        kind = "mesh" if name.endswith(".obj") else "file"
        return self.moving(entry, {kind: self.path(name), **self.placed(entry)})

    def moving(self, entry: dict[str, Any], fill: dict[str, Any]) -> dict[str, Any]:
        """The fill with the initial velocity of its entry."""
        if any(entry.get("initialAngularVelocity", [0])):
            self.notes.append("initialAngularVelocity of a fluid is left out")
        velocity = entry.get("initialVelocity", [0, 0, 0])
        return {**fill, "velocity": velocity} if any(velocity) else fill

    def emitter(self, entry: dict[str, Any]) -> dict[str, Any]:
        """An emitter: it emits along its first axis; width and height count particles.

        Older scenes have a "direction" instead of a rotation, and a velocity of three numbers."""
        turn, size = rotation(entry), 2.0 * self.radius
        velocity = entry.get("velocity", 1)
        width, height = entry.get("width", 5), entry.get("height", 5)
        centre = entry.get("translation", [0, 0, 0])
        inlet = {"direction": [row[0] for row in turn], "up": [row[1] for row in turn],
                 "speed": velocity, "start": entry.get("emitStartTime", 0)}
        if isinstance(velocity, list):
            inlet.update(direction=velocity, speed=math.hypot(*velocity))
            del inlet["up"]
        if entry.get("type", 0):
            inlet["disc"] = {"center": centre, "radius": width * self.radius}
        else:
            inlet["rectangle"] = {"center": centre, "size": [width * size, height * size]}
        if "emitEndTime" in entry:
            inlet["duration"] = entry["emitEndTime"] - inlet["start"]
        return inlet

    def fluids(self) -> list[dict[str, Any]]:
        """A body for each id of the fluids."""
        parts: dict[str, dict[str, list[Any]]] = {}
        for key, read, to in (("FluidBlocks", self.block, "fill"),
                              ("FluidModels", self.model, "fill"),
                              ("Emitters", self.emitter, "inlets")):
            for entry in self.data.get(key, []):
                of_id = parts.setdefault(entry.get("id", "Fluid"), {})
                of_id.setdefault(to, []).append(read(entry))
        materials = {entry.get("id", "Fluid"): entry for entry in self.data.get("Materials", [])}
        bodies = []
        for name, shapes in parts.items():
            material = {**self.settings, **materials.get(name, {})}  # older scenes have no materials
            particles = {"radius": self.radius, "rest_density": material.get("density0", 1000), **shapes}
            if "inlets" in shapes and "maxEmitterParticles" in material:
                particles["budget"] = material["maxEmitterParticles"]
            bodies.append({"name": name, "particles": particles, "constraints": [{"type": "fluid"}]})
            for key, text in MATERIAL.items():
                if material.get(f"{key}Method", material.get(key)):
                    self.notes.append(f"{name}: {text}")
        return bodies

    def outlets(self) -> list[dict[str, Any]]:
        """Boxes of emitters outside of which particles are used again: there they leave the scene."""
        return [{"box": {"minimum": entry["emitterBoxMin"], "maximum": entry["emitterBoxMax"]},
                 "outside": True}
                for entry in [self.settings, *self.data.get("Materials", [])]
                if self.data.get("Emitters") and entry.get("emitterReuseParticles")]

    def rigid(self, entry: dict[str, Any], number: int, scene: dict[str, Any]) -> None:
        """Adds a rigid body: a tank, a solid, or a dynamic body."""
        name, place = os.path.basename(entry["geometryFile"]), self.placed(entry)
        if entry.get("isAnimated"):
            self.notes.append(f"{name}: the motion that a script gives is left out")
        if not entry.get("isDynamic") and name in BOXES and rotation(entry) == IDENTITY:
            half, at = [0.5 * a for a in place["scale"]], place["translate"]
            kind = "tank" if entry.get("isWall") else "box"
            scene["solids"].append({"name": f"{kind}{number}", "open": BOXES[name], "box": {
                "minimum": [round(a - b, 9) for a, b in zip(at, half)],
                "maximum": [round(a + b, 9) for a, b in zip(at, half)]}})
            return
        shape = {"mesh": self.path(entry["geometryFile"]), **place}
        if not entry.get("isDynamic"):
            scene["solids"].append({"name": f"solid{number}", **shape})
            return
        scene["bodies"].append({
            "name": f"rigid{number}", "velocity": entry.get("velocity", [0, 0, 0]),
            "rigid": {**shape, "cell": 2.0 * self.radius, "density": entry.get("density", 1000),
                      "angular_velocity": entry.get("angularVelocity", [0, 0, 0])}})
        scene.setdefault("contact", {"thickness": 0.5 * self.radius,
                                     "friction": entry.get("friction", 0.2)})

    def convert(self) -> dict[str, Any]:
        """The scene as a dictionary."""
        settings = self.settings
        step = {"maximum": settings.get("cflMaxTimeStepSize", 0.005)}
        if settings.get("cflMethod", 1) == 0:
            step = {"fixed": settings.get("timeStepSize", 0.001)}
        scene = {"duration": settings.get("stopAt", STOP),
                 "frame_interval": round(1.0 / settings.get("dataExportFPS", 25), 9),
                 "gravity": settings.get("gravitation", [0, -9.81, 0]), "time_step": step,
                 "bodies": self.fluids(), "solids": [], "outlets": self.outlets()}
        self.notes += [f"{key}: left out" for key in self.data if key not in CONVERTED | SOLVER]
        if settings.get("sim2D"):
            self.notes.append("a scene of two dimensions: its blocks are filled in three")
        if "stopAt" not in settings:
            self.notes.append(f"the scene has no \"stopAt\": it lasts {STOP:g} s")
        for number, entry in enumerate(self.data.get("RigidBodies", [])):
            self.rigid(entry, number, scene)
        return scene


def main(arguments: list[str]) -> int:
    """Converts the file that the arguments name; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python3 -m projdyn.splishsplash",
                                     description="Converts a scene of SPlisHSPlasH.")
    parser.add_argument("scene", help="the JSON file of SPlisHSPlasH")
    parser.add_argument("-o", "--output", help="the scene file to write; default: standard output")
    parser.add_argument("--models", help="a folder of meshes that are not where the scene says")
    options = parser.parse_args(arguments)
    try:
        with open(options.scene, encoding="utf-8") as file:
            converter = Converter(json.load(file), os.path.dirname(options.scene), options.models)
        text = json.dumps(converter.convert(), indent=2) + "\n"
    except OSError as error:
        print(f"{options.scene}: {error.strerror}", file=sys.stderr)
        return 2
    except (ValueError, KeyError, TypeError, AttributeError, ArithmeticError) as error:
        print(f"{options.scene}: {type(error).__name__}: {error}", file=sys.stderr)
        return 2
    for note in dict.fromkeys(converter.notes):
        print(f"{options.scene}: {note}", file=sys.stderr)
    if not options.output:
        sys.stdout.write(text)
        return 0
    with open(options.output, "w", encoding="utf-8") as file:
        file.write(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
