/* SPDX-License-Identifier: MIT
 * What does each reader make of these bytes (those that take no file: calls.c)? Anything but a crash, a leak, a hang,
 * or success without what it promises.
 */
#include "targets.h"

#include "draco_codec.h"
#include "gltf_asset.h"
#include "ies_profile.h"
#include "image_decode.h"
#include "panorama_decode.h"
#include "probes.h"
#include "vs3_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Small, so that time goes into ways through the code and not into pixels and points. */
enum { PIXELS_MOST = 1 << 16, POINTS_MOST = 1 << 16 };

/* A failure has a line of its own; success has none. */
static void check_message(hemi_result result, const char *message) {
    if ((result != HEMI_OK) != (message[0] != 0) || strchr(message, '\n')) abort();
}

static hemi_result keep_colors(void *user, bool texels, const char *file, float *rgb, size_t count) {
    (void)user, (void)texels, (void)file, (void)rgb, (void)count;
    return HEMI_OK;
}

/* What a bake asks of an asset. */
static void walk(gltf_asset *asset) {
    char message[GLTF_MESSAGE_SIZE];
    hemi_material_desc material = { .struct_size = sizeof material };
    hemi_light_desc light = { .struct_size = sizeof light };
    hemi_sky_desc sky = { .struct_size = sizeof sky };
    gltf_camera camera;
    check_message(gltf_asset_read_textures(asset, keep_colors, NULL, message), message);
    for (uint32_t i = 0; i < gltf_asset_mesh_count(asset); i++) {
        hemi_mesh_desc mesh = { .struct_size = sizeof mesh };
        if (!gltf_asset_mesh(asset, i, &mesh)) continue;
        for (size_t k = 0; k < 3 * (size_t)mesh.triangle_count; k++)
            if (mesh.indices[k] >= mesh.vertex_count) abort();
        gltf_asset_texture(asset, i, &mesh);
        gltf_asset_mesh_mask(asset, i);
        gltf_asset_mesh_opacity(asset, i);
    }
    for (uint32_t i = 0; i < gltf_asset_material_count(asset); i++) gltf_asset_material(asset, i, &material);
    for (uint32_t i = 0; gltf_asset_light(asset, i, &light); i++) {
    }
    for (uint32_t i = 0; i < gltf_asset_camera_count(asset); i++) gltf_asset_camera(asset, i, &camera);
    gltf_asset_sky(asset, &sky);
}

static void fuzz_gltf(const uint8_t *bytes, size_t size) {
    char message[GLTF_MESSAGE_SIZE];
    gltf_asset *asset = NULL;
    /* No file is read: nothing lies in a folder that is not there. */
    const gltf_limits limits = { .root = "/nowhere", .bytes = bytes, .byte_count = size, .image_pixels = PIXELS_MOST };
    hemi_result result = gltf_asset_read_within("fuzz.glb", &limits, &asset, message);
    check_message(result, message);
    if ((result == HEMI_OK) != (asset != NULL)) abort();
    if (asset) walk(asset);
    gltf_asset_destroy(asset);
}

static void fuzz_draco(const uint8_t *bytes, size_t size) {
    draco_codec_mesh *mesh = NULL;
    hemi_result result = draco_codec_decode(bytes, size, POINTS_MOST, POINTS_MOST, &mesh);
    if ((result == HEMI_OK) != (mesh != NULL)) abort();
    if (mesh && draco_codec_mesh_point_count(mesh) > POINTS_MOST) abort();
    draco_codec_mesh_destroy(mesh);
}

static void fuzz_image(const uint8_t *bytes, size_t size) {
    char message[IMAGE_MESSAGE_SIZE] = "";
    image_pixels pixels = { 0 };
    check_message(image_decode(bytes, size, PIXELS_MOST, &pixels, message), message);
    image_pixels_free(&pixels);
}

static void fuzz_hdr(const uint8_t *bytes, size_t size) {
    char note[PANORAMA_NOTE_SIZE], message[IMAGE_MESSAGE_SIZE];
    hdr_image image = { 0 };
    hemi_result result = panorama_decode(bytes, size, &image, note, message);
    check_message(result, message);
    for (size_t i = 0; i < 3 * (size_t)image.width * image.height; i++)
        if (!isfinite(image.rgb[i]) || image.rgb[i] < 0.0f) abort();
    hdr_image_free(&image);
}

static void fuzz_vs3(const uint8_t *bytes, size_t size) {
    char message[VS3_MESSAGE_SIZE] = "";
    vs3_scene scene = { 0 };
    check_message(vs3_parse(bytes, size, &scene, message), message);
    vs3_scene_free(&scene);
}

static void fuzz_hprb(const uint8_t *bytes, size_t size) {
    char message[PROBES_MESSAGE_SIZE] = "";
    probe_set set = { 0 };
    check_message(probe_set_parse(bytes, size, &set, message), message);
    probe_set_destroy(&set);
}

static void fuzz_ies(const uint8_t *bytes, size_t size) {
    char message[IES_MESSAGE_SIZE] = "";
    ies_profile profile = { 0 };
    check_message(ies_profile_read(bytes, size, &profile, message), message);
    ies_profile_free(&profile);
}

const fuzz_target FUZZ_TARGETS[] = { { "gltf", fuzz_gltf }, { "draco", fuzz_draco },     { "image", fuzz_image },
                                     { "hdr", fuzz_hdr },   { "vs3", fuzz_vs3 },         { "hprb", fuzz_hprb },
                                     { "ies", fuzz_ies },   { "meshopt", fuzz_meshopt }, { "scene", fuzz_scene },
                                     { "bake", fuzz_bake }, { "config", fuzz_config },   { "factor", fuzz_factor },
                                     { "kept", fuzz_kept }, { "rows", fuzz_rows },       { "ckpt", fuzz_checkpoint },
                                     { NULL, NULL } };

const fuzz_target *fuzz_target_named(const char *name) {
    for (const fuzz_target *t = FUZZ_TARGETS; t->name; t++)
        if (name && strcmp(name, t->name) == 0) return t;
    return NULL;
}

hemi_context *fuzz_context(void) {
    static hemi_context *context;
    const hemi_context_desc one = { .struct_size = sizeof one, .threads = 1 };
    if (!context && hemi_context_create(&one, &context) != HEMI_OK) abort();
    return context;
}
