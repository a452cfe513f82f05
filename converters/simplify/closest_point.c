/* SPDX-License-Identifier: MIT
 * See closest_point.h. The nearest point of a triangle is looked for on its plane, then on its edges.
 */
#include "closest_point.h"

#include <hemibake/allocator.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEAF_TRIANGLES = 4, STACK = 64 };

/* Half: the cosine of 60 degrees. */
static const double SAME_WAY = 0.5;

typedef struct node {
    float low[3], high[3];
    uint32_t first, count; /* of a leaf: triangles; count 0: children first and first + 1 */
} node;

struct closest_point {
    const hemi_allocator *memory;
    const float *positions;
    const uint32_t *indices;
    uint32_t *order; /* triangles, those of a leaf together */
    float *normals;  /* normals[3*t+k], unit */
    node *nodes;
    size_t node_count;
};

/* A triangle by its middle on the axis that is being split. */
typedef struct keyed {
    float key;
    uint32_t triangle;
} keyed;

static const float *corner(const closest_point *n, uint32_t triangle, int i) {
    return n->positions + 3 * (size_t)n->indices[3 * (size_t)triangle + (size_t)i];
}

/* ---- the tree ------------------------------------------------------------------------------------------------------
 */

static int compare(const void *a, const void *b) {
    const keyed *x = a, *y = b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

static void set_box(const closest_point *n, node *out) {
    for (int k = 0; k < 3; k++) out->low[k] = INFINITY, out->high[k] = -INFINITY;
    for (uint32_t i = out->first; i < out->first + out->count; i++)
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) {
                out->low[k] = fminf(out->low[k], corner(n, n->order[i], c)[k]);
                out->high[k] = fmaxf(out->high[k], corner(n, n->order[i], c)[k]);
            }
}

/* Halves by number along the longest side. */
static void split(closest_point *n, size_t index, keyed *keys) {
    node *whole = &n->nodes[index];
    uint32_t first = whole->first, count = whole->count;
    int axis = 0;
    set_box(n, whole);
    if (count <= LEAF_TRIANGLES) return;
    for (int k = 1; k < 3; k++)
        if (whole->high[k] - whole->low[k] > whole->high[axis] - whole->low[axis]) axis = k;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t t = n->order[first + i];
        keys[i] = (keyed){ corner(n, t, 0)[axis] + corner(n, t, 1)[axis] + corner(n, t, 2)[axis], t };
    }
    qsort(keys, count, sizeof *keys, compare);
    for (uint32_t i = 0; i < count; i++) n->order[first + i] = keys[i].triangle;
    size_t child = n->node_count;
    n->node_count += 2;
    n->nodes[child] = (node){ .first = first, .count = count / 2 };
    n->nodes[child + 1] = (node){ .first = first + count / 2, .count = count - count / 2 };
    whole->first = (uint32_t)child;
    whole->count = 0;
    split(n, child, keys);
    split(n, child + 1, keys);
}

static void set_normal(closest_point *n, uint32_t t) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = (double)corner(n, t, 1)[k] - corner(n, t, 0)[k];
        v[k] = (double)corner(n, t, 2)[k] - corner(n, t, 0)[k];
    }
    const double c[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] };
    double length = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
    for (int k = 0; k < 3; k++) n->normals[3 * (size_t)t + (size_t)k] = length > 0.0 ? (float)(c[k] / length) : 0.0f;
}

closest_point *closest_point_create(const hemi_allocator *memory, const float *positions, const uint32_t *indices,
                                    size_t triangle_count) {
    closest_point *n = hemi_allocate_zeroed(memory, 1, sizeof *n);
    keyed *keys = hemi_allocate(memory, (triangle_count + 1) * sizeof *keys);
    if (n) {
        *n = (closest_point){ .memory = memory,
                              .positions = positions,
                              .indices = indices,
                              .order = hemi_allocate(memory, (triangle_count + 1) * sizeof *n->order),
                              .normals = hemi_allocate(memory, (3 * triangle_count + 1) * sizeof *n->normals),
                              .nodes = hemi_allocate(memory, (2 * triangle_count + 1) * sizeof *n->nodes) };
    }
    bool ok = n && keys && n->order && n->normals && n->nodes;
    for (uint32_t t = 0; ok && t < triangle_count; t++) n->order[t] = t, set_normal(n, t);
    if (ok && triangle_count > 0) {
        n->nodes[n->node_count++] = (node){ .first = 0, .count = (uint32_t)triangle_count };
        split(n, 0, keys);
    }
    hemi_deallocate(memory, keys);
    if (ok) return n;
    closest_point_destroy(n);
    return NULL;
}

void closest_point_destroy(closest_point *n) {
    if (!n) return;
    const hemi_allocator *memory = n->memory;
    hemi_deallocate(memory, n->order);
    hemi_deallocate(memory, n->normals);
    hemi_deallocate(memory, n->nodes);
    hemi_deallocate(memory, n);
}

/* ---- looking -------------------------------------------------------------------------------------------------------
 */

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double clamp01(double x) {
    return x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
}

/* Weights of the corners of a, a + u, a + v nearest to a + p, on the edge from corner i to the next. */
static double nearest_on_edge(const double u[3], const double v[3], const double p[3], int i, double w[3]) {
    double start[3], along[3], off[3];
    for (int k = 0; k < 3; k++) {
        start[k] = i == 0 ? 0.0 : i == 1 ? u[k] : v[k];
        along[k] = (i == 0 ? u[k] : i == 1 ? v[k] : 0.0) - start[k];
        off[k] = p[k] - start[k];
    }
    double square = dot(along, along), t = square > 0.0 ? clamp01(dot(off, along) / square) : 0.0;
    w[0] = w[1] = w[2] = 0.0;
    w[i] = 1.0 - t;
    w[(i + 1) % 3] = t;
    for (int k = 0; k < 3; k++) off[k] -= t * along[k];
    return dot(off, off);
}

/* Square of the distance to a triangle. */
static double nearest_on_triangle(const closest_point *n, uint32_t t, const float point[3], double w[3]) {
    double u[3], v[3], p[3];
    for (int k = 0; k < 3; k++) {
        double a = corner(n, t, 0)[k];
        u[k] = corner(n, t, 1)[k] - a, v[k] = corner(n, t, 2)[k] - a, p[k] = point[k] - a;
    }
    double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), pu = dot(p, u), pv = dot(p, v);
    double determinant = uu * vv - uv * uv, best = INFINITY, one[3];
    double s = (vv * pu - uv * pv) / determinant, r = (uu * pv - uv * pu) / determinant;
    if (determinant > 0.0 && s >= 0.0 && r >= 0.0 && s + r <= 1.0) {
        double off[3];
        w[0] = 1 - s - r, w[1] = s, w[2] = r;
        for (int k = 0; k < 3; k++) off[k] = p[k] - s * u[k] - r * v[k];
        return dot(off, off);
    }
    for (int i = 0; i < 3; i++) {
        double square = nearest_on_edge(u, v, p, i, one);
        if (square >= best) continue;
        best = square;
        memcpy(w, one, sizeof one);
    }
    return best;
}

static double box_distance(const node *b, const float point[3]) {
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        double d = fmax(fmax((double)b->low[k] - point[k], (double)point[k] - b->high[k]), 0.0);
        sum += d * d;
    }
    return sqrt(sum);
}

static void try_triangle(const closest_point *n, uint32_t t, const float point[3], const float normal[3], double turned,
                         double *least, closest_point_hit *best) {
    double w[3], facing = 0.0;
    for (size_t k = 0; k < 3; k++) facing += (double)normal[k] * n->normals[3 * (size_t)t + k];
    bool any_way = normal[0] == 0.0f && normal[1] == 0.0f && normal[2] == 0.0f;
    double penalty = any_way || facing >= SAME_WAY ? 0.0 : facing >= 0.0 ? turned : 2 * turned;
    if (penalty >= *least) return;
    double distance = sqrt(nearest_on_triangle(n, t, point, w));
    if (!(distance + penalty < *least)) return;
    *least = distance + penalty;
    *best = (closest_point_hit){ t, { w[0], w[1], w[2] }, distance };
}

closest_point_hit closest_point_find(const closest_point *n, const float point[3], const float normal[3], double turned,
                                     uint32_t guess) {
    closest_point_hit best = { .triangle = UINT32_MAX };
    double least = INFINITY;
    uint32_t stack[STACK], count = 0;
    if (n->node_count == 0) return best;
    try_triangle(n, guess, point, normal, turned, &least, &best);
    stack[count++] = 0;
    while (count > 0) {
        const node *b = &n->nodes[stack[--count]];
        if (box_distance(b, point) >= least) continue;
        for (uint32_t i = 0; i < b->count; i++)
            try_triangle(n, n->order[b->first + i], point, normal, turned, &least, &best);
        if (b->count > 0) continue;
        /* The nearer child on top. */
        bool second = box_distance(&n->nodes[b->first + 1], point) < box_distance(&n->nodes[b->first], point);
        stack[count++] = b->first + !second;
        stack[count++] = b->first + second;
    }
    return best;
}
