/* SPDX-License-Identifier: MIT
 * See decimate_faces.h. Shapes are heights over longest edges: 0.87 of an equilateral triangle, 0.5 of half a square.
 */
#include "decimate_faces.h"

#include "geometry/vec3.h"

#include <string.h>

/* Where triangles have more points than this, vertices that went are close enough to each other: the middles of edges
 * between them are forgotten. */
enum { MANY = 64 };

/* Comparisons instead of fmin and fmax, which are calls. The first is no NaN; where the second is, it is the first. */
static inline double lesser(double a, double b) {
    return b < a ? b : a;
}

static inline double greater(double a, double b) {
    return b > a ? b : a;
}

/* ---- triangles in their plane ---- */

static double twice_area(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double square_distance(const double a[2], const double b[2]) {
    return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
}

/* 0 or less if it is turned over. */
static double shape_of(const double a[2], const double b[2], const double c[2]) {
    double longest = greater(square_distance(a, b), greater(square_distance(b, c), square_distance(c, a)));
    return longest > 0.0 ? twice_area(a, b, c) / longest : 0.0;
}

static const double *at(const decimate_faces *m, uint32_t vertex) {
    return m->vertices[vertex].at;
}

/* whole: twice the triangle's area. */
static void weights_at(const double *const p[3], double whole, const double x[2], double w[3]) {
    w[0] = twice_area(x, p[1], p[2]) / whole;
    w[1] = twice_area(p[0], x, p[2]) / whole;
    w[2] = 1.0 - w[0] - w[1];
}

/* ---- what colours are off by ---- */

static void point_at(const decimate_faces *m, const decimate_point *p, double out[2]) {
    for (int k = 0; k < 2; k++) out[k] = 0.5 * (at(m, p->a)[k] + at(m, p->b)[k]);
}

/* Its colour node. */
static size_t node_of(const decimate_faces *m, uint32_t vertex) {
    return m->vertices[vertex].node;
}

/* By what a triangle is off at a point, in a field: change[c], and the tolerance there. */
static double change_at(const decimate_faces *m, const decimate_field *f, const decimate_point *p,
                        const uint32_t corner[3], const double w[3], double change[3]) {
    size_t a = node_of(m, p->a), b = node_of(m, p->b), n[3];
    for (int k = 0; k < 3; k++) n[k] = node_of(m, corner[k]);
    for (size_t c = 0; c < 3; c++)
        change[c] = w[0] * f->values[3 * n[0] + c] + w[1] * f->values[3 * n[1] + c] + w[2] * f->values[3 * n[2] + c] -
                    0.5 * (f->values[3 * a + c] + f->values[3 * b + c]);
    return 0.5 * (f->tolerance[a] + f->tolerance[b]);
}

static double error_at(const decimate_faces *m, const decimate_point *p, const uint32_t corner[3], const double w[3]) {
    double worst = 0.0, change[3];
    for (int i = 0; i < m->in->field_count; i++) {
        double tolerance = change_at(m, &m->in->fields[i], p, corner, w, change);
        for (int c = 0; c < 3; c++) worst = greater(worst, fabs(change[c]) / tolerance);
    }
    return worst;
}

/* ---- rings ---- */

static bool has(const uint32_t *list, uint32_t count, uint32_t what) {
    for (uint32_t i = 0; i < count; i++)
        if (list[i] == what) return true;
    return false;
}

bool decimate_ring_find(const decimate_faces *m, uint32_t vertex, decimate_ring *out) {
    uint32_t firsts = 0, lasts = 0;
    out->count = 0;
    out->first = out->last = DECIMATE_NONE;
    for (uint32_t c = m->vertices[vertex].first_corner; c != DECIMATE_NONE; c = m->next_corner[c]) {
        uint32_t t = c / 3, k = c % 3;
        if (out->count == DECIMATE_RING_MAX) return false;
        out->triangle[out->count] = t;
        out->after[out->count] = m->corners[3 * (size_t)t + (k + 1) % 3];
        out->before[out->count++] = m->corners[3 * (size_t)t + (k + 2) % 3];
    }
    for (uint32_t i = 0; i < out->count; i++) {
        if (!has(out->before, out->count, out->after[i])) out->first = out->after[i], firsts++;
        if (!has(out->after, out->count, out->before[i])) out->last = out->before[i], lasts++;
    }
    return out->count > 0 && firsts == lasts && firsts <= 1;
}

/* What is left of a ring: triangles from the target to the edges that do not have it. */
typedef struct fan {
    uint32_t count, corner[DECIMATE_RING_MAX][3];
    const double *p[DECIMATE_RING_MAX][3];
    double whole[DECIMATE_RING_MAX]; /* twice the area */
} fan;

static void set_fan(const decimate_faces *m, const decimate_ring *ring, uint32_t target, fan *out) {
    out->count = 0;
    for (uint32_t i = 0; i < ring->count; i++) {
        if (ring->after[i] == target || ring->before[i] == target) continue;
        uint32_t *corner = out->corner[out->count];
        corner[0] = target, corner[1] = ring->after[i], corner[2] = ring->before[i];
        for (int k = 0; k < 3; k++) out->p[out->count][k] = at(m, corner[k]);
        const double *const *p = out->p[out->count];
        out->whole[out->count++] = twice_area(p[0], p[1], p[2]);
    }
}

/* The worst shape in a fan; 0 if it may not be. */
static double shape_of_fan(const decimate_faces *m, uint32_t vertex, const decimate_ring *ring, const fan *left) {
    double worst = INFINITY, before = INFINITY;
    for (uint32_t i = 0; i < left->count; i++)
        worst = lesser(worst, shape_of(left->p[i][0], left->p[i][1], left->p[i][2]));
    if (left->count == 0 || !(worst > 0.0)) return 0.0;
    if (worst >= m->shapes[m->vertices[vertex].face]) return worst;
    for (uint32_t i = 0; i < ring->count; i++)
        before = lesser(before, shape_of(at(m, vertex), at(m, ring->after[i]), at(m, ring->before[i])));
    return worst >= before ? worst : 0.0;
}

/* The triangle of a fan that a point is in, or is least out of. */
static uint32_t locate(const fan *in, const double x[2], double w[3]) {
    uint32_t best = 0;
    double deepest = -INFINITY;
    for (uint32_t i = 0; i < in->count && deepest < 0.0; i++) {
        double found[3];
        weights_at(in->p[i], in->whole[i], x, found);
        double depth = lesser(found[0], lesser(found[1], found[2]));
        if (!(depth > deepest)) continue;
        deepest = depth;
        best = i;
        memcpy(w, found, sizeof found);
    }
    return best;
}

static double error_in_fan(const decimate_faces *m, const fan *left, const decimate_point *p) {
    double x[2], w[3];
    point_at(m, p, x);
    uint32_t i = locate(left, x, w);
    return error_at(m, p, left->corner[i], w);
}

static bool predict_fan(const decimate_faces *m, uint32_t vertex, const decimate_ring *ring, const fan *left,
                        decimate_cost *out) {
    const decimate_point own = { vertex, vertex, DECIMATE_NONE };
    out->shape = shape_of_fan(m, vertex, ring, left);
    if (out->shape > 0.0) out->error = error_in_fan(m, left, &own);
    return out->shape > 0.0;
}

bool decimate_ring_guess(const decimate_faces *m, uint32_t vertex, const decimate_ring *ring, uint32_t target,
                         decimate_cost *out) {
    fan left;
    set_fan(m, ring, target, &left);
    return predict_fan(m, vertex, ring, &left, out);
}

bool decimate_ring_cost(const decimate_faces *m, uint32_t vertex, const decimate_ring *ring, uint32_t target,
                        double limit, decimate_cost *out) {
    fan left;
    set_fan(m, ring, target, &left);
    if (!predict_fan(m, vertex, ring, &left, out)) return false;
    for (uint32_t i = 0; i < ring->count; i++)
        for (uint32_t p = m->first_point[ring->triangle[i]]; p != DECIMATE_NONE && out->error < limit;
             p = m->points[p].next)
            out->error = greater(out->error, error_in_fan(m, &left, &m->points[p]));
    return out->error < limit;
}

/* Takes the corners of a triangle out of the list of a vertex. */
static void forget_triangle(decimate_faces *m, uint32_t vertex, uint32_t triangle) {
    uint32_t *link = &m->vertices[vertex].first_corner;
    while (*link != DECIMATE_NONE && *link / 3 != triangle) link = &m->next_corner[*link];
    if (*link != DECIMATE_NONE) *link = m->next_corner[*link];
}

/* The points of a ring, and one where the vertex was, as one list; how many. */
static uint32_t take_points(decimate_faces *m, uint32_t vertex, const decimate_ring *ring, uint32_t *list) {
    uint32_t count = 1;
    *list = m->point_count++;
    m->points[*list] = (decimate_point){ vertex, vertex, DECIMATE_NONE };
    for (uint32_t i = 0; i < ring->count; i++) {
        for (uint32_t p = m->first_point[ring->triangle[i]], next; p != DECIMATE_NONE; p = next, count++) {
            next = m->points[p].next;
            m->points[p].next = *list;
            *list = p;
        }
        m->first_point[ring->triangle[i]] = DECIMATE_NONE;
    }
    return count;
}

/* Gives them to the triangles of the fan that is left. */
static void redistribute_points(decimate_faces *m, uint32_t vertex, const decimate_ring *ring, const fan *left,
                                const uint32_t *triangles) {
    double x[2], w[3];
    uint32_t list, count = take_points(m, vertex, ring, &list);
    for (uint32_t p = list, next; p != DECIMATE_NONE; p = next) {
        next = m->points[p].next;
        if (count > MANY * left->count && m->points[p].a != m->points[p].b) continue;
        point_at(m, &m->points[p], x);
        uint32_t *first = &m->first_point[triangles[locate(left, x, w)]];
        m->points[p].next = *first;
        *first = p;
    }
}

void decimate_ring_collapse(decimate_faces *m, uint32_t vertex, const decimate_ring *ring, uint32_t target) {
    fan left;
    uint32_t kept[DECIMATE_RING_MAX], count = 0;
    set_fan(m, ring, target, &left);
    for (uint32_t i = 0; i < ring->count; i++)
        if (ring->after[i] != target && ring->before[i] != target) kept[count++] = ring->triangle[i];
    redistribute_points(m, vertex, ring, &left, kept);
    for (uint32_t i = 0; i < ring->count; i++) {
        uint32_t t = ring->triangle[i], *corner = m->corners + 3 * (size_t)t, k = 0;
        if (ring->after[i] == target || ring->before[i] == target) {
            forget_triangle(m, ring->after[i], t);
            forget_triangle(m, ring->before[i], t);
            corner[0] = DECIMATE_NONE;
            continue;
        }
        while (corner[k] != vertex) k++;
        corner[k] = target;
        m->next_corner[3 * (size_t)t + k] = m->vertices[target].first_corner;
        m->vertices[target].first_corner = 3 * t + k;
    }
    m->vertices[vertex].first_corner = DECIMATE_NONE;
    m->vertices[vertex].gone = true;
}

void decimate_faces_measure(const decimate_faces *m, decimate_result *out) {
    for (uint32_t t = 0; t < m->triangle_count; t++) {
        const uint32_t *corner = m->corners + 3 * (size_t)t;
        double sum = 0.0, count = 0.0, x[2], w[3], change[3];
        if (corner[0] == DECIMATE_NONE || (m->in->emitters && m->in->emitters[m->faces[t]])) continue;
        const double *const p[3] = { at(m, corner[0]), at(m, corner[1]), at(m, corner[2]) };
        const double area = 0.5 * twice_area(p[0], p[1], p[2]);
        if (!(area > 0.0)) continue; /* nothing of it is seen, and its points have no weights in it */
        for (uint32_t i = m->first_point[t]; i != DECIMATE_NONE; i = m->points[i].next, count++) {
            point_at(m, &m->points[i], x);
            weights_at(p, twice_area(p[0], p[1], p[2]), x, w);
            double tolerance = change_at(m, &m->in->fields[0], &m->points[i], corner, w, change);
            for (int c = 0; c < 3; c++) out->error = fmax(out->error, fabs(change[c]) / tolerance);
            sum += vec3_dot(change, change);
        }
        if (count > 0.0) out->square += area * sum / count;
    }
}
