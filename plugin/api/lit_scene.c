/* SPDX-License-Identifier: MIT */
#include "lit_scene.h"

#include "geometry/vec3.h"
#include "light/lit_area.h"

#include <hemibake/mesh_transform.h>

typedef struct triangle_flags {
    bool *double_sided, *emits, *passes;
} triangle_flags;

static bool lets_light_through(const hemi_mesh_desc *of, const hemi_material_desc *m) {
    return of->alpha_mask || !vec3_is_zero(m->transmission) || !vec3_is_zero(m->diffuse_transmission);
}

static void add_mesh(const hemi_scene *in, const hemi_mesh_desc *m, size_t first, triangle_bvh *out,
                     triangle_flags *flags) {
    const hemi_material_desc *made_of = &in->materials[m->material];
    bool turned = hemi_transform_determinant(m->transform) < 0.0;
    for (size_t t = 0; t < m->triangle_count; t++) {
        for (int k = 0; k < 3; k++)
            hemi_transform_point(m->transform, m->positions + 3 * (size_t)m->indices[3 * t + (size_t)k],
                                 out->corners[first + t][turned ? 2 - k : k]);
        flags->double_sided[first + t] = made_of->double_sided;
        flags->emits[first + t] = !vec3_is_zero(made_of->emission);
        flags->passes[first + t] = lets_light_through(m, made_of);
    }
}

static size_t triangle_count(const bake_scene *f) {
    size_t count = 0;
    for (size_t i = 0; i < f->mesh_count; i++) count += f->meshes[i].triangle_count;
    return count;
}

static double area_of(const hemi_scene *in, const bake_scene *f, const lights *l, triangle_bvh *t,
                      triangle_flags *flags) {
    bool has_sky = l->sky_is_given, emits = false;
    size_t first = 0;
    for (size_t i = 0; i < f->mesh_count; first += f->meshes[i++].triangle_count)
        add_mesh(in, &f->meshes[i], first, t, flags);
    for (size_t i = 0; i < t->count; i++) emits = emits || flags->emits[i];
    for (size_t i = 0; i < l->punctual_count; i++) has_sky = has_sky || l->punctual[i].kind == PUNCTUAL_DIRECTIONAL;
    if (!triangle_bvh_build(&in->context->memory, t)) return -1.0;
    const lit_area_setup setup = { .memory = &in->context->memory,
                                   .triangles = t,
                                   .double_sided = flags->double_sided,
                                   .emits = flags->emits,
                                   .passes = flags->passes,
                                   .punctual = l->punctual,
                                   .punctual_count = l->punctual_count,
                                   .has_sky = has_sky || (l->punctual_count == 0 && !emits) };
    return lit_area(&setup);
}

double lit_scene_area(const hemi_scene *in, const bake_scene *f, const lights *l) {
    allocator *memory = &in->context->memory;
    size_t count = triangle_count(f);
    bool *all = block_new(memory, 3 * count + 1);
    triangle_bvh t;
    triangle_flags flags = { all, all + count, all + 2 * count };
    double area = triangle_bvh_allocate(memory, count, &t) && all ? area_of(in, f, l, &t, &flags) : -1.0;
    triangle_bvh_free(&t);
    block_free(all);
    return area;
}
