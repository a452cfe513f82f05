/* SPDX-License-Identifier: MIT
 * Which JSON does tinygltf get to read, and what has to be mended in the JSON that it wrote?
 *
 * Before reading, the text is checked and rewritten so that tinygltf neither fails on nor misreads what the
 * specification allows:
 *   - every index, count and offset is a non-negative integer below 2^31 (tinygltf keeps the low 32 bits); 1.0 is 1
 *   - nesting is bounded (tinygltf recurses through extras and extensions)
 *   - required members are there, so that errors name their place in the file
 *   - the `indices` of a Draco primitive move into its extension (tinygltf refuses accessors without a buffer view
 * there)
 *   - the empty fallback buffers of EXT_meshopt_compression get a byte (tinygltf refuses buffers without any)
 *   - other URIs become names that say which buffer or image it is (tinygltf turns + into a space and refuses files
 * that are longer than byteLength)
 *   - channels of KHR_animation_pointer that move a node name it (tinygltf drops them)
 *   - base64 data URIs of any media type become application/octet-stream (tinygltf knows seven types)
 * After writing, the output is the text that was read, with what baking and renumbering changed taken from tinygltf's
 * text: tinygltf loses extras, extensions and members that it does not know, and writes numbers in its own way.
 */
#ifndef HEMIBAKE_GLTF_JSON_H
#define HEMIBAKE_GLTF_JSON_H

#include "gltf_asset.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The member of KHR_draco_mesh_compression that holds the primitive's indices between reading and restoring. */
#define GLTF_DRACO_INDICES "hemibake_indices"

/* What the text for tinygltf calls buffer or image i that is not in a data URI; it asks for the bytes by that name. */
#define GLTF_BUFFER_NAME "hemibake-buffer-"
#define GLTF_IMAGE_NAME  "hemibake-image-"

/* A buffer or image of the asset: where its bytes are. */
typedef struct gltf_json_file {
    char *uri;     /* as written; NULL: the binary chunk of a .glb, a data URI, a buffer view */
    size_t length; /* byteLength of a buffer; 0: any */
} gltf_json_file;

typedef struct gltf_json_input {
    char *text; /* NUL-terminated */
    gltf_json_file *buffers, *images;
    int buffer_count, image_count;
} gltf_json_input;

/* glb: the text comes from a .glb, whose first buffer needs no uri. */
hemi_result gltf_json_before_read(const char *text, size_t length, bool glb, gltf_json_input *out,
                                  char message[GLTF_MESSAGE_SIZE]);
void gltf_json_input_free(gltf_json_input *input);

/* What the `extras` of an element in tinygltf's text say: its number in the list it came from, or, coded below -1, that
 * it replaces that element. Without extras it is new. */
#define GLTF_ORIGIN_REPLACED(index) (-2 - (index))

typedef struct gltf_json_mend {
    const char *original;    /* the text that was read, NUL-terminated */
    size_t buffer_length;    /* of buffers[0]; 0: no buffer is written */
    const char *buffer_uri;  /* NULL: the binary chunk of a .glb */
    const char *extras_json; /* asset.extras.hemibake, or NULL */
    bool pretty;
} gltf_json_mend;

/* *out: malloc'ed, NUL-terminated. */
hemi_result gltf_json_after_write(const char *text, size_t length, const gltf_json_mend *mend, char **out,
                                  char message[GLTF_MESSAGE_SIZE]);

struct cJSON;

/* ---- gltf_json_check.c: private to the JSON files ---- */

hemi_result gltf_json_check(const struct cJSON *root, bool glb, char *message);

/* Whether a buffer only stands for what EXT_meshopt_compression unpacks, without bytes of its own. */
bool gltf_json_is_fallback(const struct cJSON *buffer);

/* ---- gltf_json_text.c ---- */

/* A tree whose numbers and escaped strings are printed as they stand in text; NULL if it is no JSON. */
struct cJSON *gltf_json_parse_exactly(const char *text);

#ifdef __cplusplus
}
#endif
#endif
