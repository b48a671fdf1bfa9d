"""Renders one frame of a run, with camera, sky and ground of its own:

    blender --background --python blender/render.py -- DIR -o picture.png [OPTIONS]"""
import argparse
import pathlib
import sys

import bpy
import numpy as np
from mathutils import Vector

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import projdyn  # noqa: E402
from projdyn.objects import SERIES, import_run  # noqa: E402

VIEW = Vector((0.55, -1.0, 0.5)).normalized()  # from the scene to the camera


def arguments():
    parser = argparse.ArgumentParser(prog="blender --background --python blender/render.py --")
    parser.add_argument("directory")
    parser.add_argument("-o", "--output", default="render.png")
    parser.add_argument("--frame", type=int, default=None, help="default: the last")
    parser.add_argument("--size", default="960x600")
    parser.add_argument("--samples", type=int, default=128)
    parser.add_argument("--zoom", type=float, default=1.0)
    rest = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    return parser.parse_args(rest)


def corners(objects):
    """Lowest and highest corner of the vertices of objects, m."""
    points = [np.array([v.co for v in item.data.vertices]) for item in objects]
    points = np.concatenate([p for p in points if len(p)])
    return points.min(axis=0), points.max(axis=0)


def add_camera(scene, low, high, zoom):
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera, camera.data.lens = camera, 60
    camera.data.clip_start, radius = 1e-3, float(np.linalg.norm(high - low)) / 2
    middle = Vector((low + high) / 2)
    camera.location = middle + VIEW * (radius / np.tan(camera.data.angle_y / 2) / zoom)
    camera.rotation_euler = VIEW.to_track_quat("Z", "Y").to_euler()
    camera.data.clip_end = 100 * radius


def add_ground(scene, height, size):
    mesh = bpy.data.meshes.new("ground")
    corners_of = [(x * size, y * size, height) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    mesh.from_pydata(corners_of, [], [(0, 1, 2, 3)])
    mesh.materials.append(projdyn.objects.material_of("ground"))
    scene.collection.objects.link(bpy.data.objects.new("ground", mesh))


def add_light(scene):
    """A sun from the left and behind the camera, and a pale sky."""
    sky = bpy.data.worlds.new("sky")
    sky.use_nodes, scene.world = True, sky
    sky.node_tree.nodes["Background"].inputs[0].default_value = (0.55, 0.72, 0.95, 1)
    sky.node_tree.nodes["Background"].inputs[1].default_value = 0.9
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    scene.collection.objects.link(sun)
    sun.data.energy, sun.data.angle = 4.5, np.radians(3)
    sun.rotation_euler = (np.radians(38), np.radians(-20), np.radians(-25))


def set_up_cycles(scene, options):
    scene.render.engine = "CYCLES"
    scene.cycles.samples = options.samples
    scene.cycles.use_denoising = False  # Debian's Blender has no denoiser
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = False
    scene.cycles.max_bounces = 16
    scene.cycles.transmission_bounces = 16
    scene.render.use_motion_blur = True
    scene.view_settings.look = "Medium High Contrast"
    width, height = options.size.split("x")
    scene.render.resolution_x, scene.render.resolution_y = int(width), int(height)
    scene.render.resolution_percentage = 100


def main():
    options = arguments()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    projdyn.register()
    scene = bpy.context.scene
    run = import_run(scene, options.directory, use_mesh=True)
    scene.frame_set(scene.frame_end if options.frame is None else options.frame)
    moving = [item for item in run.objects if SERIES in item]
    low, high = corners(moving)
    everything = corners(run.objects)
    add_camera(scene, low, high, options.zoom)
    add_ground(scene, everything[0][2] - 1e-3, 100 * float(np.linalg.norm(high - low)))
    add_light(scene)
    set_up_cycles(scene, options)
    scene.render.filepath = str(pathlib.Path(options.output).resolve())
    bpy.ops.render.render(write_still=True)


main()
