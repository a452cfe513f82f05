/* SPDX-License-Identifier: MIT
 * What do textures make of each element? Means by area, which the host works out; patches get the means of their
 * elements.
 */
#include "build_scene.h"

#include "base/block.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* As for materials: radiance leaves as float. */
static const double EMISSION_MAX = 1e30;

bool mesh_desc_is_textured(const hemi_mesh_desc *m) {
    return m->texture && m->attributes && m->attribute_count > 0;
}

void bake_scene_attributes(const bake_scene *f, const hemi_mesh_desc *m, uint32_t vertex, double *out) {
    const tessellation *t = &f->pieces;
    const uint32_t *corner = m->indices + 3 * (size_t)t->source_triangles[vertex];
    const float *w = t->source_weights + 3 * (size_t)vertex;
    for (uint32_t k = 0; k < m->attribute_count; k++) {
        out[k] = 0.0;
        for (int i = 0; i < 3; i++) out[k] += (double)w[i] * m->attributes[m->attribute_count * (size_t)corner[i] + k];
    }
}

/* False: not numbers that a surface can have. */
static bool to_material(const double rho[3], const double radiance[3], material *out) {
    for (int c = 0; c < 3; c++) {
        if (!(rho[c] >= 0.0) || isinf(rho[c]) || !(radiance[c] >= 0.0 && radiance[c] <= EMISSION_MAX)) return false;
        out->rho[c] = rho[c];
        out->M[c] = PI * radiance[c];
    }
    return true;
}

/* What is demodulated is multiplied by the texture again, so it is reduced as much as their product is. */
static void clamp(bake_scene *f, material *out, material *demodulated) {
    bool any = false;
    for (int c = 0; c < 3; c++) {
        if (out->rho[c] <= HEMI_REFLECTANCE_MAX) continue;
        demodulated->rho[c] *= HEMI_REFLECTANCE_MAX / out->rho[c];
        out->rho[c] = HEMI_REFLECTANCE_MAX;
        any = true;
    }
    f->clamped_elements += any;
}

static bool build_element(bake_scene *f, const hemi_mesh_desc *m, size_t index, double *attributes, material *own) {
    element *e = &f->mesh.elements[index];
    uint32_t corners = (uint32_t)element_corner_count(e);
    hemi_texture_mean mean;
    for (uint32_t i = 0; i < corners; i++)
        bake_scene_attributes(f, m, e->corner[i], attributes + (size_t)m->attribute_count * i);
    for (int c = 0; c < 3; c++) {
        mean.reflectance[c] = mean.demodulated_reflectance[c] = e->material->rho[c];
        mean.emission[c] = mean.demodulated_emission[c] = e->material->M[c] / PI;
    }
    m->texture(m->texture_user, attributes, corners, &mean);
    if (!to_material(mean.reflectance, mean.emission, own) ||
        !to_material(mean.demodulated_reflectance, mean.demodulated_emission, &f->demodulated[index]))
        return false;
    clamp(f, own, &f->demodulated[index]);
    e->material = own;
    return true;
}

static hemi_result build_mesh_textures(const hemi_scene *in, bake_scene *f, size_t mesh_index) {
    const hemi_mesh_desc *m = &f->meshes[mesh_index];
    const tessellate_range *r = &f->ranges[mesh_index];
    double *attributes = block_new(f->memory.memory, 4 * (size_t)m->attribute_count * sizeof *attributes);
    material *own = arena_alloc(&f->memory, r->element_count, sizeof *own);
    bool room = attributes && own, ok = room;
    for (size_t e = r->first_element; ok && e < (size_t)r->first_element + r->element_count; e++)
        ok = build_element(f, m, e, attributes, own++);
    block_free(attributes);
    if (!room) return HEMI_ERROR_MEMORY;
    if (ok) return HEMI_OK;
    return context_fail(in->context, HEMI_ERROR_DATA,
                        "mesh '%s': its texture gives what no surface can reflect or emit", m->name ? m->name : "");
}

hemi_result build_textures(const hemi_scene *in, bake_scene *f) {
    hemi_result result = HEMI_OK;
    bool any = false;
    for (size_t i = 0; i < f->mesh_count; i++) any = any || mesh_desc_is_textured(&f->meshes[i]);
    if (!any) return HEMI_OK;
    f->demodulated = arena_alloc(&f->memory, f->mesh.element_count, sizeof *f->demodulated);
    if (!f->demodulated) return HEMI_ERROR_MEMORY;
    f->clamped_elements = 0;
    for (size_t e = 0; e < f->mesh.element_count; e++) f->demodulated[e] = *f->mesh.elements[e].material;
    for (size_t i = 0; result == HEMI_OK && i < f->mesh_count; i++)
        if (mesh_desc_is_textured(&f->meshes[i])) result = build_mesh_textures(in, f, i);
    mesh_average_finishes(&f->mesh);
    return result;
}
