/* SPDX-License-Identifier: MIT
 * What is each element made of? Its surface's material, or what a texture makes of it: means by area, which the host
 * works out; patches get the means of their elements. Which of all that would reflect more than it may is said once.
 */
#include "build_scene.h"

#include "geometry/vec3.h"
#include "mesh/shade_elements.h"
#include "scene/material.h"

#include <stdatomic.h>
#include <string.h>

bool mesh_desc_is_textured(const hemi_mesh_desc *m) {
    return m->texture && (m->attributes || m->attribute_count == 0);
}

void bake_scene_attributes(const bake_scene *f, const hemi_mesh_desc *m, uint32_t vertex, double *out) {
    mesh_vertices_interpolate(&f->vertices, vertex, m->indices, m->attributes, m->attribute_count, out);
}

void mesh_desc_shade(const hemi_scene *in, const hemi_mesh_desc *m, const double incident[3], double *attributes,
                     double radiance[3], double demodulated[3]) {
    const hemi_material_desc *plain = &in->materials[m->material];
    size_t count = m->attribute_count;
    hemi_texture_mean mean;
    for (int c = 0; c < 3; c++) {
        mean.reflectance[c] = mean.demodulated_reflectance[c] = plain->reflectance[c];
        mean.emission[c] = mean.demodulated_emission[c] = plain->emission[c];
        mean.transmission[c] = plain->transmission[c];
        mean.diffuse_transmission[c] = plain->diffuse_transmission[c];
    }
    if (mesh_desc_is_textured(m)) {
        for (size_t i = 1; i < 3; i++) memcpy(attributes + i * count, attributes, count * sizeof *attributes);
        m->texture(m->texture_user, attributes, 3, &mean);
    }
    for (int c = 0; c < 3; c++) {
        double excess = fmax(mean.reflectance[c] / HEMI_REFLECTANCE_MAX, 1.0);
        radiance[c] = mean.emission[c] + mean.reflectance[c] / excess * incident[c];
        demodulated[c] = mean.demodulated_emission[c] + mean.demodulated_reflectance[c] / excess * incident[c];
    }
}

typedef struct texturing {
    bake_scene *f;
    material *own; /* own[e] of element e */
    atomic_uint clamped;
} texturing;

static const hemi_mesh_desc *mesh_of(const bake_scene *f, const patch *p) {
    return &f->meshes[f->scene.surfaces[p->surface].mesh];
}

static shading_thread where(void *user, const patch *p) {
    const hemi_mesh_desc *m = mesh_of(((texturing *)user)->f, p);
    return !mesh_desc_is_textured(m) ? SHADED_NOWHERE : m->texture_is_reentrant ? SHADED_ANYWHERE : SHADED_HERE;
}

static bool build_element(void *user, size_t index, double *attributes) {
    texturing *g = user;
    bake_scene *f = g->f;
    element *e = &f->mesh.elements[index];
    material *own = &g->own[index];
    const hemi_mesh_desc *m = mesh_of(f, &f->mesh.patches[e->patch]);
    uint32_t corners = (uint32_t)element_corner_count(e);
    hemi_texture_mean mean;
    for (uint32_t i = 0; i < corners; i++)
        bake_scene_attributes(f, m, e->corner[i], attributes + (size_t)m->attribute_count * i);
    for (int c = 0; c < 3; c++) {
        mean.demodulated_reflectance[c] = e->material->rho[c];
        mean.reflectance[c] = e->material->rho[c] - e->material->diffuse_transmittance[c];
        mean.emission[c] = mean.demodulated_emission[c] = e->material->M[c] / PI;
        mean.transmission[c] = e->material->transmittance[c];
        mean.diffuse_transmission[c] = e->material->diffuse_transmittance[c];
    }
    m->texture(m->texture_user, attributes, corners, &mean);
    if (!material_set(own, mean.reflectance, mean.emission) ||
        !material_set_transmission(own, mean.transmission, mean.diffuse_transmission, HEMI_REFLECTANCE_MAX,
                                   f->solves_diffuse_transmission) ||
        !material_set(&f->demodulated[index], mean.demodulated_reflectance, mean.demodulated_emission))
        return false;
    for (int c = 0; c < 3 && !f->solves_diffuse_transmission; c++)
        if (mean.diffuse_transmission[c] > 0.0)
            f->demodulated[index].rho[c] *= own->rho[c] / (own->rho[c] + mean.diffuse_transmission[c]);
    atomic_fetch_add(&g->clamped, material_clamp(own, &f->demodulated[index], HEMI_REFLECTANCE_MAX));
    e->material = own;
    return true;
}

hemi_result build_textures(const hemi_scene *in, bake_scene *f) {
    size_t count = f->mesh.element_count, widest = 0;
    texturing g = { .f = f };
    bool any = false;
    mesh_set_materials(&f->mesh, &f->scene);
    for (size_t i = 0; i < f->mesh_count; i++) {
        any = any || mesh_desc_is_textured(&f->meshes[i]); /* a copy may be */
        if (f->meshes[i].attribute_count > widest) widest = f->meshes[i].attribute_count;
    }
    if (!any) return HEMI_OK;
    g.own = arena_alloc(&f->memory, count, sizeof *g.own);
    f->demodulated = arena_alloc(&f->memory, count, sizeof *f->demodulated);
    if (!g.own || !f->demodulated) return HEMI_ERROR_MEMORY;
    for (size_t e = 0; e < count; e++) f->demodulated[e] = *f->mesh.elements[e].material;
    size_t bad =
        shade_elements(&(shade_elements_setup){ &f->mesh, in->context->jobs, 4 * widest, where, build_element, &g });
    f->clamped_elements = atomic_load(&g.clamped);
    mesh_average_materials(&f->mesh);
    if (bad == SHADED_ALL || bad == SHADED_NO_MEMORY) return bad == SHADED_ALL ? HEMI_OK : HEMI_ERROR_MEMORY;
    const char *name = mesh_of(f, &f->mesh.patches[bad])->name;
    return context_fail(in->context, HEMI_ERROR_DATA,
                        "mesh '%s': its texture gives what no surface can reflect or emit", name ? name : "");
}

/* ---- too much reflectance ---- */

void say_clamped(hemi_scene *in, bake_scene *f) {
    bool *plain = block_zeroed(f->memory.memory, in->material_count + 1, sizeof *plain);
    const char *first = NULL;
    f->clamped_materials = 0;
    if (!plain) return;                        /* it is only said */
    for (size_t i = 0; i < f->mesh_count; i++) /* that a mesh shows as they are */
        if (f->meshes[i].triangle_count > 0 && !mesh_desc_is_textured(&f->meshes[i]))
            plain[f->meshes[i].material] = true;
    for (size_t i = 0; i < in->material_count; i++) {
        if (!plain[i] || !in->materials[i].name) continue;
        if (f->clamped_materials++ == 0) first = in->materials[i].name;
    }
    block_free(plain);
    if (in->clamped_said) return;
    in->clamped_said = true;
    if (f->clamped_materials == 1)
        context_log(in->context, HEMI_LOG_WARNING, "material '%s': reflectance clamped to %g", first,
                    HEMI_REFLECTANCE_MAX);
    else if (f->clamped_materials > 1)
        context_log(in->context, HEMI_LOG_WARNING, "material '%s' and %u more: reflectance clamped to %g", first,
                    f->clamped_materials - 1, HEMI_REFLECTANCE_MAX);
    if (f->clamped_elements > 0)
        context_log(in->context, HEMI_LOG_WARNING, "textures: reflectance clamped to %g at %u of %zu elements",
                    HEMI_REFLECTANCE_MAX, f->clamped_elements, f->mesh.element_count);
}
