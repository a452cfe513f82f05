/* SPDX-License-Identifier: MIT
 * See the list at the head of gltf_json.h: what is rewritten before tinygltf reads the text.
 */
#include "gltf_json.h"

#include <cjson/cJSON.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool gltf_json_is_fallback(const cJSON *buffer) {
    const cJSON *extensions = cJSON_GetObjectItemCaseSensitive(buffer, "extensions");
    return !cJSON_GetObjectItemCaseSensitive(buffer, "uri") &&
           cJSON_IsObject(cJSON_GetObjectItemCaseSensitive(extensions, "EXT_meshopt_compression"));
}

/* ---- before reading: what tinygltf would refuse ------------------------------------------------------------------ */

static void set_text(cJSON *object, const char *name, const char *text) {
    cJSON_DeleteItemFromObjectCaseSensitive(object, name);
    cJSON_AddStringToObject(object, name, text);
}

static void hide_draco_indices(cJSON *root) {
    cJSON *mesh, *primitive;
    cJSON_ArrayForEach(mesh, cJSON_GetObjectItemCaseSensitive(root, "meshes"))
        cJSON_ArrayForEach(primitive, cJSON_GetObjectItemCaseSensitive(mesh, "primitives")) {
        cJSON *extensions = cJSON_GetObjectItemCaseSensitive(primitive, "extensions");
        cJSON *draco = cJSON_GetObjectItemCaseSensitive(extensions, "KHR_draco_mesh_compression");
        cJSON_DeleteItemFromObjectCaseSensitive(draco, GLTF_DRACO_INDICES);
        cJSON *indices = cJSON_DetachItemFromObjectCaseSensitive(primitive, "indices");
        if (!indices) continue;
        cJSON_AddItemToObject(cJSON_IsObject(draco) ? draco : primitive,
                              cJSON_IsObject(draco) ? GLTF_DRACO_INDICES : "indices", indices);
    }
}

/* KHR_animation_pointer moves a node by "/nodes/3/translation"; tinygltf knows targets with a node only. */
static void resolve_pointer(cJSON *target) {
    const cJSON *extensions = cJSON_GetObjectItemCaseSensitive(target, "extensions");
    const cJSON *extension = cJSON_GetObjectItemCaseSensitive(extensions, "KHR_animation_pointer");
    const cJSON *pointer = cJSON_GetObjectItemCaseSensitive(extension, "pointer");
    int node = 0;
    char path[16] = "";
    if (!cJSON_IsString(pointer) || cJSON_GetObjectItemCaseSensitive(target, "node")) return;
    if (sscanf(pointer->valuestring, "/nodes/%9d/%15[a-z]", &node, path) != 2 || node < 0) return;
    cJSON_AddNumberToObject(target, "node", node);
    set_text(target, "path", path);
}

static void resolve_pointers(cJSON *root) {
    cJSON *animation, *channel;
    cJSON_ArrayForEach(animation, cJSON_GetObjectItemCaseSensitive(root, "animations"))
        cJSON_ArrayForEach(channel, cJSON_GetObjectItemCaseSensitive(animation, "channels"))
            resolve_pointer(cJSON_GetObjectItemCaseSensitive(channel, "target"));
}

/* tinygltf wants bytes behind every buffer; nothing refers to this one once its views are unpacked. */
static void fill_fallbacks(cJSON *root) {
    cJSON *buffer;
    cJSON_ArrayForEach(buffer, cJSON_GetObjectItemCaseSensitive(root, "buffers")) {
        if (!gltf_json_is_fallback(buffer)) continue;
        cJSON_AddStringToObject(buffer, "uri", "data:application/octet-stream;base64,AA==");
        cJSON_SetNumberValue(cJSON_GetObjectItemCaseSensitive(buffer, "byteLength"), 1);
    }
}

static void widen_data_uris(cJSON *list) {
    static const char octets[] = "data:application/octet-stream;base64,";
    cJSON *element;
    cJSON_ArrayForEach(element, list) {
        cJSON *uri = cJSON_GetObjectItemCaseSensitive(element, "uri");
        if (!cJSON_IsString(uri) || strncmp(uri->valuestring, "data:", 5) != 0) continue;
        const char *data = strchr(uri->valuestring, ',');
        if (!data || data - uri->valuestring < 7 || strncmp(data - 7, ";base64", 7) != 0) continue;
        size_t size = strlen(data + 1);
        char *text = cJSON_malloc(sizeof octets + size);
        if (!text) continue;
        memcpy(text, octets, sizeof octets - 1);
        memcpy(text + sizeof octets - 1, data + 1, size + 1);
        cJSON_free(uri->valuestring);
        uri->valuestring = text;
    }
}

/* ---- before reading: where bytes are ----------------------------------------------------------------------------- */

/* Gives every element that names a file the name that we know it by, and keeps its own. */
static gltf_json_file *take_files(cJSON *list, const char *name, bool has_lengths, int *count) {
    int index = 0;
    cJSON *element;
    *count = cJSON_GetArraySize(list);
    gltf_json_file *files = calloc((size_t)*count + 1, sizeof *files);
    cJSON_ArrayForEach(element, list) {
        if (!files) break;
        gltf_json_file *file = &files[index];
        const cJSON *uri = cJSON_GetObjectItemCaseSensitive(element, "uri");
        char synthetic[64];
        snprintf(synthetic, sizeof synthetic, "%s%d", name, index++);
        if (has_lengths) file->length = (size_t)cJSON_GetObjectItemCaseSensitive(element, "byteLength")->valuedouble;
        if (cJSON_IsString(uri) && strncmp(uri->valuestring, "data:", 5) == 0) continue;
        if (uri && !cJSON_IsString(uri)) continue;
        if (!uri && !has_lengths) continue; /* an image in a buffer view */
        if (uri) file->uri = strdup(uri->valuestring);
        set_text(element, "uri", synthetic);
    }
    return files;
}

void gltf_json_input_free(gltf_json_input *input) {
    for (int i = 0; input->buffers && i < input->buffer_count; i++) free(input->buffers[i].uri);
    for (int i = 0; input->images && i < input->image_count; i++) free(input->images[i].uri);
    free(input->buffers);
    free(input->images);
    free(input->text);
    *input = (gltf_json_input){ 0 };
}

static hemi_result make_input(cJSON *root, gltf_json_input *out) {
    cJSON *buffers = cJSON_GetObjectItemCaseSensitive(root, "buffers");
    cJSON *images = cJSON_GetObjectItemCaseSensitive(root, "images");
    hide_draco_indices(root);
    fill_fallbacks(root);
    resolve_pointers(root);
    widen_data_uris(buffers);
    widen_data_uris(images);
    out->buffers = take_files(buffers, GLTF_BUFFER_NAME, true, &out->buffer_count);
    out->images = take_files(images, GLTF_IMAGE_NAME, false, &out->image_count);
    out->text = cJSON_PrintUnformatted(root);
    return out->buffers && out->images && out->text ? HEMI_OK : HEMI_ERROR_MEMORY;
}

static bool only_space_follows(const char *at, const char *end) {
    while (at < end && (*at == ' ' || *at == '\t' || *at == '\r' || *at == '\n' || *at == '\0')) at++;
    return at == end;
}

hemi_result gltf_json_before_read(const char *text, size_t length, bool glb, gltf_json_input *out,
                                  char message[GLTF_MESSAGE_SIZE]) {
    const char *end = NULL;
    *out = (gltf_json_input){ 0 };
    cJSON *root = cJSON_ParseWithLengthOpts(text, length, &end, false);
    const char *zero = root ? memchr(text, 0, (size_t)(end - text)) : NULL; /* cJSON lets it pass, JSON does not */
    if (zero) end = zero;
    if (!root || zero || !only_space_follows(end, text + length)) {
        snprintf(message, GLTF_MESSAGE_SIZE, "the JSON is malformed at byte %zu; export the file again",
                 end && end >= text ? (size_t)(end - text) : (size_t)0);
        cJSON_Delete(root);
        return HEMI_ERROR_DATA;
    }
    hemi_result result = gltf_json_check(root, glb, message);
    if (result == HEMI_OK) result = make_input(root, out);
    if (result != HEMI_OK) gltf_json_input_free(out);
    cJSON_Delete(root);
    return result;
}
