/* SPDX-License-Identifier: MIT
 * See wide_ground.h. The ground is what lies in the plane of the largest triangle, and what is parallel to that and
 * large: a lawn and a lake, or floors. The walls of a room are not parallel, so the box around the others is the room.
 * A dome is what emits and is far wider than all that does not.
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

/* A mesh that emits is a dome if it is around all that does not, and so many times as wide. */
static const double DOME_SHARE = 4.0;

/* A point light twice as far away as it is high gives an eleventh of what it gives below itself. */
static const double POOL_HEIGHTS = 2.0;

/* Half a dome stands on the ground that the things stand on, or by this share of their diameter above it. */
static const double DOME_LIFT = 0.1;

typedef struct triangle {
    double corner[3][3], normal[3], area;
} triangle;

typedef struct ground_search {
    const wide_ground_scene *in;
    double all, diameter; /* m2; m */
    triangle largest;
    wide_ground *out;
    double dark_low[3], dark_high[3],
        things;  /* of all that neither is ground nor emits: the box, and its diameter, m */
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
    for (size_t i = 0; i < g->in->mesh_count; i++)
        for (size_t t = 0; t < g->in->meshes[i].triangle_count; t++) {
            triangle one;
            take_triangle(&g->in->meshes[i], t, &one);
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

static bool emits(const ground_search *g, size_t mesh) {
    return !vec3_is_zero(g->in->materials[g->in->meshes[mesh].material].emission);
}

static bool is_ground(const ground_search *g, const triangle *t) {
    if (fabs(vec3_dot(t->normal, g->largest.normal)) < SAME_WAY) return false;
    return t->area >= LARGE * g->all || is_in_plane(g, t);
}

/* Where a light is, and the ground below it as far as it lights that well: by so many of its heights. */
static void widen_by_lights(const ground_search *g, double low[3], double high[3]) {
    for (size_t i = 0; i < g->in->light_count; i++) {
        const hemi_light_desc *l = &g->in->lights[i];
        double from[3];
        if (l->kind == HEMI_LIGHT_DIRECTIONAL) continue;
        vec3_sub(from, l->position, g->largest.corner[0]);
        double pool = POOL_HEIGHTS * fabs(vec3_dot(from, g->largest.normal));
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], l->position[k] - pool);
            high[k] = fmax(high[k], l->position[k] + pool);
        }
    }
}

/* Is it around all that does not emit, and far wider? */
static bool is_dome(const ground_search *g, size_t mesh) {
    const hemi_mesh_desc *m = &g->in->meshes[mesh];
    double low[3], high[3], within = DOME_LIFT * g->things;
    if (!emits(g, mesh)) return false;
    empty(low, high);
    for (size_t t = 0; t < m->triangle_count; t++) {
        triangle one;
        take_triangle(m, t, &one);
        widen(low, high, &one);
    }
    for (int k = 0; k < 3; k++)
        if (low[k] > g->dark_low[k] + within || high[k] < g->dark_high[k] - within) return false;
    return vec3_distance(low, high) > DOME_SHARE * g->things;
}

/* False: there is nothing but ground, or what stands on it is too wide for the ground to be wide beside it. */
static bool find_box(ground_search *g) {
    wide_ground *out = g->out;
    empty(out->low, out->high);
    for (int lamps = 0; lamps < 2; lamps++) {
        for (size_t i = 0; i < g->in->mesh_count; i++) {
            const hemi_mesh_desc *m = &g->in->meshes[i];
            if (emits(g, i) != lamps || is_dome(g, i)) continue;
            for (size_t t = 0; t < m->triangle_count; t++) {
                triangle one;
                take_triangle(m, t, &one);
                if (!(one.area > 0.0) || is_ground(g, &one)) continue;
                widen(out->low, out->high, &one);
                if (vec3_distance(out->low, out->high) > sqrt(NEAR_SHARE) * g->diameter) return false;
            }
        }
        if (lamps) continue;
        if (!(out->low[0] <= out->high[0])) return false;
        g->things = vec3_distance(out->low, out->high);
        vec3_copy(g->dark_low, out->low), vec3_copy(g->dark_high, out->high);
    }
    widen_by_lights(g, out->low, out->high);
    return g->things > 0.0;
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
    for (size_t i = 0; i < g->in->mesh_count; i++) {
        bool dome = is_dome(g, i);
        for (size_t t = 0; t < g->in->meshes[i].triangle_count; t++) {
            triangle one;
            take_triangle(&g->in->meshes[i], t, &one);
            if (!(one.area > 0.0)) continue;
            bool around = dome || is_ground(g, &one);
            g->near += around ? area_inside(g->out, &one) : one.area;
            if (around && (dome || !is_in_plane(g, &one))) g->out->is_plane = false;
        }
    }
}

double wide_ground_find(const wide_ground_scene *in, wide_ground *out) {
    ground_search g = { .in = in, .all = mesh_descs_area(in->meshes, in->mesh_count), .out = out };
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
