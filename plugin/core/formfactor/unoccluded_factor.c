/* SPDX-License-Identifier: MIT
 * What would a receiver get from a shooter if nothing stood between? The closed form of the shooter's outline near it
 * and for emitters, a point estimate far away. A cluster whose outline would count backs against fronts is asked member
 * by member.
 */
#include "formfactor/column_worker.h"

#include "base/tolerance.h"
#include "formfactor/sample_factors.h"
#include "geometry/vec3.h"
#include "mesh/shading_normals.h"

#include <string.h>

column_receiver column_patch_receiver(const mesh *m, uint32_t patch_index) {
    const patch *p = &m->patches[patch_index];
    column_receiver r = { .surface = p->surface,
                          .patch = patch_index,
                          .diameter = p->diameter,
                          .is_smooth = p->is_smooth,
                          .first_sample = p->first_sample,
                          .sample_count = p->sample_count };
    memcpy(r.corner, p->corner, sizeof r.corner);
    vec3_copy(r.center, p->center);
    return r;
}

static bool any_corner_above(const mesh *m, const column_receiver *r, const subpatch *from, double margin) {
    for (int i = 0; i < 4 && r->corner[i] != NO_INDEX; i++)
        if (vec3_dot(from->normal, m->vertices + 3 * (size_t)r->corner[i]) > from->plane + margin) return true;
    return false;
}

/* factors[k] += F from sample k of the receiver to a distant small shooter: cos cos A / (pi r2). */
static void point_factors(const mesh *m, const column_receiver *r, const surface *facing, const subpatch *from,
                          double *factors) {
    for (uint32_t k = 0; k < r->sample_count; k++) {
        uint32_t s = r->first_sample + k;
        double to_sample[3] = { m->x[s] - from->center[0], m->y[s] - from->center[1], m->z[s] - from->center[2] };
        double r2 = vec3_dot(to_sample, to_sample);
        double emitted = vec3_dot(from->vector_area, to_sample);
        double received = -vec3_dot(mesh_sample_normal(m, facing, s), to_sample);
        factors[k] += emitted > 0.0 && received > 0.0 ? emitted * received / (PI * r2 * r2) : 0.0;
    }
}

/* w->batch += the factors of one shape; false if the receiver is behind all of it. */
static bool add_shape(column_worker *w, const subpatch *from, const mesh *m, const column_receiver *r) {
    const column_setup *setup = w->setup;
    const surface *facing = &setup->scene->surfaces[r->surface];
    double margin = TOLERANCE_PLANE * setup->scene->radius;
    polygon above;
    polygon_clip(&above, &from->shape, facing->normal, facing->plane + margin);
    if (above.count < 3) return false;
    double nearest = vec3_distance(from->center, r->center) - 0.5 * r->diameter;
    bool closed_form = from->emits || setup->method == COLUMN_ANALYTIC || nearest < setup->near_diameters * from->edge;
    if (closed_form)
        sample_factors_add(m, facing, r->is_smooth, &above, r->first_sample, r->sample_count, w->batch);
    else
        point_factors(m, r, facing, from, w->batch);
    w->statistics.evaluations += r->sample_count;
    if (closed_form) w->statistics.analytic += r->sample_count;
    return true;
}

/* Do all members of a cluster show their fronts to all of the receiver? Where they do not, the outline would count
 * backs against fronts. */
static bool all_show(const subpatch *from, const column_receiver *r) {
    const cluster *c = from->cluster;
    double to[3], reach = 0.5 * (c->diameter + r->diameter);
    vec3_sub(to, r->center, from->center);
    return vec3_dot(to, c->normal) - reach > c->spread * (vec3_length(to) + reach);
}

/* The same member by member. */
static bool add_members(column_worker *w, const cluster *c, const mesh *m, const column_receiver *r) {
    double margin = TOLERANCE_PLANE * w->setup->scene->radius;
    bool any = false;
    for (uint32_t k = 0; k < c->member_count; k++) {
        const subpatch one = subpatch_of_single_patch(w->setup->scene, w->setup->mesh, c->members[k]);
        if (any_corner_above(m, r, &one, margin)) any |= add_shape(w, &one, m, r);
    }
    return any;
}

bool column_place(const column_worker *w, const subpatch *from, const mesh *m, const column_receiver *r, uint32_t k,
                  double out[3]) {
    return shading_normals_lift_sample(m, &w->setup->scene->surfaces[r->surface], from->emits && r->is_smooth,
                                       r->first_sample + k, out);
}

/* From an emitter to samples that look for it from above their facet: all above the horizon of each counts. False:
 * nothing is. */
static bool add_lifted(column_worker *w, const subpatch *from, const mesh *m, const column_receiver *r) {
    const surface *f = &w->setup->scene->surfaces[r->surface];
    bool any = false;
    for (uint32_t k = 0; k < r->sample_count; k++) {
        const double *normal = mesh_sample_normal(m, f, (size_t)r->first_sample + k);
        double point[3], margin = TOLERANCE_PLANE * w->setup->scene->radius;
        polygon above = { 0 }, in_front = from->shape;
        if (!column_place(w, from, m, r, k, point)) polygon_clip(&in_front, &from->shape, f->normal, f->plane + margin);
        polygon_clip(&above, &in_front, normal, vec3_dot(normal, point) + margin);
        w->batch[k] = above.count < 3 ? 0.0 : polygon_factor(&above, point, normal);
        any = any || w->batch[k] > 0.0;
    }
    w->statistics.evaluations += r->sample_count, w->statistics.analytic += r->sample_count;
    return any;
}

bool unoccluded_factors(column_worker *w, const subpatch *from, const mesh *m, const column_receiver *r) {
    const cluster *c = from->cluster;
    if (!any_corner_above(m, r, from, TOLERANCE_PLANE * w->setup->scene->radius)) return false;
    /* What is curved sees a little of itself: that is left out. */
    if (c && mesh_lead(w->setup->mesh, r->patch) == from->patch) return false;
    memset(w->batch, 0, r->sample_count * sizeof *w->batch);
    if (c && !all_show(from, r)) return add_members(w, c, m, r);
    double place[3];
    bool are_lifted = false;
    for (uint32_t k = 0; k < r->sample_count && !are_lifted; k++) are_lifted = column_place(w, from, m, r, k, place);
    if (!(are_lifted ? add_lifted(w, from, m, r) : add_shape(w, from, m, r))) return false;
    for (uint32_t k = 0; from->coverage != 1.0 && k < r->sample_count; k++) w->batch[k] *= from->coverage;
    return true;
}
