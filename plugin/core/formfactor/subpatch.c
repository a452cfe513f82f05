/* SPDX-License-Identifier: MIT */
#include "formfactor/subpatch.h"

#include <string.h>

static void set_shape(subpatch *s, const polygon *shape) {
    s->shape = *shape;
    polygon_centroid(shape, s->center);
    polygon_vector_area(shape, s->vector_area);
    s->edge = sqrt(vec3_length(s->vector_area));
}

subpatch subpatch_of_single_patch(const scene *s, const mesh *m, uint32_t patch_index) {
    const patch *p = &m->patches[patch_index];
    const surface *on = &s->surfaces[p->surface];
    subpatch out = { .plane = on->plane,
                     .area = p->area,
                     .diameter = p->diameter,
                     .coverage = p->coverage,
                     .patch = patch_index,
                     .emits = material_emits(&p->material) };
    const polygon shape = mesh_polygon(m, p->corner);
    vec3_copy(out.normal, on->normal);
    set_shape(&out, &shape);
    return out;
}

static subpatch whole_cluster(const cluster *c) {
    subpatch out = { .plane = INFINITY,
                     .area = c->area,
                     .diameter = c->diameter,
                     .coverage = c->share,
                     .patch = c->members[0],
                     .cluster = c };
    polygon shape = { .count = c->corner_count };
    memcpy(shape.corner, c->corner, (size_t)c->corner_count * sizeof *c->corner);
    set_shape(&out, &shape);
    vec3_copy(out.center, c->eye);
    vec3_copy(out.normal, c->normal);
    for (int i = 0; i < shape.count; i++) out.plane = fmin(out.plane, vec3_dot(out.normal, shape.corner[i]));
    return out;
}

subpatch subpatch_of_patch(const scene *s, const mesh *m, uint32_t patch_index) {
    const cluster *c = mesh_cluster(m, patch_index);
    return c && c->members[0] == patch_index ? whole_cluster(c) : subpatch_of_single_patch(s, m, patch_index);
}

void subpatch_quarter(const subpatch *whole, subpatch quarter[4]) {
    polygon shape[4];
    polygon_quarter(&whole->shape, shape);
    for (int q = 0; q < 4; q++) {
        quarter[q] = *whole;
        set_shape(&quarter[q], &shape[q]);
        quarter[q].area = 0.25 * whole->area;
        quarter[q].path = 4 * whole->path + (uint64_t)q + 1;
    }
}

subpatch subpatch_of_path(const subpatch *whole, uint64_t path) {
    subpatch quarter[4];
    if (path == whole->path) return *whole;
    const subpatch parent = subpatch_of_path(whole, (path - 1) / 4);
    subpatch_quarter(&parent, quarter);
    return quarter[(path - 1) % 4];
}
