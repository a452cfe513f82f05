# SPDX-License-Identifier: MIT
"""What may be chosen for a bake? The properties of the panel, and the program's options that they stand for."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty

from .options import OPTIONS

UNSET = "default"


def about(option, unset=""):
    """What the program's own help says of it."""
    text = OPTIONS[option]["help"]
    return text[0].upper() + text[1:] + unset


def words(option):
    """Those of an option, after one for what the program does without it."""
    return [(word, word.capitalize(), "") for word in (UNSET, *OPTIONS[option]["words"])]


def number(name, option, **more):
    """0 stands for what the program does without the option."""
    return FloatProperty(name=name, description=about(option, "; 0: not given"), default=0.0, min=0.0, soft_max=OPTIONS[option]["high"], **more)


class HemibakeSettings(bpy.types.PropertyGroup):
    bake_on_export: BoolProperty(
        name="Bake with hemibake", description="Bake what the glTF exporter of Blender 4.4 and newer writes", default=False
    )
    quality: EnumProperty(name="Quality", description=about("quality"), items=words("quality"), default=UNSET)
    error: number("Error", "error", precision=4)
    time: number("Time Limit", "time", unit="TIME_ABSOLUTE")
    element_size: number("Element Size", "element_size", unit="LENGTH")
    exposure_auto: BoolProperty(name="Auto Exposure", description="Lit surfaces average to middle grey", default=True)
    exposure: FloatProperty(
        name="Exposure", description=about("exposure"), default=0.0, min=OPTIONS["exposure"]["low"], max=OPTIONS["exposure"]["high"]
    )
    scene_linear: BoolProperty(name="Scene Linear", description=about("scene_linear"), default=False)
    display: StringProperty(name="Display", description=about("display", "; empty: its default"))
    view: StringProperty(name="View", description=about("view", "; empty: its default"))
    draco: BoolProperty(name="Draco", description="Compress the geometry", default=True)
    report: BoolProperty(name="Report", description="Write NAME.json beside the asset", default=False)
    preview: BoolProperty(name="Preview", description="Write NAME.png beside the asset", default=False)
    threads: IntProperty(name="Threads", description="0: all cores", default=0, min=0, max=int(OPTIONS["threads"]["high"]))
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
    out = ["--quality", settings.quality] if settings.quality != UNSET else []
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
