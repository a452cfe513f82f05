/* SPDX-License-Identifier: MIT
 * See vertex_fit.h. The normal equations are solved by conjugate gradients with a diagonal preconditioner, three
 * bands at a time; the matrix is never formed, it is applied sample by sample.
 */
#include "reconstruct/vertex_fit.h"

#include <string.h>

/* The weight of smoothness, relative to data: small enough to leave fits alone, large enough to settle a vertex whose
 * samples do not. */
static const double SMOOTHNESS = 2e-3;

/* Of the first residual. Errors of rooms and an apartment differ from those at 1e-7 by 2e-5, for half the iterations.
 */
static const double RESIDUAL_TARGET = 1e-5;
enum { ITERATIONS_MAX = 400 };

/* Samples of at least this share of their area's weight say what a vertex may be. */
static const double TRUSTED = 0.5;

/* See limit_to_samples. Measured on the rooms of tests/accuracy: an inner slack of 0 to 0.25 changes the error by
 * 0.02 %, without a limit halos reach a tenth of the step. */
static const double RIM_SLACK = 0.5, INNER_SLACK = 0.1;
enum { RIM_ELEMENTS = 3 };

/* What a sample shows: three places of its element, and their weights. */
typedef struct sample_row {
    uint8_t place[3];
    float phi[3];
} sample_row;

/* Samples of elements with vertices hanging alike show the same: rows[quad][hanging][diagonal][k], and no memory a
 * sample. */
enum { HANGING = 16, DIAGONALS = 2, SAMPLES_MAX = 4 };

typedef struct fit {
    const vertex_fit_input *in;
    vertex_fit_result *out;
    sample_row rows[2][HANGING][DIAGONALS][SAMPLES_MAX];
    double *diagonal;      /* of the whole matrix */
    double *x, *r, *p, *q; /* [3*node+c]: solution, residual, direction, matrix times direction */
} fit;

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

static void set_rows(fit *f) {
    for (int corners = 3; corners <= 4; corners++)
        for (int hung = 0; hung < 1 << corners; hung++) {
            element e = { .hanging = (uint8_t)hung };
            if (corners == 3) e.corner[3] = NO_INDEX;
            for (int d = 0; d < DIAGONALS; d++)
                for (int k = 0; k < corners; k++) {
                    sample_row *row = &f->rows[corners == 4][hung][d][k];
                    double at[2], phi[3];
                    element_sample_place(corners, k, at);
                    element_locate(&e, d, at[0], at[1], row->place, phi);
                    for (int i = 0; i < 3; i++) row->phi[i] = (float)phi[i];
                }
        }
}

/* The rows of an element's samples. */
static const sample_row *rows_of(const fit *f, size_t index) {
    const element *e = &f->in->mesh->elements[index];
    return f->rows[element_corner_count(e) == 4][e->hanging][f->out->diagonal[index]];
}

static void assemble_element(fit *f, size_t index) {
    const element *e = &f->in->mesh->elements[index];
    const uint32_t *node = f->in->node + ELEMENT_PLACES * index;
    uint8_t ring[ELEMENT_PLACES];
    int corners = element_corner_count(e), places = element_ring(e, ring);
    f->out->diagonal[index] = f->in->diagonal ? f->in->diagonal[index] : choose_diagonal(f->in, e);
    const sample_row *rows = rows_of(f, index);
    for (int k = 0; k < corners; k++) {
        size_t s = (size_t)e->first_sample + (size_t)k;
        double w = f->in->weight[s];
        for (int i = 0; i < 3; i++) {
            double phi = rows[k].phi[i];
            size_t v = node[rows[k].place[i]];
            f->diagonal[v] += w * phi * phi;
            for (int c = 0; c < 3; c++) f->r[3 * v + (size_t)c] += w * phi * f->in->radiance[3 * s + (size_t)c];
        }
    }
    for (int i = 0; i < places; i++) f->diagonal[node[ring[i]]] += 2 * SMOOTHNESS * e->area;
}

static void multiply_samples(fit *f, size_t index) {
    const element *e = &f->in->mesh->elements[index];
    const uint32_t *node = f->in->node + ELEMENT_PLACES * index;
    const sample_row *row = rows_of(f, index);
    for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)element_corner_count(e); s++, row++) {
        for (size_t c = 0; c < 3; c++) {
            double shown = 0.0;
            for (int i = 0; i < 3; i++) shown += row->phi[i] * f->p[3 * (size_t)node[row->place[i]] + c];
            shown *= f->in->weight[s];
            for (int i = 0; i < 3; i++) f->q[3 * (size_t)node[row->place[i]] + c] += row->phi[i] * shown;
        }
    }
}

/* q = matrix p */
static void multiply(fit *f) {
    memset(f->q, 0, 3 * f->in->node_count * sizeof *f->q);
    for (size_t index = 0; index < f->in->mesh->element_count; index++) {
        const element *e = &f->in->mesh->elements[index];
        const uint32_t *node = f->in->node + ELEMENT_PLACES * index;
        uint8_t ring[ELEMENT_PLACES];
        int places = element_ring(e, ring);
        multiply_samples(f, index);
        for (int i = 0; i < places; i++) {
            size_t a = node[ring[i]], b = node[ring[(i + 1) % places]];
            for (size_t c = 0; c < 3; c++) {
                double pull = SMOOTHNESS * e->area * (f->p[3 * a + c] - f->p[3 * b + c]);
                f->q[3 * a + c] += pull;
                f->q[3 * b + c] -= pull;
            }
        }
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
        if (done || (f->in->watch && watcher_over(f->in->watch))) return;
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
    const uint32_t *node = f->in->node + ELEMENT_PLACES * index;
    uint8_t ring[ELEMENT_PLACES];
    int corners = element_corner_count(e), places = element_ring(e, ring);
    double low = INFINITY, high = -INFINITY;
    for (int k = 0; k < corners; k++) {
        size_t s = (size_t)e->first_sample + (size_t)k;
        if (f->in->weight[s] < TRUSTED * f->in->mesh->sample_area[s]) continue;
        low = fmin(low, f->in->radiance[3 * s + c]);
        high = fmax(high, f->in->radiance[3 * s + c]);
    }
    for (int i = 0; i < places; i++) {
        span *around = &spans[node[ring[i]]];
        around->low = fmin(around->low, low);
        around->high = fmax(around->high, high);
        around->elements += ring[i] < 4 ? 1 : 2; /* as if this one were as fine as its neighbours */
    }
}

/* Least squares ring along a step; a vertex keeps to the span of its samples. At the rim of a face the outermost
 * samples are a quarter of an element inside, so a ramp needs half their span more. */
static bool limit_to_samples(fit *f) {
    span *spans = block_new(f->in->mesh->memory, (f->in->node_count + 1) * sizeof *spans);
    if (!spans) return false;
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
    block_free(spans);
    return true;
}

static void measure(fit *f) {
    double off = 0.0, all = 0.0;
    for (size_t index = 0; index < f->in->mesh->element_count; index++) {
        const element *e = &f->in->mesh->elements[index];
        if (f->in->emits && f->in->emits[index]) continue;
        const uint32_t *node = f->in->node + ELEMENT_PLACES * index;
        const sample_row *row = rows_of(f, index);
        for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)element_corner_count(e); s++, row++) {
            for (size_t c = 0; c < 3; c++) {
                double shown = 0.0, B = f->in->radiance[3 * s + c];
                for (int i = 0; i < 3; i++) shown += row->phi[i] * f->x[3 * (size_t)node[row->place[i]] + c];
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
    set_rows(&f);
    f.diagonal = block_zeroed(memory, n + 1, sizeof *f.diagonal);
    f.x = block_zeroed(memory, 3 * n + 1, sizeof *f.x);
    f.r = block_zeroed(memory, 3 * n + 1, sizeof *f.r);
    f.p = block_zeroed(memory, 3 * n + 1, sizeof *f.p);
    f.q = block_zeroed(memory, 3 * n + 1, sizeof *f.q);
    out->diagonal = block_zeroed(memory, elements + 1, 1);
    bool ok = f.diagonal && f.x && f.r && f.p && f.q && out->diagonal;
    if (ok) {
        for (size_t e = 0; e < elements; e++) assemble_element(&f, e);
        conjugate_gradients(&f);
    }
    block_free_all(f.diagonal, f.r, f.p, f.q);
    out->radiance = f.x;
    ok = ok && limit_to_samples(&f);
    if (ok)
        measure(&f);
    else
        vertex_fit_free(out);
    return ok;
}

void vertex_fit_free(vertex_fit_result *r) {
    block_free_all(r->radiance, r->diagonal);
    memset(r, 0, sizeof *r);
}
