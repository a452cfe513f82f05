# SPDX-License-Identifier: MIT
"""What happens on File > Export > glTF baked with hemibake? The scene is exported to a temporary file, and that is baked, with a
progress bar; Esc cancels. In background mode the operator returns when it is done."""

import os
import shutil
import tempfile

import bpy
from bpy_extras.io_utils import ExportHelper

from . import cages, export, preferences
from .program import Run
from .settings import arguments


class ExportHemibake(bpy.types.Operator, ExportHelper):
    """Export glTF with global illumination in its vertex colours"""

    bl_idname = "export_scene.hemibake"
    bl_label = "Export Baked glTF"
    bl_options = {"PRESET"}

    filename_ext = ".glb"
    filter_glob: bpy.props.StringProperty(default="*.glb;*.gltf", options={"HIDDEN"})

    _timer = None

    def draw(self, context):
        context.scene.hemibake.draw(self.layout)
        self.layout.prop(context.scene.hemibake, "selection")

    def execute(self, context):
        fault = self.start(context)
        if fault:
            self.report({"ERROR"}, fault)
            return {"CANCELLED"}
        if bpy.app.background:
            self.run.wait()
            return self.finish(context)
        self._timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def start(self, context):
        """Exports, and begins to bake; what is wrong, or None."""
        program = preferences.find_program(context)
        if not program:
            return "hemibake is not found: install it, or say where it is in the preferences of the add-on"
        self.folder = tempfile.mkdtemp(prefix="hemibake-")
        source = os.path.join(self.folder, os.path.splitext(os.path.basename(self.filepath))[0] + ".glb")
        settings = context.scene.hemibake
        try:
            options = export.export_scene(context, source, settings)
            self.run = Run(program, source, self.filepath, arguments(settings, self.filepath) + options)
        except BaseException as e:
            shutil.rmtree(self.folder)
            if isinstance(e, (cages.CageError, RuntimeError, OSError)):
                return str(e)
            raise
        return None

    def modal(self, context, event):
        if event.type == "ESC":
            self.run.cancel()
            self.clean_up(context)
            self.report({"WARNING"}, "Cancelled; nothing is written")
            return {"CANCELLED"}
        if event.type == "TIMER":
            context.window_manager.progress_update(100 * self.run.fraction)
            context.workspace.status_text_set(f"hemibake: {100 * self.run.fraction:.0f} % {self.run.stage}    Esc: Cancel")
            if self.run.is_over():
                return self.finish(context)
        return {"PASS_THROUGH"}

    def finish(self, context):
        self.clean_up(context)
        fault = self.run.fault()
        if fault:
            self.report({"ERROR"}, fault)
            return {"CANCELLED"}
        for message in self.run.messages:
            self.report({"WARNING"}, message)
        if self.run.stopped_early():
            self.report({"WARNING"}, "Stopped before it converged")
        self.report({"INFO"}, f"Baked {self.filepath}")
        return {"FINISHED"}

    def clean_up(self, context):
        if self._timer:
            context.window_manager.event_timer_remove(self._timer)
            context.window_manager.progress_end()
            context.workspace.status_text_set(None)
        shutil.rmtree(self.folder, ignore_errors=True)


def draw_menu(self, context):
    self.layout.operator(ExportHemibake.bl_idname, text="glTF baked with hemibake (.glb/.gltf)")


CLASSES = (ExportHemibake,)
