/* SPDX-License-Identifier: MIT
 * Which meshes are control cages? Those that name a subdivision scheme; what is baked is their limit surface.
 */
#include "build_scene.h"

#include "subdivide.h"

static hemi_result make_limit_surface(const hemi_scene *in, const hemi_mesh_desc *cage, mesh_copy *out) {
    char message[SUBDIVIDE_MESSAGE_SIZE];
    subdivide_surface limit = { 0 };
    hemi_result result = subdivide_mesh(&in->context->blocks, cage, 0, &limit, message);
    if (result == HEMI_ERROR_MEMORY) return result;
    if (result != HEMI_OK)
        return context_fail(in->context, result, "mesh '%s': %s", cage->name ? cage->name : "", message);
    /* The surface's arrays change hands. */
    out->positions = limit.positions;
    out->normals = limit.normals;
    out->attributes = limit.attributes;
    out->indices = limit.indices;
    out->desc = *cage;
    out->desc.positions = limit.positions;
    out->desc.normals = limit.normals;
    out->desc.indices = limit.indices;
    out->desc.vertex_count = limit.vertex_count;
    out->desc.triangle_count = limit.triangle_count;
    out->desc.attributes = limit.attributes;
    out->desc.attribute_count = limit.attribute_count;
    if (cage->attribute_count > 0 && (!limit.attributes || limit.attribute_count != cage->attribute_count))
        out->desc.texture = NULL;
    return HEMI_OK;
}

hemi_result build_limit_surfaces(const hemi_scene *in, bake_scene *f) {
    hemi_result result = HEMI_OK;
    f->mesh_count = in->mesh_count;
    f->meshes = block_zeroed(&in->context->memory, in->mesh_count + 1, sizeof *f->meshes);
    f->limit_surfaces = block_zeroed(&in->context->memory, in->mesh_count + 1, sizeof *f->limit_surfaces);
    if (!f->meshes || !f->limit_surfaces) return HEMI_ERROR_MEMORY;
    for (size_t i = 0; result == HEMI_OK && i < in->mesh_count; i++) {
        f->meshes[i] = in->meshes[i].desc;
        if (!mesh_is_subdivided(&f->meshes[i]) || f->meshes[i].triangle_count == 0) continue;
        result = make_limit_surface(in, &in->meshes[i].desc, &f->limit_surfaces[i]);
        if (result == HEMI_OK) f->meshes[i] = f->limit_surfaces[i].desc;
    }
    return result;
}
