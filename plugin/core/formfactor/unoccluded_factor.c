/* SPDX-License-Identifier: MIT
 * What would a receiver get from a shooter if nothing stood between? The closed form of the shooter's outline near it
 * and for emitters, a point estimate far away. A cluster whose outline would count backs against fronts is asked member
 * by member.
 */
#include "formfactor/column_worker.h"

#include "base/tolerance.h"
#include "geometry/vec3.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

shooter_view shooter_view_of(const polygon *shape) {
    shooter_view v = { .shape = shape };
    polygon_centroid(shape, v.center);
    polygon_vector_area(shape, v.area_vector);
    v.diameter = sqrt(vec3_length(v.area_vector));
    return v;
}

shooting_subpatch shooting_subpatch_of(const column_worker *w, const subpatch *piece) {
    const patch *p = &w->setup->mesh->patches[piece->patch];
    const surface *on = &w->setup->scene->surfaces[p->surface];
    shooting_subpatch s = { piece, { 0 }, on->plane, material_emits(&p->material), p->coverage };
    vec3_copy(s.normal, on->normal);
    if (!piece->cluster) return s;
    /* One of very many: no shadow is its own. */
    s.light = false;
    vec3_copy(s.normal, piece->cluster->normal);
    s.plane = INFINITY;
    for (int i = 0; i < piece->shape.count; i++) s.plane = fmin(s.plane, vec3_dot(s.normal, piece->shape.corner[i]));
    s.coverage = piece->cluster->share;
    return s;
}

shooter_view shooter_view_from(const shooting_subpatch *s, const polygon *shape) {
    shooter_view v = shooter_view_of(shape);
    if (s->piece->cluster) vec3_copy(v.center, s->piece->center);
    return v;
}

column_receiver column_patch_receiver(const mesh *m, uint32_t patch_index) {
    const patch *p = &m->patches[patch_index];
    column_receiver r = { .surface = p->surface,
                          .patch = patch_index,
                          .diameter = p->diameter,
                          .first_sample = p->first_sample,
                          .sample_count = p->sample_count };
    memcpy(r.corner, p->corner, sizeof r.corner);
    vec3_copy(r.center, p->center);
    return r;
}

static bool any_corner_above(const mesh *m, const column_receiver *r, const shooting_subpatch *s, double margin) {
    for (int i = 0; i < 4 && r->corner[i] != NO_INDEX; i++)
        if (vec3_dot(s->normal, m->vertices + 3 * (size_t)r->corner[i]) > s->plane + margin) return true;
    return false;
}

/* factors[k] += F from sample k of the receiver to a distant small shooter: cos cos A / (pi r2). */
static void point_factors(const mesh *m, const column_receiver *r, const surface *facing, const shooter_view *from,
                          double *factors) {
    for (uint32_t k = 0; k < r->sample_count; k++) {
        uint32_t s = r->first_sample + k;
        double to_sample[3] = { m->x[s] - from->center[0], m->y[s] - from->center[1], m->z[s] - from->center[2] };
        double r2 = vec3_dot(to_sample, to_sample);
        double emitted = vec3_dot(from->area_vector, to_sample), received = -vec3_dot(facing->normal, to_sample);
        factors[k] += emitted > 0.0 && received > 0.0 ? emitted * received / (PI * r2 * r2) : 0.0;
    }
}

static void closed_form_factors(const mesh *m, const column_receiver *r, const surface *facing, const polygon *above,
                                double *factors) {
    uint32_t first = r->first_sample;
    polygon_factor_batch(above, facing->normal, m->x + first, m->y + first, m->z + first, r->sample_count, factors);
}

/* w->batch += the factors of one shape; false if the receiver is behind all of it. */
static bool add_shape(column_worker *w, const shooting_subpatch *s, const shooter_view *from, const mesh *m,
                      const column_receiver *r) {
    const column_setup *setup = w->setup;
    const surface *facing = &setup->scene->surfaces[r->surface];
    double margin = TOLERANCE_PLANE * setup->scene->radius;
    polygon above;
    polygon_clip(&above, from->shape, facing->normal, facing->plane + margin);
    if (above.count < 3) return false;
    double nearest = vec3_distance(from->center, r->center) - 0.5 * r->diameter;
    bool closed_form = s->light || setup->method == COLUMN_ANALYTIC || nearest < setup->near_diameters * from->diameter;
    if (closed_form)
        closed_form_factors(m, r, facing, &above, w->batch);
    else
        point_factors(m, r, facing, from, w->batch);
    w->statistics.evaluations += r->sample_count;
    if (closed_form) w->statistics.analytic += r->sample_count;
    return true;
}

/* Do all members of a cluster show their fronts to all of the receiver? Where they do not, the outline would count
 * backs against fronts. */
static bool all_show(const cluster *c, const shooter_view *from, const column_receiver *r) {
    double to[3], reach = 0.5 * (c->diameter + r->diameter);
    vec3_sub(to, r->center, from->center);
    return vec3_dot(to, c->normal) - reach > c->spread * (vec3_length(to) + reach);
}

/* The same member by member. */
static bool add_members(column_worker *w, const cluster *c, const mesh *m, const column_receiver *r) {
    double margin = TOLERANCE_PLANE * w->setup->scene->radius;
    bool any = false;
    for (uint32_t k = 0; k < c->member_count; k++) {
        const subpatch piece = subpatch_of_single_patch(w->setup->mesh, c->members[k]);
        const shooting_subpatch one = shooting_subpatch_of(w, &piece);
        const shooter_view from = shooter_view_of(&piece.shape);
        if (any_corner_above(m, r, &one, margin)) any |= add_shape(w, &one, &from, m, r);
    }
    return any;
}

bool unoccluded_factors(column_worker *w, const shooting_subpatch *s, const shooter_view *from, const mesh *m,
                        const column_receiver *r) {
    const cluster *c = s->piece->cluster;
    if (!any_corner_above(m, r, s, TOLERANCE_PLANE * w->setup->scene->radius)) return false;
    /* What is curved sees a little of itself: that is left out. */
    if (c && mesh_lead(w->setup->mesh, r->patch) == s->piece->patch) return false;
    memset(w->batch, 0, r->sample_count * sizeof *w->batch);
    if (c && !all_show(c, from, r)) return add_members(w, c, m, r);
    if (!add_shape(w, s, from, m, r)) return false;
    for (uint32_t k = 0; s->coverage != 1.0 && k < r->sample_count; k++) w->batch[k] *= s->coverage;
    return true;
}
