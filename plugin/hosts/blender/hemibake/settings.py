# SPDX-License-Identifier: MIT
"""What may be chosen for a bake? The properties of the panel, and the program's options that they stand for."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

QUALITIES = [(word, word.capitalize(), "") for word in ("draft", "medium", "high", "reference")]


class HemibakeSettings(bpy.types.PropertyGroup):
    bake_on_export: BoolProperty(
        name="Bake with hemibake", description="Bake what the glTF exporter of Blender 4.4 and newer writes", default=False
    )
    quality: EnumProperty(name="Quality", description="Preset of sizes and targets", items=QUALITIES, default="medium")
    error: FloatProperty(
        name="Error", description="Stop when the estimated relative error is below this; 0: as the quality says",
        default=0.0, min=0.0, max=1.0, precision=4,
    )
    time: FloatProperty(name="Time Limit", description="Seconds; 0: none", default=0.0, min=0.0, unit="TIME_ABSOLUTE")
    element_size: FloatProperty(
        name="Element Size", description="Edge of an element; 0: as the quality says", default=0.0, min=0.0, unit="LENGTH"
    )
    exposure_auto: BoolProperty(name="Auto Exposure", description="Lit surfaces average to middle grey", default=True)
    exposure: FloatProperty(name="Exposure", description="Stops to brighten by", default=0.0, min=-64.0, max=64.0)
    scene_linear: BoolProperty(
        name="Scene Linear", description="No view transform: radiance as float in _RADIOSITY", default=False
    )
    display: StringProperty(name="Display", description="Of the OpenColorIO configuration; empty: its default")
    view: StringProperty(name="View", description="View transform of the display; empty: its default")
    draco: BoolProperty(name="Draco", description="Compress the geometry", default=True)
    report: BoolProperty(name="Report", description="Write NAME.json beside the asset", default=False)
    preview: BoolProperty(name="Preview", description="Write NAME.png beside the asset", default=False)
    threads: IntProperty(name="Threads", description="0: all cores", default=0, min=0, max=256)
    subdivision_cage: BoolProperty(
        name="Subdivision as Cage",
        description="Hand over the cages of Subdivision Surface modifiers, and bake their limit surface; every mesh needs one, "
        "of the same level. Off: Blender applies the modifiers",
        default=False,
    )
    selection: BoolProperty(name="Selected Objects", description="Export the selection only", default=False)

    def draw(self, layout):
        layout.use_property_split = True
        for name in ("quality", "error", "time", "element_size", "exposure_auto"):
            layout.prop(self, name)
        row = layout.row()
        row.enabled = not self.exposure_auto
        row.prop(self, "exposure")
        for name in ("display", "view", "scene_linear", "draco", "report", "preview", "subdivision_cage", "threads"):
            layout.prop(self, name)


def arguments(settings, output):
    """Options of 'hemibake bake' for an output."""
    stem = output.rsplit(".", 1)[0]
    out = ["--quality", settings.quality]
    out += ["--exposure=" + ("auto" if settings.exposure_auto else repr(settings.exposure))]
    for name in ("error", "time", "element_size", "threads", "display", "view"):
        value = getattr(settings, name)
        if value:
            out.append(f"--{name.replace('_', '-')}={value}")
    for wanted, flag in ((settings.scene_linear, "--scene-linear"), (not settings.draco, "--no-draco")):
        out += [flag] if wanted else []
    for wanted, flag, end in ((settings.report, "--report", "json"), (settings.preview, "--preview", "png")):
        out += [f"{flag}={stem}.{end}"] if wanted else []
    return out
