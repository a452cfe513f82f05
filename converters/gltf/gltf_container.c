/* SPDX-License-Identifier: MIT */
#include "gltf_container.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER = 12, CHUNK_HEADER = 8 };
static const uint32_t chunk_json = 0x4E4F534A, chunk_bin = 0x004E4942;

static uint32_t read_u32(const uint8_t *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static void write_u32(uint8_t *p, uint32_t value) {
    for (int i = 0; i < 4; i++) p[i] = (uint8_t)(value >> 8 * i);
}

static hemi_result malformed(char *message, const char *text) {
    snprintf(message, GLTF_MESSAGE_SIZE, "%s", text);
    return HEMI_ERROR_DATA;
}

/* The chunk at *offset, or false if it does not fit. */
static bool next_chunk(const uint8_t *bytes, size_t size, size_t *offset, uint32_t *type, const uint8_t **data,
                       size_t *data_size) {
    if (size - *offset < CHUNK_HEADER) return false;
    *data_size = read_u32(bytes + *offset);
    *type = read_u32(bytes + *offset + 4);
    *offset += CHUNK_HEADER;
    if (*data_size > size - *offset) return false;
    *data = bytes + *offset;
    *offset += *data_size;
    return true;
}

static hemi_result split_binary(const uint8_t *bytes, size_t size, gltf_chunks *out, char *message) {
    if (size < HEADER) return malformed(message, "the GLB header is truncated; export the file again");
    uint32_t version = read_u32(bytes + 4), length = read_u32(bytes + 8), type;
    if (version != 2) {
        snprintf(message, GLTF_MESSAGE_SIZE, "GLB version %u is not supported; convert the file to glTF 2.0", version);
        return HEMI_ERROR_UNSUPPORTED;
    }
    if (length > size) {
        snprintf(message, GLTF_MESSAGE_SIZE, "truncated GLB: its header says %u bytes, the file has %zu; copy it again",
                 length, size);
        return HEMI_ERROR_DATA;
    }
    size_t offset = HEADER;
    if (length < HEADER || !next_chunk(bytes, length, &offset, &type, &out->json, &out->json_size) ||
        type != chunk_json)
        return malformed(message, "the first chunk of the GLB is not whole JSON; export the file again");
    out->binary = true;
    while (offset < length) {
        const uint8_t *data;
        size_t data_size;
        if (!next_chunk(bytes, length, &offset, &type, &data, &data_size))
            return malformed(message, "a chunk of the GLB runs past its end; export the file again");
        if (type != chunk_bin || out->bin) continue; /* other chunks are for extensions: ignored, as the rules say */
        out->bin = data;
        out->bin_size = data_size;
    }
    return HEMI_OK;
}

hemi_result gltf_container_split(const uint8_t *bytes, size_t size, gltf_chunks *out, char message[GLTF_MESSAGE_SIZE]) {
    *out = (gltf_chunks){ 0 };
    if (size >= 4 && memcmp(bytes, "glTF", 4) == 0) return split_binary(bytes, size, out, message);
    size_t start = size >= 3 && memcmp(bytes, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0; /* a byte-order mark is tolerated */
    size_t first = start;
    while (first < size && strchr(" \t\r\n", bytes[first]) && bytes[first]) first++;
    if (first == size || bytes[first] != '{')
        return malformed(message, "not a glTF file: it begins with neither \"glTF\" nor a JSON object");
    out->json = bytes + start;
    out->json_size = size - start;
    return HEMI_OK;
}

static size_t padded(size_t size) {
    return (size + 3) & ~(size_t)3;
}

/* Writes a chunk's header and padding; where its bytes go. */
static uint8_t *put_chunk(uint8_t *at, uint32_t type, size_t size, int padding) {
    write_u32(at, (uint32_t)padded(size));
    write_u32(at + 4, type);
    memset(at + CHUNK_HEADER + size, padding, padded(size) - size);
    return at + CHUNK_HEADER;
}

hemi_result gltf_container_join(const char *json, size_t json_size, size_t bin_size, uint8_t **out, size_t *out_size,
                                uint8_t **bin) {
    size_t total = HEADER + CHUNK_HEADER + padded(json_size) + (bin_size ? CHUNK_HEADER + padded(bin_size) : 0);
    if (total > UINT32_MAX) return HEMI_ERROR_LIMIT;
    uint8_t *bytes = malloc(total);
    if (!bytes) return HEMI_ERROR_MEMORY;
    memcpy(bytes, "glTF", 4);
    write_u32(bytes + 4, 2);
    write_u32(bytes + 8, (uint32_t)total);
    uint8_t *text = put_chunk(bytes + HEADER, chunk_json, json_size, ' ');
    memcpy(text, json, json_size);
    *bin = bin_size ? put_chunk(text + padded(json_size), chunk_bin, bin_size, 0) : NULL;
    *out = bytes;
    *out_size = total;
    return HEMI_OK;
}
