/* SPDX-License-Identifier: MIT
 * What does a glTF asset hold that can be baked, and how does the same asset look with the light in its vertices?
 *
 * Reads .glb and .gltf (external buffers, data URIs, KHR_draco_mesh_compression, EXT_meshopt_compression,
 * KHR_mesh_quantization, EXT_mesh_gpu_instancing, sparse accessors), lists what can be baked in the ABI's own structs,
 * and writes the asset back with COLOR_0 on every primitive that was baked. Whatever was not baked survives. Units and
 * frames are those of hemibake.h, which are glTF's: metres, right-handed, fronts counter-clockwise.
 *
 *     gltf_asset *asset;
 *     char message[GLTF_MESSAGE_SIZE];
 *     if (gltf_asset_read(path, &asset, message) != HEMI_OK) fprintf(stderr, "%s: %s\n", path, message);
 *     for (uint32_t m = 0; m < gltf_asset_material_count(asset); m++) { gltf_asset_material(asset, m, &material); ... }
 *     for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++) { gltf_asset_mesh(asset, i, &mesh); ... }
 *     gltf_asset_write(asset, &desc, &output, message);
 *     gltf_output_free(&output); gltf_asset_destroy(asset);
 *
 * Memory: everything an asset hands out points into it and lives as long as it. Threads: an asset may be read from
 * many threads at once. Nothing here prints or keeps state between calls.
 */
#ifndef HEMIBAKE_GLTF_ASSET_H
#define HEMIBAKE_GLTF_ASSET_H

#include "hemibake/hemibake.h"

HEMI_C_BEGIN

#define GLTF_MESSAGE_SIZE 512

typedef struct gltf_asset gltf_asset;

/* ---- reading --------------------------------------------------------------------------------------------------- */

/* Whether the file is binary is told by its first four bytes, not by its name. Images stay undecoded bytes.
 * On failure *out is NULL and message holds "what is wrong, where (a path into the JSON), what to do" without the
 * file's name and without a newline: HEMI_ERROR_FILE (cannot be opened, a .bin is missing), HEMI_ERROR_DATA
 * (malformed), HEMI_ERROR_UNSUPPORTED (a required extension is unknown), HEMI_ERROR_LIMIT, HEMI_ERROR_MEMORY.
 * On success message is empty. */
hemi_result gltf_asset_read(const char *path, gltf_asset **out, char message[GLTF_MESSAGE_SIZE]);

/* What of a file is read, and how much it may ask for. */
typedef struct gltf_limits {
    const char *root; /* the asset, its buffers and its images lie in this folder, links followed; NULL: anywhere */
    uint64_t image_pixels; /* of one image; 0: IMAGE_PIXELS_DEFAULT (image_decode.h) */
    const uint8_t *bytes;  /* of the asset's own file, where they have been read already; NULL: path is read */
    size_t byte_count;
    const char *scene;   /* the scene that is baked, by its name or its number from 0; NULL: the default one, else 0 */
    bool opens_scene;    /* what is written opens with that scene, if one is asked for */
    const char *variant; /* the variant of KHR_materials_variants that is baked, by its name; NULL: none, the materials
                            that primitives name themselves */
    uint64_t (*memory_left)(void *user); /* bytes that a picture may take while it is decoded; NULL: any */
    void *memory_user;
    bool leaves_moving; /* what is animated, skinned or morphed is no part of the bake; else it is, at its rest pose */
} gltf_limits;

/* The same within limits; NULL: all zero. */
hemi_result gltf_asset_read_within(const char *path, const gltf_limits *limits, gltf_asset **out,
                                   char message[GLTF_MESSAGE_SIZE]);
void gltf_asset_destroy(gltf_asset *asset); /* NULL is fine */

/* How many scenes the asset has; without any, all its nodes are baked. */
uint32_t gltf_asset_scene_count(const gltf_asset *asset);

/* ---- materials ------------------------------------------------------------------------------------------------- */

/* The asset's materials in their order, then one more: glTF's default, for primitives that name none. */
uint32_t gltf_asset_material_count(const gltf_asset *asset);

/* How metals bake. GLTF_METALS_ROUGH is the rule that game engines use for lightmaps: what a rough metal mirrors is
 * taken as diffuse, and the less of it the smoother the metal is, since a vertex colour holds no mirror image:
 *
 *     rho = base ((1 - m) + m r^2 / 2),    metalness m, roughness r
 *
 * GLTF_METALS_BLACK: without the second term. */
typedef enum gltf_metals { GLTF_METALS_ROUGH, GLTF_METALS_BLACK } gltf_metals;

/* Before materials and textures are asked for; GLTF_METALS_ROUGH if it is not. */
void gltf_asset_set_metals(gltf_asset *asset, gltf_metals metals);

/* What emits does so scale times as much. Before materials and textures are asked for. */
void gltf_asset_scale_emission(gltf_asset *asset, double scale);

/* Where a material hardly reflects and emits by a picture, as one that was lit elsewhere and is shown so, its unlit
 * copy shows that picture in the place of the base colour's. Before textures are asked for. */
void gltf_asset_show_emission(gltf_asset *asset);

/* Light passes the bodies of lamps (gltf_asset_mesh_is_lamp), which are not shown then: nothing is dark behind what
 * nobody sees. A material that others have too stays as it is. Before materials are asked for. */
void gltf_asset_clear_lamps(gltf_asset *asset);

/* reflectance = baseColorFactor.rgb times what gltf_metals says, or the diffuseFactor of
 * KHR_materials_pbrSpecularGlossiness; emission = emissiveFactor * KHR_materials_emissive_strength
 * * scale. A texture of the
 * material that could not be read (gltf_asset_read_textures) has it be no metal. */
bool gltf_asset_material(const gltf_asset *asset, uint32_t material, hemi_material_desc *out);

/* What gltf_asset_material has multiplied the colour factors by, for who reads them in another colour space: the share
 * that gltf_metals leaves, and emissiveStrength * scale. False if material is out of range. */
bool gltf_asset_material_weights(const gltf_asset *asset, uint32_t material, double *reflectance, double *emission);

/* ---- textures -------------------------------------------------------------------------------------------------- */

/* Puts count colours, rgb[3*i+c], into the space that is solved in: texels as they are stored (0..1), or factors, which
 * are linear Rec.709. file: the image's, or NULL. */
typedef hemi_result (*gltf_convert_fn)(void *user, bool texels, const char *file, float *rgb, size_t count);

/* Bytes that pictures take as long as the asset lives, once textures have been read. */
uint64_t gltf_asset_picture_bytes(const gltf_asset *asset);

/* Decodes the images of baseColorTexture, emissiveTexture and metallicRoughnessTexture (or diffuseTexture), so that
 * gltf_asset_texture can tell their means. convert NULL: glTF's rule, texels are sRGB. Where an image is missing,
 * broken or no PNG, JPEG or WebP, factors count alone; of a base colour or metallic-roughness texture, metalness and
 * roughness then are 0 and 1, since glTF's defaults are those of a white metal. gltf_asset_skipped then lists that,
 * what is unlit, and what materials have beyond diffuse reflection. */
hemi_result gltf_asset_read_textures(gltf_asset *asset, gltf_convert_fn convert, void *user,
                                     char message[GLTF_MESSAGE_SIZE]);

/* Sets texture, texture_user and alpha_mask of the mesh's desc. False: its material is the same everywhere. With
 * KHR_texture_transform, any set of coordinates and COLOR_0; the metalness of each texel counts, and a
 * KHR_materials_unlit surface emits what it shows. shown_*: without the base colour's texture, which stays on the baked
 * asset. */
bool gltf_asset_texture(const gltf_asset *asset, uint32_t mesh, hemi_mesh_desc *out);

/* ---- meshes ---------------------------------------------------------------------------------------------------- */

/* One for each node of the scene that is not hidden, each copy that EXT_mesh_gpu_instancing makes there, and each
 * primitive of the mesh that can be baked: triangles, strips or fans that are not blended. What is animated stands
 * where its node does, what is skinned or morphed has the shape of its rest pose: positions are then in the world, and
 * own_vertices is set. In the order of a walk through the scene, parents first; levels of detail (MSFT_lod) that are no
 * part of it come last. */
uint32_t gltf_asset_mesh_count(const gltf_asset *asset);

/* name: the node's, or its mesh's if it has none. positions[3*v+k] in the node's own frame; normals[3*v+k] or NULL;
 * attributes[attribute_count*v+k]: first every TEXCOORD of the primitive in the order of its number, two each, then
 * COLOR_1 and on and the asset's own attributes, then COLOR_0 as linear rgb, last u, v, w of what alphaMode MASK cuts
 * out, or NULL; indices of triangles, strips and
 * fans unrolled; transform: node to world, column-major; material: an index from above; subdivision as extras ask for
 * it and polygons as FB_ngon_encoding says them (gltf_subdivision.cpp). False if mesh is out of range. */
bool gltf_asset_mesh(const gltf_asset *asset, uint32_t mesh, hemi_mesh_desc *out);

/* Is its level of subdivision left to the host ("level": "auto")? Its desc has one that is fine for most. */
bool gltf_asset_mesh_level_is_auto(const gltf_asset *asset, uint32_t mesh);

/* Is it the body of a lamp, which lights but is no part of what is shown? extras.hemibake_lamp of its node
 * is true. */
bool gltf_asset_mesh_is_lamp(const gltf_asset *asset, uint32_t mesh);

/* Is its material KHR_materials_unlit? Such a surface shows its colour whatever falls on it, so a bake passes it by. */
bool gltf_asset_mesh_is_unlit(const gltf_asset *asset, uint32_t mesh);

/* What extras.hemibake of its node, or of one above that, or of its material ask. */
typedef struct gltf_mesh_steering {
    bool is_left_out;    /* it stays as it is, and does not stand in the way of light */
    bool facets;         /* received light is weighted by the normals of its facets */
    double element_size; /* m; 0: that of the bake */
    const char *group;   /* of lights, that its emission belongs to; NULL: they name none */
} gltf_mesh_steering;

bool gltf_asset_mesh_steering(const gltf_asset *asset, uint32_t mesh, gltf_mesh_steering *out);

/* Does it stay as it is, being unlit or because its extras ask for that? */
bool gltf_asset_mesh_is_left(const gltf_asset *asset, uint32_t mesh);

/* Does it stand in the way of light? All do but unlit backdrops, which lie around all else. After
 * gltf_asset_read_textures. */
bool gltf_asset_mesh_blocks(const gltf_asset *asset, uint32_t mesh);

/* What a viewer multiplies COLOR_0 by: the base colour's factor, 0..1. */
void gltf_asset_mesh_factor(const gltf_asset *asset, uint32_t mesh, double factor[3]);

/* Reads the pictures that a viewer multiplies colours by, and what alphaMode MASK cuts out, for the two below; instead
 * of gltf_asset_read_textures, which bakes ask. */
hemi_result gltf_asset_read_shown(gltf_asset *asset, char message[GLTF_MESSAGE_SIZE]);

/* rgb times what a viewer multiplies COLOR_0 by at a point of a triangle of the mesh: factor and picture of the base
 * colour. weights: of the three corners; share: of the triangle's area that is looked at. */
void gltf_asset_mesh_shown(const gltf_asset *asset, uint32_t mesh, const uint32_t corner[3], const double weights[3],
                           double share, float rgb[3]);

/* What is cut out of the mesh, as in gltf_asset_texture, or, of one that blends, how much it covers; NULL: nothing, or
 * gltf_asset_mesh_opacity everywhere. */
const hemi_alpha_mask *gltf_asset_mesh_mask(const gltf_asset *asset, uint32_t mesh);

/* How much of what is behind it a mesh covers where it is shown: its factor of alpha where it blends, and what its
 * baked copy blends by for the light that it lets straight through; 1: all. */
double gltf_asset_mesh_opacity(const gltf_asset *asset, uint32_t mesh);

/* Does what is seen of it blend with what is behind (alphaMode BLEND)? */
bool gltf_asset_mesh_blends(const gltf_asset *asset, uint32_t mesh);

/* The first mesh of the same geometry, which other nodes or copies show too: mesh itself if it is that one. */
uint32_t gltf_asset_mesh_original(const gltf_asset *asset, uint32_t mesh);

/* How many meshes the output has more than the asset because everything that is lit has light of its own. */
uint32_t gltf_asset_mesh_copies(const gltf_asset *asset);

/* radiosity[3*v+c]: the attribute _RADIOSITY that an earlier bake left, W/m2/sr; NULL without one. */
const float *gltf_asset_mesh_radiosity(const gltf_asset *asset, uint32_t mesh);

/* colors[3*v+c]: COLOR_0 as linear rgb, whatever its component type; NULL without one. */
const float *gltf_asset_mesh_color(const gltf_asset *asset, uint32_t mesh);

/* One line for each kind of what is not baked, or not as it was: the first that it is about, how many more, and why. */
size_t gltf_asset_skipped_count(const gltf_asset *asset);
const char *gltf_asset_skipped(const gltf_asset *asset, size_t index); /* NULL if out of range */

/* ---- lights ---------------------------------------------------------------------------------------------------- */

/* The lights of KHR_lights_punctual that nodes of the scene hold and that are not animated, in the order of the walk:
 * intensity is colour times intensity, in candela and lux, which fit emission in nits. False if out of range. */
bool gltf_asset_light(const gltf_asset *asset, uint32_t index, hemi_light_desc *out);

/* The light that EXT_lights_image_based gives the scene, from its irradianceCoefficients as a small panorama; the
 * specular images are not read. False without one. */
bool gltf_asset_sky(const gltf_asset *asset, hemi_sky_desc *out);

/* ---- cameras --------------------------------------------------------------------------------------------------- */

typedef struct gltf_camera {
    const char *name; /* the node's, or the camera's if the node has none */
    const char *path; /* of the prim in USD, extras.usd.path of the node; "": none */
    double eye[3];    /* world, metres */
    double target[3]; /* eye + unit view direction */
    double up[3];     /* unit */
    double yfov;      /* radians; 0: orthographic */
    double ymag;      /* half the height of an orthographic view, m; 0: perspective */
} gltf_camera;

/* The cameras that nodes of the scene hold, in the order of the walk. False if index is out of range. */
uint32_t gltf_asset_camera_count(const gltf_asset *asset);
bool gltf_asset_camera(const gltf_asset *asset, uint32_t index, gltf_camera *out);

/* ---- writing --------------------------------------------------------------------------------------------------- */

/* What a bake made of one mesh of the asset. */
typedef struct gltf_baked_mesh {
    const hemi_mesh_view *view; /* NULL: geometry and material stay as they were. Without triangles: it goes */
    const float *colors;        /* colors[3*v+c], linear; clamped to [0,1] and written as COLOR_0 */
    const float *radiosity;     /* radiosity[3*v+c], written as it is as _RADIOSITY; NULL: none */
    const float *errors;        /* errors[v], as _ERROR; NULL: none */
} gltf_baked_mesh;

typedef struct gltf_write_desc {
    bool binary;                   /* .glb; else .gltf and a .bin */
    const char *bin_name;          /* uri of the .bin, relative to the .gltf; NULL: "scene.bin" */
    const gltf_baked_mesh *meshes; /* meshes[i] belongs to mesh i of the asset */
    uint32_t mesh_count;           /* must be gltf_asset_mesh_count */
    const float *const *lights;    /* lights[i][3*(v+g*vertex_count)+c] of mesh i, written as it is as attribute g of
                                      light_names; NULL: none */
    const char *const *light_names;
    uint32_t light_count;
    unsigned threads;  /* that Draco's work is shared by, without a trace in the bytes; 0: one for each core */
    bool draco;        /* KHR_draco_mesh_compression on every baked primitive */
    int draco_level;   /* 0 (fast) .. 10 (small) */
    int draco_bits[4]; /* of position, normal, color, texcoord, 1..30; 0: 14, 10, 12, 12. Others are lossless. Positions
                          of an asset of several meshes have up to four more, so that what meets goes on meeting */
    bool keep_materials; /* materials, normals, tangents and COLOR_0 stay; light is in _RADIOSITY only */
    bool whole_colors; /* colours have in them what textures and variants of KHR_materials_variants multiply them by */
    bool float_colors; /* without Draco, COLOR_0 as FLOAT and not as integers */
    bool drop_lights;  /* without lights of extensions, whose light is in the vertices */
    bool keep_instances;     /* what shares a mesh goes on sharing it, with the light of the first of them */
    const char *generator;   /* asset.generator; NULL: as it was */
    const char *extras_json; /* JSON text that becomes asset.extras.hemibake, or NULL */
} gltf_write_desc;

typedef struct gltf_output {
    uint8_t *main; /* the .glb or .gltf */
    size_t main_size;
    uint8_t *bin; /* the .bin; NULL for a .glb, or if the asset has no binary data */
    size_t bin_size;
    uint64_t triangles, vertices;   /* of the baked primitives, as a reader will count them */
    uint64_t geometry_bytes_before; /* indices and attributes of the baked primitives, uncompressed ... */
    uint64_t geometry_bytes_after;  /* ... and as written; the same without Draco */
    double max_position_error;      /* world, metres: what quantisation moved a vertex at most (measured) */
    double max_color_error;         /* the same for a component of COLOR_0 */
    double max_normal_error;        /* the same for NORMAL, the length of the difference */
    double max_texcoord_error;      /* the same for a component of a TEXCOORD */
} gltf_output;

/* Serialises the asset with the baked geometry to memory; the caller writes the files. Same input, same bytes.
 *
 * The output is the document that was read, member for member, except for: a baked primitive gets POSITION, COLOR_0,
 * its TEXCOORDs and own attributes (interpolated through view->source_triangles, as floats; those of a limit surface
 * from view->attributes),
 * _RADIOSITY if given, and no NORMAL. COLOR_0 is FLOAT VEC3 under Draco, else normalised UNSIGNED_SHORT VEC4. Its
 * material becomes a single-sided KHR_materials_unlit copy that keeps name, extras, alpha and baseColorTexture; so does
 * every material that KHR_materials_variants maps to it, and COLOR_0 then is light that their factors multiply. A mesh
 * that several nodes share becomes one mesh a node, a copy of EXT_mesh_gpu_instancing a node of its own. Accessors,
 * buffer views, meshes, textures, images and samplers that only the old geometry and materials used go, unless the
 * asset uses an extension that may know them by number. There is one buffer; every image whose file was found is in it,
 * byte for byte. On failure *out is empty and message says why. */
hemi_result gltf_asset_write(const gltf_asset *asset, const gltf_write_desc *desc, gltf_output *out,
                             char message[GLTF_MESSAGE_SIZE]);
void gltf_output_free(gltf_output *output); /* NULL is fine; leaves it empty */

HEMI_C_END
#endif
