"""Blender add-on: File > Import > projdyn run. docs/guide/blender.md explains it."""
import bpy
from bpy.app.handlers import persistent
from bpy_extras.io_utils import ImportHelper

from .objects import import_run, update_objects
from .run_directory import RunError
from .vtk_legacy import FileError

bl_info = {
    "name": "projdyn run",
    "description": "Imports fluids, cloth and solids of a projdyn run, frame by frame",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "File > Import > projdyn run",
    "category": "Import-Export",
}


class ImportProjdynRun(bpy.types.Operator, ImportHelper):
    """Import the bodies and solids of a run"""
    bl_idname = "import_scene.projdyn"
    bl_label = "Import projdyn run"
    bl_options = {"UNDO"}

    filter_glob: bpy.props.StringProperty(default="report.json", options={"HIDDEN"})
    use_mesh: bpy.props.BoolProperty(
        name="Water as a surface", default=True,
        description="Shows the meshes of `projdyn mesh` where there are some, else particles")

    def execute(self, context):
        try:
            directory = bpy.path.abspath(self.filepath).removesuffix("report.json")
            import_run(context.scene, directory, self.use_mesh)
        except (RunError, FileError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


@persistent
def on_frame(scene, _depsgraph=None):
    update_objects(scene)


def menu(self, _context):
    self.layout.operator(ImportProjdynRun.bl_idname, text="projdyn run (report.json)")


def register():
    bpy.utils.register_class(ImportProjdynRun)
    bpy.types.TOPBAR_MT_file_import.append(menu)
    bpy.app.handlers.frame_change_pre.append(on_frame)


def unregister():
    bpy.app.handlers.frame_change_pre.remove(on_frame)
    bpy.types.TOPBAR_MT_file_import.remove(menu)
    bpy.utils.unregister_class(ImportProjdynRun)
