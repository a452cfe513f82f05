/* SPDX-License-Identifier: MIT */
#include "bake_preview.h"

#include "baked_glb.h"
#include "false_color.h"
#include "preview.h"
#include "triangle_area.h"

#include <stdlib.h>

int bake_preview(hemi_context *context, const gltf_asset *asset, const baked_colors *colors, const options *o,
                 console *c, unsigned char **bytes, size_t *size) {
    uint32_t count = colors->mesh_count;
    preview_mesh *meshes = calloc(count + 1, sizeof *meshes);
    int status = meshes ? EXIT_DONE : EXIT_BAD_INPUT;
    for (uint32_t i = 0; status == EXIT_DONE && i < count; i++) {
        const hemi_mesh_view *v = &colors->views[i];
        if (baked_glb_hides(asset, o, i)) continue;
        baked_colors_mesh(colors, asset, i, &meshes[i].shape);
        meshes[i].colors = colors->seen[i];
        meshes[i].mask = v->source_triangles ? gltf_asset_mesh_mask(asset, i) : NULL;
        meshes[i].view = v;
    }
    if (status == EXIT_DONE) status = preview_draw(context, asset, meshes, count, false, o, c, bytes, size);
    free(meshes);
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

static float *error_colors(const hemi_mesh_view *v, double full) {
    float *rgb = calloc(3 * (size_t)v->vertex_count + 1, sizeof *rgb);
    for (uint32_t i = 0; rgb && v->errors && full > 0.0 && i < v->vertex_count; i++)
        false_color((double)v->errors[i] / full, rgb + 3 * (size_t)i);
    return rgb;
}

int bake_preview_errors(hemi_context *context, const gltf_asset *asset, const baked_colors *colors, const options *o,
                        console *c, unsigned char **bytes, size_t *size, double *full) {
    baked_colors shown = *colors;
    shown.seen = calloc(colors->mesh_count + 1, sizeof *shown.seen);
    bool ok = shown.seen;
    *full = full_error(colors);
    for (uint32_t i = 0; ok && i < colors->mesh_count; i++)
        ok = (shown.seen[i] = error_colors(&colors->views[i], *full)) != NULL;
    int status = ok ? bake_preview(context, asset, &shown, o, c, bytes, size) : EXIT_BAD_INPUT;
    for (uint32_t i = 0; shown.seen && i < colors->mesh_count; i++) free(shown.seen[i]);
    free(shown.seen);
    return status;
}

/* ---- before ------------------------------------------------------------------------------------------------------ */

/* Where flat light comes from, a unit vector, and how bright what faces across it stays. */
static const double FLAT_LIGHT[3] = { 0.36, 0.80, 0.48 };
static const double FLAT_SHADE = 0.45;

/* A mesh whose triangles share no vertices, so that each has its own shade. */
typedef struct faceted_mesh {
    float *positions, *colors;
    uint32_t *indices;
} faceted_mesh;

static void shade(const hemi_mesh_desc *mesh, const float *own, const double factor[3], uint32_t t,
                  const faceted_mesh *out) {
    const uint32_t *corner = mesh->indices + 3 * (size_t)t;
    double normal[3], area = triangle_area(mesh->positions, mesh->transform, corner, normal), faces = 0.0;
    for (int k = 0; k < 3; k++) faces += area > 0.0 ? FLAT_LIGHT[k] * normal[k] / area : 0.0;
    double light = FLAT_SHADE + (1.0 - FLAT_SHADE) * 0.5 * (1.0 + faces);
    for (size_t i = 0; i < 3; i++)
        for (size_t k = 0; k < 3; k++) {
            size_t at = 9 * (size_t)t + 3 * i + k, from = 3 * (size_t)corner[i] + k;
            out->positions[at] = mesh->positions[from];
            out->colors[at] = (float)(light * factor[k] * (own ? (double)own[from] : 1.0));
            out->indices[3 * (size_t)t + i] = 3 * t + (uint32_t)i;
        }
}

static bool facet(const gltf_asset *asset, uint32_t index, const hemi_mesh_desc *mesh, faceted_mesh *out) {
    size_t count = 9 * (size_t)mesh->triangle_count + 1;
    double factor[3];
    *out = (faceted_mesh){ malloc(count * sizeof(float)), malloc(count * sizeof(float)),
                           malloc(count * sizeof(uint32_t)) };
    if (!out->positions || !out->colors || !out->indices) return false;
    gltf_asset_mesh_factor(asset, index, factor);
    const float *own = gltf_asset_mesh_color(asset, index);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) shade(mesh, own, factor, t, out);
    return true;
}

int bake_preview_before(hemi_context *context, const gltf_asset *asset, const options *o, console *c,
                        unsigned char **bytes, size_t *size) {
    uint32_t count = gltf_asset_mesh_count(asset);
    preview_mesh *meshes = calloc(count + 1, sizeof *meshes);
    faceted_mesh *facets = calloc(count + 1, sizeof *facets);
    int status = meshes && facets ? EXIT_DONE : EXIT_BAD_INPUT;
    for (uint32_t i = 0; status == EXIT_DONE && i < count; i++) {
        hemi_mesh_desc *shape = &meshes[i].shape;
        if (baked_glb_hides(asset, o, i)) continue;
        gltf_asset_mesh(asset, i, shape);
        if (!facet(asset, i, shape, &facets[i])) status = EXIT_BAD_INPUT;
        shape->positions = facets[i].positions;
        shape->indices = facets[i].indices;
        shape->vertex_count = 3 * shape->triangle_count;
        meshes[i].colors = facets[i].colors;
    }
    if (status == EXIT_DONE) status = preview_draw(context, asset, meshes, count, false, o, c, bytes, size);
    for (uint32_t i = 0; facets && i < count; i++) {
        free(facets[i].positions);
        free(facets[i].colors);
        free(facets[i].indices);
    }
    free(meshes);
    free(facets);
    return status;
}
