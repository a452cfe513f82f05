/* SPDX-License-Identifier: MIT
 * See wide_ground.h. The ground is what lies in the plane of the largest triangle, and what is parallel to that and
 * large: a lawn and a lake, or floors. The walls of a room are not parallel, so the box around the others is the room.
 */
#include "wide_ground.h"

#include "mesh_descs.h"

#include "geometry/polygon.h"
#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

/* Triangles of less than this share of all area are ground in the plane of the largest alone. */
static const double LARGE = 0.01;

/* The cosine between parallel normals, and how far off a plane what lies in it is, in diameters of the scene. */
static const double SAME_WAY = 1.0 - 1e-6, OFF_PLANE = 1e-6;

/* Shadows fall beside what throws them: by the things is what is no further from their box than this many of its
 * diameters. From there elements grow by so much with each metre. */
static const double BESIDE = 0.5, GROWTH = 0.25;

/* Nothing is done about a ground unless what lies by the things is less than this share of all: elements are half as
 * wide then. */
static const double NEAR_SHARE = 0.25;

typedef struct triangle {
    double corner[3][3], normal[3], area;
} triangle;

typedef struct ground_search {
    const hemi_mesh_desc *meshes;
    size_t count;
    double all, diameter; /* m2; m */
    triangle largest;
    wide_ground *out;
    double near; /* m2 */
} ground_search;

static void take_triangle(const hemi_mesh_desc *m, size_t t, triangle *out) {
    for (int k = 0; k < 3; k++)
        hemi_transform_point(m->transform, m->positions + 3 * (size_t)m->indices[3 * t + (size_t)k], out->corner[k]);
    triangle_cross(out->normal, out->corner[0], out->corner[1], out->corner[2]);
    out->area = 0.5 * vec3_normalize(out->normal);
}

static void widen(double low[3], double high[3], const triangle *t) {
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) low[k] = fmin(low[k], t->corner[i][k]), high[k] = fmax(high[k], t->corner[i][k]);
}

static void empty(double low[3], double high[3]) {
    for (int k = 0; k < 3; k++) low[k] = INFINITY, high[k] = -INFINITY;
}

static void find_largest(ground_search *g) {
    double low[3], high[3];
    empty(low, high);
    for (size_t i = 0; i < g->count; i++)
        for (size_t t = 0; t < g->meshes[i].triangle_count; t++) {
            triangle one;
            take_triangle(&g->meshes[i], t, &one);
            if (!(one.area > 0.0)) continue;
            widen(low, high, &one);
            if (one.area > g->largest.area) g->largest = one;
        }
    g->diameter = g->largest.area > 0.0 ? vec3_distance(low, high) : 0.0;
}

static bool is_in_plane(const ground_search *g, const triangle *t) {
    double from[3];
    vec3_sub(from, t->corner[0], g->largest.corner[0]);
    return fabs(vec3_dot(from, g->largest.normal)) <= OFF_PLANE * g->diameter;
}

static bool is_ground(const ground_search *g, const triangle *t) {
    if (fabs(vec3_dot(t->normal, g->largest.normal)) < SAME_WAY) return false;
    return t->area >= LARGE * g->all || is_in_plane(g, t);
}

/* False: there is nothing but ground, or what stands on it is too wide for the ground to be wide beside it. */
static bool find_box(ground_search *g) {
    wide_ground *out = g->out;
    double diameter = 0.0;
    empty(out->low, out->high);
    for (size_t i = 0; i < g->count; i++)
        for (size_t t = 0; t < g->meshes[i].triangle_count; t++) {
            triangle one;
            take_triangle(&g->meshes[i], t, &one);
            if (!(one.area > 0.0) || is_ground(g, &one)) continue;
            widen(out->low, out->high, &one);
            diameter = vec3_distance(out->low, out->high);
            if (diameter > sqrt(NEAR_SHARE) * g->diameter) return false;
        }
    return diameter > 0.0;
}

/* What of a triangle lies in the box, m2. */
static double area_inside(const wide_ground *g, const triangle *t) {
    polygon whole = { .count = 3 }, part;
    double middle[3];
    for (int i = 0; i < 3; i++) vec3_copy(whole.corner[i], t->corner[i]);
    for (int k = 0; k < 3; k++) {
        double up[3] = { k == 0, k == 1, k == 2 }, down[3] = { -up[0], -up[1], -up[2] };
        polygon_clip(&part, &whole, up, g->low[k]);
        polygon_clip(&whole, &part, down, -g->high[k]);
    }
    return whole.count < 3 ? 0.0 : polygon_centroid(&whole, middle);
}

static void measure_near(ground_search *g) {
    double diameter = vec3_distance(g->out->low, g->out->high), margin = BESIDE * diameter;
    vec3_mid(g->out->center, g->out->low, g->out->high);
    g->out->radius = 0.5 * diameter;
    g->out->is_plane = true;
    for (int k = 0; k < 3; k++) g->out->low[k] -= margin, g->out->high[k] += margin;
    for (size_t i = 0; i < g->count; i++)
        for (size_t t = 0; t < g->meshes[i].triangle_count; t++) {
            triangle one;
            take_triangle(&g->meshes[i], t, &one);
            if (!(one.area > 0.0)) continue;
            bool ground = is_ground(g, &one);
            g->near += ground ? area_inside(g->out, &one) : one.area;
            if (ground && !is_in_plane(g, &one)) g->out->is_plane = false;
        }
}

double wide_ground_find(const hemi_mesh_desc *meshes, size_t count, wide_ground *out) {
    ground_search g = { .meshes = meshes, .count = count, .all = mesh_descs_area(meshes, count), .out = out };
    out->is_there = false;
    find_largest(&g);
    if (!find_box(&g)) return g.all;
    measure_near(&g);
    out->is_there = g.near < NEAR_SHARE * g.all;
    return out->is_there ? g.near : g.all;
}

double wide_ground_size(const wide_ground *g, const double p[3], const double q[3]) {
    double away = 0.0;
    for (int k = 0; g->is_there && k < 3; k++)
        away = fmax(away, fmax(g->low[k] - fmax(p[k], q[k]), fmin(p[k], q[k]) - g->high[k]));
    return GROWTH * away;
}
