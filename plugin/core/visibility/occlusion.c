/* SPDX-License-Identifier: MIT */
#include "visibility/occlusion.h"

#include "base/tolerance.h"

/* Above its facet, in radii of the scene, a place is lifted; and light passes so many times as high above it as the
 * place is: where a surface is convex it passes the facet just so. */
static const double TOLERANCE_LEVEL = 1e-11, FREE = 4.0;

/* How far the point is outside an edge, times the edge's length. */
static inline double outside_edge(const scene *s, const surface *f, int i, const double point[3], double edge[3]) {
    const double *a = scene_vertex(s, f->corner[i]);
    const double *b = scene_vertex(s, f->corner[i + 1 < surface_corner_count(f) ? i + 1 : 0]);
    double offset[3], side[3];
    vec3_sub(edge, b, a);
    vec3_sub(offset, point, a);
    vec3_cross(side, edge, offset);
    return -vec3_dot(side, f->normal);
}

static void point_between(const double from[3], const double to[3], double t, double out[3]) {
    double direction[3];
    vec3_sub(direction, to, from);
    vec3_add_scaled(out, from, t, direction);
}

bool occlusion_inside(const scene *s, const surface *f, const double from[3], const double to[3], double t) {
    double point[3], edge[3];
    if (f->pane) return false;
    point_between(from, to, t, point);
    for (int i = 0; i < surface_corner_count(f); i++) {
        double outside = outside_edge(s, f, i, point, edge);
        if (outside > 0.0 && outside > TOLERANCE_EDGE * s->radius * vec3_length(edge)) return false;
    }
    return !f->holes || !alpha_mask_is_hole(f->holes, point);
}

bool occlusion_by_own(const scene *s, const surface *f, const double from[3], const double place[3]) {
    const double there = surface_height(f, from), here = surface_height(f, place);
    double lifted[3];
    if (there >= 0.0) return false;
    if (here <= TOLERANCE_LEVEL * s->radius) return true;
    vec3_add_scaled(lifted, place, (FREE - 1.0) * here, f->normal);
    return occlusion_inside(s, f, from, lifted, there / (there - FREE * here));
}

bool occlusion_by_small(const surface *f, const surface *own, const double from[3], const double to[3], double t,
                        double there, double here) {
    double distance = vec3_distance(from, to), limit = TOLERANCE_SMALL_FACE_PIXELS * there;
    if (f->area > limit * limit || f->holes || f->pane) return false;
    double cosine = surface_height(own, from) / distance;
    return (1 - t) * distance > TOLERANCE_DEPTH_BIAS_PIXELS * here / fmax(cosine, 0.1);
}

int occlusion_edge_beside(const scene *s, const surface *f, const double from[3], const double to[3], double t) {
    double point[3], edge[3], furthest = TOLERANCE_EDGE * s->radius;
    int beside = -1;
    point_between(from, to, t, point);
    for (int i = 0; i < surface_corner_count(f); i++) {
        double outside = outside_edge(s, f, i, point, edge), length = outside > 0.0 ? vec3_length(edge) : 0.0;
        if (length > 0.0 && outside > furthest * length) furthest = outside / length, beside = i;
    }
    return beside;
}
