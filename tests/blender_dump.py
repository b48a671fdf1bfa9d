"""Imports a run in Blender, by the operator of the menu, and writes what the scene then holds; run
by test_blender.py:

    blender --background --factory-startup --python blender_dump.py -- ADDON RUN OUT FRAME...

OUT.json: one entry per object. OUT.npz: NAME.FRAME.points, .triangles, .ATTRIBUTE; and
opacity.sharp, opacity.blur of the object "ball" in the last frame."""
import json
import sys

import bpy
import numpy as np

ADDON, RUN, OUT, *FRAMES = sys.argv[sys.argv.index("--") + 1:]
sys.path.insert(0, ADDON)
import projdyn  # noqa: E402


def dump(name, mesh):
    points = np.empty((len(mesh.vertices), 3), np.float32)
    mesh.vertices.foreach_get("co", points.ravel())
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    arrays = {f"{name}.points": points, f"{name}.triangles": corners.reshape(-1, 3)}
    for key in ("velocity", "density", "pressure"):
        if key in mesh.attributes:
            data, vectors = mesh.attributes[key].data, key == "velocity"
            values = np.empty((len(data), 3 if vectors else 1), np.float32)
            data.foreach_get("vector" if vectors else "value", values.ravel())
            arrays[f"{name}.{key}"] = values
    if mesh.uv_layers:
        arrays[f"{name}.uv"] = np.empty((len(mesh.loops), 2), np.float32)
        mesh.uv_layers[0].data.foreach_get("uv", arrays[f"{name}.uv"].ravel())
    return arrays


def describe(item):
    mesh = item.data
    return {"material": mesh.materials[0].name, "color": list(mesh.materials[0].diffuse_color)[:3],
            "modifiers": [m.type for m in item.modifiers],
            "smooth": all(p.use_smooth for p in mesh.polygons)}


def silhouettes(scene, name):
    """Opacity of the pixels of an object seen from the front, without and with motion blur."""
    for item in scene.objects:
        item.hide_render = item.name != name
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    middle = np.mean([vertex.co for vertex in scene.objects[name].data.vertices], axis=0)
    scene.camera, camera.location = camera, middle - (0, 1, 0)
    camera.rotation_euler, camera.data.type = (np.pi / 2, 0, 0), "ORTHO"
    camera.data.ortho_scale = 0.4
    scene.render.engine, scene.cycles.samples = "CYCLES", 16
    scene.cycles.use_denoising, scene.render.film_transparent = False, True
    scene.render.resolution_x, scene.render.resolution_y = 80, 60
    scene.render.resolution_percentage, scene.render.motion_blur_shutter = 100, 2.0
    for kind in ("sharp", "blur"):
        scene.render.use_motion_blur = kind == "blur"
        scene.render.filepath = f"{OUT}_{kind}.png"
        bpy.ops.render.render(write_still=True)
        picture = bpy.data.images.load(scene.render.filepath)
        yield f"opacity.{kind}", np.array(picture.pixels).reshape(60, 80, 4)[:, :, 3]


def main():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    projdyn.register()
    assert bpy.ops.import_scene.projdyn(filepath=f"{RUN}/report.json") == {"FINISHED"}
    scene, arrays = bpy.context.scene, {}
    for frame in map(int, FRAMES):
        scene.frame_set(frame)
        for item in scene.objects:
            arrays |= dump(f"{item.name}.{frame}", item.data)
    told = {"fps": scene.render.fps / scene.render.fps_base, "start": scene.frame_start,
            "end": scene.frame_end, "objects": {i.name: describe(i) for i in scene.objects}}
    with open(f"{OUT}.json", "w", encoding="utf-8") as file:
        json.dump(told, file)
    np.savez(OUT, **arrays, **dict(silhouettes(scene, "ball")))


main()
