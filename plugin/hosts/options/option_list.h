/* SPDX-License-Identifier: MIT
 * Which options are there? The one list: an option is a line here and its use. From it come parsing, --help, the stamp
 * in a baked asset, the man page, OPTIONS.md, and what Python, Node, glTF-Transform and Blender take.
 *
 *     OPTION(name, argument, kind, field, low, high, commands, marks, help)
 *
 * argument  as help shows it; of a CHOICE the words, in order, between bars
 * kind      an option_kind, without KIND_
 * field     of `options` (option_table.h); of options.bake what hemi_bake takes. 0 there is the default, which the
 * library knows, and a negative number is off low, high of a number; both 0: of any size commands  that take it marks
 * FILES: whoever has files baked by the command takes it, Python's bake, Blender, CMake; SCENES: whoever bakes a scene
 * in memory by options, bakeScene and bake of glTF-Transform; DOCUMENTS: only bake of glTF-Transform; STAMPED: what is
 * written depends on it, and the asset says how it was given; ZERO_IS_OFF: 0 turns off what it is about
 */
/* clang-format off */
OPTION("-o", "OUT", TEXT, output, 0, 0, BAKE | RENDER | FACTORS, 0,
       "where the result goes: .glb, .gltf, .usda, .usdc or .usdz (bake; of several inputs a folder, as then --report, "
       "--preview and --depfile are), .png (render), .csv (factors; default stdout)")
OPTION("--tolerance", "T", NUMBER, tolerance, 1e-12, 1, FACTORS, 0,
       "absolute error that a form factor may have (default 1e-5)")
OPTION("--quality", "draft|medium|high|reference", CHOICE, bake.quality, 0, 0, BAKE | INSPECT, FILES | SCENES | STAMPED,
       "preset of sizes and targets below (default medium; with --error: as fine as meets it)")
OPTION("--method", "hybrid|analytic|pr|fm|rows|auto", CHOICE, bake.method, 0, 0, BAKE | INSPECT, FILES | SCENES | STAMPED,
       "how radiosity is solved (default auto: rows, by rays, under a sky, where a sun shines beside lamps and for many small "
       "faces, else hybrid; the report says which); the others are the paper's, to compare with")
OPTION("--visibility", "osmesa|egl|rays|auto", CHOICE, bake.visibility, 0, 0, BAKE | INSPECT, FILES | SCENES | STAMPED,
       "what draws the item buffers of columns: OpenGL by OSMesa or EGL, or Embree's rays (default auto: what is there and "
       "predicted to be fastest; the report says which)")
OPTION("--normals", "file|faces", CHOICE, bake.normals, 0, 0, BAKE | INSPECT, FILES | SCENES | STAMPED,
       "by which normals light is received: the file's, so that what is smooth looks smooth (default), or those of its "
       "facets")
OPTION("--error", "E", NUMBER, bake.error_target, 1e-6, 1, BAKE, FILES | SCENES | STAMPED,
       "stop when the estimated relative error is below E (e.g. 0.01)")
OPTION("--time", "T", SECONDS, bake.time_limit_s, 1e-3, 1e9, BAKE, FILES | SCENES,
       "stop after T seconds with the best answer so far (exit status 4); where neither quality nor sizes are given, "
       "elements are as small as T allows")
OPTION("--unshot", "U", NUMBER, bake.unshot_target, 1e-9, 0.999, BAKE, FILES | SCENES | STAMPED,
       "stop when this fraction of the emitted power is unshot")
OPTION("--element-size", "M", NUMBER, bake.element_size, 1e-9, 1e9, BAKE | INSPECT, FILES | SCENES | STAMPED,
       "target edge of an element, metres (default: from quality and scene)")
OPTION("--patch-size", "M", NUMBER, bake.patch_size, 1e-9, 1e9, BAKE | INSPECT, FILES | SCENES | STAMPED,
       "target edge of a patch, metres")
OPTION("--max-elements", "N", COUNT, bake.max_elements, 1, 4e9, BAKE | INSPECT, FILES | SCENES | STAMPED,
       "refine to no more elements than this, and refuse to start with more (default 4000000)")
OPTION("--refine-levels", "N", COUNT, bake.adapt_levels, 1, 8, BAKE, FILES | SCENES | STAMPED,
       "quarter elements up to N times where light is not linear (default: by quality; never with --element-size)")
OPTION("--refine-error", "E", NUMBER, bake.adapt_error, 1e-6, 1, BAKE, FILES | SCENES | STAMPED,
       "refine until the size of elements costs less than this relative error (default: by quality)")
OPTION("--uniform", NULL, OFF, bake.adapt_levels, 0, 0, BAKE, FILES | SCENES | STAMPED,
       "elements of one size: do not refine")
OPTION("--merge-error", "E", NUMBER, bake.decimate_error, 0, 1, BAKE, FILES | SCENES | STAMPED | ZERO_IS_OFF,
       "merge triangles where that changes no colour by more than this share of it (default: by quality; 0, or with "
       "--flat or kept instances: never)")
OPTION("--stand-in", "D", NUMBER, bake.proxy_error, 0, 1, BAKE | INSPECT, FILES | SCENES | STAMPED | ZERO_IS_OFF,
       "a mesh that is too dense is solved on a simpler one, off by so many elements at most (default 0.035, by rows 0.02; 0: never)")
OPTION("--cluster-angle", "DEG", NUMBER, bake.cluster_angle, 0, 60, BAKE, FILES | SCENES | STAMPED | ZERO_IS_OFF,
       "small patches shoot as one with those beside them whose normals differ by less (default 20; 0: never)")
OPTION("--hemicube", "N", COUNT, bake.hemicube, 16, 4096, BAKE | INSPECT, FILES | SCENES | STAMPED,
       "hemi-cube resolution, pixels across")
OPTION("--hemicube-light", "N", COUNT, bake.hemicube_light, 16, 4096, BAKE, FILES | SCENES | STAMPED,
       "the same on emitters")
OPTION("--light-tolerance", "F", NUMBER, bake.light_tolerance, 1e-9, 1, BAKE, FILES | SCENES | STAMPED,
       "share of an emitter's power in penumbra that quarters it further (default 0.005)")
OPTION("--subdivide", "LEVEL|auto", LEVEL, subdivide, 0, 8, BAKE | INSPECT, FILES | STAMPED | ZERO_IS_OFF,
       "take every mesh as the cage of a subdivision surface, refined LEVEL times, unless its extras say how; 0: "
       "none; auto: what USD says are cages, as elements are small")
OPTION("--subdivide-scheme", "catmull-clark|loop|bilinear", CHOICE, subdivision, 0, 0, BAKE, FILES | STAMPED,
       "which surface (default catmull-clark)")
OPTION("--subdivide-adaptive", NULL, FLAG, subdivide_adaptive, 0, 0, BAKE, FILES | STAMPED,
       "refine where the surface curves, at most LEVEL times")
OPTION("--threads", "N", COUNT, threads, 1, 256, BAKE | FACTORS | INSPECT, FILES | SCENES,
       "worker threads (default: all cores); the result is the same for any number")
OPTION("--seed", "N", COUNT, bake.seed, 0, 9e15, BAKE, FILES | SCENES | STAMPED,
       "turns the hemi-cubes differently")
OPTION("--memory", "MIB", MEBIBYTES, bake.memory_limit, 1, 1e9, BAKE | INSPECT, FILES | SCENES,
       "of the process at its peak, within a tenth: fewer rays, kept form factors and elements where they do not fit; what "
       "cannot fit is refused (default: any, with 4096 for kept form factors)")
OPTION("--sun", "AZIMUTH,ELEVATION,LUX[,ANGLE]", SUN, sun, 0, 0, BAKE | INSPECT, FILES | DOCUMENTS | STAMPED,
       "a sun, in degrees: azimuth from north (-z) by east (+x), angular diameter 0.533 by default")
OPTION("--environment", "R,G,B|FILE.hdr|FILE.exr", SKY, environment, 0, 0, BAKE | INSPECT, FILES | DOCUMENTS | STAMPED,
       "radiance of the sky all around: one colour, or a panorama (default: 1 if nothing else gives light)")
OPTION("--emissive-scale", "X", NUMBER, emissive_scale, 1e-9, 1e9, BAKE | INSPECT, FILES | STAMPED,
       "what emits does so this many times as much (default 1)")
OPTION("--bounces", "N", COUNT, bake.bounces, 0, 1000, BAKE, FILES | SCENES | STAMPED | ZERO_IS_OFF,
       "follow light through so many reflections before the one that is seen (default: all; 0: direct light only)")
OPTION("--direct-only", NULL, OFF, bake.bounces, 0, 0, BAKE, FILES | SCENES | STAMPED,
       "as --bounces 0")
OPTION("--ao", NULL, FLAG, ao, 0, 0, BAKE, FILES | STAMPED,
       "ambient occlusion in the place of light: the share of a white sky that is seen, 0 to 1, as with --scene-linear; "
       "textures stay")
OPTION("--ao-distance", "M", NUMBER, bake.open_distance, 1e-9, 1e9, BAKE, FILES | SCENES | STAMPED,
       "what is farther away than this does not occlude (default, with --ao: a tenth of the diagonal of the scene)")
OPTION("--scene-linear", NULL, FLAG, scene_linear, 0, 0, BAKE, FILES | SCENES | STAMPED,
       "no view transform: linear Rec.709 radiance as float in _RADIOSITY, clamped in COLOR_0")
OPTION("--rows", "FILE", TEXT, rows, 0, 0, BAKE, FILES,
       "keep what rays hit in FILE; if it is there already, of this geometry and these options, light the scene anew by it, "
       "with whatever emits now, in a fraction of the time")
OPTION("--lights-from", "FILE", TEXT, lights_from, 0, 0, BAKE, FILES | STAMPED,
       "light it by another asset of the same geometry: by its lamps, sky and what its materials emit, mesh by mesh; all "
       "else stays, and --sun, --environment and --rows go with it")
OPTION("--light-groups", NULL, FLAG, light_groups, 0, 0, BAKE, FILES | STAMPED,
       "linear radiance by each group of lights, in _LIGHT_NAME, which add up to what is shown: by extras.hemibake.group of "
       "materials, else by node; the sun and the sky are groups too; solved by rows")
OPTION("--vertex-errors", NULL, FLAG, bake.vertex_errors, 0, 0, BAKE, FILES | SCENES | STAMPED,
       "where the estimated error lies, as float in _ERROR: as a share of the rms radiance; its mean square is about the "
       "square of the estimate")
OPTION("--exposure", "EV|auto", EXPOSURE, exposure, -64, 64, BAKE, FILES | SCENES | STAMPED,
       "stops to brighten by before the view transform (default auto: lit surfaces average to middle grey)")
OPTION("--ocio", "CONFIG", TEXT, ocio, 0, 0, BAKE | INSPECT, FILES | SCENES,
       "OpenColorIO configuration (default: $OCIO, else one of our own)")
OPTION("--input-space", "S|file-rules", TEXT, input_space, 0, 0, BAKE | INSPECT, FILES | STAMPED,
       "space of the configuration that colour factors are in (default: linear Rec.709, as glTF says)")
OPTION("--working-space", "S", TEXT, working_space, 0, 0, BAKE | INSPECT, FILES | SCENES | STAMPED,
       "linear space whose primaries light is added up in (default: the role scene_linear)")
OPTION("--display", "D", TEXT, display, 0, 0, BAKE, FILES | SCENES | STAMPED,
       "display of the configuration")
OPTION("--view", "V", TEXT, view, 0, 0, BAKE, FILES | SCENES | STAMPED,
       "view of the display")
OPTION("--look", "L", TEXT, look, 0, 0, BAKE, FILES | SCENES | STAMPED,
       "look to apply")
OPTION("--no-draco", NULL, FLAG, no_draco, 0, 0, BAKE, FILES | STAMPED,
       "write plain accessors instead of KHR_draco_mesh_compression")
OPTION("--metals", "rough|black", CHOICE, metals, 0, 0, BAKE | INSPECT, FILES | STAMPED,
       "metals reflect their colour times roughness^2 / 2 (rough, the default), or nothing diffusely (black)")
OPTION("--keep-pbr", NULL, FLAG, keep_pbr, 0, 0, BAKE, FILES | STAMPED,
       "leave materials and normals alone: light goes into the float attribute _RADIOSITY only")
OPTION("--keep-instances", NULL, FLAG, keep_instances, 0, 0, BAKE, FILES | STAMPED,
       "what shares a mesh goes on sharing it, lit by the mean of all (default: a lit copy each)")
OPTION("--draco-level", "0..10", COUNT, draco_level, 0, 10, BAKE, FILES | STAMPED,
       "0 fast, 10 small (default 7)")
OPTION("--draco-bits", "K=N,...", BITS, draco_bits, 1, 30, BAKE, FILES | STAMPED,
       "quantisation bits (default position=14,normal=10,color=12,texcoord=12); where an asset has several meshes, positions "
       "get up to 4 more, so that all lie on one grid and meet as before")
OPTION("--root", "DIR", TEXT, root, 0, 0, BAKE | COMPARE | RENDER | FACTORS | INSPECT | VIEW, FILES,
       "read nothing outside of this folder, links followed, whatever a file names")
OPTION("--max-pixels", "N", COUNT, max_pixels, 1, 1e9, BAKE | INSPECT, FILES,
       "read images of at most this many pixels, and eight times as many in all (default 33554432)")
OPTION("--report", "FILE.json|html", TEXT, report, 0, 0, BAKE, FILES,
       "what was done, how long it took, how far off it is: for programs, or as one page to look at")
OPTION("--scene", "NAME|N|all", TEXT, scene, 0, 0, BAKE | COMPARE | RENDER | INSPECT | VIEW, FILES | STAMPED,
       "which scene of a glTF asset, by its name or its number from 0, or all one by one (default: the default scene)")
OPTION("--moving", "rest|leave", CHOICE, moving, 0, 0, BAKE | INSPECT, FILES | STAMPED,
       "what is animated, skinned or morphed is baked at its rest pose (default), or left as it is, without a shadow")
OPTION("--variant", "NAME|/PRIM{SET=CHOICE}", TEXT, variant, 0, 0, BAKE | INSPECT, FILES | STAMPED,
       "of a glTF asset: the variant (KHR_materials_variants) whose light is baked; of a USD stage: the choice of a "
       "variant set; several with commas between")
OPTION("--time-code", "T", NUMBER, time_code, -1e9, 1e9, BAKE | INSPECT, FILES | STAMPED,
       "of a USD stage: when (default: its start, else its first sample)")
OPTION("--keep-lamps", NULL, FLAG, keep_lamps, 0, 0, BAKE, FILES | STAMPED,
       "of a USD stage: lamps with an area are part of what is written")
OPTION("--layer", "FILE.usda", TEXT, layer, 0, 0, BAKE, FILES,
       "of a USD stage: a layer over it, with a variant set hemibake {baked, source}")
OPTION("--preview", "FILE.png|jpg", TEXT, preview, 0, 0, BAKE, FILES,
       "a picture of the result, PNG or JPEG")
OPTION("--depfile", "FILE.d", TEXT, depfile, 0, 0, BAKE, STAMPED,
       "which files the result depends on, for Make, Ninja and CMake")
OPTION("--checkpoint", "FILE", TEXT, checkpoint, 0, 0, BAKE, FILES,
       "keep what takes long in a file, as it is found, so that --resume can go on; it goes when the outputs are there")
OPTION("--resume", "FILE", TEXT, resume, 0, 0, BAKE, FILES,
       "go on where the bake of a checkpoint was ended, of the same input, options and version, to the same bytes")
OPTION("--reference", "PROBES.hprb", TEXT, reference, 0, 0, BAKE | VIEW, FILES,
       "path-traced probes to measure the error against (view: or another bake)")
OPTION("--before", "IN", TEXT, before, 0, 0, VIEW, 0,
       "what the bake was made of, to be shown beside it")
OPTION("--port", "N", COUNT, port, 1, 65535, VIEW, 0,
       "where the page is (default: any that is free)")
OPTION("--camera", "NAME|N", TEXT, camera, 0, 0, BAKE | COMPARE | RENDER, FILES,
       "camera of the picture (default: the first; without one, from outside)")
OPTION("--look-from", "X,Y,Z", POINT, look_from, 0, 0, BAKE | COMPARE | RENDER, FILES,
       "where the picture is taken from, metres, y up, in the place of a camera")
OPTION("--look-at", "X,Y,Z", POINT, look_at, 0, 0, BAKE | COMPARE | RENDER, FILES,
       "what it is taken of (default, with --look-from: the middle of the asset)")
OPTION("--all-cameras", NULL, FLAG, all_cameras, 0, 0, RENDER, 0,
       "a picture from every camera, numbered from 0: OUT-0.png and on")
OPTION("--turntable", "N", COUNT, turntable, 2, 1000, RENDER, 0,
       "N pictures from all around, numbered from 0: OUT-0.png and on; from --look-from on, else from the front")
OPTION("--heatmap", "FILE.png|jpg", TEXT, heatmap, 0, 0, COMPARE, 0,
       "a picture of where the bake is off, as a share of what is there")
OPTION("--worst", "N", COUNT, worst, 1, 1000, COMPARE, 0,
       "list the N points that have the largest shares of the error")
OPTION("--size", "WxH", SIZE, size, 1, 8192, BAKE | COMPARE | RENDER, FILES,
       "size of the picture (default 960x720)")
OPTION("--flat", NULL, FLAG, bake.flat, 0, 0, BAKE | RENDER, FILES | SCENES | STAMPED,
       "one colour a triangle, in the picture and in what is written")
OPTION("--strict", NULL, FLAG, strict, 0, 0, INSPECT, 0,
       "exit status 1 where anything is to be minded, for continuous integration")
OPTION("--json", NULL, FLAG, json, 0, 0, COMPARE | INSPECT, 0,
       "print it as JSON")
OPTION("--jobs", "N", COUNT, jobs, 1, 256, BAKE, 0,
       "of several inputs bake so many at a time (default 1); unless --threads says, they share the cores")
OPTION("--force", NULL, FLAG, force, 0, 0, BAKE, FILES,
       "write onto the input itself, where that is what -o names; of several inputs bake the unchanged ones too")
OPTION("--quiet", NULL, FLAG, quiet, 0, 0, BAKE | RENDER | FACTORS, 0,
       "print nothing but errors")
OPTION("--progress", "auto|plain|json", CHOICE, progress, 0, 0, BAKE, 0,
       "how progress is shown on stderr (auto: on a terminal only)")
/* clang-format on */
