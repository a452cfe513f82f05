/* SPDX-License-Identifier: MIT
 * Is this picture possible, and which triangles are in it? hemi_picture joins the meshes to one and hands them to the
 * core.
 */
#include "build_scene.h"
#include "desc_size.h"
#include "geometry/vec3.h"
#include "internal.h"

#include "picture/picture.h"

#include "base/block.h"

#include <math.h>
#include <string.h>

enum { PICTURE_SIZE_MAX = 8192, SUPERSAMPLE_MAX = 8 };

typedef struct joined {
    double *positions;
    float *colors;
    uint32_t *indices;
    size_t vertex_count, triangle_count;
    uint32_t *first; /* first[mesh]: of its triangles; and behind the last */
    float *coordinates;
    alpha_mask_map *maps; /* of meshes; NULL: nothing is cut out */
} joined;

static bool is_view(const hemi_picture_desc *d) {
    for (int k = 0; k < 3; k++)
        if (!isfinite(d->eye[k]) || !isfinite(d->target[k]) || !isfinite(d->up[k])) return false;
    return d->vertical_fov >= 0.0 && d->vertical_fov < PI;
}

static bool is_mask(const hemi_picture_mask *m) {
    const hemi_alpha_mask *a = m->mask;
    return !a || (m->coordinates && a->alpha && a->width > 0 && a->height > 0 && a->cutoff >= 0.0);
}

static const char *picture_fault(const hemi_picture_desc *d) {
    if (d->width == 0 || d->height == 0 || d->width > PICTURE_SIZE_MAX || d->height > PICTURE_SIZE_MAX)
        return "a picture is 1 to 8192 pixels wide and high";
    if (d->supersample > SUPERSAMPLE_MAX) return "a picture takes at most 8 rays a pixel and axis";
    if (!is_view(d)) return "a picture's eye, target, up or field of view is not a number that it can be";
    if (d->mesh_count && !d->meshes) return "a picture has a mesh count but no meshes";
    for (size_t i = 0; i < d->mesh_count; i++) {
        const hemi_picture_mesh *m = &d->meshes[i];
        if ((m->vertex_count && (!m->positions || !m->colors)) || (m->triangle_count && !m->indices))
            return "a picture's mesh counts vertices or triangles but has no positions, colours or indices";
        if (d->masks && !is_mask(&d->masks[i])) return "a picture's mask has no coordinates, no alpha or no size";
        for (size_t k = 0; k < 3 * (size_t)m->vertex_count; k++)
            if (!isfinite(m->positions[k])) return "a position of a picture's mesh is not a finite number";
        for (size_t k = 0; k < 3 * (size_t)m->triangle_count; k++)
            if (m->indices[k] >= m->vertex_count) return "an index of a picture's mesh is past its last vertex";
    }
    return NULL;
}

static bool join_masks(allocator *memory, const hemi_picture_desc *d, joined *out) {
    if (!d->masks) return true;
    out->coordinates = block_zeroed(memory, 3 * out->vertex_count + 1, sizeof *out->coordinates);
    out->maps = block_zeroed(memory, d->mesh_count, sizeof *out->maps);
    for (size_t i = 0, v = 0; out->coordinates && out->maps && i < d->mesh_count; v += d->meshes[i++].vertex_count) {
        const size_t count = d->meshes[i].vertex_count;
        if (!d->masks[i].mask || count == 0) continue;
        out->maps[i] = alpha_map_of(d->masks[i].mask);
        memcpy(out->coordinates + 3 * v, d->masks[i].coordinates, 3 * count * sizeof *out->coordinates);
    }
    return out->coordinates && out->maps;
}

static bool join(allocator *memory, const hemi_picture_desc *d, joined *out) {
    for (size_t i = 0; i < d->mesh_count; i++) {
        out->vertex_count += d->meshes[i].vertex_count;
        out->triangle_count += d->meshes[i].triangle_count;
    }
    out->positions = block_new(memory, (3 * out->vertex_count + 1) * sizeof *out->positions);
    out->colors = block_new(memory, (3 * out->vertex_count + 1) * sizeof *out->colors);
    out->indices = block_new(memory, (3 * out->triangle_count + 1) * sizeof *out->indices);
    out->first = block_zeroed(memory, d->mesh_count + 1, sizeof *out->first);
    if (!out->positions || !out->colors || !out->indices || !out->first) return false;
    size_t vertex = 0, index = 0;
    for (size_t i = 0; i < d->mesh_count; i++) {
        const hemi_picture_mesh *m = &d->meshes[i];
        for (size_t k = 0; k < 3 * (size_t)m->triangle_count; k++)
            out->indices[index++] = m->indices[k] + (uint32_t)vertex;
        for (size_t k = 0; k < 3 * (size_t)m->vertex_count; k++) {
            out->positions[3 * vertex + k] = m->positions[k];
            out->colors[3 * vertex + k] = m->colors[k];
        }
        vertex += m->vertex_count;
        out->first[i + 1] = out->first[i] + m->triangle_count;
    }
    return join_masks(memory, d, out);
}

hemi_result hemi_picture(hemi_context *context, const hemi_picture_desc *given, float *pixels) {
    hemi_picture_desc known, *desc = &known;
    const size_t least = DESC_THROUGH(hemi_picture_desc, height);
    char message[128];
    joined all = { 0 };
    if (!context || !pixels || !desc_take(context, "picture", given, least, &known, sizeof known))
        return HEMI_ERROR_ARGUMENT;
    const char *fault = picture_fault(desc);
    if (fault) return context_fail(context, HEMI_ERROR_ARGUMENT, "%s", fault);
    context_begin(context);
    hemi_result result = join(&context->memory, desc, &all) ? HEMI_OK : HEMI_ERROR_MEMORY;
    if (result == HEMI_OK && all.triangle_count == 0)
        result = context_fail(context, HEMI_ERROR_NO_SURFACES, "there is nothing to draw");
    if (result == HEMI_OK) {
        int supersample = desc->supersample ? (int)desc->supersample : 3;
        uint32_t longest = desc->width > desc->height ? desc->width : desc->height;
        /* A supersampled picture may not need a frame buffer larger than back ends have. */
        while (supersample > 1 && (uint32_t)supersample * longest > PICTURE_SIZE_MAX) supersample--;
        picture p = { .positions = all.positions,
                      .colors = all.colors,
                      .vertex_count = all.vertex_count,
                      .indices = all.indices,
                      .triangle_count = all.triangle_count,
                      .vertical_fov = desc->vertical_fov > 0.0 ? desc->vertical_fov : 0.698131700797731830,
                      .width = (int)desc->width,
                      .height = (int)desc->height,
                      .supersample = supersample,
                      .flat = desc->flat,
                      .draw_backs = desc->draw_backs,
                      .coordinates = all.coordinates,
                      .maps = all.maps,
                      .blended = desc->blended,
                      .first = all.first,
                      .mesh_count = desc->mesh_count,
                      .shade = desc->shade,
                      .shade_user = desc->shade_user,
                      .memory = &context->memory };
        memcpy(p.eye, desc->eye, sizeof p.eye);
        memcpy(p.target, desc->target, sizeof p.target);
        memcpy(p.up, desc->up, sizeof p.up);
        memcpy(p.background, desc->background, sizeof p.background);
        if (!picture_draw(&p, pixels, message, sizeof message)) result = context_core_failure(context, message);
    }
    block_free_all(all.positions, all.colors, all.indices, all.first, all.coordinates, all.maps);
    return context_end(context, result);
}
