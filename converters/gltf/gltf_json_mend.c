/* SPDX-License-Identifier: MIT
 * What of the JSON that tinygltf wrote goes into the output, and what is taken from the text that was read? The output
 * is the original document; only members that baking or renumbering changed come from tinygltf. Every element that
 * tinygltf wrote says in its extras which element of the original it is (see GLTF_ORIGIN_... in gltf_json.h).
 */
#include "gltf_json.h"

#include <cjson/cJSON.h>

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NO_ORIGIN = INT_MIN };

typedef struct merge {
    cJSON *root;          /* the original, which becomes the output */
    const cJSON *written; /* by tinygltf */
    int *textures;        /* textures[i]: the new number of texture i of the original, or -1 */
    int texture_count;
} merge;

/* Makes `to`, a copy of an element of the original, what `from` says. */
typedef void (*merge_element)(const merge *m, cJSON *to, const cJSON *from, const cJSON *original);

static cJSON *get(const cJSON *object, const char *name) {
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

/* ---- members ---------------------------------------------------------------------------------------------------- */

static void drop(cJSON *object, const char *name) {
    cJSON_DeleteItemFromObjectCaseSensitive(object, name);
}

/* Takes a member from `from`, in its old place; drops it if there is none. */
static void take(cJSON *to, const cJSON *from, const char *name) {
    const cJSON *member = get(from, name);
    if (!member)
        drop(to, name);
    else if (get(to, name))
        cJSON_ReplaceItemInObjectCaseSensitive(to, name, cJSON_Duplicate(member, true));
    else
        cJSON_AddItemToObject(to, name, cJSON_Duplicate(member, true));
}

/* The same for a number, whose text is kept if its value is. */
static void take_number(cJSON *to, const cJSON *from, const char *name) {
    const cJSON *old = get(to, name), *fresh = get(from, name);
    if (!old || !fresh || old->valuedouble != fresh->valuedouble) take(to, from, name);
}

/* The same for every number of an object, such as attributes. */
static void take_numbers(cJSON *to, const cJSON *from, const char *name) {
    cJSON *into = get(to, name);
    const cJSON *source = get(from, name), *member;
    if (!into || !source) {
        take(to, from, name);
        return;
    }
    for (cJSON *old = into->child, *next; old; old = next) {
        next = old->next;
        if (!get(source, old->string)) cJSON_Delete(cJSON_DetachItemViaPointer(into, old));
    }
    cJSON_ArrayForEach(member, source) take_number(into, source, member->string);
}

static void drop_extension(cJSON *object, const char *name) {
    cJSON *extensions = get(object, "extensions");
    drop(extensions, name);
    if (extensions && !extensions->child) drop(object, "extensions");
}

/* The extension as tinygltf wrote it: gone, as it was, or with other numbers in `numbers`. */
static void take_extension(cJSON *to, const cJSON *from, const char *name, const char *numbers) {
    cJSON *source = get(get(from, "extensions"), name), *into = get(get(to, "extensions"), name);
    if (!source) {
        drop_extension(to, name);
    } else if (into) {
        if (numbers)
            take_numbers(into, source, numbers);
        else
            take_number(into, source, "bufferView");
        if (!numbers && get(source, "attributes")) take_numbers(into, source, "attributes");
    } else {
        cJSON *extensions = get(to, "extensions");
        if (!extensions) extensions = cJSON_AddObjectToObject(to, "extensions");
        cJSON_AddItemToObject(extensions, name, cJSON_Duplicate(source, true));
    }
}

/* ---- lists ------------------------------------------------------------------------------------------------------ */

static int origin_of(const cJSON *element) {
    const cJSON *extras = get(element, "extras");
    return cJSON_IsNumber(extras) ? extras->valueint : NO_ORIGIN;
}

static cJSON *merged_element(const merge *m, const cJSON *from, cJSON *const *originals, int count,
                             merge_element element) {
    int origin = origin_of(from);
    bool replaced = origin != NO_ORIGIN && origin < 0;
    int index = replaced ? GLTF_ORIGIN_REPLACED(origin) : origin;
    bool known = index >= 0 && index < count;
    cJSON *to = cJSON_Duplicate(known && !replaced ? originals[index] : from, true);
    if (!known || replaced) drop(to, "extras");
    if (known) element(m, to, from, originals[index]);
    return to;
}

/* The written list with the elements of the original put back; NULL without memory. */
static cJSON *merged_list(const merge *m, const cJSON *original, const cJSON *written, merge_element element) {
    int count = cJSON_GetArraySize(original), i = 0;
    cJSON **originals = malloc(((size_t)count + 1) * sizeof *originals), *list = cJSON_CreateArray(), *item;
    cJSON_ArrayForEach(item, original) originals[i++] = item;
    cJSON_ArrayForEach(item, written) cJSON_AddItemToArray(list, merged_element(m, item, originals, count, element));
    free(originals);
    return list;
}

static void merge_list(const merge *m, const char *name, merge_element element) {
    const cJSON *original = get(m->root, name), *written = get(m->written, name);
    if (!cJSON_GetArraySize(written)) {
        drop(m->root, name);
        return;
    }
    cJSON *list = merged_list(m, original, written, element);
    if (original)
        cJSON_ReplaceItemInObjectCaseSensitive(m->root, name, list);
    else
        cJSON_AddItemToObject(m->root, name, list);
}

/* ---- elements --------------------------------------------------------------------------------------------------- */

static void merge_accessor(const merge *m, cJSON *to, const cJSON *from, const cJSON *original) {
    (void)m, (void)original;
    take_number(to, from, "bufferView");
    cJSON *into = get(to, "sparse");
    const cJSON *source = get(from, "sparse");
    if (!into || !source) return;
    take_number(get(into, "indices"), get(source, "indices"), "bufferView");
    take_number(get(into, "values"), get(source, "values"), "bufferView");
}

static void merge_view(const merge *m, cJSON *to, const cJSON *from, const cJSON *original) {
    (void)m, (void)original;
    take_number(to, from, "buffer");
    take_number(to, from, "byteOffset");
    take_number(to, from, "byteLength");
    drop_extension(to, "EXT_meshopt_compression");
}

static void merge_primitive(const merge *m, cJSON *to, const cJSON *from, const cJSON *original) {
    (void)m, (void)original;
    const cJSON *mode = get(from, "mode"), *old_mode = get(to, "mode");
    take_numbers(to, from, "attributes");
    take_number(to, from, "indices");
    take_number(to, from, "material");
    if (mode && mode->valueint != (old_mode ? old_mode->valueint : 4)) take(to, from, "mode");
    cJSON *target = get(to, "targets") ? get(to, "targets")->child : NULL, *next;
    for (const cJSON *source = get(from, "targets") ? get(from, "targets")->child : NULL; target && source;
         source = source->next, target = next) {
        const cJSON *member;
        next = target->next;
        cJSON_ArrayForEach(member, source) take_number(target, source, member->string);
    }
    take_extension(to, from, "KHR_draco_mesh_compression", NULL);
    static const char *const lost[] = { "KHR_materials_variants", "FB_ngon_encoding" };
    for (size_t i = 0; i < sizeof lost / sizeof *lost; i++)
        if (!get(get(from, "extensions"), lost[i])) drop_extension(to, lost[i]);
}

static void merge_mesh(const merge *m, cJSON *to, const cJSON *from, const cJSON *original) {
    cJSON *primitives = merged_list(m, get(original, "primitives"), get(from, "primitives"), merge_primitive);
    cJSON_ReplaceItemInObjectCaseSensitive(to, "primitives", primitives);
}

static void merge_node(const merge *m, cJSON *to, const cJSON *from, const cJSON *original) {
    (void)m;
    take_number(to, from, "mesh");
    if (cJSON_GetArraySize(get(from, "children")) != cJSON_GetArraySize(get(original, "children")))
        take(to, from, "children");
    take_extension(to, from, "EXT_mesh_gpu_instancing", "attributes");
}

static void merge_image(const merge *m, cJSON *to, const cJSON *from, const cJSON *original) {
    (void)m;
    const cJSON *view = get(from, "bufferView");
    if (!view || view->valuedouble < 0) return; /* its file is missing: the reference stays */
    if (!get(original, "bufferView")) take(to, from, "mimeType");
    take_number(to, from, "bufferView");
    drop(to, "uri");
}

static void merge_texture(const merge *m, cJSON *to, const cJSON *from, const cJSON *original) {
    (void)m, (void)original;
    const cJSON *extension;
    take_number(to, from, "source");
    take_number(to, from, "sampler");
    cJSON_ArrayForEach(extension, get(from, "extensions")) {
        cJSON *into = get(get(to, "extensions"), extension->string);
        if (into && get(extension, "source")) take_number(into, extension, "source");
    }
}

static void merge_sampler(const merge *m, cJSON *to, const cJSON *from, const cJSON *original) {
    (void)m, (void)to, (void)from, (void)original;
}

/* ---- materials -------------------------------------------------------------------------------------------------- */

/* Whether a member is a reference to a texture: all that Khronos ratified are called so. */
static bool is_texture_info(const cJSON *item) {
    static const char end[] = "Texture";
    size_t length = item->string ? strlen(item->string) : 0;
    return length >= sizeof end - 1 && strcmp(item->string + length - (sizeof end - 1), end) == 0 && get(item, "index");
}

static void renumber_textures(const merge *m, cJSON *parent) {
    cJSON *item;
    cJSON_ArrayForEach(item, parent) {
        if (item->string && strcmp(item->string, "extras") == 0) continue;
        cJSON *index = is_texture_info(item) ? get(item, "index") : NULL;
        int old = index ? index->valueint : -1;
        if (old >= 0 && old < m->texture_count && m->textures[old] >= 0 && m->textures[old] != old)
            cJSON_ReplaceItemInObjectCaseSensitive(item, "index", cJSON_CreateNumber(m->textures[old]));
        if (cJSON_IsObject(item) || cJSON_IsArray(item)) renumber_textures(m, item);
    }
}

/* Transform, coordinate set and extras of the texture that an unlit copy shows; its index is the new one. */
static void restore_texture(cJSON *to, const cJSON *original) {
    cJSON *into = get(to, "pbrMetallicRoughness");
    const cJSON *index = get(get(into, "baseColorTexture"), "index");
    const cJSON *glossy = get(get(original, "extensions"), "KHR_materials_pbrSpecularGlossiness");
    const cJSON *source =
        glossy ? get(glossy, "diffuseTexture") : get(get(original, "pbrMetallicRoughness"), "baseColorTexture");
    if (!index || !source) return;
    cJSON *texture = cJSON_Duplicate(source, true);
    cJSON_ReplaceItemInObjectCaseSensitive(texture, "index", cJSON_Duplicate(index, true));
    cJSON_ReplaceItemInObjectCaseSensitive(into, "baseColorTexture", texture);
}

static void merge_material(const merge *m, cJSON *to, const cJSON *from, const cJSON *original) {
    cJSON *extension;
    if (origin_of(from) >= 0) {
        renumber_textures(m, to);
        return;
    }
    restore_texture(to, original);
    cJSON_ArrayForEach(extension, get(from, "extensions")) {
        const cJSON *before = get(get(original, "extensions"), extension->string);
        if (before) take(get(to, "extensions"), get(original, "extensions"), extension->string);
    }
    if (get(original, "extras")) take(to, original, "extras");
}

/* ---- lists whose elements keep their places ---------------------------------------------------------------------- */

static void merge_skins(const merge *m) {
    const cJSON *from = get(m->written, "skins") ? get(m->written, "skins")->child : NULL;
    cJSON *to;
    cJSON_ArrayForEach(to, get(m->root, "skins")) {
        if (from) take_number(to, from, "inverseBindMatrices");
        from = from ? from->next : NULL;
    }
}

static void merge_animations(const merge *m) {
    const cJSON *from = get(m->written, "animations") ? get(m->written, "animations")->child : NULL;
    cJSON *to, *sampler;
    cJSON_ArrayForEach(to, get(m->root, "animations")) {
        const cJSON *source = from && get(from, "samplers") ? get(from, "samplers")->child : NULL;
        cJSON_ArrayForEach(sampler, get(to, "samplers")) {
            if (source) take_number(sampler, source, "input");
            if (source) take_number(sampler, source, "output");
            source = source ? source->next : NULL;
        }
        from = from ? from->next : NULL;
    }
}

/* ---- the document ------------------------------------------------------------------------------------------------ */

static hemi_result add_extras(cJSON *root, const char *text, char *message) {
    cJSON *value = cJSON_Parse(text), *asset = get(root, "asset");
    if (!value) {
        snprintf(message, GLTF_MESSAGE_SIZE, "the text for asset.extras.hemibake is not JSON");
        return HEMI_ERROR_ARGUMENT;
    }
    cJSON *extras = get(asset, "extras");
    if (!cJSON_IsObject(extras)) {
        drop(asset, "extras");
        extras = cJSON_AddObjectToObject(asset, "extras");
    }
    drop(extras, "hemibake");
    cJSON_AddItemToObject(extras, "hemibake", value);
    return HEMI_OK;
}

/* One buffer holds everything; the name and extras of a single one before it are kept. */
static void set_buffer(cJSON *root, const gltf_json_mend *mend) {
    cJSON *old = get(root, "buffers"), *buffer = NULL;
    if (cJSON_GetArraySize(old) == 1) buffer = cJSON_Duplicate(old->child, true);
    if (!buffer) buffer = cJSON_CreateObject();
    drop(root, "buffers");
    drop(buffer, "uri");
    drop_extension(buffer, "EXT_meshopt_compression");
    drop(buffer, "byteLength");
    if (mend->buffer_length == 0) {
        cJSON_Delete(buffer);
        return;
    }
    cJSON_AddItemToArray(cJSON_AddArrayToObject(root, "buffers"), buffer);
    cJSON_AddNumberToObject(buffer, "byteLength", (double)mend->buffer_length);
    if (mend->buffer_uri) cJSON_AddStringToObject(buffer, "uri", mend->buffer_uri);
}

static bool map_textures(merge *m) {
    int number = 0;
    const cJSON *texture;
    m->texture_count = cJSON_GetArraySize(get(m->root, "textures"));
    m->textures = malloc(((size_t)m->texture_count + 1) * sizeof *m->textures);
    if (!m->textures) return false;
    for (int i = 0; i < m->texture_count; i++) m->textures[i] = -1;
    cJSON_ArrayForEach(texture, get(m->written, "textures")) {
        int origin = origin_of(texture);
        if (origin >= 0 && origin < m->texture_count) m->textures[origin] = number;
        number++;
    }
    return true;
}

static void merge_document(const merge *m) {
    merge_list(m, "accessors", merge_accessor);
    merge_list(m, "bufferViews", merge_view);
    merge_list(m, "meshes", merge_mesh);
    merge_list(m, "nodes", merge_node);
    merge_list(m, "materials", merge_material);
    merge_list(m, "textures", merge_texture);
    merge_list(m, "images", merge_image);
    merge_list(m, "samplers", merge_sampler);
    merge_skins(m);
    merge_animations(m);
    take(m->root, m->written, "extensionsUsed");
    take(m->root, m->written, "extensionsRequired");
    if (get(get(m->written, "asset"), "generator")) take(get(m->root, "asset"), get(m->written, "asset"), "generator");
}

hemi_result gltf_json_after_write(const char *text, size_t length, const gltf_json_mend *mend, char **out,
                                  char message[GLTF_MESSAGE_SIZE]) {
    cJSON *written = cJSON_ParseWithLength(text, length);
    merge m = { .root = gltf_json_parse_exactly(mend->original), .written = written };
    hemi_result result = m.root && written && map_textures(&m) ? HEMI_OK : HEMI_ERROR_MEMORY;
    *out = NULL;
    if (result == HEMI_OK) {
        merge_document(&m);
        set_buffer(m.root, mend);
        if (mend->extras_json) result = add_extras(m.root, mend->extras_json, message);
    }
    if (result == HEMI_OK) {
        *out = mend->pretty ? cJSON_Print(m.root) : cJSON_PrintUnformatted(m.root);
        if (!*out) result = HEMI_ERROR_MEMORY;
    }
    cJSON_Delete(m.root);
    cJSON_Delete(written);
    free(m.textures);
    return result;
}
