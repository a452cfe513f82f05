/* SPDX-License-Identifier: MIT
 * See vertex_fit.h. The normal equations are solved by conjugate gradients with a diagonal preconditioner, element by
 * element, three bands at a time.
 */
#include "reconstruct/vertex_fit.h"

#include "base/block.h"

#include <math.h>
#include <string.h>

/* The weight of smoothness, relative to data: small enough to leave fits alone, large enough to settle a vertex whose
 * samples do not. */
static const double SMOOTHNESS = 2e-3;
static const double RESIDUAL_TARGET = 1e-7;
enum { ITERATIONS_MAX = 400 };

/* Samples of at least this share of their area's weight say what a vertex may be. */
static const double TRUSTED = 0.5;

/* See limit_to_samples. Measured on the rooms of tests/accuracy: an inner slack of 0 to 0.25 changes the error by
 * 0.02 %, without a limit halos reach a tenth of the step. */
static const double RIM_SLACK = 0.5, INNER_SLACK = 0.1;
enum { RIM_ELEMENTS = 3 };

/* The upper triangle of an element's 4 x 4 matrix, by rows. */
typedef struct element_matrix {
    float m[10];
} element_matrix;

typedef struct fit {
    const vertex_fit_input *in;
    vertex_fit_result *out;
    element_matrix *matrices;
    double *diagonal;      /* of the whole matrix */
    double *x, *r, *p, *q; /* [3*node+c]: solution, residual, direction, matrix times direction */
} fit;

void vertex_fit_weights(int corner_count, int diagonal, int k, double weights[4]) {
    element_sample_weights(corner_count, k, weights);
    if (corner_count == 3) return;
    double u = k == 0 || k == 3 ? 0.25 : 0.75, v = k < 2 ? 0.25 : 0.75;
    if (diagonal == 0) { /* triangles 0 1 2 and 0 2 3 */
        double low = u < v ? u : v, high = u < v ? v : u;
        weights[0] = 1 - high, weights[2] = low;
        weights[1] = u > v ? u - v : 0, weights[3] = v > u ? v - u : 0;
    } else { /* triangles 0 1 3 and 1 2 3 */
        bool lower = u + v <= 1;
        weights[0] = lower ? 1 - u - v : 0, weights[2] = lower ? 0 : u + v - 1;
        weights[1] = lower ? u : 1 - v, weights[3] = lower ? v : 1 - u;
    }
}

/* Cuts where the samples at the two ends differ less, so that an edge of light runs along it. */
static uint8_t choose_diagonal(const vertex_fit_input *in, const element *e) {
    if (element_corner_count(e) == 3) return 0;
    const double *B = in->radiance + 3 * (size_t)e->first_sample;
    double along02 = 0.0, along13 = 0.0;
    for (int c = 0; c < 3; c++) {
        along02 += fabs(B[c] - B[6 + c]);
        along13 += fabs(B[3 + c] - B[9 + c]);
    }
    return along13 < along02;
}

static int upper(int i, int j) {
    static const int row[4] = { 0, 3, 5, 6 };
    return i <= j ? row[i] + j : row[j] + i;
}

static void assemble_element(fit *f, size_t index) {
    const element *e = &f->in->mesh->elements[index];
    const uint32_t *node = f->in->node + 4 * index;
    int corners = element_corner_count(e);
    double m[10] = { 0 };
    f->out->diagonal[index] = choose_diagonal(f->in, e);
    for (int k = 0; k < corners; k++) {
        double phi[4], w = f->in->weight[e->first_sample + k];
        vertex_fit_weights(corners, f->out->diagonal[index], k, phi);
        for (int i = 0; i < corners; i++) {
            for (int j = i; j < corners; j++) m[upper(i, j)] += w * phi[i] * phi[j];
            for (int c = 0; c < 3; c++)
                f->r[3 * (size_t)node[i] + c] += w * phi[i] * f->in->radiance[3 * ((size_t)e->first_sample + k) + c];
        }
    }
    for (int i = 0; i < corners; i++) {
        int j = (i + 1) % corners;
        m[upper(i, i)] += SMOOTHNESS * e->area;
        m[upper(j, j)] += SMOOTHNESS * e->area;
        m[upper(i, j)] -= SMOOTHNESS * e->area;
    }
    for (int i = 0; i < 10; i++) f->matrices[index].m[i] = (float)m[i];
    for (int i = 0; i < corners; i++) f->diagonal[node[i]] += m[upper(i, i)];
}

/* q = matrix p */
static void multiply(fit *f) {
    memset(f->q, 0, 3 * f->in->node_count * sizeof *f->q);
    for (size_t index = 0; index < f->in->mesh->element_count; index++) {
        const uint32_t *node = f->in->node + 4 * index;
        int corners = element_corner_count(&f->in->mesh->elements[index]);
        for (int i = 0; i < corners; i++)
            for (int j = 0; j < corners; j++)
                for (int c = 0; c < 3; c++)
                    f->q[3 * (size_t)node[i] + c] += f->matrices[index].m[upper(i, j)] * f->p[3 * (size_t)node[j] + c];
    }
}

/* sum over nodes of a b / d for one band; d may be NULL. */
static double dot_band(const fit *f, const double *a, const double *b, const double *d, int c) {
    double sum = 0.0;
    for (size_t v = 0; v < f->in->node_count; v++) {
        double scale = d ? (d[v] > 0.0 ? 1.0 / d[v] : 0.0) : 1.0;
        sum += a[3 * v + c] * b[3 * v + c] * scale;
    }
    return sum;
}

static void set_direction(fit *f, const double beta[3]) {
    for (size_t v = 0; v < f->in->node_count; v++)
        for (int c = 0; c < 3; c++) {
            double preconditioned = f->diagonal[v] > 0.0 ? f->r[3 * v + c] / f->diagonal[v] : 0.0;
            f->p[3 * v + c] = preconditioned + beta[c] * f->p[3 * v + c];
        }
}

static void conjugate_gradients(fit *f) {
    double rz[3], first[3], beta[3] = { 0, 0, 0 };
    for (int c = 0; c < 3; c++) first[c] = rz[c] = dot_band(f, f->r, f->r, f->diagonal, c);
    set_direction(f, beta);
    for (f->out->iterations = 0; f->out->iterations < ITERATIONS_MAX; f->out->iterations++) {
        bool done = true;
        multiply(f);
        for (int c = 0; c < 3; c++) {
            double pq = dot_band(f, f->p, f->q, NULL, c), alpha = pq > 0.0 ? rz[c] / pq : 0.0;
            for (size_t v = 0; v < f->in->node_count; v++) {
                f->x[3 * v + c] += alpha * f->p[3 * v + c];
                f->r[3 * v + c] -= alpha * f->q[3 * v + c];
            }
            double next = dot_band(f, f->r, f->r, f->diagonal, c);
            beta[c] = rz[c] > 0.0 ? next / rz[c] : 0.0;
            rz[c] = next;
            done = done && next <= RESIDUAL_TARGET * RESIDUAL_TARGET * first[c];
        }
        if (done) return;
        set_direction(f, beta);
    }
}

/* What the trusted samples of the elements around a node span, of one band. */
typedef struct span {
    double low, high;
    int elements;
} span;

static void widen_spans(const fit *f, size_t index, int c, span *spans) {
    const element *e = &f->in->mesh->elements[index];
    const uint32_t *node = f->in->node + 4 * index;
    int corners = element_corner_count(e);
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k < corners; k++) {
        size_t s = (size_t)e->first_sample + (size_t)k;
        if (f->in->weight[s] < TRUSTED * f->in->mesh->sample_area[s]) continue;
        low = fmin(low, f->in->radiance[3 * s + c]);
        high = fmax(high, f->in->radiance[3 * s + c]);
    }
    for (int i = 0; i < corners; i++) {
        spans[node[i]].low = fmin(spans[node[i]].low, low);
        spans[node[i]].high = fmax(spans[node[i]].high, high);
        spans[node[i]].elements++;
    }
}

/* Least squares ring along a step; a vertex keeps to the span of its samples. At the rim of a face the outermost
 * samples are a quarter of an element inside, so a ramp needs half their span more. */
static void limit_to_samples(fit *f, span *spans) {
    for (int c = 0; c < 3; c++) {
        for (size_t v = 0; v < f->in->node_count; v++) spans[v] = (span){ INFINITY, -INFINITY, 0 };
        for (size_t e = 0; e < f->in->mesh->element_count; e++) widen_spans(f, e, c, spans);
        for (size_t v = 0; v < f->in->node_count; v++) {
            double slack =
                (spans[v].elements <= RIM_ELEMENTS ? RIM_SLACK : INNER_SLACK) * (spans[v].high - spans[v].low);
            double *x = &f->x[3 * v + c];
            if (spans[v].low <= spans[v].high) *x = fmin(fmax(*x, spans[v].low - slack), spans[v].high + slack);
            *x = *x > 0.0 ? *x : 0.0;
        }
    }
}

static void measure(fit *f) {
    double off = 0.0, all = 0.0;
    for (size_t index = 0; index < f->in->mesh->element_count; index++) {
        const element *e = &f->in->mesh->elements[index];
        const uint32_t *node = f->in->node + 4 * index;
        int corners = element_corner_count(e);
        if (f->in->emits && f->in->emits[index]) continue;
        for (int k = 0; k < corners; k++) {
            double phi[4];
            size_t s = (size_t)e->first_sample + (size_t)k;
            vertex_fit_weights(corners, f->out->diagonal[index], k, phi);
            for (int c = 0; c < 3; c++) {
                double shown = 0.0, B = f->in->radiance[3 * s + c];
                for (int i = 0; i < corners; i++) shown += phi[i] * f->x[3 * (size_t)node[i] + c];
                off += f->in->weight[s] * (shown - B) * (shown - B);
                all += f->in->weight[s] * B * B;
            }
        }
    }
    f->out->residual = all > 0.0 ? sqrt(off / all) : 0.0;
}

bool vertex_fit(const vertex_fit_input *in, vertex_fit_result *out) {
    size_t n = in->node_count, elements = in->mesh->element_count;
    fit f = { .in = in, .out = out };
    allocator *memory = in->mesh->memory;
    memset(out, 0, sizeof *out);
    f.matrices = block_zeroed(memory, elements + 1, sizeof *f.matrices);
    f.diagonal = block_zeroed(memory, n + 1, sizeof *f.diagonal);
    f.x = block_zeroed(memory, 3 * n + 1, sizeof *f.x);
    f.r = block_zeroed(memory, 3 * n + 1, sizeof *f.r);
    f.p = block_zeroed(memory, 3 * n + 1, sizeof *f.p);
    f.q = block_zeroed(memory, 3 * n + 1, sizeof *f.q);
    out->diagonal = block_zeroed(memory, elements + 1, 1);
    span *spans = block_new(memory, (n + 1) * sizeof *spans);
    bool ok = spans && f.matrices && f.diagonal && f.x && f.r && f.p && f.q && out->diagonal;
    if (ok) {
        for (size_t e = 0; e < elements; e++) assemble_element(&f, e);
        conjugate_gradients(&f);
        limit_to_samples(&f, spans);
        measure(&f);
        out->radiance = f.x;
        f.x = NULL;
    }
    block_free(spans);
    block_free(f.matrices);
    block_free(f.diagonal);
    block_free(f.x);
    block_free(f.r);
    block_free(f.p);
    block_free(f.q);
    if (!ok) vertex_fit_free(out);
    return ok;
}

void vertex_fit_free(vertex_fit_result *r) {
    block_free(r->radiance);
    block_free(r->diagonal);
    memset(r, 0, sizeof *r);
}
