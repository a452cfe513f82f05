/* SPDX-License-Identifier: MIT
 * How is the document read for tinygltf, and edited? Text and tree are walked together once: cJSON prints 1.0 as 1 and
 * knows integers up to 2^53 only, so numbers and escaped strings of the tree get their text; and the copy for tinygltf
 * differs in a few values:
 *   - numbers are as cJSON prints them: integers written as 1.0 or 1e3 lose point and exponent
 *   - the indices of Draco primitives are -1 (tinygltf refuses accessors without a buffer view there), and restored
 *   - strides that glTF does not allow are 0, and restored
 *   - there are no buffers and images, which gltf_read.cpp reads (tinygltf turns + into a space, refuses files longer
 *     than byteLength, buffers without bytes, and media types beyond seven)
 *   - spots without a cone have an empty one (tinygltf refuses them)
 *   - channels of KHR_animation_pointer that move a node name it (tinygltf drops them)
 *   - control characters in strings are escaped
 *   - extras that nobody here reads are 0
 */
#include "gltf_model.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <new>
#include <unordered_map>

/* ---- members ---------------------------------------------------------------------------------------------------- */

cJSON *gltf_member(const cJSON *object, const char *name) {
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

cJSON *gltf_extension(const cJSON *element, const char *name) {
    return gltf_member(gltf_member(element, "extensions"), name);
}

std::vector<cJSON *> gltf_elements(const cJSON *list) {
    std::vector<cJSON *> elements;
    cJSON *element;
    cJSON_ArrayForEach(element, list) elements.push_back(element);
    return elements;
}

bool gltf_is_number(const cJSON *item) {
    return cJSON_IsNumber(item) || (cJSON_IsRaw(item) && item->valuestring[0] != '"');
}

int gltf_index(const cJSON *object, const char *name) {
    const cJSON *number = gltf_member(object, name);
    return gltf_is_number(number) ? number->valueint : -1;
}

bool gltf_is_texture_info(const cJSON *item) {
    static const char end[] = "Texture";
    size_t length = item->string ? std::strlen(item->string) : 0, size = sizeof end - 1;
    return length >= size && std::strcmp(item->string + length - size, end) == 0 && gltf_index(item, "index") >= 0;
}

/* ---- editing ---------------------------------------------------------------------------------------------------- */

static gltf_json checked(cJSON *item) {
    if (!item) throw std::bad_alloc();
    return gltf_json(item);
}

gltf_json gltf_copy(const cJSON *item) {
    return checked(cJSON_Duplicate(item, true));
}

void gltf_set(cJSON *object, const char *name, gltf_json value) {
    bool placed = gltf_member(object, name) ? cJSON_ReplaceItemInObjectCaseSensitive(object, name, value.get())
                                            : cJSON_AddItemToObject(object, name, value.get());
    if (!placed) throw std::bad_alloc();
    (void)value.release();
}

void gltf_set_text(cJSON *object, const char *name, const char *text) {
    gltf_set(object, name, checked(cJSON_CreateString(text)));
}

void gltf_set_numbers(cJSON *object, const char *name, const double *values, size_t count) {
    gltf_set(object, name, checked(cJSON_CreateDoubleArray(values, int(count))));
}

void gltf_append(cJSON *list, gltf_json element) {
    if (!cJSON_AddItemToArray(list, element.get())) throw std::bad_alloc();
    (void)element.release();
}

void gltf_drop(cJSON *object, const char *name) {
    cJSON_DeleteItemFromObjectCaseSensitive(object, name);
}

void gltf_drop_extension(cJSON *element, const char *name) {
    cJSON *extensions = gltf_member(element, "extensions");
    if (!gltf_member(extensions, name)) return;
    gltf_drop(extensions, name);
    if (!extensions->child) gltf_drop(element, "extensions");
}

void gltf_change_number(cJSON *number, double value) {
    if (number->valuedouble == value) return;
    cJSON_free(number->valuestring);
    number->valuestring = nullptr;
    number->type = cJSON_Number | (number->type & ~0xFF);
    cJSON_SetNumberHelper(number, value);
}

void gltf_set_number(cJSON *object, const char *name, double value) {
    cJSON *number = gltf_member(object, name);
    if (gltf_is_number(number))
        gltf_change_number(number, value);
    else
        gltf_set(object, name, checked(cJSON_CreateNumber(value)));
}

cJSON *gltf_object(cJSON *object, const char *name) {
    if (!cJSON_IsObject(gltf_member(object, name))) gltf_set(object, name, checked(cJSON_CreateObject()));
    return gltf_member(object, name);
}

cJSON *gltf_list(cJSON *object, const char *name) {
    if (!cJSON_IsArray(gltf_member(object, name))) gltf_set(object, name, checked(cJSON_CreateArray()));
    return gltf_member(object, name);
}

/* ---- text and tree together -------------------------------------------------------------------------------------- */

/* The text that stands for a value in tinygltf's copy. */
using edit_map = std::unordered_map<const cJSON *, std::string>;

/* cJSON's idea of space. */
static const char *skip_space(const char *at) {
    while (static_cast<unsigned char>(*at) <= ' ') at++;
    return at;
}

/* Past a string that begins at its quote. */
static const char *skip_string(const char *at) {
    for (at++; *at != '"'; at++)
        if (*at == '\\') at++;
    return at + 1;
}

static void keep_text(cJSON *item, const char *begin, const char *end) {
    size_t size = size_t(end - begin);
    char *text = static_cast<char *>(cJSON_malloc(size + 1));
    if (!text) throw std::bad_alloc();
    std::memcpy(text, begin, size);
    text[size] = '\0';
    cJSON_free(item->valuestring);
    item->valuestring = text;
    item->type = cJSON_Raw | (item->type & ~0xFF);
}

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/* Digits alone, few enough for a double, come out as they went in. */
static bool prints_alike(const char *begin, const char *end) {
    return end - begin < 10 && std::all_of(begin, end, is_digit);
}

/* A fraction of no more digits than a double keeps, printed without an exponent, does too. */
static bool is_short_fraction(const char *at, const char *end, double value) {
    size_t sign = *at == '-', size = size_t(end - at) - sign;
    const char *begin = at + sign, *point = std::find_if_not(begin, end, is_digit);
    bool leads = point > begin && (*begin != '0' || point == begin + 1);
    return leads && size <= 16 && end - point > 1 && *point == '.' && std::all_of(point + 1, end, is_digit) &&
           end[-1] != '0' && std::fabs(value) >= 1e-4;
}

/* As cJSON 1.7 prints it: its own function, which asks for the locale and scans what it has printed, takes twice as
 * long for what is no integer. False: that one is to print it. */
static bool print_fraction(double value, char text[64]) {
    if (!std::isfinite(value) || value == std::floor(value)) return false;
    char *end = std::to_chars(text, text + 63, value, std::chars_format::general, 15).ptr;
    double read = 0;
    std::from_chars(text, end, read);
    double most = std::fmax(std::fabs(read), std::fabs(value));
    if (!(std::fabs(read - value) <= most * std::numeric_limits<double>::epsilon()))
        end = std::to_chars(text, text + 63, value, std::chars_format::general, 17).ptr;
    *end = '\0';
    return true;
}

static bool is_control(char c) {
    return static_cast<unsigned char>(c) < ' ';
}

/* Walks a text that was parsed to the tree, so neither runs out before the other. */
struct text_walk {
    const edit_map &edits;
    const char *copied; /* the text before it is in out already */
    std::string out{};
    int edited = 0; /* how many values around this one are exchanged */

    void exchange(const char *begin, const char *end, const std::string &text) {
        if (edited) return;
        out.append(copied, begin);
        out += text;
        copied = end;
    }
    const char *string(const char *at);
    const char *scalar(cJSON *item, const char *at);
    const char *children(cJSON *item, const char *at);
    const char *value(cJSON *item, const char *at);
};

const char *text_walk::string(const char *at) {
    const char *end = skip_string(at);
    if (edited || std::none_of(at, end, is_control)) return end;
    std::string escaped;
    for (const char *c = at; c < end; c++) escaped += is_control(*c) ? gltf_text("\\u%04x", *c) : std::string(1, *c);
    exchange(at, end, escaped);
    return end;
}

const char *text_walk::scalar(cJSON *item, const char *at) {
    const char *end = at;
    if (*at == '"') {
        end = string(at);
        if (std::memchr(at, '\\', size_t(end - at))) keep_text(item, at, end);
        return end;
    }
    while (static_cast<unsigned char>(*end) > ' ' && !std::strchr(",]}", *end)) end++;
    if (!cJSON_IsNumber(item) || prints_alike(at, end) || is_short_fraction(at, end, item->valuedouble)) return end;
    char printed[64];
    if (!print_fraction(item->valuedouble, printed) && !cJSON_PrintPreallocated(item, printed, sizeof printed, false))
        throw std::bad_alloc();
    if (std::string(at, end) == printed) return end;
    exchange(at, end, printed);
    keep_text(item, at, end);
    return end;
}

const char *text_walk::children(cJSON *item, const char *at) {
    bool object = *at++ == '{';
    for (cJSON *child = item->child; child; child = child->next) {
        if (object) at = skip_space(string(skip_space(at))) + 1;
        at = skip_space(value(child, skip_space(at)));
        if (*at == ',') at++;
    }
    return skip_space(at) + 1;
}

/* Extras that this folder does not read, none of which begin with its name; tinygltf would hold them at many times the
 * size of their text. */
static bool is_foreign_extras(const cJSON *item) {
    if (!item->string || !item->child || std::strcmp(item->string, "extras") != 0) return false;
    for (const cJSON *child = item->child; child; child = child->next)
        if (child->string && std::strncmp(child->string, "hemibake", 8) == 0) return false;
    return true;
}

const char *text_walk::value(cJSON *item, const char *at) {
    auto edit = edits.find(item);
    const bool foreign = is_foreign_extras(item), exchanged = foreign || edit != edits.end();
    if (exchanged) exchange(at, at, foreign ? "0" : edit->second);
    edited += exchanged;
    const char *end = *at == '{' || *at == '[' ? children(item, at) : scalar(item, at);
    edited -= exchanged;
    if (exchanged && !edited) copied = end;
    return end;
}

/* ---- what tinygltf would refuse or misread ----------------------------------------------------------------------- */

bool gltf_is_fallback(const cJSON *buffer) {
    return !gltf_member(buffer, "uri") && cJSON_IsObject(gltf_extension(buffer, "EXT_meshopt_compression"));
}

bool gltf_is_base64(const char *uri) {
    const char *data = std::strchr(uri, ',');
    return std::strncmp(uri, "data:", 5) == 0 && data && data - uri >= 7 && !std::strncmp(data - 7, ";base64", 7);
}

/* Base64 leaves the tree, as the output has its bytes elsewhere. */
static void take_uri(cJSON *uri, gltf_source &source) {
    if (!cJSON_IsString(uri)) return;
    bool base64 = gltf_is_base64(uri->valuestring);
    if (base64 || std::strncmp(uri->valuestring, "data:", 5) != 0) source.uri = uri->valuestring;
    if (!base64) return;
    cJSON_free(uri->valuestring);
    uri->valuestring = static_cast<char *>(cJSON_malloc(1));
    if (!uri->valuestring) throw std::bad_alloc();
    uri->valuestring[0] = '\0';
}

static std::vector<gltf_source> take_sources(const cJSON *list, edit_map &edits) {
    std::vector<gltf_source> sources;
    for (const cJSON *element : gltf_elements(list)) {
        const cJSON *length = gltf_member(element, "byteLength"), *type = gltf_member(element, "mimeType");
        gltf_source source;
        source.length = length ? size_t(length->valuedouble) : 0;
        source.fallback = gltf_is_fallback(element);
        source.view = gltf_index(element, "bufferView");
        if (source.view >= 0 && cJSON_IsString(type)) source.media_type = type->valuestring;
        take_uri(gltf_member(element, "uri"), source);
        sources.push_back(std::move(source));
    }
    if (list) edits[list] = "[]";
    return sources;
}

static void hide_draco_indices(const cJSON *meshes, edit_map &edits) {
    for (const cJSON *mesh : gltf_elements(meshes))
        for (const cJSON *primitive : gltf_elements(gltf_member(mesh, "primitives"))) {
            const cJSON *indices = gltf_member(primitive, "indices"),
                        *packed = gltf_extension(primitive, "KHR_draco_mesh_compression");
            if (indices && cJSON_IsObject(packed)) edits[indices] = "-1";
        }
}

static void hide_strides(const cJSON *views, edit_map &edits) {
    for (const cJSON *view : gltf_elements(views)) {
        const cJSON *stride = gltf_member(view, "byteStride");
        if (stride && (stride->valueint % 4 != 0 || stride->valueint > 252)) edits[stride] = "0";
    }
}

/* KHR_animation_pointer moves a node by "/nodes/3/translation"; tinygltf knows targets with a node only. */
static void resolve_pointer(const cJSON *target, edit_map &edits) {
    const cJSON *pointer = gltf_member(gltf_extension(target, "KHR_animation_pointer"), "pointer");
    int node = 0;
    char path[16] = "";
    if (!cJSON_IsString(pointer) || gltf_member(target, "node")) return;
    if (sscanf(pointer->valuestring, "/nodes/%9d/%15[a-z]", &node, path) != 2 || node < 0) return;
    edits[target] = gltf_text("{\"node\":%d,\"path\":\"%s\"}", node, path);
}

/* A spot may do without its cone. */
static void add_cones(const cJSON *lights, edit_map &edits) {
    for (const cJSON *light : gltf_elements(lights)) {
        const cJSON *type = gltf_member(light, "type");
        if (cJSON_IsString(type) && std::strcmp(type->valuestring, "spot") == 0 && !gltf_member(light, "spot"))
            edits[type] = "\"spot\",\"spot\":{}";
    }
}

gltf_reading gltf_read_document(cJSON *root, const char *text, size_t length) {
    gltf_reading reading;
    edit_map edits;
    reading.buffers = take_sources(gltf_member(root, "buffers"), edits);
    reading.images = take_sources(gltf_member(root, "images"), edits);
    hide_draco_indices(gltf_member(root, "meshes"), edits);
    hide_strides(gltf_member(root, "bufferViews"), edits);
    for (const cJSON *animation : gltf_elements(gltf_member(root, "animations")))
        for (const cJSON *channel : gltf_elements(gltf_member(animation, "channels")))
            resolve_pointer(gltf_member(channel, "target"), edits);
    add_cones(gltf_member(gltf_extension(root, "KHR_lights_punctual"), "lights"), edits);
    const char *begin = static_cast<const char *>(std::memchr(text, '{', length)); /* a byte order mark goes before */
    text_walk walk = { edits, begin };
    walk.out.reserve(length);
    const char *end = walk.value(root, begin);
    walk.out.append(walk.copied, end);
    reading.text = std::move(walk.out);
    return reading;
}

static bool only_space_follows(const char *at, const char *end) {
    return std::all_of(at, end, [](char c) { return std::strchr(" \t\r\n", c) != nullptr; }); /* zeros too */
}

/* cJSON does not say whether it lacks memory. Where there is none any more this throws; a text that is at fault is so
 * twice. */
static void throw_if_memory_lacked(const char *text, size_t length) {
    std::vector<char> room(length);
    if (gltf_json(cJSON_ParseWithLength(text, length))) throw std::bad_alloc();
}

gltf_json gltf_parse_document(const char *text, size_t length, bool glb) {
    const char *end = nullptr;
    gltf_json root(cJSON_ParseWithLengthOpts(text, length, &end, false));
    if (!root) throw_if_memory_lacked(text, length);
    /* cJSON lets a zero pass, JSON does not. */
    const void *zero = root ? std::memchr(text, 0, size_t(end - text)) : nullptr;
    if (zero) end = static_cast<const char *>(zero);
    if (!root || zero || !only_space_follows(end, text + length))
        gltf_fail(HEMI_ERROR_DATA, "the JSON is malformed at byte %zu; export the file again",
                  end && end >= text ? size_t(end - text) : size_t(0));
    gltf_check_document(root.get(), glb);
    return root;
}
