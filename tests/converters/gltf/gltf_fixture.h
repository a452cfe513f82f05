/* SPDX-License-Identifier: MIT
 * Which glTF scene do the tests of this folder read? A small one with one thing of every kind, built here.
 *
 *     root (moved by 1,2,3)
 *       floor       mesh 0, scaled by 2        baked
 *       floor again mesh 0, the same mesh      baked, but for its lines
 *       mover       mesh 0, animated           not baked
 *       glass       mesh 1, BLEND, lines       not baked
 *       eye         camera 0
 *       puppet      mesh 2, skinned            not baked
 *       lamp        light 0 of KHR_lights_punctual
 *       (nameless)  a joint: an empty node
 */
#ifndef HEMIBAKE_TESTS_GLTF_FIXTURE_H
#define HEMIBAKE_TESTS_GLTF_FIXTURE_H

#include "check.h"
#include "gltf_asset.h"
#include "gltf_container.h"

#include <stddef.h>
#include <stdlib.h>
#include <unistd.h>

typedef struct fixture_bin {
    float positions[12], normals[12], uvs[8];
    uint16_t quad[6], unused[2];
    uint8_t colors[16];
    float times[2], moves[6];
    uint8_t image[12];
    float bind[16];
    uint8_t joints[16];
    float weights[16];
    uint16_t lines[4];
} fixture_bin;

/* A unit square in the plane y = 0, front up. */
static inline fixture_bin fixture_make_bin(void) {
    return (fixture_bin){
        .positions = { 0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0 },
        .normals = { 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0 },
        .uvs = { 0, 0, 0, 1, 1, 1, 1, 0 },
        .quad = { 0, 1, 2, 0, 2, 3 },
        .colors = { 255, 0, 51, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255 },
        .times = { 0, 1 },
        .moves = { 0, 0, 0, 0, 1, 0 },
        .image = { 0x89, 'P', 'N', 'G', 13, 10, 26, 10, 1, 2, 3, 4 },
        .bind = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 },
        .weights = { 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0 },
        .lines = { 0, 1, 2, 3 },
    };
}

#define FIXTURE_VIEW(member) (int)offsetof(fixture_bin, member), (int)sizeof(((fixture_bin *)0)->member)

/* The text, malloc'ed. */
static inline char *fixture_make_json(void) {
    char *text = malloc(16384), *at = text;
    at += sprintf(
        at, "{\"asset\":{\"version\":\"2.0\",\"minVersion\":\"2.0\",\"generator\":\"a test\",\"copyright\":\"nobody\","
            "\"extras\":{\"kept\":1}},"
            "\"extensionsUsed\":[\"KHR_lights_punctual\",\"KHR_materials_emissive_strength\"],"
            "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\",\"name\":\"bulb\","
            "\"intensity\":5,\"color\":[1,0.5,0.25]}]}},"
            "\"scene\":0,\"scenes\":[{\"name\":\"room\",\"nodes\":[0],\"extras\":{\"big\":12345678901}}],"
            "\"nodes\":[{\"name\":\"root\",\"translation\":[1,2,3],\"children\":[1,2,3,4,5,6,7,8],"
            "\"extras\":{\"nested\":{\"empty\":{}},\"list\":[1,null,2.5]}},");
    at += sprintf(
        at, "{\"name\":\"floor\",\"mesh\":0,\"scale\":[2,2,2]},{\"name\":\"floor again\",\"mesh\":0},"
            "{\"name\":\"mover\",\"mesh\":0,\"translation\":[0,0,0]},{\"name\":\"glass\",\"mesh\":1},"
            "{\"name\":\"eye\",\"camera\":0,\"rotation\":[0,0.7071067811865476,0,0.7071067811865476]},"
            "{\"name\":\"puppet\",\"mesh\":2,\"skin\":0},"
            "{\"name\":\"lamp\",\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}},{}],"
            "\"cameras\":[{\"type\":\"perspective\",\"name\":\"lens\",\"perspective\":{\"yfov\":0.75,\"znear\":0.1}}],"
            "\"meshes\":[{\"name\":\"square\",\"extras\":{\"mesh\":true},\"primitives\":["
            "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2,\"COLOR_0\":4},\"indices\":3,"
            "\"material\":0,\"extras\":{\"first\":1}},"
            "{\"attributes\":{\"POSITION\":0},\"indices\":10,\"mode\":1,\"material\":1}]},"
            "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":10,\"mode\":1,\"material\":2}]},"
            "{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"JOINTS_0\":7,\"WEIGHTS_0\":8},\"indices\":3}]}],");
    at += sprintf(at,
                  "\"materials\":[{\"name\":\"glow\",\"doubleSided\":true,\"emissiveFactor\":[1,0.5,0],"
                  "\"extras\":{\"tag\":7},"
                  "\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":4}},"
                  "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.4,0.2,1],\"metallicFactor\":0.5,"
                  "\"baseColorTexture\":{\"index\":0}}},"
                  "{\"name\":\"wire\"},{\"name\":\"pane\",\"alphaMode\":\"BLEND\"}],"
                  "\"textures\":[{\"source\":0,\"sampler\":0}],\"samplers\":[{\"name\":\"rough\",\"magFilter\":9728}],"
                  "\"images\":[{\"bufferView\":7,\"mimeType\":\"image/png\",\"name\":\"checker\"}],"
                  "\"skins\":[{\"joints\":[8],\"inverseBindMatrices\":9,\"name\":\"bones\",\"extras\":{\"skin\":2}}],"
                  "\"animations\":[{\"name\":\"rise\",\"channels\":[{\"sampler\":0,\"target\":{\"node\":3,"
                  "\"path\":\"translation\"}}],\"samplers\":[{\"input\":5,\"output\":6}]}],");
    at += sprintf(
        at, "\"accessors\":["
            "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,0,1]},"
            "{\"bufferView\":1,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
            "{\"bufferView\":2,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"},"
            "{\"bufferView\":3,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"},"
            "{\"bufferView\":4,\"componentType\":5121,\"count\":4,\"type\":\"VEC4\",\"normalized\":true},"
            "{\"bufferView\":5,\"componentType\":5126,\"count\":2,\"type\":\"SCALAR\",\"min\":[0],\"max\":[1]},"
            "{\"bufferView\":6,\"componentType\":5126,\"count\":2,\"type\":\"VEC3\"},"
            "{\"bufferView\":9,\"componentType\":5121,\"count\":4,\"type\":\"VEC4\"},"
            "{\"bufferView\":10,\"componentType\":5126,\"count\":4,\"type\":\"VEC4\"},"
            "{\"bufferView\":8,\"componentType\":5126,\"count\":1,\"type\":\"MAT4\"},"
            "{\"bufferView\":11,\"componentType\":5123,\"count\":4,\"type\":\"SCALAR\"}],");
    at += sprintf(at,
                  "\"bufferViews\":["
#define VIEW_TEXT "{\"buffer\":0,\"byteOffset\":%d,\"byteLength\":%d}"
                  VIEW_TEXT "," VIEW_TEXT "," VIEW_TEXT "," VIEW_TEXT "," VIEW_TEXT "," VIEW_TEXT "," VIEW_TEXT
                  "," VIEW_TEXT "," VIEW_TEXT "," VIEW_TEXT "," VIEW_TEXT "," VIEW_TEXT "],",
#undef VIEW_TEXT
                  FIXTURE_VIEW(positions), FIXTURE_VIEW(normals), FIXTURE_VIEW(uvs), FIXTURE_VIEW(quad),
                  FIXTURE_VIEW(colors), FIXTURE_VIEW(times), FIXTURE_VIEW(moves), FIXTURE_VIEW(image),
                  FIXTURE_VIEW(bind), FIXTURE_VIEW(joints), FIXTURE_VIEW(weights), FIXTURE_VIEW(lines));
    sprintf(at, "\"buffers\":[{\"byteLength\":%d}]}", (int)sizeof(fixture_bin));
    return text;
}

/* ---- files ---------------------------------------------------------------------------------------------------- */

/* A folder of this program's own. */
static inline const char *fixture_folder(void) {
    static char path[256];
    const char *parent = getenv("TMPDIR");
    if (!path[0]) {
        snprintf(path, sizeof path, "%s/hemibake-gltf-XXXXXX", parent && *parent ? parent : "/tmp");
        if (!mkdtemp(path)) exit(2);
    }
    return path;
}

/* The path of a file in that folder; valid until the next four calls. */
static inline const char *fixture_path(const char *name) {
    static char paths[4][512];
    static int next;
    next = (next + 1) % 4;
    snprintf(paths[next], sizeof paths[next], "%s/%s", fixture_folder(), name);
    return paths[next];
}

static inline void fixture_write(const char *name, const void *bytes, size_t size) {
    FILE *file = fopen(fixture_path(name), "wb");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file) != 0) exit(2);
}

static inline void fixture_remove(const char *name) {
    remove(fixture_path(name));
}

static inline void fixture_clean(void) {
    rmdir(fixture_folder());
}

static inline uint8_t *fixture_glb(const char *json, const void *bin, size_t bin_size, size_t *size) {
    uint8_t *bytes = NULL, *to = NULL;
    if (gltf_container_join(json, strlen(json), bin_size, &bytes, size, &to) != HEMI_OK) exit(2);
    if (bin_size) memcpy(to, bin, bin_size);
    return bytes;
}

/* Writes JSON and binary as a .glb and reads it; the file is gone afterwards. */
static inline hemi_result fixture_read(const char *json, const void *bin, size_t bin_size, gltf_asset **out,
                                       char message[GLTF_MESSAGE_SIZE]) {
    size_t size;
    uint8_t *bytes = fixture_glb(json, bin, bin_size, &size);
    fixture_write("scene.glb", bytes, size);
    free(bytes);
    const gltf_limits limits = { .leaves_moving = true }; /* what moves is tests/cli/moving_test.py's */
    hemi_result result = gltf_asset_read_within(fixture_path("scene.glb"), &limits, out, message);
    fixture_remove("scene.glb");
    return result;
}

/* The same, for scenes that must be read; NULL counts as a failure. */
static inline gltf_asset *fixture_open(const char *json, const void *bin, size_t bin_size) {
    char message[GLTF_MESSAGE_SIZE];
    gltf_asset *asset = NULL;
    hemi_result result = fixture_read(json, bin, bin_size, &asset, message);
    if (result != HEMI_OK) fprintf(stderr, "result %d: %s\n", (int)result, message);
    CHECK_EQUAL(result, HEMI_OK);
    return asset;
}

static inline gltf_asset *fixture_open_scene(void) {
    fixture_bin bin = fixture_make_bin();
    char *json = fixture_make_json();
    gltf_asset *asset = fixture_open(json, &bin, sizeof bin);
    free(json);
    return asset;
}

/* text with the first occurrence of find replaced; malloc'ed. NULL if find does not occur. */
static inline char *fixture_replace(const char *text, const char *find, const char *replacement) {
    const char *at = strstr(text, find);
    if (!at) return NULL;
    char *out = malloc(strlen(text) + strlen(replacement) + 1);
    sprintf(out, "%.*s%s%s", (int)(at - text), text, replacement, at + strlen(find));
    return out;
}

#endif
