/* SPDX-License-Identifier: MIT
 * See occlusion.h.
 */
#include "visibility/occlusion.h"

#include "base/tolerance.h"

/* How far the point is outside an edge, times the edge's length. */
static double outside_edge(const scene *s, const surface *f, int i, const double point[3], double *length) {
    const double *a = scene_vertex(s, f->corner[i]), *b = scene_vertex(s, f->corner[(i + 1) % surface_corner_count(f)]);
    double edge[3], offset[3], side[3];
    vec3_sub(edge, b, a);
    vec3_sub(offset, point, a);
    vec3_cross(side, edge, offset);
    *length = vec3_length(edge);
    return -vec3_dot(side, f->normal);
}

static void point_between(const double from[3], const double to[3], double t, double out[3]) {
    double direction[3];
    vec3_sub(direction, to, from);
    vec3_add_scaled(out, from, t, direction);
}

bool occlusion_inside(const scene *s, const surface *f, const double from[3], const double to[3], double t) {
    double point[3], length;
    point_between(from, to, t, point);
    for (int i = 0; i < surface_corner_count(f); i++)
        if (outside_edge(s, f, i, point, &length) > TOLERANCE_EDGE * s->radius * length) return false;
    return !f->holes || !cutout_is_hole(f->holes, point);
}

int occlusion_edge_beside(const scene *s, const surface *f, const double from[3], const double to[3], double t) {
    double point[3], length, furthest = TOLERANCE_EDGE * s->radius;
    int beside = -1;
    point_between(from, to, t, point);
    for (int i = 0; i < surface_corner_count(f); i++) {
        double outside = outside_edge(s, f, i, point, &length);
        if (outside > furthest * length) furthest = outside / length, beside = i;
    }
    return beside;
}
