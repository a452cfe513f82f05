/* SPDX-License-Identifier: MIT */
#include "preview.h"

#include "jpeg_encode.h"
#include "path_text.h"
#include "png_encode.h"

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the unlit background of a web page would be: a light grey. */
static const float BACKGROUND = 0.88f;

/* Of half its box: what is further from the origin is drawn about its own middle, as floats are too coarse there. */
static const double FAR_AWAY = 256.0;

/* Where what is drawn has its origin: that of the world, so that pictures stay as they are, unless it is far away. */
static void find_origin(const preview_mesh *meshes, size_t count, double origin[3]) {
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    double away = 0.0, half = 0.0;
    for (size_t i = 0; i < count; i++)
        for (size_t v = 0; meshes[i].shape.triangle_count && v < meshes[i].shape.vertex_count; v++) {
            double world[3];
            hemi_transform_point(meshes[i].shape.transform, meshes[i].shape.positions + 3 * v, world);
            for (int k = 0; k < 3; k++) low[k] = fmin(low[k], world[k]), high[k] = fmax(high[k], world[k]);
        }
    for (int k = 0; k < 3; k++) {
        origin[k] = high[k] >= low[k] ? 0.5 * (low[k] + high[k]) : 0.0;
        away = fmax(away, fabs(origin[k])), half = fmax(half, 0.5 * (high[k] - low[k]));
    }
    for (int k = 0; k < 3 && !(away > FAR_AWAY * half); k++) origin[k] = 0.0;
}

/* About an origin. */
static float *to_world(const hemi_mesh_desc *m, const double origin[3]) {
    float *out = malloc((3 * (size_t)m->vertex_count + 1) * sizeof *out);
    for (size_t v = 0; out && v < m->vertex_count; v++) {
        double world[3];
        hemi_transform_point(m->transform, m->positions + 3 * v, world);
        for (int k = 0; k < 3; k++) out[3 * v + k] = (float)(world[k] - origin[k]);
    }
    return out;
}

static float *white(uint32_t vertex_count) {
    float *out = malloc((3 * (size_t)vertex_count + 1) * sizeof *out);
    for (size_t i = 0; out && i < 3 * (size_t)vertex_count; i++) out[i] = 1.0f;
    return out;
}

/* IEC 61966-2-1 */
static uint8_t encode_srgb(float linear) {
    double v = linear <= 0.0031308f ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
    v = v < 0.0 ? 0.0 : v > 1.0 ? 1.0 : v;
    return (uint8_t)(255.0 * v + 0.5);
}

static bool find_camera(const gltf_asset *asset, const char *wanted, gltf_camera *out) {
    if (!wanted) return gltf_asset_camera(asset, 0, out);
    for (uint32_t i = 0; i < gltf_asset_camera_count(asset); i++)
        if (gltf_asset_camera(asset, i, out) && (strcmp(out->name, wanted) == 0 || strcmp(out->path, wanted) == 0))
            return true;
    char *end;
    unsigned long index = strtoul(wanted, &end, 10);
    return *wanted && !*end && index <= UINT32_MAX && gltf_asset_camera(asset, (uint32_t)index, out);
}

int preview_check_camera(const gltf_asset *asset, const options *o, console *c) {
    gltf_camera camera;
    if (o->look_at.is_given && !o->look_from.is_given) return console_error(c, "--look-at: it needs --look-from too");
    const double *from = o->look_from.values, *at = o->look_at.values;
    if (o->look_from.is_given && o->look_at.is_given && from[0] == at[0] && from[1] == at[1] && from[2] == at[2])
        return console_error(c, "--look-at: it is where --look-from is");
    if (!o->camera || find_camera(asset, o->camera, &camera)) return EXIT_DONE;
    return console_error(c, "--camera: there is no camera '%s'; the asset has %u, counted from 0", o->camera,
                         gltf_asset_camera_count(asset));
}

/* The middle of the box around all that is drawn. */
static void find_middle(const hemi_picture_desc *desc, double middle[3]) {
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t i = 0; i < desc->mesh_count; i++)
        for (size_t k = 0; k < 3 * (size_t)desc->meshes[i].vertex_count; k++) {
            low[k % 3] = fmin(low[k % 3], (double)desc->meshes[i].positions[k]);
            high[k % 3] = fmax(high[k % 3], (double)desc->meshes[i].positions[k]);
        }
    for (int k = 0; k < 3; k++) middle[k] = high[k] >= low[k] ? 0.5 * (low[k] + high[k]) : 0.0;
}

/* Where --look-from stands, about an origin. Who looks straight up or down has north, -z, at the top of the picture. */
static void look_from(const options *o, const double origin[3], hemi_picture_desc *desc) {
    memcpy(desc->eye, o->look_from.values, sizeof desc->eye);
    memcpy(desc->target, o->look_at.values, sizeof desc->target);
    for (int k = 0; k < 3; k++) desc->eye[k] -= origin[k], desc->target[k] -= origin[k];
    if (!o->look_at.is_given) find_middle(desc, desc->target);
    bool is_upright = desc->eye[0] == desc->target[0] && desc->eye[2] == desc->target[2];
    desc->up[1] = is_upright ? 0.0 : 1.0;
    desc->up[2] = is_upright ? -1.0 : 0.0;
}

static void set_camera(const gltf_asset *asset, const options *o, const double origin[3], hemi_picture_desc *desc) {
    gltf_camera camera;
    if (o->look_from.is_given) {
        look_from(o, origin, desc);
        return;
    }
    if (!find_camera(asset, o->camera, &camera)) return;
    for (int k = 0; k < 3; k++)
        desc->eye[k] = camera.eye[k] - origin[k], desc->target[k] = camera.target[k] - origin[k];
    memcpy(desc->up, camera.up, sizeof desc->up);
    desc->vertical_fov = camera.yfov;
}

/* What the name of the picture asks for. */
static hemi_result encode_as(const char *name, const uint8_t *rgba, const options *o, unsigned char **bytes,
                             size_t *size) {
    bool is_jpeg = path_ends_in(name, ".jpg") || path_ends_in(name, ".jpeg");
    return (is_jpeg ? jpeg_encode : png_encode)(rgba, o->size[0], o->size[1], bytes, size);
}

static int encode(const float *pixels, const options *o, console *c, unsigned char **bytes, size_t *size) {
    size_t count = (size_t)o->size[0] * o->size[1];
    uint8_t *rgba = malloc(4 * count);
    hemi_result result = rgba ? HEMI_OK : HEMI_ERROR_MEMORY;
    for (size_t i = 0; rgba && i < count; i++) {
        for (int k = 0; k < 3; k++) rgba[4 * i + k] = encode_srgb(pixels[4 * i + k]);
        rgba[4 * i + 3] = 255;
    }
    const char *name = o->command == COMMAND_RENDER    ? o->output
                       : o->command == COMMAND_COMPARE ? o->heatmap
                                                       : o->preview;
    if (rgba) result = encode_as(name, rgba, o, bytes, size);
    free(rgba);
    return result == HEMI_OK ? EXIT_DONE : console_error(c, "the picture: %s", hemi_result_text(result));
}

/* One opaque texel: what blends by a factor alone does so by w. */
static const uint8_t OPAQUE_TEXEL = 255;
static const hemi_alpha_mask EVEN = { .struct_size = sizeof EVEN, .alpha = &OPAQUE_TEXEL, .width = 1, .height = 1 };

static float *even_coordinates(uint32_t vertex_count, double opacity) {
    float *out = calloc(3 * (size_t)vertex_count + 1, sizeof *out);
    for (size_t v = 0; out && v < vertex_count; v++) out[3 * v + 2] = (float)opacity;
    return out;
}

/* The u, v, w of a mesh's mask; NULL when out of memory. */
static float *mask_coordinates(const gltf_asset *asset, uint32_t index, const preview_mesh *m) {
    hemi_mesh_desc own;
    gltf_asset_mesh(asset, index, &own);
    const size_t count = own.attribute_count;
    float *out = malloc((3 * (size_t)m->shape.vertex_count + 1) * sizeof *out);
    const float *from = own.attributes + m->mask->attribute;
    const bool moved = m->view && m->view->source_triangles;
    for (size_t v = 0; out && v < m->shape.vertex_count; v++) {
        const size_t at = m->corners ? m->corners[v] : v;
        if (!moved) memcpy(out + 3 * v, from + count * at, 3 * sizeof *out);
        for (size_t k = 0; moved && k < 3; k++) {
            const uint32_t *corner = own.indices + 3 * (size_t)m->view->source_triangles[v];
            out[3 * v + k] = 0.0f;
            for (size_t i = 0; i < 3; i++)
                out[3 * v + k] += m->view->source_weights[3 * v + i] * from[count * corner[i] + k];
        }
    }
    return out;
}

/* What is cut out of a mesh, or how much it covers. False: out of memory. */
static bool take_mask(const gltf_asset *asset, uint32_t index, const preview_mesh *m, hemi_picture_mask *out,
                      bool *blends) {
    const double opacity = gltf_asset_mesh_opacity(asset, index);
    *blends = opacity < 1.0 || gltf_asset_mesh_blends(asset, index);
    if (m->mask) {
        *out = (hemi_picture_mask){ m->mask, mask_coordinates(asset, index, m) };
        *blends = gltf_asset_mesh_blends(asset, index);
    } else if (opacity < 1.0) {
        *out = (hemi_picture_mask){ &EVEN, even_coordinates(m->shape.vertex_count, opacity) };
    }
    return !out->mask || out->coordinates;
}

typedef struct shown {
    const gltf_asset *asset;
    const preview_mesh *meshes;
} shown;

static void shade(void *user, size_t mesh, uint32_t triangle, const double weights[3], double share, float rgb[3]) {
    const shown *s = user;
    const preview_mesh *m = &s->meshes[mesh];
    const uint32_t *corners = m->corners ? m->corners : m->shape.indices;
    gltf_asset_mesh_shown(s->asset, (uint32_t)mesh, corners + 3 * (size_t)triangle, weights, share, rgb);
    for (size_t k = 0; k < 3; k++) rgb[k] = fmaxf(rgb[k], m->glow[k]);
}

int preview_draw(hemi_context *context, const gltf_asset *asset, const preview_mesh *meshes, size_t count,
                 bool shows_textures, const options *o, console *c, unsigned char **bytes, size_t *size) {
    hemi_picture_mesh *drawn = calloc(count + 1, sizeof *drawn);
    hemi_picture_mask *masks = calloc(count + 1, sizeof *masks);
    bool *blended = calloc(count + 1, sizeof *blended);
    float *pixels = malloc(4 * (size_t)o->size[0] * o->size[1] * sizeof *pixels);
    bool ok = drawn && masks && blended && pixels;
    int status = EXIT_BAD_INPUT;
    double origin[3];
    find_origin(meshes, count, origin);
    hemi_picture_desc desc = { .struct_size = sizeof desc,
                               .meshes = drawn,
                               .mesh_count = count,
                               .width = o->size[0],
                               .height = o->size[1],
                               .flat = o->bake.flat,
                               .background = { BACKGROUND, BACKGROUND, BACKGROUND },
                               .shade = shows_textures ? shade : NULL,
                               .shade_user = &(shown){ asset, meshes },
                               .masks = masks,
                               .blended = blended };
    for (size_t i = 0; ok && i < count; i++) {
        const hemi_mesh_desc *shape = &meshes[i].shape;
        drawn[i] = (hemi_picture_mesh){ .positions = to_world(shape, origin),
                                        .colors = meshes[i].colors ? meshes[i].colors : white(shape->vertex_count),
                                        .indices = shape->indices,
                                        .vertex_count = shape->vertex_count,
                                        .triangle_count = shape->triangle_count };
        ok = take_mask(asset, (uint32_t)i, &meshes[i], &masks[i], &blended[i]) && drawn[i].positions && drawn[i].colors;
    }
    if (ok) set_camera(asset, o, origin, &desc);
    if (!ok)
        console_error(c, "out of memory while drawing");
    else if (hemi_picture(context, &desc, pixels) == HEMI_OK)
        status = encode(pixels, o, c, bytes, size);
    for (size_t i = 0; drawn && i < count; i++) {
        free((void *)drawn[i].positions);
        if (!meshes[i].colors) free((void *)drawn[i].colors);
        if (masks) free((void *)masks[i].coordinates);
    }
    free(masks);
    free(blended);
    free(drawn);
    free(pixels);
    return status;
}

int preview_draw_asset(hemi_context *context, const gltf_asset *asset, const options *o, console *c,
                       unsigned char **bytes, size_t *size) {
    uint32_t count = gltf_asset_mesh_count(asset);
    preview_mesh *meshes = calloc(count + 1, sizeof *meshes);
    for (uint32_t i = 0; meshes && i < count; i++) {
        gltf_asset_mesh(asset, i, &meshes[i].shape);
        meshes[i].colors = gltf_asset_mesh_color(asset, i);
        meshes[i].mask = gltf_asset_mesh_mask(asset, i);
    }
    int status = meshes ? preview_draw(context, asset, meshes, count, true, o, c, bytes, size)
                        : console_error(c, "out of memory while drawing");
    free(meshes);
    return status;
}
