/* SPDX-License-Identifier: MIT
 * See closest_point.h. The nearest point of a triangle is looked for on its plane, then on its edges.
 */
#include "closest_point.h"

#include "geometry/bvh.h"
#include "geometry/triangle.h"

/* Half: the cosine of 60 degrees. */
static const double SAME_WAY = 0.5;

struct closest_point {
    const float *positions;
    const uint32_t *indices;
    float *normals; /* normals[3*t+k], unit */
    bvh tree;       /* of triangles */
};

static void get_corners(const closest_point *n, uint32_t triangle, double corner[3][3]) {
    triangle_from_floats(corner, n->positions, n->indices + 3 * (size_t)triangle);
}

/* ---- the tree ---------------------------------------------------------------------------------------------------- */

static void take_triangle(closest_point *n, uint32_t t, bvh_box *box) {
    double p[3][3], normal[3];
    get_corners(n, t, p);
    bvh_box_set(box, t, p, 3, 0.0);
    triangle_cross(normal, p[0], p[1], p[2]);
    vec3_normalize(normal);
    for (size_t k = 0; k < 3; k++) n->normals[3 * (size_t)t + k] = (float)normal[k];
}

closest_point *closest_point_create(allocator *memory, jobs *j, const float *positions, const uint32_t *indices,
                                    size_t triangle_count) {
    closest_point *n = block_zeroed(memory, 1, sizeof *n);
    bvh_box *boxes = block_new(memory, (triangle_count + 1) * sizeof *boxes);
    if (n) {
        *n = (closest_point){ .positions = positions,
                              .indices = indices,
                              .normals = block_new(memory, (3 * triangle_count + 1) * sizeof *n->normals),
                              .tree.nodes = block_new(memory, (2 * triangle_count + 1) * sizeof *n->tree.nodes),
                              .tree.items = block_new(memory, (triangle_count + 1) * sizeof *n->tree.items) };
    }
    bool ok = n && boxes && n->normals && n->tree.nodes && n->tree.items;
    for (uint32_t t = 0; ok && t < triangle_count; t++) take_triangle(n, t, &boxes[t]);
    if (ok) bvh_build(j, &n->tree, boxes, triangle_count);
    block_free(boxes);
    if (ok) return n;
    closest_point_destroy(n);
    return NULL;
}

void closest_point_destroy(closest_point *n) {
    if (!n) return;
    block_free(n->normals);
    block_free(n->tree.nodes);
    block_free(n->tree.items);
    block_free(n);
}

/* ---- looking ----------------------------------------------------------------------------------------------------- */

/* What is looked for, and what was found so far. */
typedef struct search {
    const closest_point *n;
    const float *normal;
    double point[3], turned;
    closest_point_hit best;
} search;

static double penalty_of(const search *s, uint32_t t) {
    const float *n = s->normal;
    if (n[0] == 0.0f && n[1] == 0.0f && n[2] == 0.0f) return 0.0;
    double facing = vec3_dot_floats(n, s->n->normals + 3 * (size_t)t);
    return facing >= SAME_WAY ? 0.0 : facing >= 0.0 ? s->turned : 2 * s->turned;
}

static double visit_triangles(void *user, const uint32_t *triangles, uint32_t count, double least) {
    search *s = user;
    for (uint32_t i = 0; i < count; i++) {
        double p[3][3], w[3], penalty = penalty_of(s, triangles[i]);
        if (penalty >= least) continue;
        get_corners(s->n, triangles[i], p);
        double distance = sqrt(triangle_nearest(w, p[0], p[1], p[2], s->point));
        if (!(distance + penalty < least)) continue;
        least = distance + penalty;
        s->best = (closest_point_hit){ triangles[i], { w[0], w[1], w[2] }, distance };
    }
    return least;
}

closest_point_hit closest_point_find(const closest_point *n, const float point[3], const float normal[3], double turned,
                                     uint32_t guess) {
    search s = { .n = n, .normal = normal, .turned = turned, .best.triangle = UINT32_MAX };
    vec3_from_floats(s.point, point);
    if (n->tree.node_count > 0)
        bvh_closest(&n->tree, s.point, visit_triangles(&s, &guess, 1, INFINITY), visit_triangles, &s);
    return s.best;
}

void closest_point_interpolate(const closest_point_hit *hit, const uint32_t *indices, const float *from, size_t width,
                               float *to) {
    for (size_t c = 0; from && c < width; c++) {
        double sum = 0.0;
        for (size_t i = 0; i < 3; i++)
            sum += hit->weights[i] * (double)from[width * indices[3 * (size_t)hit->triangle + i] + c];
        to[c] = (float)sum;
    }
}
