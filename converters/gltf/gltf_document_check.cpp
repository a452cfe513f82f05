/* SPDX-License-Identifier: MIT
 * Does the document have the members that glTF demands, and is every index, count and offset a number that fits?
 * Messages name the place, which tinygltf's do not.
 */
#include "gltf_model.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstring>

/* tinygltf recurses through extras and extensions. */
static const int nesting_max = 128;

/* Names come from the file: what could break a line of output is replaced. */
[[noreturn]] static void fail(const std::string &where, const char *what, hemi_result code = HEMI_ERROR_DATA) {
    gltf_fail(code, "%s %s", gltf_printable(where, 255).c_str(), what);
}

static bool is_one_of(const char *name, std::initializer_list<const char *> list) {
    return name && std::any_of(list.begin(), list.end(), [name](const char *one) { return !std::strcmp(name, one); });
}

/* ---- indices are indices ---------------------------------------------------------------------------------------- */

/* A place in the document, such as nodes[3].children[1]. */
struct place {
    const place *parent; /* null: the root */
    const cJSON *item;
    int index;
    int depth;
};

static std::string text_of(const place &at) {
    if (!at.parent) return "";
    std::string before = text_of(*at.parent);
    if (!at.item->string) return before + gltf_text("[%d]", at.index);
    return before + (before.empty() ? "" : ".") + at.item->string;
}

static bool is_index_member(const char *name) {
    return is_one_of(name, { "mesh",     "camera",     "skin",    "node",          "material",
                             "indices",  "bufferView", "buffer",  "byteOffset",    "input",
                             "output",   "source",     "sampler", "index",         "count",
                             "skeleton", "byteLength", "scene",   "mode",          "target",
                             "texCoord", "byteStride", "light",   "componentType", "inverseBindMatrices" });
}

static bool is_index(const cJSON *item) {
    return cJSON_IsNumber(item) && item->valuedouble >= 0 && item->valuedouble <= INT_MAX &&
           item->valuedouble == double(int(item->valuedouble));
}

/* How much of a part of the document is ours to judge. */
enum judged { NOTHING, NUMBERS /* members that are not numbers may mean something else */, ALL };

/* Extensions whose numbers tinygltf would truncate to 32 bits and we would believe. */
static bool is_read_extension(const char *name) {
    return is_one_of(name, { "KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_mesh_gpu_instancing",
                             "KHR_texture_basisu", "KHR_texture_transform", "EXT_texture_webp", "EXT_texture_avif",
                             "MSFT_texture_dds", "KHR_lights_punctual", "EXT_lights_image_based" }) ||
           (name && std::strncmp(name, "KHR_materials_", 14) == 0);
}

static bool is_root_member(const char *name) {
    return is_one_of(name, { "accessors", "animations", "bufferViews", "buffers", "cameras", "images", "materials",
                             "meshes", "nodes", "samplers", "scenes", "skins", "textures", "extensions" });
}

static judged judge_member(judged parent, const cJSON *holder, const cJSON *item, bool at_root) {
    if (at_root && !is_root_member(item->string)) return NOTHING;
    if (is_one_of(item->string, { "extras" })) return NOTHING;
    if (is_one_of(holder->string, { "extensions" }))
        return parent != NOTHING && is_read_extension(item->string) ? NUMBERS : NOTHING;
    return parent;
}

/* Whether a member that holds an index in glTF holds something else. */
static bool breaks_index(const cJSON *parent, const cJSON *item, judged checked, bool attributes) {
    if (checked == NOTHING || (checked == NUMBERS && !cJSON_IsNumber(item))) return false;
    if (attributes || is_one_of(parent->string, { "children", "joints" })) return !is_index(item);
    if (!is_index_member(item->string)) return false;
    return !cJSON_IsObject(item) && !is_index(item); /* `indices` and `target` are objects in some places */
}

/* Of two members of one name, one reader takes the first and another the last. [glTF 2.0, section 2.7.3] */
static void check_names(const place &at) {
    std::vector<const char *> names;
    for (const cJSON *item : gltf_elements(at.item)) names.push_back(item->string);
    std::sort(names.begin(), names.end(), [](const char *a, const char *b) { return std::strcmp(a, b) < 0; });
    auto twice = std::adjacent_find(names.begin(), names.end(), [](auto a, auto b) { return !std::strcmp(a, b); });
    if (twice == names.end()) return;
    std::string where = text_of(at);
    fail(where + (where.empty() ? "" : ".") + *twice, "is there twice; export the file again");
}

/* Walks the tree below a place. */
static void check_tree(const place &at, judged checked, bool attributes) {
    if (at.depth > nesting_max) fail(text_of(at), "is nested too deeply; flatten it");
    if (checked != NOTHING && cJSON_IsObject(at.item)) check_names(at);
    const cJSON *parent = at.item;
    int index = 0;
    for (const cJSON *item : gltf_elements(parent)) {
        place inner = { &at, item, index++, at.depth + 1 };
        if (cJSON_IsNumber(item) && !std::isfinite(item->valuedouble)) fail(text_of(inner), "is not finite");
        if (breaks_index(parent, item, checked, attributes))
            fail(text_of(inner), "is not an integer from 0 to 2147483647");
        if (!cJSON_IsArray(item) && !cJSON_IsObject(item)) continue;
        bool dictionary = (is_one_of(item->string, { "attributes" }) && cJSON_IsObject(item)) ||
                          (is_one_of(parent->string, { "targets" }) && cJSON_IsArray(parent));
        check_tree(inner, judge_member(checked, parent, item, at.depth == 0), dictionary);
    }
}

/* ---- what must be there ----------------------------------------------------------------------------------------- */

struct required_member {
    const char *list, *member;
    int type; /* cJSON_Number, cJSON_String, cJSON_Array; cJSON_Invalid: the list's elements only */
};

static const required_member required_members[] = {
    { "buffers", "byteLength", cJSON_Number },     { "bufferViews", "buffer", cJSON_Number },
    { "bufferViews", "byteLength", cJSON_Number }, { "accessors", "componentType", cJSON_Number },
    { "accessors", "count", cJSON_Number },        { "accessors", "type", cJSON_String },
    { "meshes", "primitives", cJSON_Array },       { "animations", "channels", cJSON_Array },
    { "animations", "samplers", cJSON_Array },     { "skins", "joints", cJSON_Array },
    { "nodes", nullptr, cJSON_Invalid },           { "scenes", nullptr, cJSON_Invalid },
    { "materials", nullptr, cJSON_Invalid },       { "textures", nullptr, cJSON_Invalid },
    { "images", nullptr, cJSON_Invalid },          { "samplers", nullptr, cJSON_Invalid },
    { "cameras", "type", cJSON_String },
};

/* check(element, its place) for every element of a list. */
template <typename Check> static void each(const cJSON *list, const std::string &name, Check check) {
    int index = 0;
    for (const cJSON *element : gltf_elements(list)) check(element, name + gltf_text("[%d]", index++));
}

static void check_required(const cJSON *root, const required_member &rule) {
    const cJSON *list = gltf_member(root, rule.list);
    if (list && !cJSON_IsArray(list)) fail(rule.list, "is not an array");
    each(list, rule.list, [&rule](const cJSON *element, const std::string &where) {
        if (!cJSON_IsObject(element)) fail(where, "is not an object");
        if (!rule.member) return;
        const cJSON *member = gltf_member(element, rule.member);
        if (!member) fail(where + "." + rule.member, "is missing");
        if ((member->type & 0xFF) != rule.type) fail(where + "." + rule.member, "has the wrong type");
    });
}

static void check_asset(const cJSON *root) {
    const cJSON *version = gltf_member(gltf_member(root, "asset"), "version");
    if (!cJSON_IsString(version)) fail("asset.version", "is missing; this is not a glTF 2.0 file");
    if (std::strncmp(version->valuestring, "2.", 2) != 0)
        fail("asset.version", "is not 2.0; convert the file to glTF 2.0", HEMI_ERROR_UNSUPPORTED);
}

/* How many bytes a data URI holds; 0 if it is not base64. */
static double base64_size(const char *uri) {
    const char *data = std::strstr(uri, ";base64,");
    if (!data) return 0;
    data += std::strlen(";base64,");
    size_t size = std::strlen(data);
    while (size > 0 && data[size - 1] == '=') size--;
    return std::floor(double(size) * 3 / 4);
}

static void check_buffer(const cJSON *buffer, const std::string &where, bool in_chunk) {
    const cJSON *uri = gltf_member(buffer, "uri");
    if (!(uri ? cJSON_IsString(uri) && uri->valuestring[0] : in_chunk || gltf_is_fallback(buffer)))
        fail(where + ".uri", "is missing; only the first buffer of a .glb may do without");
    double length = gltf_member(buffer, "byteLength")->valuedouble;
    if (length < 1) fail(where + ".byteLength", "is zero");
    if (uri && std::strncmp(uri->valuestring, "data:", 5) == 0 && base64_size(uri->valuestring) != length)
        fail(where + ".uri", "is not a base64 data URI of byteLength bytes");
}

static void check_image(const cJSON *image, const std::string &where) {
    const cJSON *uri = gltf_member(image, "uri");
    if (uri && !cJSON_IsString(uri)) fail(where + ".uri", "has the wrong type");
}

static void check_sparse(const cJSON *accessor, const std::string &where) {
    const cJSON *sparse = gltf_member(accessor, "sparse");
    const cJSON *indices = gltf_member(sparse, "indices"), *values = gltf_member(sparse, "values");
    auto has = [](const cJSON *object, const char *name) { return cJSON_IsNumber(gltf_member(object, name)); };
    if (sparse && !(has(sparse, "count") && has(indices, "bufferView") && has(indices, "componentType") &&
                    has(values, "bufferView")))
        fail(where + ".sparse", "lacks count, or a bufferView or componentType in its indices or values");
}

/* What tinygltf refuses without a place. */
static void check_accessor_type(const cJSON *accessor, const std::string &where) {
    int type = gltf_index(accessor, "componentType");
    if (type < 5120 || type == 5124 || type > 5126)
        fail(where + ".componentType", "is none of 5120 to 5123, 5125, 5126");
    if (!is_one_of(gltf_member(accessor, "type")->valuestring,
                   { "SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4" }))
        fail(where + ".type", "is none of SCALAR, VEC2 to VEC4, MAT2 to MAT4");
}

static void check_light(const cJSON *light, const std::string &where) {
    if (!cJSON_IsString(gltf_member(light, "type"))) fail(where + ".type", "is missing or is no string");
}

static void check_view(const cJSON *view, const std::string &where, int buffers) {
    gltf_check_index(gltf_index(view, "buffer"), size_t(buffers), "buffers", where + ".buffer");
}

static void check_mesh(const cJSON *mesh, const std::string &where, int accessors) {
    const cJSON *primitives = gltf_member(mesh, "primitives");
    each(primitives, where + ".primitives", [accessors](const cJSON *primitive, const std::string &at) {
        const cJSON *indices = gltf_member(primitive, "indices");
        if (!cJSON_IsObject(gltf_member(primitive, "attributes"))) fail(at + ".attributes", "is missing");
        if (indices && !(cJSON_IsNumber(indices) && indices->valueint < accessors))
            fail(at + ".indices", "names an accessor that does not exist");
    });
}

/* tinygltf would take the default in silence, or refuse a wrong number of numbers without a place. */
static void check_factor(const cJSON *holder, const std::string &where, const char *name, int count, const char *what) {
    const cJSON *factor = gltf_member(holder, name);
    if (!factor) return;
    bool numbers = cJSON_IsArray(factor) && cJSON_GetArraySize(factor) == count;
    for (const cJSON *number : gltf_elements(factor)) numbers = numbers && cJSON_IsNumber(number);
    if (!numbers) fail(where + "." + name, what);
}

static void check_colors(const cJSON *material, const std::string &where) {
    const cJSON *pbr = gltf_member(material, "pbrMetallicRoughness");
    if (pbr && !cJSON_IsObject(pbr)) fail(where + ".pbrMetallicRoughness", "is not an object");
    check_factor(pbr, where + ".pbrMetallicRoughness", "baseColorFactor", 4, "is not four numbers");
    check_factor(material, where, "emissiveFactor", 3, "is not three numbers");
}

void gltf_check_document(const cJSON *root, bool glb) {
    if (!cJSON_IsObject(root)) fail("the JSON", "is not an object");
    check_asset(root);
    check_tree({ nullptr, root, 0, 0 }, ALL, false);
    for (const required_member &rule : required_members) check_required(root, rule);
    const cJSON *buffers = gltf_member(root, "buffers"), *accessors = gltf_member(root, "accessors");
    each(buffers, "buffers", [&](const cJSON *buffer, const std::string &where) {
        check_buffer(buffer, where, glb && buffer == buffers->child);
    });
    each(gltf_member(root, "images"), "images", check_image);
    each(accessors, "accessors", check_accessor_type);
    each(gltf_member(gltf_extension(root, "KHR_lights_punctual"), "lights"), "extensions.KHR_lights_punctual.lights",
         check_light);
    int buffer_count = cJSON_GetArraySize(buffers), accessor_count = cJSON_GetArraySize(accessors);
    each(gltf_member(root, "bufferViews"), "bufferViews",
         [=](const cJSON *view, const std::string &where) { check_view(view, where, buffer_count); });
    each(accessors, "accessors", check_sparse);
    each(gltf_member(root, "meshes"), "meshes",
         [=](const cJSON *mesh, const std::string &where) { check_mesh(mesh, where, accessor_count); });
    each(gltf_member(root, "materials"), "materials", check_colors);
}
