/* SPDX-License-Identifier: MIT
 * Where are the JSON and the binary chunk of a .glb, and how are the two put together again?
 *
 *     "glTF" | version 2 | length | JSON length | "JSON" | text, padded with spaces | BIN length | "BIN\0" | bytes,
 * padded
 *
 * All numbers are 32 bits, little-endian; chunks begin at multiples of four. [glTF 2.0, section 4]
 */
#ifndef HEMIBAKE_GLTF_CONTAINER_H
#define HEMIBAKE_GLTF_CONTAINER_H

#include "gltf_asset.h"

HEMI_C_BEGIN

typedef struct gltf_chunks {
    bool binary; /* false: the file is plain JSON */
    const uint8_t *json;
    size_t json_size;
    const uint8_t *bin; /* NULL without one */
    size_t bin_size;
} gltf_chunks;

/* Finds the chunks; they point into bytes. */
hemi_result gltf_container_split(const uint8_t *bytes, size_t size, gltf_chunks *out, char message[GLTF_MESSAGE_SIZE]);

/* *out: malloc'ed, with everything but the bytes of the BIN chunk, which go to *bin. No such chunk if bin_size is 0. */
hemi_result gltf_container_join(const char *json, size_t json_size, size_t bin_size, uint8_t **out, size_t *out_size,
                                uint8_t **bin);

HEMI_C_END
#endif
