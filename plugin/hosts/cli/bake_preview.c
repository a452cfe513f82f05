/* SPDX-License-Identifier: MIT */
#include "bake_preview.h"

#include "asset_input.h"
#include "baked_glb.h"
#include "false_color.h"
#include "preview.h"
#include "triangle_area.h"
#include "usd_files.h"

#include <math.h>
#include <stdlib.h>

/* ---- after ------------------------------------------------------------------------------------------------------- */

/* What a bake would write, without what no picture shows and without loss. */
static int serialise(const gltf_asset *asset, const baked_colors *colors, const options *o, console *c,
                     gltf_output *out) {
    const light_names groups = { 0 };
    options seen = *o;
    seen.keep_pbr = seen.scene_linear = seen.bake.vertex_errors = false;
    seen.no_draco = true;
    const baked_glb glb = {
        .o = &seen, .asset = asset, .colors = colors, .for_usd = usd_is_output(o->output), .groups = &groups
    };
    return baked_glb_make(&glb, c, out);
}

/* What the asset names and does not hold lies where the input looks for it, and no further than that may. */
static int read_back(const gltf_output *written, const options *o, console *c, gltf_asset **out) {
    char message[GLTF_MESSAGE_SIZE];
    const char *input = o->continues ? o->continues : o->inputs[0];
    const bool is_usd = usd_is_input(input);
    const gltf_limits limits = { .root = is_usd ? NULL : o->root,
                                 .image_pixels = o->max_pixels,
                                 .bytes = written->main,
                                 .byte_count = written->main_size,
                                 .scene = is_usd ? NULL : o->scene };
    hemi_result result = gltf_asset_read_within(input, &limits, out, message);
    if (result == HEMI_OK) result = gltf_asset_read_shown(*out, message);
    return result == HEMI_OK ? EXIT_DONE : console_error(c, "the picture: %s", message);
}

int bake_preview(hemi_context *context, const gltf_asset *asset, const baked_colors *colors, const options *o,
                 console *c, unsigned char **bytes, size_t *size) {
    gltf_output written = { 0 };
    gltf_asset *shown = NULL;
    int status = serialise(asset, colors, o, c, &written);
    if (status == EXIT_DONE) status = read_back(&written, o, c, &shown);
    gltf_output_free(&written);
    if (status == EXIT_DONE) status = preview_draw_asset(context, shown, o, c, bytes, size);
    gltf_asset_destroy(shown);
    return status;
}

/* ---- where it is off --------------------------------------------------------------------------------------------- */

/* Of vertices, the share that the lightest colour is for. */
static const double BEYOND_FULL = 0.05;

static int compare_floats(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static double full_error(const baked_colors *colors) {
    size_t count = 0, at = 0;
    for (uint32_t i = 0; i < colors->mesh_count; i++) count += colors->views[i].vertex_count;
    float *all = malloc((count + 1) * sizeof *all);
    for (uint32_t i = 0; all && i < colors->mesh_count; i++)
        for (uint32_t v = 0; colors->views[i].errors && v < colors->views[i].vertex_count; v++)
            all[at++] = colors->views[i].errors[v];
    if (all) qsort(all, at, sizeof *all, compare_floats);
    double full = all && at ? (double)all[(size_t)((1.0 - BEYOND_FULL) * (double)(at - 1))] : 0.0;
    free(all);
    return full;
}

/* What no error is known of: a grey that none has. */
static const float UNKNOWN = 0.35f;

static float *error_colors(const hemi_mesh_view *v, double full) {
    float *rgb = calloc(3 * (size_t)v->vertex_count + 1, sizeof *rgb);
    for (uint32_t i = 0; rgb && v->errors && full > 0.0 && i < v->vertex_count; i++)
        false_color((double)v->errors[i] / full, rgb + 3 * (size_t)i);
    return rgb;
}

static float *grey(uint32_t vertex_count) {
    float *rgb = malloc((3 * (size_t)vertex_count + 1) * sizeof *rgb);
    for (size_t i = 0; rgb && i < 3 * (size_t)vertex_count; i++) rgb[i] = UNKNOWN;
    return rgb;
}

/* A mesh in the colours of its errors; what is not baked has none and is grey. */
static bool take_errors(const gltf_asset *asset, const baked_colors *colors, uint32_t index, double full,
                        preview_mesh *out) {
    const hemi_mesh_view *v = &colors->views[index];
    const bool is_left = gltf_asset_mesh_is_left(asset, index);
    if (is_left)
        gltf_asset_mesh(asset, index, &out->shape);
    else
        baked_colors_mesh(colors, asset, index, &out->shape);
    out->colors = is_left ? grey(out->shape.vertex_count) : error_colors(v, full);
    out->mask = is_left || v->source_triangles ? gltf_asset_mesh_mask(asset, index) : NULL;
    out->view = is_left ? NULL : v;
    return out->colors != NULL;
}

int bake_preview_errors(hemi_context *context, const gltf_asset *asset, const baked_colors *colors, const options *o,
                        console *c, unsigned char **bytes, size_t *size, double *full) {
    const uint32_t count = colors->mesh_count;
    preview_mesh *meshes = calloc(count + 1, sizeof *meshes);
    int status = meshes ? EXIT_DONE : EXIT_BAD_INPUT;
    *full = full_error(colors);
    for (uint32_t i = 0; status == EXIT_DONE && i < count; i++)
        if (!baked_glb_hides(asset, o, i) && !take_errors(asset, colors, i, *full, &meshes[i])) status = EXIT_BAD_INPUT;
    if (status == EXIT_DONE) status = preview_draw(context, asset, meshes, count, false, o, c, bytes, size);
    for (uint32_t i = 0; meshes && i < count; i++) free((void *)meshes[i].colors);
    free(meshes);
    return status;
}

/* ---- before ------------------------------------------------------------------------------------------------------ */

/* Where flat light comes from, a unit vector, and how bright what faces across it stays. */
static const double FLAT_LIGHT[3] = { 0.36, 0.80, 0.48 };
static const double FLAT_SHADE = 0.45;

/* A mesh whose triangles share no vertices, so that what has no normals has a shade for each. */
typedef struct faceted_mesh {
    float *positions, *colors;
    uint32_t *indices;
} faceted_mesh;

/* A normal of the mesh in the world, on the side of its facet: planes follow the cofactors of what moves points. */
static void world_normal(const hemi_mesh_desc *mesh, uint32_t vertex, const double facet[3], double out[3]) {
    const float zero[3] = { 0, 0, 0 };
    double origin[3], axes[3][3], side = 0.0, length = 0.0;
    hemi_transform_point(mesh->transform, zero, origin);
    for (int c = 0; c < 3; c++) {
        const float unit[3] = { c == 0, c == 1, c == 2 };
        hemi_transform_point(mesh->transform, unit, axes[c]);
        for (int k = 0; k < 3; k++) axes[c][k] -= origin[k];
    }
    for (int k = 0; k < 3; k++) {
        const int p = (k + 1) % 3, q = (k + 2) % 3;
        out[k] = 0.0;
        for (int c = 0; c < 3; c++) {
            const double *u = axes[(c + 1) % 3], *v = axes[(c + 2) % 3];
            out[k] += (double)mesh->normals[3 * (size_t)vertex + (size_t)c] * (u[p] * v[q] - u[q] * v[p]);
        }
        side += out[k] * facet[k], length += out[k] * out[k];
    }
    double scale = length > 0.0 ? copysign(1.0 / sqrt(length), side) : 0.0;
    for (int k = 0; k < 3; k++) out[k] *= scale;
}

static double flat_light(const double normal[3]) {
    double faces = 0.0;
    for (int k = 0; k < 3; k++) faces += FLAT_LIGHT[k] * normal[k];
    return FLAT_SHADE + (1.0 - FLAT_SHADE) * 0.5 * (1.0 + faces);
}

static void shade(const hemi_mesh_desc *mesh, const float *own, const double factor[3], uint32_t t,
                  const faceted_mesh *out) {
    const uint32_t *corner = mesh->indices + 3 * (size_t)t;
    double normal[3], area = triangle_area(mesh->positions, mesh->transform, corner, normal);
    for (int k = 0; k < 3; k++) normal[k] = area > 0.0 ? normal[k] / area : 0.0;
    for (size_t i = 0; i < 3; i++) {
        double smooth[3] = { normal[0], normal[1], normal[2] };
        if (mesh->normals) world_normal(mesh, corner[i], normal, smooth);
        for (size_t k = 0; k < 3; k++) {
            size_t at = 9 * (size_t)t + 3 * i + k, from = 3 * (size_t)corner[i] + k;
            out->positions[at] = mesh->positions[from];
            out->colors[at] = (float)(flat_light(smooth) * factor[k] * (own ? (double)own[from] : 1.0));
            out->indices[3 * (size_t)t + i] = 3 * t + (uint32_t)i;
        }
    }
}

/* has_pictures: the factor of the base colour is multiplied by with its texture. */
static bool facet(const gltf_asset *asset, uint32_t index, const hemi_mesh_desc *mesh, bool has_pictures,
                  faceted_mesh *out) {
    size_t count = 9 * (size_t)mesh->triangle_count + 1;
    double factor[3] = { 1.0, 1.0, 1.0 };
    *out = (faceted_mesh){ malloc(count * sizeof(float)), malloc(count * sizeof(float)),
                           malloc(count * sizeof(uint32_t)) };
    if (!out->positions || !out->colors || !out->indices) return false;
    if (!has_pictures) gltf_asset_mesh_factor(asset, index, factor);
    const float *own = gltf_asset_mesh_color(asset, index);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) shade(mesh, own, factor, t, out);
    return true;
}

/* A lamp shines before the bake too, or it would be as dark as what it does not reflect. What textures say, or what is
 * unlit and lights nothing, is left to the colours. */
static void find_glow(const gltf_asset *asset, uint32_t index, const hemi_mesh_desc *mesh, float glow[3]) {
    hemi_mesh_desc textured = *mesh;
    hemi_material_desc material;
    if (gltf_asset_mesh_is_unlit(asset, index) || gltf_asset_texture(asset, index, &textured) ||
        !gltf_asset_material(asset, mesh->material, &material))
        return;
    for (size_t k = 0; k < 3; k++) glow[k] = (float)fmin(material.emission[k], 1.0);
}

/* The input once more, with what viewers see of its textures, which bakes do not keep. */
static int read_shown(const options *o, console *c, gltf_asset **out) {
    char message[GLTF_MESSAGE_SIZE];
    options as_read = *o;
    int status = asset_input_read(o, c, NULL, &as_read, out);
    if (status == EXIT_DONE && gltf_asset_read_shown(*out, message) != HEMI_OK)
        status = console_error(c, "the picture: %s", message);
    return status;
}

/* baked: the asset with what it emits. */
static int draw_before(hemi_context *context, const gltf_asset *asset, const gltf_asset *baked, bool has_pictures,
                       const options *o, console *c, unsigned char **bytes, size_t *size) {
    uint32_t count = gltf_asset_mesh_count(asset);
    preview_mesh *meshes = calloc(count + 1, sizeof *meshes);
    faceted_mesh *facets = calloc(count + 1, sizeof *facets);
    int status = meshes && facets ? EXIT_DONE : EXIT_BAD_INPUT;
    for (uint32_t i = 0; status == EXIT_DONE && i < count; i++) {
        hemi_mesh_desc *shape = &meshes[i].shape;
        if (baked_glb_hides(asset, o, i)) continue;
        gltf_asset_mesh(asset, i, shape);
        find_glow(baked, i, shape, meshes[i].glow);
        if (o->bake.normals == HEMI_NORMALS_FACES) shape->normals = NULL;
        if (!facet(asset, i, shape, has_pictures, &facets[i])) status = EXIT_BAD_INPUT;
        meshes[i].corners = shape->indices;
        meshes[i].mask = has_pictures ? gltf_asset_mesh_mask(asset, i) : NULL;
        shape->positions = facets[i].positions;
        shape->normals = NULL;
        shape->indices = facets[i].indices;
        shape->vertex_count = 3 * shape->triangle_count;
        meshes[i].colors = facets[i].colors;
    }
    if (status == EXIT_DONE) status = preview_draw(context, asset, meshes, count, has_pictures, o, c, bytes, size);
    for (uint32_t i = 0; facets && i < count; i++) {
        free(facets[i].positions);
        free(facets[i].colors);
        free(facets[i].indices);
    }
    free(meshes);
    free(facets);
    return status;
}

int bake_preview_before(hemi_context *context, const gltf_asset *asset, const options *o, console *c,
                        unsigned char **bytes, size_t *size) {
    gltf_asset *shown = NULL;
    /* To read a stage takes a process of its own: it is seen without. */
    if (usd_is_input(o->continues ? o->continues : o->inputs[0]))
        return draw_before(context, asset, asset, false, o, c, bytes, size);
    int status = read_shown(o, c, &shown);
    if (status == EXIT_DONE) status = draw_before(context, shown, asset, true, o, c, bytes, size);
    gltf_asset_destroy(shown);
    return status;
}
