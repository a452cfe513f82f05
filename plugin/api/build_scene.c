/* SPDX-License-Identifier: MIT */
#include "build_scene.h"

#include "proxy_mesh.h"

#include "geometry/vec3.h"
#include "light/lit_area.h"
#include "mesh/shading_normals.h"
#include "mesh/weighted_normals.h"
#include "scene/material.h"

#include <assert.h>
#include <string.h>

double bake_scene_lit_area(const hemi_scene *in, const bake_scene *f, const lights *l) {
    lit_mesh *meshes = block_new(&in->context->memory, (f->mesh_count + 1) * sizeof *meshes);
    lit_area_setup setup = { .memory = &in->context->memory, .meshes = meshes, .lights = l };
    double area = -1.0;
    for (size_t i = 0; meshes && i < f->mesh_count; i++) {
        const hemi_mesh_desc *m = &f->meshes[i];
        const hemi_material_desc *of = &in->materials[m->material];
        bool passes = m->alpha_mask || !vec3_is_zero(of->transmission) || !vec3_is_zero(of->diffuse_transmission);
        meshes[i] = (lit_mesh){ of->double_sided, !vec3_is_zero(of->emission), passes };
    }
    if (meshes && mesh_descs_triangles(in->context->jobs, f->meshes, f->mesh_count, &setup.triangles, &setup.mesh_of))
        area = lit_area(&setup);
    triangle_bvh_free(&setup.triangles);
    block_free_all(setup.mesh_of, meshes);
    return area;
}

static bool build_surfaces(const hemi_scene *in, bake_scene *f) {
    scene *s = &f->scene;
    uint32_t *neighbours = arena_alloc(&f->memory, 4 * s->surface_count, sizeof *neighbours);
    material *materials = arena_alloc(&f->memory, in->material_count, sizeof *materials);
    for (size_t i = 0; materials && i < in->material_count; i++) {
        const hemi_material_desc *m = &in->materials[i];
        bool is_material = material_set(&materials[i], m->reflectance, m->emission) &&
                           material_set_transmission(&materials[i], m->transmission, m->diffuse_transmission,
                                                     HEMI_REFLECTANCE_MAX, f->solves_diffuse_transmission);
        assert(is_material); /* scene_input.c has looked */
        (void)is_material;
        material_clamp(&materials[i], NULL, HEMI_REFLECTANCE_MAX);
    }
    s->materials = materials;
    s->material_count = in->material_count;
    for (size_t i = 0; i < s->surface_count; i++) surface_measure(&s->surfaces[i], s->vertices);
    scene_measure(s);
    s->neighbours = neighbours;
    return materials && neighbours && scene_find_neighbours(s, neighbours) && build_masks(f);
}

/* The triangles of what is only read at the vertices that the host gave stay. */
static bool find_kept(bake_scene *f) {
    f->kept = arena_alloc(&f->memory, f->scene.surface_count, sizeof *f->kept);
    for (size_t i = 0; f->kept && i < f->scene.surface_count; i++) {
        uint32_t m = f->scene.surfaces[i].mesh;
        f->kept[i] = proxy_mesh_is_used(f, m) || f->meshes[m].keep_vertices;
    }
    return f->kept;
}

hemi_result fail_too_many(const hemi_scene *in, double element_size, const bake_options *options) {
    double mib = (double)options->process_limit / (1 << 20);
    return mib > 0.0 ? context_fail(in->context, HEMI_ERROR_LIMIT,
                                    "elements of %g m make more than the %u that %.0f MiB have room for; ask for "
                                    "larger elements, or allow more",
                                    element_size, options->max_elements, mib)
                     : context_fail(in->context, HEMI_ERROR_LIMIT,
                                    "elements of %g m make more than %u of them; ask for larger elements", element_size,
                                    options->max_elements);
}

/* f->meshes as surfaces, patches and elements. */
static hemi_result build_tessellation(const hemi_scene *in, const bake_options *options, bake_scene *f) {
    bool *double_sided = arena_alloc(&f->memory, f->mesh_count, 1),
         *is_proxy = arena_alloc(&f->memory, f->mesh_count, 1);
    f->sources = arena_alloc(&f->memory, f->mesh_count, sizeof *f->sources);
    f->pictures = arena_alloc(&f->memory, f->mesh_count, sizeof *f->pictures);
    if (!double_sided || !is_proxy || !f->sources || !f->pictures) return HEMI_ERROR_MEMORY;
    for (size_t i = 0; i < f->mesh_count; i++) {
        const hemi_mesh_desc *m = &f->meshes[i];
        double_sided[i] = in->materials[m->material].double_sided;
        is_proxy[i] = proxy_mesh_is_used(f, i);
        f->pictures[i] = is_proxy[i] ? NO_INDEX : m->texture ? m->material + 1 : 0;
        f->sources[i] = (source_mesh){ m->positions, m->normals, m->attributes, m->indices, m->attribute_count, { 0 } };
        shading_normals_set_matrix(m->transform, f->sources[i].normal_matrix);
        if (!weighted_normals(&f->sources[i], m->vertex_count, m->triangle_count, &f->memory)) return HEMI_ERROR_MEMORY;
    }
    const tessellate_desc how = { .meshes = f->meshes,
                                  .double_sided = double_sided,
                                  .is_proxy = is_proxy,
                                  .mesh_count = (uint32_t)f->mesh_count,
                                  .element_size = options->element_size,
                                  .patch_size = options->patch_size,
                                  .ground = &f->ground,
                                  .max_elements = options->max_elements,
                                  .is_unchecked = options->hurries,
                                  .merges = options->decimate_error > 0.0,
                                  .memory = f->memory.memory };
    tessellation made = { .vertices = &f->vertices, .scene = &f->scene, .mesh = &f->mesh };
    hemi_result result = tessellate(&how, &made);
    f->check = made.check;
    if (result == HEMI_ERROR_LIMIT) return fail_too_many(in, options->element_size, options);
    if (result == HEMI_OK && f->scene.surface_count == 0)
        return context_fail(in->context, HEMI_ERROR_NO_SURFACES, "there is no triangle with an area to bake");
    return result;
}

hemi_result build_scene(const hemi_scene *in, const bake_options *options, bake_scene *f) {
    f->solves_diffuse_transmission = options->method == SOLVER_ROWS;
    hemi_result result = build_tessellation(in, options, f);
    const refinement_setup of = { &f->scene, &f->mesh, &f->vertices, f->sources, in->context->jobs };
    if (result != HEMI_OK) return result;
    if (!build_surfaces(in, f) ||
        !prepared_scene_cut_elements(options, &of, f->pictures, in->context->jobs, &f->memory))
        return HEMI_ERROR_MEMORY;
    result = build_textures(in, f);
    if (result != HEMI_OK) return result;
    bool ok = prepared_scene_make(options, &of, f->demodulated, &f->memory, &f->prepared) && find_kept(f);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}

void bake_scene_free(bake_scene *f) {
    proxy_meshes_free(f);
    for (size_t i = 0; f->limit_surfaces && i < f->mesh_count; i++) mesh_copy_free(&f->limit_surfaces[i]);
    block_free_all(f->limit_surfaces, f->meshes);
    tessellation_free(&(tessellation){ .vertices = &f->vertices, .scene = &f->scene, .mesh = &f->mesh });
    surface_bvh_destroy(f->tree);
    prepared_scene_free(&f->prepared);
    arena_free(&f->memory);
    memset(f, 0, sizeof *f);
}
