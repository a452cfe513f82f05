/* SPDX-License-Identifier: MIT
 * Which vertex colours fit the paths of fitted_bake.h? Conjugate gradients with a diagonal preconditioner, one band at
 * a time; a triangle is a 3 x 3 matrix, and the whole is never formed.
 */
#include "fitted_bake.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double RESIDUAL_TARGET = 1e-6;
enum { ITERATIONS_MAX = 400 };

typedef struct solve {
    const fitted_bake *bake;
    double smoothness;
    double *diagonal, *x, *r, *p, *q; /* all[v] */
} solve;

/* What a path of a triangle stands for, m2. */
static double path_area(const fitted_triangle *t) {
    return t->counted ? t->area / t->counted : 0;
}

static void set_up(solve *s, int band) {
    const fitted_bake *b = s->bake;
    memset(s->x, 0, b->vertex_count * sizeof *s->x);
    memset(s->r, 0, b->vertex_count * sizeof *s->r);
    memset(s->diagonal, 0, b->vertex_count * sizeof *s->diagonal);
    for (size_t i = 0; i < b->triangle_count; i++) {
        const fitted_triangle *t = &b->triangles[i];
        for (int k = 0; k < 3; k++) {
            s->r[t->vertex[k]] += path_area(t) * t->right[k][band];
            s->diagonal[t->vertex[k]] += path_area(t) * t->phi[k] + 2 * s->smoothness * t->area;
        }
    }
}

/* q = matrix p */
static void multiply(solve *s) {
    const fitted_bake *b = s->bake;
    memset(s->q, 0, b->vertex_count * sizeof *s->q);
    for (size_t i = 0; i < b->triangle_count; i++) {
        const fitted_triangle *t = &b->triangles[i];
        const uint32_t *v = t->vertex;
        double w = path_area(t), pull = s->smoothness * t->area;
        for (int k = 0; k < 3; k++) {
            int next = (k + 1) % 3;
            double off = w * t->phi[3 + k] - pull;
            s->q[v[k]] += (w * t->phi[k] + 2 * pull) * s->p[v[k]] + off * s->p[v[next]];
            s->q[v[next]] += off * s->p[v[k]];
        }
    }
}

static double dot_scaled(const solve *s, const double *a, const double *b, bool scaled) {
    double sum = 0;
    for (size_t v = 0; v < s->bake->vertex_count; v++)
        if (!scaled || s->diagonal[v] > 0) sum += a[v] * b[v] / (scaled ? s->diagonal[v] : 1);
    return sum;
}

static void set_direction(solve *s, double beta) {
    for (size_t v = 0; v < s->bake->vertex_count; v++)
        s->p[v] = (s->diagonal[v] > 0 ? s->r[v] / s->diagonal[v] : 0) + beta * s->p[v];
}

static void conjugate_gradients(solve *s) {
    double rz = dot_scaled(s, s->r, s->r, true), first = rz;
    memset(s->p, 0, s->bake->vertex_count * sizeof *s->p);
    set_direction(s, 0);
    for (int i = 0; i < ITERATIONS_MAX && rz > RESIDUAL_TARGET * RESIDUAL_TARGET * first; i++) {
        multiply(s);
        double pq = dot_scaled(s, s->p, s->q, false), alpha = pq > 0 ? rz / pq : 0;
        for (size_t v = 0; v < s->bake->vertex_count; v++) {
            s->x[v] += alpha * s->p[v];
            s->r[v] -= alpha * s->q[v];
        }
        double next = dot_scaled(s, s->r, s->r, true);
        set_direction(s, rz > 0 ? next / rz : 0);
        rz = next;
    }
}

bool fitted_bake_get(const fitted_bake *b, double smoothness, float *radiance) {
    size_t n = b->vertex_count + 1;
    double *block = calloc(5 * n, sizeof *block);
    if (!block) return false;
    solve s = { b, smoothness, block, block + n, block + 2 * n, block + 3 * n, block + 4 * n };
    for (int band = 0; band < 3; band++) {
        set_up(&s, band);
        conjugate_gradients(&s);
        for (size_t v = 0; v < b->vertex_count; v++) radiance[3 * v + (size_t)band] = (float)fmax(s.x[v], 0);
    }
    free(block);
    return true;
}
