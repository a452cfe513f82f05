/* SPDX-License-Identifier: MIT */
#include "solver/emitter_rays.h"

#include "base/tolerance.h"
#include "geometry/vec3.h"

#include <math.h>

/* Further away than this many of its own radii an emitter is a point: by less than 1 % (formfactor/near_distance.h). */
static const double FAR_RADII = 8.0;

/* One that fills less is sampled by its area: the mapping from its solid angle cancels there. sr */
static const double LEAST_SOLID_ANGLE = 1e-6;

/* A ray sees what it was sent to when it gets this far. */
static const double ARRIVED = 1.0 - 1e-4;

bool emitter_may_light(const tree_emitter *one, const receiver *r) {
    double to[3];
    vec3_sub(to, one->center, r->from);
    double reach = one->radius;
    return vec3_dot(one->normal, to) < 0.0 && vec3_dot(r->normal, to) > -reach && vec3_dot(r->front, to) > -reach;
}

static bool is_far(const tree_emitter *one, const receiver *r) {
    return vec3_distance_squared(one->center, r->from) > FAR_RADII * FAR_RADII * one->radius * one->radius;
}

/* What of an emitter lies above the horizon of the receiver. */
static void clip_emitter(const emitter_rays *g, const tree_emitter *one, const receiver *r, polygon *above) {
    const polygon whole = mesh_polygon(g->mesh, g->mesh->patches[one->patch].corner);
    polygon_clip(above, &whole, r->front, r->plane + TOLERANCE_PLANE * g->scene->radius);
}

double emitter_factor(const emitter_rays *g, const tree_emitter *one, const receiver *r) {
    double to[3], coverage = g->mesh->patches[one->patch].coverage;
    if (!emitter_may_light(one, r)) return 0.0;
    vec3_sub(to, one->center, r->from);
    if (is_far(one, r)) {
        double square = vec3_dot(to, to), received = vec3_dot(r->normal, to), emitted = -vec3_dot(one->normal, to);
        return received > 0.0 ? received * emitted * one->area * coverage / (PI * square * square) : 0.0;
    }
    polygon above;
    clip_emitter(g, one, r, &above);
    return fmax(polygon_factor(&above, r->from, r->normal), 0.0) * coverage;
}

emitter_aim emitter_aim_at(const emitter_rays *g, const tree_emitter *one, const receiver *r) {
    emitter_aim a = { .one = one };
    polygon above;
    if (!is_far(one, r)) {
        clip_emitter(g, one, r, &above);
        spherical_polygon_set(&a.seen, &above, r->from);
        a.by_angle = a.seen.solid_angle > LEAST_SOLID_ANGLE;
    }
    a.factor = a.by_angle ? a.seen.solid_angle / PI * g->mesh->patches[one->patch].coverage : emitter_factor(g, one, r);
    return a;
}

/* A point of an emitter for a point of the square: a quad is two triangles, by their areas. */
static void point_of(const mesh *m, const patch *p, const double square[2], double out[3]) {
    const double *a = m->vertices + 3 * (size_t)p->corner[0], *b = m->vertices + 3 * (size_t)p->corner[1];
    const double *c = m->vertices + 3 * (size_t)p->corner[2];
    double u = square[0], root, v = square[1];
    if (p->corner[3] != NO_INDEX) {
        const double *d = m->vertices + 3 * (size_t)p->corner[3];
        double ab[3], ac[3], ad[3], first[3], second[3];
        vec3_sub(ab, b, a), vec3_sub(ac, c, a), vec3_sub(ad, d, a);
        vec3_cross(first, ab, ac), vec3_cross(second, ac, ad);
        double share = vec3_length(first) / fmax(vec3_length(first) + vec3_length(second), 1e-300);
        if (u < share)
            u /= share;
        else
            u = (u - share) / (1.0 - share), b = c, c = d;
    }
    root = sqrt(u);
    for (int k = 0; k < 3; k++) out[k] = (1 - root) * a[k] + root * ((1 - v) * b[k] + v * c[k]);
}

/* What panes leave of the light from a point. */
static void pass_panes(const emitter_rays *g, const receiver *r, const double point[3], double T[3]) {
    const scene *s = g->scene;
    T[0] = T[1] = T[2] = 1.0;
    if (s->panes && !panes_transmit(s->panes, r->sheet, r->from, point, r->crossings, T)) *g->failed = true;
}

/* The point of an emitter for a point of the square, and the direction and distance to it. *weight: what light from
 * there counts beside others of the same aim. False where none comes. */
static bool point_at(const emitter_rays *g, const emitter_aim *a, const receiver *r, const double square[2],
                     double point[3], double to[3], double *distance, double *weight) {
    *weight = 0.0;
    if (a->by_angle) {
        double middle[3];
        spherical_polygon_direction(&a->seen, square, to);
        vec3_sub(middle, a->one->center, r->from);
        *distance = vec3_dot(middle, a->one->normal) / vec3_dot(to, a->one->normal);
        vec3_add_scaled(point, r->from, *distance, to);
    } else {
        point_of(g->mesh, &g->mesh->patches[a->one->patch], square, point);
        vec3_sub(to, point, r->from);
        *distance = vec3_normalize(to);
    }
    double received = vec3_dot(to, r->normal), emitted = -vec3_dot(to, a->one->normal);
    if (received <= 0.0 || vec3_dot(to, r->front) <= 0.0 || !(*distance > 0.0)) return false;
    *weight = a->by_angle ? received : received * emitted / (*distance * *distance);
    return *weight > 0.0;
}

/* Of emitters that lie in one place, the one that the ray met is who gives light there. */
static bool is_emitter(const mesh *m, ray_end end, uint32_t hit) {
    return end == RAY_FRONT && material_emits(&m->patches[m->elements[hit].patch].material);
}

void emitter_ray_sees(const emitter_rays *g, const emitter_aim *a, const receiver *r, const double square[2],
                      double *weight, double T[3]) {
    const mesh *m = g->hit;
    double point[3], to[3], distance, reached = INFINITY;
    uint32_t hit = NO_INDEX;
    T[0] = T[1] = T[2] = 0.0;
    if (!point_at(g, a, r, square, point, to, &distance, weight)) return;
    ray_end end = rays_measure(g->rays, r->from, to, &hit, &reached);
    bool is_it = end == RAY_FRONT && m->elements[hit].patch == a->one->patch;
    if (is_it || end == RAY_SKY || (reached >= ARRIVED * distance && !is_emitter(m, end, hit)))
        pass_panes(g, r, point, T);
}

void emitter_ray_factor(const emitter_rays *g, const emitter_aim *a, const receiver *r, const double square[2],
                        double F[3]) {
    double weight;
    emitter_ray_sees(g, a, r, square, &weight, F);
    double factor = a->by_angle ? weight * a->factor : a->factor;
    for (int c = 0; c < 3; c++) F[c] *= factor;
}

void light_ray_irradiance(const emitter_rays *g, const tree_emitter *one, const receiver *r, double E[3]) {
    const double parallel[3] = { 0, 0, 0 }; /* which none of them is */
    double to[3], T[3], reached = INFINITY;
    uint32_t hit = NO_INDEX;
    vec3_sub(to, one->center, r->from);
    double distance = vec3_normalize(to);
    bool is_lit = vec3_dot(to, r->front) > 0.0 &&
                  punctual_irradiance(&g->lights[one->patch], parallel, r->from, r->width, r->normal, E) &&
                  (rays_measure(g->rays, r->from, to, &hit, &reached) == RAY_SKY || reached >= ARRIVED * distance);
    if (is_lit) pass_panes(g, r, one->center, T);
    for (int c = 0; c < 3; c++) E[c] = is_lit ? T[c] * E[c] : 0.0;
}
