/* SPDX-License-Identifier: MIT
 * What is a glTF asset in memory, and which files of this folder work on it? Private, C++: only the files that touch
 * tinygltf include it. Errors travel as gltf_failure and are caught at the C functions of gltf_asset.h.
 */
#ifndef HEMIBAKE_GLTF_MODEL_H
#define HEMIBAKE_GLTF_MODEL_H

#include "gltf_asset.h"
#include "gltf_document.h"
#include "gltf_geometry.h"

#include <tiny_gltf.h>

#include <array>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

/* All files of one asset together, and all that is unpacked from them: a bound on what a hostile file can ask for. */
static const uint64_t gltf_bytes_max = uint64_t(1) << 31;

struct gltf_failure {
    hemi_result code;
    std::string text;
};

[[noreturn]] void gltf_fail(hemi_result code, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* printf into a string. */
std::string gltf_text(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* At most so many characters of a text from the file, none of which can break a line of output. */
std::string gltf_printable(const std::string &text, size_t most = 120);

struct gltf_shading;
struct gltf_mip_chain;

/* What a primitive of several variants is asked through: its material's own texture, if it has one, and the factor. */
struct gltf_variant {
    hemi_texture_fn texture;
    void *user;
    double factor[3];
};

/* The alpha of a picture, alpha[row*width+column]. */
struct gltf_alpha_map {
    uint32_t width, height;
    std::vector<uint8_t> alpha;
};

/* What a material lets past at most, and the alpha of its baked copy where that blends for it. */
struct gltf_passed {
    double straight = 0, diffuse[3] = { 0, 0, 0 }, shown_alpha = 1;
};

/* What gltf_asset_read_textures reads (gltf_shading.cpp). */
struct gltf_sampler;

struct gltf_shadings {
    gltf_convert_fn convert = nullptr;
    void *convert_user = nullptr;
    uint64_t texels = 0;
    std::map<std::pair<int, int>, std::unique_ptr<gltf_mip_chain>> mip_chains; /* by image and kind of texels */
    std::map<int, bool> readable;                                              /* of images that have been decoded */
    std::map<uint32_t, gltf_passed> passed;                                    /* of materials that let light past */
    std::set<uint32_t> unread;    /* materials whose base colour or metallic-roughness texture could not be read */
    std::set<int> empty_textures; /* that a line has named */
    std::map<int, std::unique_ptr<gltf_alpha_map>> alphas; /* by image; -1: none */
    std::vector<std::unique_ptr<hemi_alpha_mask>> masks;
    std::vector<const hemi_alpha_mask *> mask_of_mesh; /* NULL: it has none */
    std::vector<const hemi_alpha_mask *> shown_mask;   /* of meshes, in pictures: what blends has one too */
    std::vector<std::unique_ptr<gltf_shading>> owned;
    std::vector<gltf_shading *> of_mesh; /* NULL: the material is the same everywhere */
    std::vector<gltf_sampler> shown;     /* of meshes: gltf_shown.cpp */
    gltf_shadings();
    ~gltf_shadings();
};

/* Of EXT_lights_ies: values[row*columns+column] of the brightest, candela; as in ies_profile.h. */
struct gltf_profile {
    uint32_t rows = 0, columns = 0;
    double brightest = 0;
    std::vector<float> values; /* empty: it cannot be used */
};

struct gltf_asset {
    gltf_json document;                              /* what the output begins as */
    tinygltf::Model model;                           /* without the bytes of its buffers and images */
    std::vector<std::vector<unsigned char>> buffers; /* buffers[i] of the model */
    std::vector<std::vector<unsigned char>> images;  /* encoded bytes of images that came by uri; else empty */
    int scene = -1;
    bool opens_scene = false;                                                 /* gltf_limits */
    std::map<std::pair<int, int>, std::unique_ptr<gltf_geometry>> geometries; /* by mesh and primitive */
    std::map<std::pair<int, int>, std::shared_ptr<gltf_cage>> cages;          /* the same, of meshes and primitives */
    std::map<std::pair<int, int>, std::unique_ptr<gltf_geometry>> poses; /* by node and primitive: skinned, morphed */
    std::vector<std::array<double, 16>> node_worlds;                     /* of all nodes, once a skin needs them */
    std::vector<gltf_instance> instances;
    uint32_t mesh_copies = 0;                  /* that each instance needs for light of its own */
    std::vector<char> is_backdrop;             /* of instances: unlit, and around all else */
    std::map<int, std::vector<double>> copies; /* copies[node][16*i+k]: transform of instance i in the node's frame */
    std::vector<gltf_camera> cameras;
    std::vector<hemi_light_desc> lights;
    std::vector<std::vector<unsigned char>> profile_files; /* of EXT_lights_ies, those that came by uri; else empty */
    std::map<int, gltf_profile> profiles;
    std::vector<float> sky;                  /* a panorama of gltf_sky_width x gltf_sky_height; empty: none */
    std::vector<std::string> skipped, lines; /* notes as they came, and gathered (gltf_notes.cpp) */
    std::unique_ptr<gltf_shadings> shadings;
    std::vector<std::unique_ptr<gltf_variant>> variants; /* of instances; NULL: it has one variant */
    uint64_t (*memory_left)(void *user) = nullptr;       /* gltf_limits */
    void *memory_user = nullptr;
    uint64_t image_pixels = 0; /* that one image may have */
    gltf_metals metals = GLTF_METALS_ROUGH;
    double emission_scale = 1;
    bool shows_emission = false;
    std::vector<bool> is_of_lamps; /* of materials: bodies of lamps have it, and nothing else */
    bool lamps_are_clear = false;
};

/* ---- gltf_read.cpp: the model; gltf_check.cpp, which it ends with: nothing in it is out of range ---- */
void gltf_load(gltf_asset &asset, const char *path, const gltf_limits &limits);
void gltf_check(gltf_asset &asset);

/* What an image is by its first bytes; what they do not tell is as given. */
std::string gltf_media_type(const unsigned char *bytes, size_t length, const std::string &given);

/* Refuses an index that is not in [0, count): "where is i, but there are only n what". */
void gltf_check_index(int index, size_t count, const char *what, const std::string &where);

/* ---- gltf_meshopt.cpp: packed views become plain ones, and corners that are alike one vertex ---- */
void gltf_decode_meshopt(gltf_asset &asset);
void gltf_weld_corners(gltf_geometry &geometry);

/* ---- gltf_accessor.cpp: numbers out of bytes ---- */
size_t gltf_element_size(const tinygltf::Accessor &accessor); /* bytes, without stride */

/* What becomes of values that are not finite. */
enum gltf_broken { gltf_zero_broken, gltf_refuse_broken, gltf_keep_broken };

/* out[components*i+k]; integers are normalised if the accessor says so. The accessor must have that many components (or
 * one more, which is left out). */
std::vector<float> gltf_read_floats(const gltf_asset &asset, int accessor, int components, gltf_broken rule,
                                    const std::string &where);
std::vector<uint32_t> gltf_read_indices(const gltf_asset &asset, int accessor, const std::string &where);
std::vector<float> gltf_read_matrices(const gltf_asset &asset, int accessor, const std::string &where); /* [16*i+k] */

/* Scales integers that Draco gave as they are, by the accessor's component type. */
void gltf_normalize(const tinygltf::Accessor &accessor, std::vector<float> &values);

/* ---- gltf_primitive.cpp: the triangles of a primitive ---- */
std::unique_ptr<gltf_geometry> gltf_read_primitive(const gltf_asset &asset, int mesh, int primitive,
                                                   bool keeps_vertices);

/* An attribute of a primitive, Draco's too; empty: it has none of that name. */
std::vector<float> gltf_read_attribute(const gltf_asset &asset, int mesh, int primitive, const std::string &name,
                                       int components);

/* ---- gltf_pose.cpp: what is skinned or morphed as its rest pose shows it ---- */
std::unique_ptr<gltf_geometry> gltf_read_posed(gltf_asset &asset, int node, int mesh, int primitive);

/* ---- gltf_notes.cpp: what is said, one line a kind ---- */

/* Of whom ("node 3 \"door\"", its first word being the kind of thing) what is said. */
void gltf_note(gltf_asset &asset, const std::string &subject, const std::string &text);
void gltf_gather_notes(gltf_asset &asset); /* what gltf_asset_skipped hands out from then on */

/* ---- gltf_scene_choice.cpp: which scene, which variant, which nodes ---- */
std::vector<int> gltf_choose_scene(gltf_asset &asset, const char *wanted); /* its roots */
void gltf_choose_variant(gltf_asset &asset, const char *wanted);
bool gltf_node_is_hidden(const tinygltf::Node &node);

/* By node: whose level it is. Of nodes below these roots that are not hidden. */
std::map<int, gltf_detail> gltf_find_levels(const tinygltf::Model &model, const std::vector<int> &roots);

/* ---- gltf_alpha_mask.cpp: alphaMode MASK ---- */

/* The material if its alphaMode is MASK, or MASK or BLEND; else NULL. */
const tinygltf::Material *gltf_masked_material(const gltf_asset &asset, int material);
const tinygltf::Material *gltf_covered_material(const gltf_asset &asset, int material);

/* u, v, w of hemi_alpha_mask at every vertex, of what blends by COLOR_0's alpha too; or nothing. */
std::vector<float> gltf_mask_coordinates(const gltf_asset &asset, int material, const gltf_geometry &geometry);

/* NULL: the mask of a mesh of this geometry leaves all of it. asset.shadings is there. */
const hemi_alpha_mask *gltf_read_alpha_mask(gltf_asset &asset, const gltf_geometry &geometry, uint32_t material);

/* The same for pictures; of what blends, how much it covers, if that is not all. */
const hemi_alpha_mask *gltf_read_shown_mask(gltf_asset &asset, const gltf_geometry &geometry, uint32_t material);

/* ---- gltf_subdivision.cpp: control cages and their polygons ---- */
std::vector<uint32_t> gltf_polygon_sizes(const tinygltf::Primitive &primitive, const std::vector<uint32_t> &indices);
std::shared_ptr<gltf_cage> gltf_read_cage(gltf_asset &asset, int node, int mesh, int primitive);
hemi_subdivision_desc gltf_describe_cage(const gltf_instance &instance);

/* ---- gltf_instancing.cpp: where EXT_mesh_gpu_instancing puts its copies ---- */
std::vector<double> gltf_read_copies(const gltf_asset &asset, int node); /* [16*i+k] */

/* T R S, column-major, the quaternion (x, y, z, w) normalised. [glTF 2.0, 3.5.3] */
void gltf_compose(const double translation[3], const double rotation[4], const double scale[3], double out[16]);
void gltf_multiply(const double a[16], const double b[16], double out[16]);

/* ---- gltf_light.cpp: lights without a surface ---- */
static const size_t gltf_sky_width = 64, gltf_sky_height = 32; /* for harmonics of degree 2 */
void gltf_add_light(gltf_asset &asset, int node, const double world[16]);
void gltf_read_sky(gltf_asset &asset);
void gltf_add_profile(gltf_asset &asset, int node, const double world[16]); /* EXT_lights_ies; gltf_light_profile.cpp */

/* ---- gltf_variants.cpp: light that variants of a primitive share ---- */
/* Materials that stand in for a material seen from afar (MSFT_lod). */
std::vector<int> gltf_material_levels(const gltf_asset &asset, int material);
bool gltf_has_variants(const gltf_asset &asset, const gltf_instance &instance);
void gltf_variant_factor(const gltf_asset &asset, uint32_t material, double factor[3]);
void gltf_prepare_variants(gltf_asset &asset, hemi_texture_fn texture); /* texture: of asset.shadings->of_mesh */
bool gltf_show_variants(const gltf_asset &asset, uint32_t mesh, hemi_mesh_desc &out); /* sets its texture */

/* ---- gltf_unlit.cpp: what shows its colour whatever falls on it ---- */
bool gltf_is_baked(const gltf_asset &asset); /* by a bake before */
bool gltf_is_unlit(const tinygltf::Material &material);
void gltf_find_backdrops(gltf_asset &asset);

/* What is said of an unlit material: what has it stands in the way of light unless it is a backdrop, or is left out.
 * After gltf_find_backdrops. */
std::string gltf_unlit_note(const gltf_asset &asset, uint32_t material);

/* ---- gltf_scene.cpp: the walk through the scene ---- */
void gltf_walk_scene(gltf_asset &asset, const gltf_limits &limits);
void gltf_local_transform(const tinygltf::Node &node, double *out); /* node to parent */

/* ---- gltf_steering.cpp: what extras ask of a bake ---- */
gltf_steering gltf_read_steering(gltf_asset &asset, const tinygltf::Value &extras, const std::string &subject,
                                 bool of_material);
/* Of a node, with what is above it. */
gltf_steering gltf_steer(gltf_asset &asset, int node, const gltf_steering &above);
/* With what their materials ask, and notes of what comes of it. */
void gltf_steer_instances(gltf_asset &asset);
void gltf_steer_emission(const tinygltf::Material &material, double emission[3]);

/* ---- gltf_material.cpp ---- */
tinygltf::TextureInfo gltf_diffuse_texture(const tinygltf::Material &source);          /* of either shading model */
const tinygltf::Material &gltf_find_material(const gltf_asset &asset, uint32_t index); /* out of range: the default */
bool gltf_shows_emission(const gltf_asset &asset, const tinygltf::Material &material); /* gltf_asset_show_emission */
double gltf_base_factor(const tinygltf::Material &source, size_t c); /* of rgba, in either shading model */
double gltf_material_emission(const tinygltf::Material &source, size_t c);
double gltf_metal_share(const gltf_asset &asset); /* of specular colour times roughness^2 */

/* By its name as it is: to look it up as a string would take memory, which those who ask have no way to lack. */
template <typename map_t> const tinygltf::Value *gltf_find_named(const map_t &map, const char *name) {
    for (const auto &[key, value] : map)
        if (key == name) return &value;
    return nullptr;
}

/* A number that an extension gives: its member, or with index >= 0 an element of it. */
double gltf_extension_number(const tinygltf::ExtensionMap &extensions, const char *extension, const char *member,
                             int index, double fallback);

/* What an element of the document's `materials` becomes once its light is baked; source NULL: the default material. */
gltf_json gltf_unlit_material(const gltf_asset &asset, const tinygltf::Material &material, const cJSON *source,
                              bool textured, double shown_alpha);

/* A texture info that an extension holds; without the member its index is -1. */
tinygltf::TextureInfo gltf_extension_texture(const tinygltf::Value &holder, const char *member);

/* ---- gltf_compact.cpp: only what is used goes into the buffer of the output ---- */

/* The lists of a document whose elements are named by their number. */
enum gltf_list_kind {
    gltf_accessors,
    gltf_views,
    gltf_meshes,
    gltf_nodes,
    gltf_materials,
    gltf_textures,
    gltf_images,
    gltf_samplers,
    gltf_list_count
};

/* A document being written. */
struct gltf_draft {
    const gltf_asset &asset;
    gltf_json document;                             /* a copy of the asset's, edited */
    std::vector<cJSON *> lists[gltf_list_count]{};  /* its elements: first those of the asset, then fresh ones */
    std::vector<char> was_named[gltf_list_count]{}; /* was_named[list][i]: the asset itself used element i */
    bool keeps_numbers = false; /* an extension that nobody here knows may name accessors, views, textures, meshes */
    std::vector<std::vector<unsigned char>> fresh{}; /* bytes of buffer view asset.model.bufferViews.size() + i */
    std::vector<const unsigned char *> bytes{};      /* of every view of the output, once they are placed */
    std::vector<size_t> kept_users{}; /* of the asset's meshes: copies of nodes that show them as they were */
    gltf_output stats{};

    explicit gltf_draft(const gltf_asset &source);
};

/* Adds to a list, making it if there is none; the element's number. */
int gltf_add_element(gltf_draft &draft, gltf_list_kind list, gltf_json element);
int gltf_add_view(gltf_draft &draft, std::vector<unsigned char> bytes, int target); /* target 0: none */

void gltf_replace_element(gltf_draft &draft, gltf_list_kind list, size_t i, gltf_json element);

/* Removes element i from its list: NULL stands in its place until the list is closed. */
void gltf_remove_element(gltf_draft &draft, gltf_list_kind list, size_t i);

/* Takes the gaps out of a list; moved[i] is the new number of element i, -1 if it is gone. */
std::vector<int> gltf_close_list(gltf_draft &draft, gltf_list_kind list);

/* Packs images, drops what nothing uses, renumbers the rest; how many bytes the one buffer has, and the bytes. */
size_t gltf_compact(gltf_draft &draft);
void gltf_copy_views(const gltf_draft &draft, unsigned char *to);

/* ---- gltf_bake.cpp: new geometry and materials for what was baked ---- */
void gltf_apply_bake(gltf_draft &draft, const gltf_write_desc &desc);

/* ---- gltf_part_scenes.cpp: scenes that share nodes with the one that is baked ---- */
std::vector<int> gltf_shared_roots(const gltf_asset &asset, int scene);
void gltf_part_scenes(gltf_draft &draft);

/* ---- gltf_meshes.cpp: which node shows which mesh once copies have light of their own ---- */
/* Sets mesh_copies. */
void gltf_count_mesh_copies(gltf_asset &asset);

/* meshes[i]: the mesh of the draft that shows instance i of the asset; -1: it is not baked. */
std::vector<int> gltf_separate_meshes(gltf_draft &draft, const gltf_write_desc &desc);
void gltf_drop_empty_meshes(gltf_draft &draft);

/* The attributes of one baked primitive, ready to be written. */
struct gltf_baked_primitive {
    const hemi_mesh_view *view;
    std::vector<float> colors; /* in [0,1], color_width a vertex; empty: no COLOR_0 */
    int color_width;           /* 3; 4 where COLOR_0's alpha is part of the mask */
    bool float_colors, has_variants;
    const float *radiosity, *errors; /* NULL: none */
    std::vector<gltf_attribute> transferred, lights;
    double scale; /* how much the transforms of its nodes stretch at most */
    std::string where;
};

/* ---- gltf_bake_posed.cpp: what is skinned or morphed gets light on its own vertices ---- */

/* Adds the light to a primitive that stays as it is. The backs of a double-sided one become a primitive beside it,
 * which is returned; NULL: there is none. */
cJSON *gltf_light_posed(gltf_draft &draft, const gltf_instance &instance, const gltf_baked_primitive &baked,
                        cJSON *mesh, cJSON *primitive);

/* ---- gltf_attribute_transfer.cpp: attributes at the vertices of a bake ---- */
void gltf_transfer_alpha(const gltf_geometry &source, gltf_baked_primitive &out); /* widens colors, if there is alpha */
void gltf_transfer_attributes(const gltf_geometry &source, bool lit, gltf_baked_primitive &out);

/* ---- gltf_encode.cpp: a baked primitive as accessors, plain or Draco ---- */

/* What Draco's quantisation of an attribute spans: from origin on, range in every component. */
struct gltf_grid {
    float origin[4], range;
    int bits = 0; /* of positions on a step that meshes share; 0: as many as are asked for */
};
using gltf_grids = std::map<std::string, gltf_grid>;

/* gltf_write_desc.draco_bits of positions, or as many as they have where none are asked for. */
int gltf_position_bits(const int *bits);

/* The step that meshes of so many units across share, so that what meets before Draco meets after it: a power of two,
 * of which the largest of them has two bits more than are asked for. 0: there is one mesh, or its floats are too short.
 */
double gltf_shared_step(const std::vector<double> &extents, int bits);

/* One grid an attribute for all primitives of a mesh, for the same reason; positions lie at multiples of the shared
 * step, or of a smaller one where the mesh is small. */
gltf_grids gltf_shared_grids(const std::vector<gltf_baked_primitive> &primitives, double shared_step, int bits);

/* A baked primitive in accessors. */
struct gltf_encoded_primitive {
    std::map<std::string, int> attributes;
    int indices = -1;
    int draco_view = -1; /* the buffer view of KHR_draco_mesh_compression, and its own ids of the attributes */
    std::map<std::string, int> draco_ids;
};
/* Accessors of a baked primitive: COLOR_0 of vertices from one on, three floats each, corners of triangles. */
int gltf_add_colors(gltf_draft &draft, const gltf_baked_primitive &baked, size_t first, size_t count);
int gltf_add_floats(gltf_draft &draft, const float *values, size_t count, int components);
int gltf_add_triangles(gltf_draft &draft, const uint32_t *indices, size_t count, uint32_t vertex_count);

/* Adds it to what the output says of itself. */
uint64_t gltf_plain_bytes(const gltf_baked_primitive &baked);
void gltf_count_geometry(gltf_output &stats, const gltf_baked_primitive &baked, uint64_t vertices, uint64_t bytes);

/* A baked primitive, and the grids of its mesh. */
struct gltf_to_encode {
    const gltf_baked_primitive *baked;
    const gltf_grids *grids;
};

/* Of each, in their order. */
std::vector<gltf_encoded_primitive> gltf_encode(gltf_draft &draft, const std::vector<gltf_to_encode> &list,
                                                const gltf_write_desc &desc);

#endif
