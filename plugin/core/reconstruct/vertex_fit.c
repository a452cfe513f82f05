/* SPDX-License-Identifier: MIT
 * See vertex_fit.h. Parts whose colours do not depend on each other are fitted each by itself, many at a time.
 */
#include "reconstruct/vertex_fit.h"

#include "reconstruct/fit_parts.h"
#include "reconstruct/fit_solve.h"

#include <string.h>

/* The weight of smoothness, relative to data: small enough to leave fits alone, large enough to settle a vertex whose
 * samples do not. */
static const double SMOOTHNESS = 2e-3;

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

/* So many nodes of one part are worth all threads; parts of fewer are handed out by about so many elements. */
enum { NODES_OF_LARGE = 16384, ELEMENTS_A_JOB = 1024 };

typedef struct part_figures {
    double off, all; /* sums of squares, weighed: of what is shown off the samples, and of these */
    int iterations;
} part_figures;

/* What the trusted samples of the elements around a node span, of one band. */
typedef struct span {
    double low, high;
    int elements;
} span;

typedef struct workspace {
    fit_matrix matrix;
    uint32_t *room;
    span *spans;
    size_t room_capacity, span_capacity;
} workspace;

typedef struct fit {
    const vertex_fit_input *in;
    vertex_fit_result *out;
    sample_row rows[2][HANGING][DIAGONALS][SAMPLES_MAX];
    fit_parts parts;
    part_figures *figures;          /* of parts */
    size_t large_count, task_count; /* parts that are fitted one by one, and jobs for the others */
    uint32_t *first_part;           /* of each job, and one more */
    atomic_bool failed;             /* out of memory */
} fit;

/* One part under way. */
typedef struct fitting {
    const fit *of;
    workspace *with;
    size_t part;
} fitting;

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

/* ---- one part ---- */

/* The element i of a part, and its nodes' numbers in the part by place; how many places, ring. */
static int open_element(const fitting *f, size_t i, size_t *index, uint32_t node[ELEMENT_PLACES],
                        uint8_t ring[ELEMENT_PLACES]) {
    const fit_parts *p = &f->of->parts;
    *index = p->element[p->first_element[f->part] + i];
    int places = element_ring(&f->of->in->mesh->elements[*index], ring);
    for (int k = 0; k < places; k++) node[ring[k]] = p->number[f->of->in->node[ELEMENT_PLACES * *index + ring[k]]];
    return places;
}

/* A vertex that hangs at a crease, with the finer neighbour beyond it, is of no other element: four samples do not tell
 * five colours, and what they are off by would be told apart at a corner. So it shows what the edge does there. */
static void hold_hanging(double of[ELEMENT_PLACES][ELEMENT_PLACES], double weight, int hanging, int a, int b) {
    const int at[3] = { hanging, a, b };
    static const double share[3] = { 1.0, -0.5, -0.5 };
    for (int k = 0; k < 3; k++)
        for (int l = 0; l < 3; l++) of[at[k]][at[l]] += weight * share[k] * share[l];
}

/* Adds what an element's samples, and its edges for smoothness, ask of its places. */
static void assemble_element(const fitting *f, size_t i) {
    size_t index;
    uint32_t node[ELEMENT_PLACES];
    uint8_t ring[ELEMENT_PLACES];
    double of[ELEMENT_PLACES][ELEMENT_PLACES] = { { 0 } };
    int places = open_element(f, i, &index, node, ring);
    const vertex_fit_input *in = f->of->in;
    const element *e = &in->mesh->elements[index];
    const sample_row *row = rows_of(f->of, index);
    for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)element_corner_count(e); s++, row++)
        for (int k = 0; k < 3; k++) {
            double weighed = in->weight[s] * (double)row->phi[k];
            double *r = f->with->matrix.r + 3 * (size_t)node[row->place[k]];
            for (int l = 0; l < 3; l++) of[row->place[k]][row->place[l]] += weighed * (double)row->phi[l];
            for (size_t c = 0; c < 3; c++) r[c] += weighed * in->radiance[3 * s + c];
        }
    for (int k = 0; k < places; k++) {
        int a = ring[k], b = ring[(k + 1) % places];
        double pull = SMOOTHNESS * e->area;
        of[a][a] += pull, of[b][b] += pull, of[a][b] -= pull, of[b][a] -= pull;
        if (a >= 4 && f->with->room[node[a]] == (uint32_t)places)
            hold_hanging(of, e->area, a, ring[(k + places - 1) % places], b);
    }
    for (int k = 0; k < places; k++)
        for (int l = 0; l < places; l++)
            if (of[ring[k]][ring[l]] != 0.0)
                fit_matrix_add(&f->with->matrix, node[ring[k]], node[ring[l]], of[ring[k]][ring[l]]);
}

/* The normal equations. False when out of memory. */
static bool assemble(const fitting *f) {
    workspace *w = f->with;
    allocator *memory = f->of->in->mesh->memory;
    size_t nodes = fit_parts_nodes(&f->of->parts, f->part), elements = fit_parts_elements(&f->of->parts, f->part);
    if (!block_reserve(memory, (void **)&w->room, &w->room_capacity, nodes, sizeof *w->room) ||
        !block_reserve(memory, (void **)&w->spans, &w->span_capacity, nodes, sizeof *w->spans))
        return false;
    for (size_t v = 0; v < nodes; v++) w->room[v] = 1;
    for (size_t i = 0; i < elements; i++) {
        size_t index;
        uint32_t node[ELEMENT_PLACES];
        uint8_t ring[ELEMENT_PLACES];
        int places = open_element(f, i, &index, node, ring);
        for (int k = 0; k < places; k++) w->room[node[ring[k]]] += (uint32_t)places - 1;
    }
    if (!fit_matrix_begin(memory, nodes, w->room, &w->matrix)) return false;
    for (size_t i = 0; i < elements; i++) assemble_element(f, i);
    return true;
}

static void widen_spans(const fitting *f, size_t i, int c) {
    const vertex_fit_input *in = f->of->in;
    size_t index;
    uint32_t node[ELEMENT_PLACES];
    uint8_t ring[ELEMENT_PLACES];
    int places = open_element(f, i, &index, node, ring);
    const element *e = &in->mesh->elements[index];
    double low = INFINITY, high = -INFINITY;
    for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)element_corner_count(e); s++) {
        double B = in->radiance[3 * s + (size_t)c];
        if (in->weight[s] < TRUSTED * in->mesh->sample_area[s]) continue;
        low = B < low ? B : low, high = B > high ? B : high;
    }
    for (int k = 0; k < places; k++) {
        span *around = &f->with->spans[node[ring[k]]];
        around->low = low < around->low ? low : around->low;
        around->high = high > around->high ? high : around->high;
        around->elements += ring[k] < 4 ? 1 : 2; /* as if this one were as fine as its neighbours */
    }
}

/* Least squares ring along a step; a vertex keeps to the span of its samples. At the rim of a face the outermost
 * samples are a quarter of an element inside, so a ramp needs half their span more. Below, no more than the same share
 * of the darkest: beside the sun a tenth of the step is more than all there is in the shadow, whose edge would be
 * black. */
static void limit_to_samples(const fitting *f) {
    const span *spans = f->with->spans;
    size_t nodes = fit_parts_nodes(&f->of->parts, f->part), elements = fit_parts_elements(&f->of->parts, f->part);
    for (int c = 0; c < 3; c++) {
        for (size_t v = 0; v < nodes; v++) f->with->spans[v] = (span){ INFINITY, -INFINITY, 0 };
        for (size_t i = 0; i < elements; i++) widen_spans(f, i, c);
        for (size_t v = 0; v < nodes; v++) {
            double share = spans[v].elements <= RIM_ELEMENTS ? RIM_SLACK : INNER_SLACK;
            double across = spans[v].high - spans[v].low, below = fmin(across, spans[v].low);
            double *x = &f->with->matrix.x[3 * v + (size_t)c];
            if (spans[v].low <= spans[v].high)
                *x = fmin(fmax(*x, spans[v].low - share * below), spans[v].high + share * across);
            *x = *x > 0.0 ? *x : 0.0;
        }
    }
}

static void measure(const fitting *f, part_figures *out) {
    const vertex_fit_input *in = f->of->in;
    for (size_t i = 0; i < fit_parts_elements(&f->of->parts, f->part); i++) {
        size_t index;
        uint32_t node[ELEMENT_PLACES];
        uint8_t ring[ELEMENT_PLACES];
        open_element(f, i, &index, node, ring);
        const element *e = &in->mesh->elements[index];
        const sample_row *row = rows_of(f->of, index);
        if (in->emits && in->emits[index]) continue;
        for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)element_corner_count(e); s++, row++) {
            for (size_t c = 0; c < 3; c++) {
                double shown = 0.0, B = in->radiance[3 * s + c];
                for (int k = 0; k < 3; k++)
                    shown += (double)row->phi[k] * f->with->matrix.x[3 * (size_t)node[row->place[k]] + c];
                out->off += in->weight[s] * (shown - B) * (shown - B);
                out->all += in->weight[s] * B * B;
            }
        }
    }
}

static void fit_part(fit *of, workspace *with, size_t part, jobs *j) {
    const fitting f = { of, with, part };
    const uint32_t *node = of->parts.node + of->parts.first_node[part];
    if (!assemble(&f)) {
        atomic_store(&of->failed, true);
        return;
    }
    of->figures[part].iterations = fit_solve(&with->matrix, j, of->in->watch);
    limit_to_samples(&f);
    measure(&f, &of->figures[part]);
    for (size_t v = 0; v < with->matrix.count; v++)
        memcpy(of->out->radiance + 3 * (size_t)node[v], with->matrix.x + 3 * v, 3 * sizeof(double));
}

static void workspace_free(workspace *w) {
    fit_matrix_free(&w->matrix);
    block_free_all(w->room, w->spans);
}

/* ---- all parts ---- */

static void parts_job(void *user, size_t task, unsigned worker) {
    fit *f = user;
    workspace with = { 0 };
    (void)worker;
    for (size_t p = f->first_part[task]; p < f->first_part[task + 1] && !atomic_load(&f->failed); p++)
        fit_part(f, &with, p, NULL);
    workspace_free(&with);
}

/* Parts are in order of size: the large ones come first. */
static void share_parts(fit *f) {
    size_t elements = ELEMENTS_A_JOB;
    while (f->large_count < f->parts.count && fit_parts_nodes(&f->parts, f->large_count) >= NODES_OF_LARGE)
        f->large_count++;
    for (size_t p = f->large_count; p < f->parts.count; p++) {
        if (elements >= ELEMENTS_A_JOB) f->first_part[f->task_count++] = (uint32_t)p, elements = 0;
        elements += fit_parts_elements(&f->parts, p);
    }
    f->first_part[f->task_count] = (uint32_t)f->parts.count;
}

static void fit_parts_all(fit *f) {
    workspace with = { 0 };
    share_parts(f);
    for (size_t p = 0; p < f->large_count; p++) fit_part(f, &with, p, f->in->jobs);
    workspace_free(&with);
    jobs_run(f->in->jobs, f->task_count, parts_job, NULL, f);
}

static void sum_up(const fit *f) {
    double off = 0.0, all = 0.0;
    for (size_t p = 0; p < f->parts.count; p++) {
        const part_figures *one = &f->figures[p];
        off += one->off, all += one->all;
        if (one->iterations > f->out->iterations) f->out->iterations = one->iterations;
    }
    f->out->residual = all > 0.0 ? sqrt(off / all) : 0.0;
}

bool vertex_fit(const vertex_fit_input *in, vertex_fit_result *out) {
    size_t elements = in->mesh->element_count;
    fit f = { .in = in, .out = out };
    allocator *memory = in->mesh->memory;
    memset(out, 0, sizeof *out);
    set_rows(&f);
    out->radiance = block_zeroed(memory, 3 * in->node_count + 1, sizeof *out->radiance);
    out->diagonal = block_zeroed(memory, elements + 1, 1);
    bool ok = out->radiance && out->diagonal && fit_parts_find(in->mesh, in->node, in->node_count, &f.parts);
    f.figures = block_zeroed(memory, f.parts.count + 1, sizeof *f.figures);
    f.first_part = block_new(memory, (f.parts.count + 2) * sizeof *f.first_part);
    ok = ok && f.figures && f.first_part;
    if (ok) {
        for (size_t e = 0; e < elements; e++)
            out->diagonal[e] = in->diagonal ? in->diagonal[e] : choose_diagonal(in, &in->mesh->elements[e]);
        fit_parts_all(&f);
        sum_up(&f);
        ok = !atomic_load(&f.failed);
    }
    fit_parts_free(&f.parts);
    block_free_all(f.figures, f.first_part);
    if (!ok) vertex_fit_free(out);
    return ok;
}

void vertex_fit_free(vertex_fit_result *r) {
    block_free_all(r->radiance, r->diagonal);
    memset(r, 0, sizeof *r);
}
