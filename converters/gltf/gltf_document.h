/* SPDX-License-Identifier: MIT
 * What does the JSON of an asset say, to the letter? It is parsed once, into the tree that this folder calls the
 * document; tinygltf reads the same text; a bake edits a copy of the tree, and that is printed once. So whatever nobody
 * here knows (extensions, extras, how a number was written) comes out as it went in. Private, C++.
 */
#ifndef HEMIBAKE_GLTF_DOCUMENT_H
#define HEMIBAKE_GLTF_DOCUMENT_H

#include <cjson/cJSON.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

struct gltf_json_deleter {
    void operator()(cJSON *item) const { cJSON_Delete(item); }
};
using gltf_json = std::unique_ptr<cJSON, gltf_json_deleter>;

/* ---- reading ---------------------------------------------------------------------------------------------------- */

/* Where the bytes of a buffer or an image are. */
struct gltf_source {
    std::string uri;   /* of a file or base64 data, as written; empty: the chunk of a .glb, a buffer view, nowhere */
    size_t length = 0; /* byteLength of a buffer */
    bool fallback = false;  /* a buffer without bytes, which only stands for what EXT_meshopt_compression unpacks */
    int view = -1;          /* bufferView of an image */
    std::string media_type; /* mimeType of an image in a buffer view */
};

/* What tinygltf gets instead of the text itself, and what is read without it. */
struct gltf_reading {
    std::string text;
    std::vector<gltf_source> buffers, images;
};

/* Refuses what is no JSON, or no glTF by gltf_document_check. glb: the first buffer needs no uri. */
gltf_json gltf_parse_document(const char *text, size_t length, bool glb);

/* Gives the numbers and escaped strings of the tree the text they were parsed from, and copies that text with a few
 * values exchanged, since tinygltf fails on or misreads what the specification allows. */
gltf_reading gltf_read_document(cJSON *root, const char *text, size_t length);

/* gltf_document_check.cpp: required members, numbers that are indices; messages name the place in the document. */
void gltf_check_document(const cJSON *root, bool glb);

bool gltf_is_fallback(const cJSON *buffer);
bool gltf_is_base64(const char *uri);

/* ---- members: NULL in, NULL out ---------------------------------------------------------------------------------- */

cJSON *gltf_member(const cJSON *object, const char *name);
cJSON *gltf_extension(const cJSON *element, const char *name);
std::vector<cJSON *> gltf_elements(const cJSON *list);

/* Whether the item was written as a number, which the tree holds as text then. */
bool gltf_is_number(const cJSON *item);
int gltf_index(const cJSON *object, const char *name); /* -1: there is none */

/* Whether a member of a material is a reference to a texture: all that Khronos ratified are called so. */
bool gltf_is_texture_info(const cJSON *item);

/* ---- editing: members keep their places, new ones go to the end; std::bad_alloc without memory ------------------- */

gltf_json gltf_copy(const cJSON *item);
void gltf_set(cJSON *object, const char *name, gltf_json value);
void gltf_set_text(cJSON *object, const char *name, const char *text);
void gltf_set_numbers(cJSON *object, const char *name, const double *values, size_t count);
void gltf_append(cJSON *list, gltf_json element);
void gltf_drop(cJSON *object, const char *name);
void gltf_drop_extension(cJSON *element, const char *name); /* and `extensions` with the last of them */

/* A number that is what it was keeps its text. */
void gltf_change_number(cJSON *number, double value);
void gltf_set_number(cJSON *object, const char *name, double value);

/* The object or array of that name, made if there is none. */
cJSON *gltf_object(cJSON *object, const char *name);
cJSON *gltf_list(cJSON *object, const char *name);

#endif
