# SPDX-License-Identifier: MIT
"""Where is the program? Where the preferences say, else on PATH."""

import os
import shutil

import bpy


class HemibakePreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: bpy.props.StringProperty(
        name="Program",
        description="The hemibake program; empty: the first on PATH",
        subtype="FILE_PATH",
    )

    def draw(self, context):
        self.layout.prop(self, "program")
        found = find_program(context)
        self.layout.label(text=f"Found: {found}" if found else "hemibake is not on PATH")


def find_program(context):
    """Its path, or None."""
    addon = context.preferences.addons.get(__package__)
    named = addon.preferences.program if addon else ""
    if named:
        path = bpy.path.abspath(named)
        return path if os.access(path, os.X_OK) and os.path.isfile(path) else None
    return shutil.which("hemibake")
