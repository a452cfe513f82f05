/* SPDX-License-Identifier: MIT
 * See shadow_integral.h.
 */
#include "factors/shadow_integral.h"

#include "base/block.h"
#include "geometry/triangle.h"

/* Evaluations of a triangle inside, and of the corners that quartering makes. */
enum { POINTS = 7, NEW_CORNERS = 3 };

/* The outermost point of the rule is 0.8 of the way to a corner; what is beyond a line that passes between both is less
 * than a tenth of the triangle on the side of an edge, and less at a corner. */
static const double CORNER_SHARE = 0.1;

/* A corner of triangles and the function there. */
typedef struct node {
    double point[3], value;
} node;

typedef struct cell {
    node corner[3];
    double value, error;
} cell;

/* heap: binary, by error, so that the worst cell is at hand. */
typedef struct integration {
    shadow_integrand f;
    void *user;
    cell *heap;
    size_t count, capacity;
    double error;
    uint64_t evaluations;
    allocator *memory;
} integration;

/* ---- one triangle --------------------------------------------------------------------------------------------------
 */

static node node_at(integration *g, const double point[3]) {
    node n = { .value = g->f(g->user, point) };
    vec3_copy(n.point, point);
    g->evaluations++;
    return n;
}

static node node_between(integration *g, const node *a, const node *b) {
    double point[3];
    vec3_mid(point, a->point, b->point);
    return node_at(g, point);
}

/* f at the point with weight w0 on corner i and w on the two others. */
static double inside(integration *g, const cell *c, int i, double w0, double w) {
    const double *a = c->corner[i].point, *b = c->corner[(i + 1) % 3].point, *d = c->corner[(i + 2) % 3].point;
    double point[3];
    for (int k = 0; k < 3; k++) point[k] = w0 * a[k] + w * (b[k] + d[k]);
    g->evaluations++;
    return g->f(g->user, point);
}

/* The parabola through values at x[0..2], at 1. */
static double extrapolate(const double x[3], const double f[3]) {
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        double p = x[(i + 1) % 3], q = x[(i + 2) % 3];
        sum += f[i] * (1 - p) * (1 - q) / ((x[i] - p) * (x[i] - q));
    }
    return sum;
}

/* Mean over the triangle by centroid and the three points at w: exact for degree 2 when each of these weighs s with
 * (1 - 3 s) / 9 + s (2 w^2 + (1 - 2 w)^2) = 1/6. */
static double degree_two(double center, double sum, double w) {
    double second = 2 * w * w + (1 - 2 * w) * (1 - 2 * w);
    double s = (1.0 / 6.0 - 1.0 / 9.0) / (second - 1.0 / 3.0);
    return (1 - 3 * s) * center + s * sum;
}

static void measure(integration *g, cell *c) {
    const double root = sqrt(15.0), near = (6 - root) / 21, far = (6 + root) / 21;
    const double along[3] = { 1 - 2 * near, 1.0 / 3.0, 1 - 2 * far }; /* the median of a corner */
    double area = triangle_area(c->corner[0].point, c->corner[1].point, c->corner[2].point), near_sum = 0.0,
           far_sum = 0.0, off = 0.0;
    double center = inside(g, c, 0, 1.0 / 3.0, 1.0 / 3.0);
    for (int i = 0; i < 3; i++) {
        const double f[3] = { inside(g, c, i, 1 - 2 * near, near), center, inside(g, c, i, 1 - 2 * far, far) };
        near_sum += f[0];
        far_sum += f[2];
        off = fmax(off, CORNER_SHARE * fabs(c->corner[i].value - extrapolate(along, f)));
    }
    double mean = 0.225 * center + (155 - root) / 1200 * near_sum + (155 + root) / 1200 * far_sum;
    off = fmax(off, fabs(mean - degree_two(center, near_sum, near)));
    off = fmax(off, fabs(mean - degree_two(center, far_sum, far)));
    c->value = area * mean;
    c->error = area * off;
}

/* ---- all of them ---------------------------------------------------------------------------------------------------
 */

static bool grow(integration *g) {
    if (g->count < g->capacity) return true;
    size_t capacity = g->capacity ? 2 * g->capacity : 64;
    cell *grown = block_resize(g->memory, g->heap, capacity * sizeof *grown);
    if (!grown) return false;
    g->heap = grown;
    g->capacity = capacity;
    return true;
}

static bool add_triangle(integration *g, const node *a, const node *b, const node *d) {
    cell c = { .corner = { *a, *b, *d } };
    if (!grow(g)) return false;
    measure(g, &c);
    size_t i = g->count++;
    for (; i > 0 && g->heap[(i - 1) / 2].error < c.error; i = (i - 1) / 2) g->heap[i] = g->heap[(i - 1) / 2];
    g->heap[i] = c;
    g->error += c.error;
    return true;
}

static cell take_worst(integration *g) {
    cell worst = g->heap[0], last = g->heap[--g->count];
    size_t i = 0;
    for (;;) {
        size_t child = 2 * i + 1;
        if (child >= g->count) break;
        if (child + 1 < g->count && g->heap[child + 1].error > g->heap[child].error) child++;
        if (g->heap[child].error <= last.error) break;
        g->heap[i] = g->heap[child];
        i = child;
    }
    if (g->count) g->heap[i] = last;
    g->error -= worst.error;
    return worst;
}

static bool quarter_worst(integration *g) {
    cell w = take_worst(g);
    const node *a = &w.corner[0], *b = &w.corner[1], *c = &w.corner[2];
    node ab = node_between(g, a, b), bc = node_between(g, b, c), ca = node_between(g, c, a);
    return add_triangle(g, a, &ab, &ca) && add_triangle(g, &ab, b, &bc) && add_triangle(g, &ca, &bc, c) &&
           add_triangle(g, &ab, &bc, &ca);
}

static bool start(integration *g, const polygon *shape) {
    node corner[POLYGON_CORNERS_MAX];
    bool ok = true;
    for (int i = 0; i < shape->count; i++) corner[i] = node_at(g, shape->corner[i]);
    for (int i = 1; ok && i + 1 < shape->count; i++) ok = add_triangle(g, &corner[0], &corner[i], &corner[i + 1]);
    return ok;
}

shadow_integral shadow_integrate(const polygon *shape, shadow_integrand f, void *user, double tolerance,
                                 uint64_t evaluation_limit, allocator *memory) {
    integration g = { .f = f, .user = user, .memory = memory };
    shadow_integral out = { 0 };
    bool ok = start(&g, shape);
    while (ok && g.error > tolerance && g.evaluations + 4 * POINTS + NEW_CORNERS <= evaluation_limit)
        ok = quarter_worst(&g);
    /* The running sum of errors has lost its small terms; what is reported is summed anew. */
    for (size_t i = 0; i < g.count; i++) {
        out.value += g.heap[i].value;
        out.error += g.heap[i].error;
    }
    out.evaluations = g.evaluations;
    out.converged = ok && out.error <= (1 + 1e-12) * tolerance;
    block_free(g.heap);
    return out;
}
