# SPDX-License-Identifier: MIT
"""Which options does hemibake.bake take? Made by plugin/hosts/options_table.py; not edited by hand."""

from __future__ import annotations

from os import PathLike
from typing import Literal, TypedDict


class BakeOptions(TypedDict, total=False):
    """Every option of 'hemibake bake', with _ for -."""

    quality: Literal["draft", "medium", "high", "reference"]
    """preset of sizes and targets below (default medium; with --error: as fine as meets it)"""

    method: Literal["hybrid", "analytic", "pr", "fm", "rows", "auto"]
    """how radiosity is solved (default auto: rows, by rays, under a sky, where a sun shines beside lamps and for many small faces, else hybrid; the report says which); the others are the paper's, to compare with"""

    visibility: Literal["osmesa", "egl", "rays", "auto"]
    """what draws the item buffers of columns: OpenGL by OSMesa or EGL, or Embree's rays (default auto: what is there and predicted to be fastest; the report says which)"""

    normals: Literal["file", "faces"]
    """by which normals light is received: the file's, so that what is smooth looks smooth (default), or those of its facets"""

    error: float
    """stop when the estimated relative error is below E (e.g. 0.01)"""

    time: float
    """stop after T seconds with the best answer so far (exit status 4); where neither quality nor sizes are given, elements are as small as T allows"""

    unshot: float
    """stop when this fraction of the emitted power is unshot"""

    element_size: float
    """target edge of an element, metres (default: from quality and scene)"""

    patch_size: float
    """target edge of a patch, metres"""

    max_elements: int
    """refine to no more elements than this, and refuse to start with more (default 4000000)"""

    refine_levels: int
    """quarter elements up to N times where light is not linear (default: by quality; never with --element-size)"""

    refine_error: float
    """refine until the size of elements costs less than this relative error (default: by quality)"""

    uniform: bool
    """elements of one size: do not refine"""

    merge_error: float
    """merge triangles where that changes no colour by more than this share of it (default: by quality; 0, or with --flat or kept instances: never)"""

    stand_in: float
    """a mesh that is too dense is solved on a simpler one, off by so many elements at most (default 0.035, by rows 0.02; 0: never)"""

    cluster_angle: float
    """small patches shoot as one with those beside them whose normals differ by less (default 20; 0: never)"""

    hemicube: int
    """hemi-cube resolution, pixels across"""

    hemicube_light: int
    """the same on emitters"""

    light_tolerance: float
    """share of an emitter's power in penumbra that quarters it further (default 0.005)"""

    subdivide: int | Literal["auto"]
    """take every mesh as the cage of a subdivision surface, refined LEVEL times, unless its extras say how; 0: none; auto: what USD says are cages, as elements are small"""

    subdivide_scheme: Literal["catmull-clark", "loop", "bilinear"]
    """which surface (default catmull-clark)"""

    subdivide_adaptive: bool
    """refine where the surface curves, at most LEVEL times"""

    threads: int
    """worker threads (default: all cores); the result is the same for any number"""

    seed: int
    """turns the hemi-cubes differently"""

    memory: int
    """of the process at its peak, within a tenth: fewer rays, kept form factors and elements where they do not fit; what cannot fit is refused (default: any, with 4096 for kept form factors)"""

    sun: str
    """a sun, in degrees: azimuth from north (-z) by east (+x), angular diameter 0.533 by default"""

    environment: str | PathLike[str]
    """radiance of the sky all around: one colour, or a panorama (default: 1 if nothing else gives light)"""

    emissive_scale: float
    """what emits does so this many times as much (default 1)"""

    bounces: int
    """follow light through so many reflections before the one that is seen (default: all; 0: direct light only)"""

    direct_only: bool
    """as --bounces 0"""

    ao: bool
    """ambient occlusion in the place of light: the share of a white sky that is seen, 0 to 1, as with --scene-linear; textures stay"""

    ao_distance: float
    """what is farther away than this does not occlude (default, with --ao: a tenth of the diagonal of the scene)"""

    scene_linear: bool
    """no view transform: linear Rec.709 radiance as float in _RADIOSITY, clamped in COLOR_0"""

    rows: str | PathLike[str]
    """keep what rays hit in FILE; if it is there already, of this geometry and these options, light the scene anew by it, with whatever emits now, in a fraction of the time"""

    lights_from: str | PathLike[str]
    """light it by another asset of the same geometry: by its lamps, sky and what its materials emit, mesh by mesh; all else stays, and --sun, --environment and --rows go with it"""

    light_groups: bool
    """linear radiance by each group of lights, in _LIGHT_NAME, which add up to what is shown: by extras.hemibake.group of materials, else by node; the sun and the sky are groups too; solved by rows"""

    vertex_errors: bool
    """where the estimated error lies, as float in _ERROR: as a share of the rms radiance; its mean square is about the square of the estimate"""

    exposure: float | Literal["auto"]
    """stops to brighten by before the view transform (default auto: lit surfaces average to middle grey)"""

    ocio: str | PathLike[str]
    """OpenColorIO configuration (default: $OCIO, else one of our own)"""

    input_space: str | PathLike[str]
    """space of the configuration that colour factors are in (default: linear Rec.709, as glTF says)"""

    working_space: str | PathLike[str]
    """linear space whose primaries light is added up in (default: the role scene_linear)"""

    display: str | PathLike[str]
    """display of the configuration"""

    view: str | PathLike[str]
    """view of the display"""

    look: str | PathLike[str]
    """look to apply"""

    no_draco: bool
    """write plain accessors instead of KHR_draco_mesh_compression"""

    metals: Literal["rough", "black"]
    """metals reflect their colour times roughness^2 / 2 (rough, the default), or nothing diffusely (black)"""

    keep_pbr: bool
    """leave materials and normals alone: light goes into the float attribute _RADIOSITY only"""

    keep_instances: bool
    """what shares a mesh goes on sharing it, lit by the mean of all (default: a lit copy each)"""

    draco_level: int
    """0 fast, 10 small (default 7)"""

    draco_bits: str
    """quantisation bits (default position=14,normal=10,color=12,texcoord=12); where an asset has several meshes, positions get up to 4 more, so that all lie on one grid and meet as before"""

    root: str | PathLike[str]
    """read nothing outside of this folder, links followed, whatever a file names"""

    max_pixels: int
    """read images of at most this many pixels, and eight times as many in all (default 33554432)"""

    report: str | PathLike[str]
    """what was done, how long it took, how far off it is: for programs, or as one page to look at"""

    scene: str | PathLike[str]
    """which scene of a glTF asset, by its name or its number from 0, or all one by one (default: the default scene)"""

    moving: Literal["rest", "leave"]
    """what is animated, skinned or morphed is baked at its rest pose (default), or left as it is, without a shadow"""

    variant: str | PathLike[str]
    """of a glTF asset: the variant (KHR_materials_variants) whose light is baked; of a USD stage: the choice of a variant set; several with commas between"""

    time_code: float
    """of a USD stage: when (default: its start, else its first sample)"""

    keep_lamps: bool
    """of a USD stage: lamps with an area are part of what is written"""

    layer: str | PathLike[str]
    """of a USD stage: a layer over it, with a variant set hemibake {baked, source}"""

    preview: str | PathLike[str]
    """a picture of the result, PNG or JPEG"""

    checkpoint: str | PathLike[str]
    """keep what takes long in a file, as it is found, so that --resume can go on; it goes when the outputs are there"""

    resume: str | PathLike[str]
    """go on where the bake of a checkpoint was ended, of the same input, options and version, to the same bytes"""

    reference: str | PathLike[str]
    """path-traced probes to measure the error against (view: or another bake)"""

    camera: str | PathLike[str]
    """camera of the picture (default: the first; without one, from outside)"""

    look_from: str
    """where the picture is taken from, metres, y up, in the place of a camera"""

    look_at: str
    """what it is taken of (default, with --look-from: the middle of the asset)"""

    size: str
    """size of the picture (default 960x720)"""

    flat: bool
    """one colour a triangle, in the picture and in what is written"""

    force: bool
    """write onto the input itself, where that is what -o names; of several inputs bake the unchanged ones too"""
