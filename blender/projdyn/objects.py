"""Objects of a run in the scene, and the frames that they show.

An object keeps the path of its series as a custom property. update_objects() loads the file of
the scene's current frame into its mesh: frame 0 is the start of the run, and one frame of Blender
is one frame of the run. Blender has z up: what has y up, as most scenes, is turned."""
import functools
import os
import pathlib

import bpy
import numpy as np

from .materials import material_of
from .run_directory import frame_interval, is_z_up, nearest, read_run, read_series
from .uv import read_uv
from .vtk_legacy import read_frame

# custom properties of an object
SERIES, INTERVAL, Z_UP = "projdyn_series", "projdyn_interval", "projdyn_z_up"
ATTRIBUTES = {"velocity", "density", "pressure"}  # Blender computes normals from the triangles


def turn(vectors):
    """From y up to z up: (x, y, z) -> (x, -z, y), n x 3."""
    return np.ascontiguousarray(vectors[:, (0, 2, 1)] * np.array((1, -1, 1), np.float32))


@functools.lru_cache(maxsize=64)
def _series(path, _changed):
    return read_series(pathlib.Path(path))


def series_of(path):
    """The frames of a series, read again when its file changes (a run that goes on)."""
    return _series(path, os.path.getmtime(path) if os.path.exists(path) else 0)


# ---- meshes ----------------------------------------------------------------------------------


def same_triangles(mesh, frame):
    """Whether a frame moves the vertices of a mesh and changes nothing else."""
    if (len(mesh.vertices), len(mesh.loops)) != (len(frame.points), frame.triangles.size):
        return False
    corners = np.empty(frame.triangles.size, np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return bool((corners == frame.triangles.ravel()).all())


def rebuild(mesh, frame):
    """Vertices and triangles of a frame, in place of all that the mesh had."""
    count = len(frame.triangles)
    mesh.clear_geometry()
    mesh.vertices.add(len(frame.points))
    mesh.loops.add(3 * count)
    mesh.loops.foreach_set("vertex_index", frame.triangles.ravel())
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    if bpy.app.version < (4, 0, 0):  # later versions take it from loop_start
        mesh.polygons.foreach_set("loop_total", np.full(count, 3, np.int32))


def set_attribute(mesh, name, values):
    """A point attribute: velocity in m/s, or a number."""
    vectors = values.ndim == 2
    kind = "FLOAT_VECTOR" if vectors else "FLOAT"
    attribute = mesh.attributes.get(name) or mesh.attributes.new(name, kind, "POINT")
    attribute.data.foreach_set("vector" if vectors else "value", values.ravel())


def show_frame(mesh, frame):
    """Gives a mesh the geometry and the arrays of a frame."""
    if not same_triangles(mesh, frame):
        rebuild(mesh, frame)
        mesh.polygons.foreach_set("use_smooth", np.ones(len(frame.triangles), bool))
    mesh.vertices.foreach_set("co", frame.points.ravel())
    for name in ATTRIBUTES & frame.arrays.keys():
        set_attribute(mesh, name, frame.arrays[name])
    mesh.update(calc_edges=True)


def read_at(frames, time, z_up):
    """The frame of a series at a time, with z up. z_up: whether its file has z up, too. A moving
    solid has no velocity in its files: differences of the frames before and after give it."""
    k = nearest(frames, time)
    frame = read_frame(frames[k][1])
    before, after = frames[max(k - 1, 0)], frames[min(k + 1, len(frames) - 1)]
    if "velocity" not in frame.arrays and after[0] > before[0]:
        moved = read_frame(after[1]).points - read_frame(before[1]).points
        frame.arrays["velocity"] = moved / np.float32(after[0] - before[0])
    if not z_up:
        frame.points = turn(frame.points)
        if "velocity" in frame.arrays:
            frame.arrays["velocity"] = turn(frame.arrays["velocity"])
    return frame


def update_objects(scene):
    """Loads the current frame of the scene into all objects of runs that move."""
    for item in scene.objects:
        if SERIES in item:
            time = scene.frame_current * item[INTERVAL]
            frame = read_at(series_of(item[SERIES]), time, item.get(Z_UP, False))
            show_frame(item.data, frame)


# ---- particles -------------------------------------------------------------------------------


def sphere_nodes(radius, material):
    """Geometry nodes that show vertices as spheres; attributes stay on the points."""
    group = bpy.data.node_groups.new("projdyn particles", "GeometryNodeTree")
    if hasattr(group, "interface"):  # Blender 4
        for direction in ("INPUT", "OUTPUT"):
            group.interface.new_socket("Geometry", in_out=direction,
                                       socket_type="NodeSocketGeometry")
    else:
        group.inputs.new("NodeSocketGeometry", "Geometry")
        group.outputs.new("NodeSocketGeometry", "Geometry")
    kinds = ("NodeGroupInput", "GeometryNodeMeshToPoints", "GeometryNodeSetMaterial",
             "NodeGroupOutput")
    start, points, paint, end = nodes = [group.nodes.new(kind) for kind in kinds]
    points.inputs["Radius"].default_value = radius
    paint.inputs["Material"].default_value = material
    for left, right in zip(nodes, nodes[1:]):
        group.links.new(left.outputs[0], right.inputs[0])
    return group


# ---- import ----------------------------------------------------------------------------------


def smooth_by_angle(mesh):
    """Smooth shading, with sharp edges where triangles meet at more than 30 degrees."""
    if bpy.app.version < (4, 1, 0):
        mesh.use_auto_smooth, mesh.auto_smooth_angle = True, np.pi / 6
    else:
        mesh.set_sharp_from_angle(angle=np.pi / 6)


def add_part(collection, part, frame, uv, number):
    """One object of a run, with its first frame. uv: of its corners, or None."""
    mesh = bpy.data.meshes.new(part.name)
    item = bpy.data.objects.new(part.name, mesh)
    collection.objects.link(item)
    size = float(np.linalg.norm(np.ptp(frame.points, axis=0))) if len(frame.points) else 1.0
    material = material_of(part.role, number, size, part.color)
    mesh.materials.append(material)
    show_frame(mesh, frame)
    if uv is not None:
        mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", uv.ravel())
    if part.role in ("tank", "obstacle"):
        smooth_by_angle(mesh)
    if part.radius:
        modifier = item.modifiers.new("particles", "NODES")
        modifier.node_group = sphere_nodes(part.radius, material)
    return item


def set_time(scene, interval, frames):
    """One frame of Blender per frame of the run, so that velocities blur by the right length."""
    scene.render.fps = max(1, round(1 / interval))
    scene.render.fps_base = scene.render.fps * interval
    scene.frame_start, scene.frame_end = 0, frames - 1
    scene.render.use_lock_interface = True  # meshes change between frames


def import_run(scene, directory, use_mesh):
    """Adds a collection with the objects of a run. RunError, FileError: nothing is added."""
    directory = pathlib.Path(os.path.abspath(directory))
    parts, z_up = read_run(directory, use_mesh), is_z_up(directory)
    series = [read_series(part.file) for part in parts]
    first = [read_at(frames, 0, z_up) for frames in series]
    uvs = [part.uv and read_uv(part.uv, frame.triangles) for part, frame in zip(parts, first)]
    longest = max(series, key=len)
    interval = frame_interval(longest)
    collection = bpy.data.collections.new(directory.name)
    coloured = 0
    for part, frame, uv in zip(parts, first, uvs):
        item = add_part(collection, part, frame, uv, coloured)
        coloured += part.role in ("cloth", "soft")
        if part.file.suffix == ".series":
            item[SERIES], item[INTERVAL], item[Z_UP] = str(part.file), interval, z_up
    scene.collection.children.link(collection)
    set_time(scene, interval, len(longest))
    scene.frame_set(0)
    return collection
