/* SPDX-License-Identifier: MIT
 * See baked_colors.h.
 */
#include "baked_colors.h"

#include "exposure.h"
#include "instance_mean.h"

#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t count_vertices(const baked_colors *b) {
    size_t count = 0;
    for (uint32_t i = 0; i < b->mesh_count; i++) count += b->views[i].vertex_count;
    return count;
}

static bool emits(const gltf_asset *asset, uint32_t mesh) {
    hemi_mesh_desc desc;
    hemi_material_desc material;
    gltf_asset_mesh(asset, mesh, &desc);
    gltf_asset_material(asset, desc.material, &material);
    return material.emission[0] > 0.0 || material.emission[1] > 0.0 || material.emission[2] > 0.0;
}

/* A third of the area of its triangles to each vertex, in the mesh's own frame: a scale that a whole mesh shares. */
static void add_vertex_areas(const hemi_mesh_view *view, double scale, float *areas) {
    for (size_t t = 0; t < view->triangle_count; t++) {
        const uint32_t *i = view->indices + 3 * t;
        double p[3][3];
        triangle_from_floats(p, view->positions, i);
        for (int k = 0; k < 3; k++) areas[i[k]] += (float)(scale * triangle_area(p[0], p[1], p[2]) / 3.0);
    }
}

/* Area scale of a transform: exact for uniform scale, which meters well enough for the rest. */
static double area_scale(const double m[16]) {
    return m[15] == 0.0 ? 1.0 : pow(fabs(hemi_transform_determinant(m)), 2.0 / 3.0);
}

/* Points views at radiance in linear Rec.709. A configuration that cannot say what that is has its own instead. */
static bool to_rec709(baked_colors *b, uint32_t i, const color_transform *transform) {
    size_t count = b->views[i].vertex_count;
    b->radiance[i] = malloc((3 * count + 1) * sizeof *b->radiance[i]);
    if (!b->radiance[i]) return false;
    if (count == 0) return true;
    memcpy(b->radiance[i], b->views[i].radiance, 3 * count * sizeof *b->radiance[i]);
    b->views[i].radiance = b->radiance[i];
    hemi_result result = color_transform_apply_rec709(transform, b->radiance[i], count);
    return result == HEMI_OK || result == HEMI_ERROR_UNSUPPORTED;
}

static bool meter(const baked_colors *b, const gltf_asset *asset, double *ev) {
    size_t count = count_vertices(b), first = 0;
    float *radiance = malloc((3 * count + 1) * sizeof *radiance), *areas = calloc(count + 1, sizeof *areas);
    bool ok = radiance && areas;
    for (uint32_t i = 0; ok && i < b->mesh_count; i++) {
        hemi_mesh_desc desc;
        gltf_asset_mesh(asset, i, &desc);
        memcpy(radiance + 3 * first, b->views[i].radiance, 3 * (size_t)b->views[i].vertex_count * sizeof *radiance);
        if (!emits(asset, i)) add_vertex_areas(&b->views[i], area_scale(desc.transform), areas + first);
        first += b->views[i].vertex_count;
    }
    if (ok) *ev = exposure_meter(radiance, areas, count);
    free(radiance);
    free(areas);
    return ok;
}

static size_t clamp_colors(float *rgb, size_t count) {
    size_t clipped = 0;
    for (size_t v = 0; v < count; v++) {
        bool outside = false;
        for (int c = 0; c < 3; c++) {
            float *value = &rgb[3 * v + c];
            outside = outside || *value > 1.0f || *value < -COLOR_CLIP_SLACK;
            *value = fminf(fmaxf(*value, 0.0f), 1.0f);
        }
        clipped += outside;
    }
    return clipped;
}

/* Colours of radiance in the working space, or in linear Rec.709 if linear. NULL: out of memory, or OpenColorIO failed.
 */
static float *color_vertices(const baked_colors *b, const float *from, size_t count, const color_transform *transform,
                             bool linear, size_t *clipped) {
    float *colors = malloc((3 * count + 1) * sizeof *colors);
    hemi_result result = HEMI_OK;
    if (!colors) return NULL;
    if (count == 0) return colors;
    memcpy(colors, from, 3 * count * sizeof *colors);
    if (linear) {
        /* A configuration that cannot say what Rec.709 is has its own space instead. */
        result = color_transform_apply_rec709(transform, colors, count);
        if (result == HEMI_ERROR_UNSUPPORTED) result = HEMI_OK;
        *clipped = clamp_colors(colors, count);
    } else {
        exposure_apply(colors, count, b->exposure_ev);
        result = color_transform_apply(transform, colors, count, clipped);
    }
    if (result == HEMI_OK) return colors;
    free(colors);
    return NULL;
}

static bool color_mesh(baked_colors *b, uint32_t i, const hemi_mesh_view *solved, const color_transform *transform,
                       bool linear, size_t *clipped) {
    const float *radiance = b->means[i] ? b->means[i] : solved->radiance;
    const float *light = b->shown_means[i] ? b->shown_means[i] : solved->demodulated;
    size_t outside = 0, ignored;
    b->colors[i] = color_vertices(b, light ? light : radiance, solved->vertex_count, transform, linear, &outside);
    b->seen[i] = light ? color_vertices(b, radiance, solved->vertex_count, transform, linear, &ignored) : b->colors[i];
    *clipped += outside;
    return b->colors[i] && b->seen[i];
}

/* What instances share: radiance, and of what is textured the light that multiplies the texture. */
static bool share(const gltf_asset *asset, baked_colors *b) {
    hemi_mesh_view *shown = malloc((b->mesh_count + 1) * sizeof *shown);
    bool any = false;
    if (!shown) return false;
    for (uint32_t i = 0; i < b->mesh_count; i++) {
        shown[i] = b->views[i];
        any = any || shown[i].demodulated;
        if (shown[i].demodulated) shown[i].radiance = shown[i].demodulated;
    }
    bool ok = instance_mean(asset, b->views, b->mesh_count, b->means) &&
              (!any || instance_mean(asset, shown, b->mesh_count, b->shown_means));
    for (uint32_t i = 0; i < b->mesh_count; i++) {
        if (b->views[i].demodulated) continue;
        free(b->shown_means[i]);
        b->shown_means[i] = NULL;
    }
    free(shown);
    return ok;
}

static bool allocate(const gltf_asset *asset, baked_colors *out) {
    memset(out, 0, sizeof *out);
    out->mesh_count = gltf_asset_mesh_count(asset);
    out->views = calloc(out->mesh_count + 1, sizeof *out->views);
    out->colors = calloc(out->mesh_count + 1, sizeof *out->colors);
    out->radiance = calloc(out->mesh_count + 1, sizeof *out->radiance);
    out->means = calloc(out->mesh_count + 1, sizeof *out->means);
    out->shown_means = calloc(out->mesh_count + 1, sizeof *out->shown_means);
    out->seen = calloc(out->mesh_count + 1, sizeof *out->seen);
    return out->views && out->colors && out->radiance && out->means && out->shown_means && out->seen;
}

int baked_colors_make(const hemi_solution *solution, const gltf_asset *asset, const color_transform *transform,
                      const options *o, console *c, baked_colors *out) {
    size_t clipped = 0;
    bool ok = allocate(asset, out);
    for (uint32_t i = 0; ok && i < out->mesh_count; i++) {
        out->views[i].struct_size = sizeof out->views[i];
        ok = hemi_solution_mesh(solution, i, &out->views[i]) == HEMI_OK;
    }
    if (ok && o->keep_instances) ok = share(asset, out);
    for (uint32_t i = 0; ok && i < out->mesh_count; i++) ok = to_rec709(out, i, transform);
    out->exposure_ev = o->scene_linear ? 0.0 : o->exposure.ev;
    if (ok && !o->scene_linear && !o->exposure.is_fixed) ok = meter(out, asset, &out->exposure_ev);
    for (uint32_t i = 0; ok && i < out->mesh_count; i++) {
        hemi_mesh_view solved = { .struct_size = sizeof solved };
        hemi_solution_mesh(solution, i, &solved);
        ok = color_mesh(out, i, &solved, transform, o->scene_linear, &clipped);
    }
    if (!ok) {
        console_error(c, "out of memory while colouring the result");
        return EXIT_BAD_INPUT;
    }
    size_t vertices = count_vertices(out);
    out->clipped_fraction = vertices ? (double)clipped / (double)vertices : 0.0;
    return EXIT_DONE;
}

void baked_colors_free(baked_colors *b) {
    for (uint32_t i = 0; b->colors && b->seen && i < b->mesh_count; i++) {
        if (b->seen[i] != b->colors[i]) free(b->seen[i]);
        free(b->colors[i]);
    }
    for (uint32_t i = 0; b->shown_means && i < b->mesh_count; i++) free(b->shown_means[i]);
    for (uint32_t i = 0; b->radiance && i < b->mesh_count; i++) free(b->radiance[i]);
    for (uint32_t i = 0; b->means && i < b->mesh_count; i++) free(b->means[i]);
    free(b->colors);
    free(b->radiance);
    free(b->means);
    free(b->shown_means);
    free(b->seen);
    free(b->views);
    memset(b, 0, sizeof *b);
}
