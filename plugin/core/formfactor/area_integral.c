/* SPDX-License-Identifier: MIT
 * See area_integral.h.
 */
#include "formfactor/area_integral.h"

#include "base/vec3.h"

#include <stdlib.h>
#include <string.h>

enum { POINTS = 7 };

typedef struct cell {
    double corner[3][3];
    double value, error;
} cell;

/* A binary heap by error, so that the worst cell is at hand. */
typedef struct cells {
    cell *at;
    size_t count, capacity;
} cells;

typedef struct integration {
    area_integrand f;
    void *user;
    cells heap;
    double error;
    uint64_t evaluations;
} integration;

static double triangle_area(const double corner[3][3]) {
    double u[3], v[3], n[3];
    vec3_sub(u, corner[1], corner[0]);
    vec3_sub(v, corner[2], corner[0]);
    vec3_cross(n, u, v);
    return 0.5 * vec3_length(n);
}

static double at_point(integration *g, const double corner[3][3], double w0, double w1, double w2) {
    double point[3];
    for (int k = 0; k < 3; k++) point[k] = w0 * corner[0][k] + w1 * corner[1][k] + w2 * corner[2][k];
    g->evaluations++;
    return g->f(g->user, point);
}

/* Sum over the three points with weights (1 - 2 w, w, w) in turn. */
static double orbit(integration *g, const double corner[3][3], double w) {
    return at_point(g, corner, 1 - 2 * w, w, w) + at_point(g, corner, w, 1 - 2 * w, w) +
           at_point(g, corner, w, w, 1 - 2 * w);
}

/* Mean over the triangle by centroid and one orbit at w: exact for degree 2 when the orbit weighs s each with
 * (1 - 3 s) / 9 + s (2 w^2 + (1 - 2 w)^2) = 1/6. */
static double degree_two(double center, double orbit_sum, double w) {
    double second = 2 * w * w + (1 - 2 * w) * (1 - 2 * w);
    double s = (1.0 / 6.0 - 1.0 / 9.0) / (second - 1.0 / 3.0);
    return (1 - 3 * s) * center + s * orbit_sum;
}

static void measure(integration *g, cell *c) {
    const double root = sqrt(15.0), outer = (6 - root) / 21, inner = (6 + root) / 21;
    double area = triangle_area(c->corner);
    double center = at_point(g, c->corner, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0);
    double a = orbit(g, c->corner, outer), b = orbit(g, c->corner, inner);
    double mean = 0.225 * center + (155 - root) / 1200 * a + (155 + root) / 1200 * b;
    double off = fmax(fabs(mean - degree_two(center, a, outer)), fabs(mean - degree_two(center, b, inner)));
    c->value = area * mean;
    c->error = area * off;
}

static bool push(integration *g, const cell *c) {
    cells *h = &g->heap;
    if (h->count == h->capacity) {
        size_t capacity = h->capacity ? 2 * h->capacity : 64;
        cell *grown = realloc(h->at, capacity * sizeof *grown);
        if (!grown) return false;
        h->at = grown;
        h->capacity = capacity;
    }
    size_t i = h->count++;
    for (; i > 0 && h->at[(i - 1) / 2].error < c->error; i = (i - 1) / 2) h->at[i] = h->at[(i - 1) / 2];
    h->at[i] = *c;
    g->error += c->error;
    return true;
}

static cell pop(integration *g) {
    cells *h = &g->heap;
    cell worst = h->at[0], last = h->at[--h->count];
    size_t i = 0;
    for (;;) {
        size_t child = 2 * i + 1;
        if (child >= h->count) break;
        if (child + 1 < h->count && h->at[child + 1].error > h->at[child].error) child++;
        if (h->at[child].error <= last.error) break;
        h->at[i] = h->at[child];
        i = child;
    }
    if (h->count) h->at[i] = last;
    g->error -= worst.error;
    return worst;
}

static cell new_cell(integration *g, const double a[3], const double b[3], const double c[3]) {
    cell out;
    vec3_copy(out.corner[0], a);
    vec3_copy(out.corner[1], b);
    vec3_copy(out.corner[2], c);
    measure(g, &out);
    return out;
}

/* A quarter may have no point beyond the kink that its parent saw, and think itself exact. So what the quarters changed
 * in the value of their parent is the least that each of them may be wrong by, shared between them. */
static bool push_quarters(integration *g, const cell *w) {
    cell quarter[4];
    double m[3][3], sum = 0.0;
    bool ok = true;
    for (int i = 0; i < 3; i++) vec3_mid(m[i], w->corner[i], w->corner[(i + 1) % 3]);
    quarter[0] = new_cell(g, w->corner[0], m[0], m[2]);
    quarter[1] = new_cell(g, m[0], w->corner[1], m[1]);
    quarter[2] = new_cell(g, m[2], m[1], w->corner[2]);
    quarter[3] = new_cell(g, m[0], m[1], m[2]);
    for (int i = 0; i < 4; i++) sum += quarter[i].value;
    for (int i = 0; ok && i < 4; i++) {
        quarter[i].error = fmax(quarter[i].error, 0.25 * fabs(sum - w->value));
        ok = push(g, &quarter[i]);
    }
    return ok;
}

static bool quarter_worst(integration *g) {
    cell worst = pop(g);
    return push_quarters(g, &worst);
}

/* Seven points are too few to be believed: every triangle of the fan is quartered once, whatever the limit. */
static bool begin(integration *g, const polygon *shape) {
    bool ok = true;
    for (int i = 1; ok && i + 1 < shape->count; i++) {
        cell first = new_cell(g, shape->corner[0], shape->corner[i], shape->corner[i + 1]);
        ok = push_quarters(g, &first);
    }
    return ok;
}

static double sum_errors(const cells *h) {
    double sum = 0.0;
    for (size_t i = 0; i < h->count; i++) sum += h->at[i].error;
    return sum;
}

area_integral area_integrate(const polygon *shape, area_integrand f, void *user, double tolerance,
                             uint64_t evaluation_limit) {
    integration g = { .f = f, .user = user };
    area_integral out = { 0 };
    bool ok = begin(&g, shape);
    while (ok && g.error > tolerance && g.evaluations + 4 * POINTS <= evaluation_limit) ok = quarter_worst(&g);
    /* The running sum of errors has lost its small terms; what is reported is summed anew. */
    for (size_t i = 0; i < g.heap.count; i++) out.value += g.heap.at[i].value;
    out.error = sum_errors(&g.heap);
    out.evaluations = g.evaluations;
    out.converged = ok && out.error <= 1.0000001 * tolerance;
    free(g.heap.at);
    return out;
}
