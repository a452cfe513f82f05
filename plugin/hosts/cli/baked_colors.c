/* SPDX-License-Identifier: MIT */
#include "baked_colors.h"

#include "baked_glb.h"
#include "exposure.h"
#include "instance_mean.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static size_t count_vertices(const baked_colors *b) {
    size_t count = 0;
    for (uint32_t i = 0; i < b->mesh_count; i++) count += b->views[i].vertex_count;
    return count;
}

/* The same of what groups of lights give. */
static bool lights_to_rec709(baked_colors *b, uint32_t i, const color_transform *transform) {
    size_t count = (size_t)b->views[i].vertex_count * b->views[i].light_group_count;
    b->lights[i] = malloc((3 * count + 1) * sizeof *b->lights[i]);
    if (!b->lights[i]) return false;
    if (count == 0) return true;
    memcpy(b->lights[i], b->views[i].light_groups, 3 * count * sizeof *b->lights[i]);
    hemi_result result = color_transform_apply_rec709(transform, b->lights[i], count);
    return result == HEMI_OK || result == HEMI_ERROR_UNSUPPORTED;
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
    if (!lights_to_rec709(b, i, transform)) return false;
    return result == HEMI_OK || result == HEMI_ERROR_UNSUPPORTED;
}

static seen_camera *list_cameras(const gltf_asset *asset, const options *o, size_t *count) {
    uint32_t all = gltf_asset_camera_count(asset);
    seen_camera *cameras = calloc(all + 1, sizeof *cameras);
    *count = 0;
    for (uint32_t i = 0; cameras && i < all; i++) {
        gltf_camera c;
        seen_camera *out = &cameras[*count];
        if (!gltf_asset_camera(asset, i, &c)) continue;
        memcpy(out->eye, c.eye, sizeof out->eye);
        memcpy(out->target, c.target, sizeof out->target);
        memcpy(out->up, c.up, sizeof out->up);
        out->yfov = c.yfov, out->ymag = c.ymag, out->aspect = (double)o->size[0] / o->size[1];
        (*count)++;
    }
    return cameras;
}

static seen_mesh seen_mesh_of(const baked_colors *b, const lights_from *from, uint32_t i) {
    const hemi_mesh_view *v = &b->views[i];
    hemi_mesh_desc desc;
    gltf_asset_mesh(from->input, i, &desc);
    seen_mesh out = { .positions = v->positions,
                      .radiance = v->radiance,
                      .light = b->shown_means[i] ? b->shown_means[i] : v->demodulated,
                      .indices = v->indices,
                      .triangle_count = v->triangle_count };
    memcpy(out.transform, desc.transform, sizeof out.transform);
    lights_from_emission(from, i, out.emission);
    return out;
}

static bool meter(baked_colors *b, const lights_from *from, const color_transform *transform, const options *o) {
    const gltf_asset *asset = from->input;
    size_t camera_count, mesh_count = 0;
    seen_mesh *meshes = calloc(b->mesh_count + 1, sizeof *meshes);
    seen_camera *cameras = list_cameras(asset, o, &camera_count);
    seen_points seen = { 0 };
    for (uint32_t i = 0; meshes && i < b->mesh_count; i++)
        if (!baked_glb_hides(asset, o, i)) meshes[mesh_count++] = seen_mesh_of(b, from, i);
    bool ok = meshes && cameras && seen_points_find(meshes, mesh_count, cameras, camera_count, o->threads, &seen);
    double ev = exposure_meter(seen.points, seen.count, color_transform_white(transform));
    if (!o->scene_linear && !o->exposure.is_fixed) b->exposure_ev = ev;
    const double shown_ev = o->scene_linear ? ev : b->exposure_ev;
    ok = ok && shut_in_find(from, b->views, blackness_unlit(shown_ev), o, &b->shut);
    if (ok) blackness_find(from, b->views, shown_ev, seen.cameras_are_dark, &b->shut, &b->black);
    free(seen.points);
    free(meshes);
    free(cameras);
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
    const uint32_t count = gltf_asset_mesh_count(asset);
    *out = (baked_colors){ .mesh_count = count, .views = calloc(count + 1, sizeof *out->views) };
    float ***const lists[] = { &out->radiance, &out->lights, &out->means, &out->shown_means, &out->colors, &out->seen };
    bool ok = out->views;
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        ok = (*lists[i] = calloc(count + 1, sizeof **lists[i])) && ok;
    return ok;
}

static void say_what_is_dark(const baked_colors *b, console *c) {
    const char *const lines[] = { b->black.line, b->shut.sky, b->shut.lamps };
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        if (*lines[i]) console_note(c, "warning: %s", lines[i]);
}

int baked_colors_make(const hemi_solution *solution, const lights_from *from, const color_transform *transform,
                      const options *o, console *c, baked_colors *out) {
    const gltf_asset *asset = from->input;
    size_t clipped = 0;
    bool ok = allocate(asset, out);
    for (uint32_t i = 0; ok && i < out->mesh_count; i++) {
        out->views[i].struct_size = sizeof out->views[i];
        ok = hemi_solution_mesh(solution, i, &out->views[i]) == HEMI_OK;
        if (gltf_asset_mesh_is_left(asset, i)) out->views[i].vertex_count = out->views[i].triangle_count = 0;
    }
    if (ok && o->keep_instances) ok = share(asset, out);
    for (uint32_t i = 0; ok && i < out->mesh_count; i++) ok = to_rec709(out, i, transform);
    out->exposure_ev = o->scene_linear ? 0.0 : o->exposure.ev;
    if (ok) ok = meter(out, from, transform, o);
    if (ok) say_what_is_dark(out, c);
    for (uint32_t i = 0; ok && i < out->mesh_count; i++) {
        hemi_mesh_view solved = { .struct_size = sizeof solved };
        hemi_solution_mesh(solution, i, &solved);
        ok = color_mesh(out, i, &solved, transform, o->scene_linear, &clipped);
    }
    if (!ok) return console_error(c, "out of memory while colouring the result");
    size_t vertices = count_vertices(out);
    out->clipped_fraction = vertices ? (double)clipped / (double)vertices : 0.0;
    return EXIT_DONE;
}

void baked_colors_free(baked_colors *b) {
    float **const lists[] = { b->radiance, b->lights, b->means, b->shown_means, b->colors, b->seen };
    for (uint32_t i = 0; b->colors && b->seen && i < b->mesh_count; i++)
        if (b->seen[i] == b->colors[i]) b->seen[i] = NULL;
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) {
        for (uint32_t i = 0; lists[k] && i < b->mesh_count; i++) free(lists[k][i]);
        free(lists[k]);
    }
    free(b->views);
    *b = (baked_colors){ 0 };
}

void baked_colors_mesh(const baked_colors *b, const gltf_asset *asset, uint32_t index, hemi_mesh_desc *out) {
    gltf_asset_mesh(asset, index, out);
    out->positions = b->views[index].positions;
    out->vertex_count = b->views[index].vertex_count;
    out->indices = b->views[index].indices;
    out->triangle_count = b->views[index].triangle_count;
}
