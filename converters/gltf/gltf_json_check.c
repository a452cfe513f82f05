/* SPDX-License-Identifier: MIT
 * Does the JSON have the members that glTF demands, and is every index, count and offset a number that fits? Messages
 * name the place, which tinygltf's do not.
 */
#include "gltf_json.h"

#include <cjson/cJSON.h>

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NESTING_MAX = 128, PATH_SIZE = 256 };

/* A place in the document, such as nodes[3].children[1]. */
typedef struct json_path {
    char text[PATH_SIZE];
    size_t length;
} json_path;

static void path_add(json_path *path, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int added = vsnprintf(path->text + path->length, PATH_SIZE - path->length, format, arguments);
    va_end(arguments);
    path->length += (size_t)(added > 0 ? added : 0);
    if (path->length > PATH_SIZE - 1) path->length = PATH_SIZE - 1;
}

static void path_cut(json_path *path, size_t length) {
    path->length = length;
    path->text[length] = '\0';
}

static void path_enter(json_path *path, const cJSON *item, int index) {
    if (item->string)
        path_add(path, path->length ? ".%s" : "%s", item->string);
    else
        path_add(path, "[%d]", index);
}

/* Names come from the file: what could break a line of output is replaced. */
static hemi_result fail(char *message, const char *where, const char *what) {
    snprintf(message, GLTF_MESSAGE_SIZE, "%s %s", where, what);
    for (char *c = message; *c; c++)
        if ((unsigned char)*c < ' ' || *c == 127) *c = '?';
    return HEMI_ERROR_DATA;
}

/* ---- before reading: indices are indices ------------------------------------------------------------------------ */

static bool is_one_of(const char *name, const char *const *list) {
    for (; name && *list; list++)
        if (strcmp(name, *list) == 0) return true;
    return false;
}

static const char *const index_members[] = {
    "mesh",       "camera",     "skin",   "node",   "material", "indices",  "bufferView",    "buffer",
    "byteOffset", "input",      "output", "source", "sampler",  "index",    "count",         "inverseBindMatrices",
    "skeleton",   "byteLength", "scene",  "mode",   "target",   "texCoord", "componentType", "byteStride",
    "light",      NULL
};
static const char *const index_lists[] = { "children", "joints", NULL };

static bool is_index(const cJSON *item) {
    return cJSON_IsNumber(item) && item->valuedouble >= 0 && item->valuedouble <= INT_MAX &&
           item->valuedouble == (double)(int)item->valuedouble;
}

/* How much of a part of the document is ours to judge. */
typedef enum judged { NOTHING, NUMBERS /* members that are not numbers may mean something else */, ALL } judged;

/* Extensions whose numbers tinygltf would cut to 32 bits and we would believe. */
static bool is_read_extension(const char *name) {
    static const char *const read[] = { "KHR_draco_mesh_compression",
                                        "EXT_meshopt_compression",
                                        "EXT_mesh_gpu_instancing",
                                        "KHR_texture_basisu",
                                        "KHR_texture_transform",
                                        "EXT_texture_webp",
                                        "EXT_texture_avif",
                                        "MSFT_texture_dds",
                                        "KHR_lights_punctual",
                                        "EXT_lights_image_based",
                                        NULL };
    return is_one_of(name, read) || (name && strncmp(name, "KHR_materials_", 14) == 0);
}

static const char *const root_members[] = { "accessors", "animations", "bufferViews", "buffers",    "cameras",
                                            "images",    "materials",  "meshes",      "nodes",      "samplers",
                                            "scenes",    "skins",      "textures",    "extensions", NULL };

static judged judge_member(judged parent, const cJSON *holder, const cJSON *item, bool at_root) {
    if (at_root && !is_one_of(item->string, root_members)) return NOTHING;
    if (item->string && strcmp(item->string, "extras") == 0) return NOTHING;
    if (holder->string && strcmp(holder->string, "extensions") == 0)
        return parent != NOTHING && is_read_extension(item->string) ? NUMBERS : NOTHING;
    return parent;
}

/* Whether a member that holds an index in glTF holds something else. */
static bool breaks_index(const cJSON *parent, const cJSON *item, judged checked, bool attributes) {
    if (checked == NOTHING || (checked == NUMBERS && !cJSON_IsNumber(item))) return false;
    if (attributes || is_one_of(parent->string, index_lists)) return !is_index(item);
    if (!is_one_of(item->string, index_members)) return false;
    return !cJSON_IsObject(item) && !is_index(item); /* `indices` and `target` are objects in some places */
}

/* Walks the tree below parent. */
static hemi_result check_tree(const cJSON *parent, json_path *path, int depth, judged checked, bool attributes,
                              char *message) {
    if (depth > NESTING_MAX) return fail(message, path->text, "is nested too deeply; flatten it");
    const cJSON *item;
    int index = 0;
    size_t length = path->length;
    cJSON_ArrayForEach(item, parent) {
        path_enter(path, item, index++);
        if (cJSON_IsNumber(item) && !isfinite(item->valuedouble)) return fail(message, path->text, "is not finite");
        if (breaks_index(parent, item, checked, attributes))
            return fail(message, path->text, "is not an integer from 0 to 2147483647");
        if (cJSON_IsArray(item) || cJSON_IsObject(item)) {
            judged inside = judge_member(checked, parent, item, depth == 0);
            bool dictionary = (item->string && !strcmp(item->string, "attributes") && cJSON_IsObject(item)) ||
                              (parent->string && !strcmp(parent->string, "targets") && cJSON_IsArray(parent));
            hemi_result result = check_tree(item, path, depth + 1, inside, dictionary, message);
            if (result != HEMI_OK) return result;
        }
        path_cut(path, length);
    }
    return HEMI_OK;
}

/* ---- before reading: what must be there ------------------------------------------------------------------------- */

typedef struct required_member {
    const char *list, *member;
    int type; /* cJSON_Number, cJSON_String, cJSON_Array; cJSON_Invalid: the list's elements only */
} required_member;

static const required_member required_members[] = {
    { "buffers", "byteLength", cJSON_Number },
    { "bufferViews", "buffer", cJSON_Number },
    { "bufferViews", "byteLength", cJSON_Number },
    { "accessors", "componentType", cJSON_Number },
    { "accessors", "count", cJSON_Number },
    { "accessors", "type", cJSON_String },
    { "meshes", "primitives", cJSON_Array },
    { "animations", "channels", cJSON_Array },
    { "animations", "samplers", cJSON_Array },
    { "skins", "joints", cJSON_Array },
    { "nodes", NULL, cJSON_Invalid },
    { "scenes", NULL, cJSON_Invalid },
    { "materials", NULL, cJSON_Invalid },
    { "textures", NULL, cJSON_Invalid },
    { "images", NULL, cJSON_Invalid },
    { "samplers", NULL, cJSON_Invalid },
    { "cameras", "type", cJSON_String },
};

static hemi_result check_required(const cJSON *root, const required_member *rule, char *message) {
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(root, rule->list), *element;
    if (list && !cJSON_IsArray(list)) return fail(message, rule->list, "is not an array");
    int index = 0;
    cJSON_ArrayForEach(element, list) {
        json_path path = { .length = 0 };
        path_add(&path, "%s[%d]", rule->list, index++);
        if (!cJSON_IsObject(element)) return fail(message, path.text, "is not an object");
        if (!rule->member) continue;
        path_add(&path, ".%s", rule->member);
        const cJSON *member = cJSON_GetObjectItemCaseSensitive(element, rule->member);
        if (!member) return fail(message, path.text, "is missing");
        if ((member->type & 0xFF) != rule->type) return fail(message, path.text, "has the wrong type");
    }
    return HEMI_OK;
}

static hemi_result check_asset(const cJSON *root, char *message) {
    const cJSON *asset = cJSON_GetObjectItemCaseSensitive(root, "asset");
    const cJSON *version = cJSON_GetObjectItemCaseSensitive(asset, "version");
    if (!cJSON_IsString(version)) return fail(message, "asset.version", "is missing; this is not a glTF 2.0 file");
    if (strncmp(version->valuestring, "2.", 2) != 0) {
        fail(message, "asset.version", "is not 2.0; convert the file to glTF 2.0");
        return HEMI_ERROR_UNSUPPORTED;
    }
    return HEMI_OK;
}

/* How many bytes a data URI holds; 0 if it is not base64. */
static double base64_size(const char *uri) {
    const char *data = strstr(uri, ";base64,");
    if (!data) return 0;
    data += strlen(";base64,");
    size_t size = strlen(data);
    while (size > 0 && data[size - 1] == '=') size--;
    return floor((double)size * 3 / 4);
}

static hemi_result check_buffers(const cJSON *root, bool glb, char *message) {
    const cJSON *buffer;
    int index = 0;
    cJSON_ArrayForEach(buffer, cJSON_GetObjectItemCaseSensitive(root, "buffers")) {
        json_path path = { .length = 0 };
        path_add(&path, "buffers[%d].", index);
        const cJSON *uri = cJSON_GetObjectItemCaseSensitive(buffer, "uri");
        if (!(uri ? cJSON_IsString(uri) && uri->valuestring[0]
                  : (glb && index == 0) || gltf_json_is_fallback(buffer))) {
            path_add(&path, "uri");
            return fail(message, path.text, "is missing; only the first buffer of a .glb may do without");
        }
        double length = cJSON_GetObjectItemCaseSensitive(buffer, "byteLength")->valuedouble;
        if (length < 1) {
            path_add(&path, "byteLength");
            return fail(message, path.text, "is zero");
        }
        if (uri && strncmp(uri->valuestring, "data:", 5) == 0 && base64_size(uri->valuestring) != length) {
            path_add(&path, "uri");
            return fail(message, path.text, "is not a base64 data URI of byteLength bytes");
        }
        index++;
    }
    return HEMI_OK;
}

static bool has_number(const cJSON *object, const char *name) {
    return cJSON_IsNumber(cJSON_GetObjectItemCaseSensitive(object, name));
}

static hemi_result check_sparse(const cJSON *root, char *message) {
    const cJSON *accessor;
    int index = 0;
    cJSON_ArrayForEach(accessor, cJSON_GetObjectItemCaseSensitive(root, "accessors")) {
        json_path path = { .length = 0 };
        path_add(&path, "accessors[%d].sparse", index++);
        const cJSON *sparse = cJSON_GetObjectItemCaseSensitive(accessor, "sparse");
        const cJSON *indices = cJSON_GetObjectItemCaseSensitive(sparse, "indices");
        const cJSON *values = cJSON_GetObjectItemCaseSensitive(sparse, "values");
        if (sparse && !(has_number(sparse, "count") && has_number(indices, "bufferView") &&
                        has_number(indices, "componentType") && has_number(values, "bufferView")))
            return fail(message, path.text, "lacks count, or a bufferView or componentType in its indices or values");
    }
    return HEMI_OK;
}

/* What tinygltf refuses without a place. */
static hemi_result check_accessor_types(const cJSON *root, char *message) {
    static const char *const known[] = { "SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4", NULL };
    const cJSON *accessor;
    int index = 0;
    cJSON_ArrayForEach(accessor, cJSON_GetObjectItemCaseSensitive(root, "accessors")) {
        json_path path = { .length = 0 };
        path_add(&path, "accessors[%d].componentType", index++);
        int type = cJSON_GetObjectItemCaseSensitive(accessor, "componentType")->valueint;
        if (type < 5120 || type == 5124 || type > 5126)
            return fail(message, path.text, "is none of 5120 to 5123, 5125, 5126");
        path_cut(&path, 0);
        path_add(&path, "accessors[%d].type", index - 1);
        if (!is_one_of(cJSON_GetObjectItemCaseSensitive(accessor, "type")->valuestring, known))
            return fail(message, path.text, "is none of SCALAR, VEC2 to VEC4, MAT2 to MAT4");
    }
    return HEMI_OK;
}

static hemi_result check_lights(const cJSON *root, char *message) {
    const cJSON *extensions = cJSON_GetObjectItemCaseSensitive(root, "extensions"), *light;
    const cJSON *punctual = cJSON_GetObjectItemCaseSensitive(extensions, "KHR_lights_punctual");
    int index = 0;
    cJSON_ArrayForEach(light, cJSON_GetObjectItemCaseSensitive(punctual, "lights")) {
        json_path path = { .length = 0 };
        path_add(&path, "extensions.KHR_lights_punctual.lights[%d].type", index++);
        if (!cJSON_IsString(cJSON_GetObjectItemCaseSensitive(light, "type")))
            return fail(message, path.text, "is missing or is no string");
    }
    return HEMI_OK;
}

static hemi_result check_views(const cJSON *root, char *message) {
    const cJSON *view;
    int index = 0, buffers = cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(root, "buffers"));
    cJSON_ArrayForEach(view, cJSON_GetObjectItemCaseSensitive(root, "bufferViews")) {
        json_path path = { .length = 0 };
        path_add(&path, "bufferViews[%d].byteStride", index++);
        const cJSON *stride = cJSON_GetObjectItemCaseSensitive(view, "byteStride");
        int buffer = cJSON_GetObjectItemCaseSensitive(view, "buffer")->valueint;
        if (buffer >= buffers) {
            snprintf(message, GLTF_MESSAGE_SIZE, "bufferViews[%d].buffer is %d, but there are %d buffers", index - 1,
                     buffer, buffers);
            return HEMI_ERROR_DATA;
        }
        if (stride && (stride->valueint % 4 != 0 || stride->valueint > 252))
            return fail(message, path.text, "is not a multiple of 4 up to 252");
    }
    return HEMI_OK;
}

static hemi_result check_primitive(const cJSON *primitive, int accessor_count, json_path path, char *message) {
    size_t length = path.length;
    path_add(&path, ".attributes");
    if (!cJSON_IsObject(cJSON_GetObjectItemCaseSensitive(primitive, "attributes")))
        return fail(message, path.text, "is missing");
    path_cut(&path, length);
    path_add(&path, ".indices");
    const cJSON *indices = cJSON_GetObjectItemCaseSensitive(primitive, "indices");
    if (indices && !(cJSON_IsNumber(indices) && indices->valueint < accessor_count))
        return fail(message, path.text, "names an accessor that does not exist");
    return HEMI_OK;
}

static hemi_result check_primitives(const cJSON *root, char *message) {
    const cJSON *mesh, *primitive;
    int m = 0, accessor_count = cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(root, "accessors"));
    cJSON_ArrayForEach(mesh, cJSON_GetObjectItemCaseSensitive(root, "meshes")) {
        int p = 0;
        cJSON_ArrayForEach(primitive, cJSON_GetObjectItemCaseSensitive(mesh, "primitives")) {
            json_path path = { .length = 0 };
            path_add(&path, "meshes[%d].primitives[%d]", m, p++);
            hemi_result result = check_primitive(primitive, accessor_count, path, message);
            if (result != HEMI_OK) return result;
        }
        if (p == 0) {
            json_path path = { .length = 0 };
            path_add(&path, "meshes[%d].primitives", m);
            return fail(message, path.text, "is empty");
        }
        m++;
    }
    return HEMI_OK;
}

static bool is_list_of_numbers(const cJSON *list, int count) {
    const cJSON *number;
    if (!cJSON_IsArray(list) || cJSON_GetArraySize(list) != count) return false;
    cJSON_ArrayForEach(number, list) if (!cJSON_IsNumber(number)) return false;
    return true;
}

/* tinygltf would take the default in silence. */
static hemi_result check_colors(const cJSON *root, char *message) {
    const cJSON *material;
    int index = 0;
    cJSON_ArrayForEach(material, cJSON_GetObjectItemCaseSensitive(root, "materials")) {
        json_path path = { .length = 0 };
        path_add(&path, "materials[%d].pbrMetallicRoughness.baseColorFactor", index++);
        const cJSON *pbr = cJSON_GetObjectItemCaseSensitive(material, "pbrMetallicRoughness");
        if (pbr && !cJSON_IsObject(pbr)) {
            path_cut(&path, path.length - strlen(".baseColorFactor"));
            return fail(message, path.text, "is not an object");
        }
        const cJSON *factor = cJSON_GetObjectItemCaseSensitive(pbr, "baseColorFactor");
        if (factor && !is_list_of_numbers(factor, 4)) return fail(message, path.text, "is not four numbers");
    }
    return HEMI_OK;
}

hemi_result gltf_json_check(const cJSON *root, bool glb, char *message) {
    json_path path = { .length = 0 };
    if (!cJSON_IsObject(root)) return fail(message, "the JSON", "is not an object");
    hemi_result result = check_asset(root, message);
    if (result == HEMI_OK) result = check_tree(root, &path, 0, ALL, false, message);
    for (size_t i = 0; result == HEMI_OK && i < sizeof required_members / sizeof *required_members; i++)
        result = check_required(root, &required_members[i], message);
    if (result == HEMI_OK) result = check_buffers(root, glb, message);
    if (result == HEMI_OK) result = check_accessor_types(root, message);
    if (result == HEMI_OK) result = check_lights(root, message);
    if (result == HEMI_OK) result = check_views(root, message);
    if (result == HEMI_OK) result = check_sparse(root, message);
    if (result == HEMI_OK) result = check_primitives(root, message);
    if (result == HEMI_OK) result = check_colors(root, message);
    return result;
}
