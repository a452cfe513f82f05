/* SPDX-License-Identifier: MIT */
#include "input_files.h"

#include "color_transform.h"
#include "file_read.h"
#include "gltf_container.h"
#include "path_text.h"

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

typedef struct visitor {
    input_file_visit visit;
    void *user;
} visitor;

static void see(const visitor *to, const char *path) {
    struct stat status;
    if (path && *path && stat(path, &status) == 0 && S_ISREG(status.st_mode)) to->visit(to->user, path);
}

/* ---- what a glTF names ------------------------------------------------------------------------------------------- */

/* %20 and its like, in place. */
static void decode_uri(char *uri) {
    char *to = uri;
    for (; *uri; uri++, to++) {
        int high = *uri == '%' ? path_hex_digit(uri[1]) : -1, low = high >= 0 ? path_hex_digit(uri[2]) : -1;
        *to = low >= 0 ? (char)(16 * high + low) : *uri;
        if (low >= 0) uri += 2;
    }
    *to = 0;
}

/* A URI is relative to the folder of the asset. */
static void see_uri(const visitor *to, const char *asset, const char *uri) {
    int folder = (int)(path_name(asset) - asset);
    char *path = path_format("%.*s%s", folder, asset, uri);
    if (!path) return;
    decode_uri(path + folder);
    see(to, path);
    free(path);
}

static void see_uris(const visitor *to, const char *asset, const cJSON *list) {
    const cJSON *item;
    cJSON_ArrayForEach(item, list) {
        const char *uri = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(item, "uri"));
        if (uri && strncasecmp(uri, "data:", 5) != 0) see_uri(to, asset, uri);
    }
}

/* bytes[size] may be written. NULL: there is nothing to read; a FIFO has been read by the bake. */
static uint8_t *read_whole(const char *path, size_t *size) {
    struct stat status;
    char message[FILE_MESSAGE_SIZE];
    uint8_t *bytes = NULL;
    if (stat(path, &status) == 0 && S_ISREG(status.st_mode))
        file_read_bytes(path, NULL, UINT32_MAX, &bytes, size, message);
    return bytes;
}

cJSON *input_files_json(const char *path) {
    char message[GLTF_MESSAGE_SIZE];
    gltf_chunks chunks;
    size_t size = 0;
    uint8_t *bytes = read_whole(path, &size);
    cJSON *root = NULL;
    if (bytes && gltf_container_split(bytes, size, &chunks, message) == HEMI_OK)
        root = cJSON_ParseWithLength((const char *)chunks.json, chunks.json_size);
    free(bytes);
    return root;
}

/* Anything that is no glTF names nothing else. */
static void see_parts(const visitor *to, const char *asset) {
    cJSON *root = input_files_json(asset);
    see_uris(to, asset, cJSON_GetObjectItemCaseSensitive(root, "buffers"));
    see_uris(to, asset, cJSON_GetObjectItemCaseSensitive(root, "images"));
    cJSON_Delete(root);
}

static void see_list(const visitor *to, const char *list) {
    size_t size = 0;
    char *bytes = list ? (char *)read_whole(list, &size) : NULL;
    if (!bytes) return;
    bytes[size] = 0;
    for (char *rest = NULL, *line = strtok_r(bytes, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest))
        see(to, line);
    free(bytes);
}

static void see_table(void *to, const char *path) {
    see(to, path);
}

void input_files_visit(const options *o, const input_lists *lists, input_file_visit visit, void *user) {
    visitor to = { visit, user };
    const char *config = o->ocio ? o->ocio : getenv("OCIO");
    see(&to, o->inputs[0]);
    see_parts(&to, o->inputs[0]);
    if (o->lights_from) see(&to, o->lights_from), see_parts(&to, o->lights_from);
    if (lists) see_list(&to, lists->input), see_list(&to, lists->lights);
    see(&to, config);
    color_config_files(config && *config ? config : NULL, see_table, &to);
    see(&to, o->environment); /* R,G,B names no file */
}
