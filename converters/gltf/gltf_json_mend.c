/* SPDX-License-Identifier: MIT
 * What has to be mended in the JSON that tinygltf wrote? The list is at the head of gltf_json.h.
 */
#include "gltf_json.h"

#include <cjson/cJSON.h>

#include <stdio.h>
#include <string.h>

/* Null elements become empty objects, null members of the root go. */
static void replace_nulls(cJSON *root) {
    for (cJSON *list = root->child, *next; list; list = next) {
        next = list->next;
        if (cJSON_IsNull(list)) {
            cJSON_Delete(cJSON_DetachItemViaPointer(root, list));
            continue;
        }
        if (!cJSON_IsArray(list)) continue;
        for (cJSON *element = list->child; element; element = element->next)
            if (cJSON_IsNull(element)) element->type = cJSON_Object;
    }
}

static void drop_zero_zfar(cJSON *root) {
    cJSON *camera;
    cJSON_ArrayForEach(camera, cJSON_GetObjectItemCaseSensitive(root, "cameras")) {
        cJSON *perspective = cJSON_GetObjectItemCaseSensitive(camera, "perspective");
        cJSON *zfar = cJSON_GetObjectItemCaseSensitive(perspective, "zfar");
        if (cJSON_IsNumber(zfar) && !(zfar->valuedouble > 0))
            cJSON_DeleteItemFromObjectCaseSensitive(perspective, "zfar");
    }
}

/* Copies a member of the original over what tinygltf made of it. */
static void restore_member(cJSON *to, const cJSON *from, const char *name) {
    const cJSON *member = cJSON_GetObjectItemCaseSensitive(from, name);
    if (!member || !cJSON_IsObject(to)) return;
    cJSON_DeleteItemFromObjectCaseSensitive(to, name);
    cJSON_AddItemToObject(to, name, cJSON_Duplicate(member, true));
}

static void restore_list(cJSON *root, const cJSON *original, const char *list, const char *member) {
    const cJSON *from_list = cJSON_GetObjectItemCaseSensitive(original, list);
    cJSON *to_list = cJSON_GetObjectItemCaseSensitive(root, list);
    if (!cJSON_IsArray(from_list) || !cJSON_IsArray(to_list)) return;
    const cJSON *from = from_list->child;
    for (cJSON *to = to_list->child; to && from; to = to->next, from = from->next) restore_member(to, from, member);
}

/* Lists whose elements keep their places. Animations without channels are dropped by tinygltf, so that list is taken
 * only if it kept its length. */
static void restore_from(cJSON *root, const cJSON *original) {
    static const char *const lists[] = { "nodes",    "scenes", "skins",     "cameras",
                                         "textures", "images", "materials", "samplers" };
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) restore_list(root, original, lists[i], "extras");
    if (cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(root, "animations")) ==
        cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(original, "animations")))
        restore_list(root, original, "animations", "extras");
    restore_list(root, original, "samplers", "extensions");
    restore_list(root, original, "samplers", "name");
    restore_list(root, original, "skins", "extensions");
    restore_member(root, original, "extras");
    cJSON *asset = cJSON_GetObjectItemCaseSensitive(root, "asset");
    const cJSON *asset_original = cJSON_GetObjectItemCaseSensitive(original, "asset");
    restore_member(asset, asset_original, "minVersion");
    restore_member(asset, asset_original, "extras");
}

static hemi_result add_extras(cJSON *root, const char *text, char *message) {
    cJSON *value = cJSON_Parse(text), *asset = cJSON_GetObjectItemCaseSensitive(root, "asset");
    if (!value) {
        snprintf(message, GLTF_MESSAGE_SIZE, "the text for asset.extras.hemibake is not JSON");
        return HEMI_ERROR_ARGUMENT;
    }
    cJSON *extras = cJSON_GetObjectItemCaseSensitive(asset, "extras");
    if (!cJSON_IsObject(extras)) {
        cJSON_DeleteItemFromObjectCaseSensitive(asset, "extras");
        extras = cJSON_AddObjectToObject(asset, "extras");
    }
    cJSON_DeleteItemFromObjectCaseSensitive(extras, "hemibake");
    cJSON_AddItemToObject(extras, "hemibake", value);
    return HEMI_OK;
}

static void set_buffer(cJSON *root, const gltf_json_mend *mend) {
    cJSON_DeleteItemFromObjectCaseSensitive(root, "buffers");
    if (mend->buffer_length == 0) return;
    cJSON *buffer = cJSON_CreateObject();
    cJSON_AddItemToArray(cJSON_AddArrayToObject(root, "buffers"), buffer);
    cJSON_AddNumberToObject(buffer, "byteLength", (double)mend->buffer_length);
    if (mend->buffer_uri) cJSON_AddStringToObject(buffer, "uri", mend->buffer_uri);
}

hemi_result gltf_json_after_write(const char *text, size_t length, const gltf_json_mend *mend, char **out,
                                  char message[GLTF_MESSAGE_SIZE]) {
    cJSON *root = cJSON_ParseWithLength(text, length), *original = cJSON_Parse(mend->original);
    hemi_result result = root && original ? HEMI_OK : HEMI_ERROR_MEMORY;
    *out = NULL;
    if (result == HEMI_OK) {
        replace_nulls(root);
        drop_zero_zfar(root);
        restore_from(root, original);
        set_buffer(root, mend);
        if (mend->extras_json) result = add_extras(root, mend->extras_json, message);
    }
    if (result == HEMI_OK) {
        *out = mend->pretty ? cJSON_Print(root) : cJSON_PrintUnformatted(root);
        if (!*out) result = HEMI_ERROR_MEMORY;
    }
    cJSON_Delete(root);
    cJSON_Delete(original);
    return result;
}
