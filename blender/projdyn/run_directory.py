"""The contents of a run directory: what `projdyn run` and `projdyn mesh` wrote.

    report.json          bodies, their constraints, solids, the axis that is up
    BODY.vtk.series      names and times of the frames of a body
    BODY.obj             texture coordinates of a surface
    mesh/BODY.vtk.series surface of a fluid or skin of a body, if `projdyn mesh` was run
    solids/...           meshes of solids, as report.json lists them

Blender (objects.py) and ParaView (scripts/paraview_run.py) open a run by it."""
import json
import pathlib
from dataclasses import dataclass


class RunError(Exception):
    """A directory that is no complete run; the text names the file and what was expected."""


@dataclass
class Part:
    """One thing to show."""
    name: str
    role: str  # "water", "particles" (of water), "grains", "cloth", "soft", "tank" or "obstacle"
    file: pathlib.Path  # NAME.vtk.series, or the one NAME.vtk of a solid at rest
    radius: float = 0  # m, of particles; 0: the files hold triangles
    uv: pathlib.Path | None = None  # NAME.obj, which may have texture coordinates of a surface
    color: tuple | None = None  # sRGB, 0 to 1, of the scene


def read_json(path):
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        text = f"{path}: {error.strerror}; expected a directory of `projdyn run`"
        raise RunError(text) from error
    except ValueError as error:
        raise RunError(f"{path}: expected JSON: {error}") from error


def read_series(path):
    """[(time in s, file)] of a series, ascending; one frame at 0 s for a single file."""
    if path.suffix != ".series":
        return [(0.0, path)]
    frames = [(f["time"], path.parent / f["name"]) for f in read_json(path)["files"]]
    if not frames:
        raise RunError(f"{path}: expected at least one frame")
    return frames


def nearest(frames, time):
    """Index of the frame whose time is nearest to `time`."""
    return min(range(len(frames)), key=lambda k: abs(frames[k][0] - time))


def frame_interval(frames):
    """s between two frames; 1/30 for a single one."""
    return (frames[-1][0] - frames[0][0]) / (len(frames) - 1) if len(frames) > 1 else 1 / 30


def color_of(entry):
    """The "color" of a body or a solid, "#rrggbb", as three numbers; None without one."""
    text = entry.get("color")
    return tuple(int(text[k:k + 2], 16) / 255 for k in (1, 3, 5)) if text else None


def bodies(directory, report, use_mesh):
    constraints = {(c["body"], c["type"]) for c in report["parameters"]}
    for body in report["bodies"]:
        color = color_of(body)
        name, file = body["name"], directory / f"{body['name']}.vtk.series"
        mesh, fluid = directory / "mesh" / f"{name}.vtk.series", (name, "fluid") in constraints
        meshed = use_mesh and mesh.exists()
        if body["kind"] == "surface":
            role = "soft" if (name, "tet") in constraints else "cloth"
            uv = None if meshed else directory / f"{name}.obj"
            yield Part(name, role, mesh if meshed else file, uv=uv, color=color)
        elif meshed:
            yield Part(name, "water", mesh, color=color)
        else:
            yield Part(name, "particles" if fluid else "grains", file, body["radius_m"], color=color)


def is_z_up(directory):
    """Whether z is up in the scene of a run; else y is."""
    return read_json(pathlib.Path(directory) / "report.json").get("up") == "z"


def read_run(directory, use_mesh=True):
    """The parts of a run: bodies, then solids. use_mesh: the surface of a fluid, where there is
    one, in place of its particles, and the skin of a body in place of its tetrahedra."""
    directory = pathlib.Path(directory)
    report = read_json(directory / "report.json")
    parts = list(bodies(directory, report, use_mesh))
    for solid in report["solids"]:
        role = "tank" if solid["kind"] == "box" else "obstacle"
        parts.append(Part(solid["name"], role, directory / solid["file"], color=color_of(solid)))
    return parts
