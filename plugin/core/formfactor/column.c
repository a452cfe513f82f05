/* SPDX-License-Identifier: MIT
 * See column.h.
 */
#include "formfactor/column_worker.h"

#include "base/tolerance.h"
#include "base/vec3.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static size_t longest_run(const mesh *m) {
    size_t longest = 1;
    for (size_t p = 0; p < m->patch_count; p++)
        if (m->patches[p].sample_count > longest) longest = m->patches[p].sample_count;
    return longest;
}

static bool allocate(column_worker *w, const column_setup *s) {
    const mesh *m = s->mesh;
    size_t n = (size_t)(s->resolution > s->resolution_light ? s->resolution : s->resolution_light);
    w->cube.ids = malloc(3 * n * n * sizeof *w->cube.ids);
    w->batch = malloc(longest_run(m) * sizeof *w->batch);
    w->sum = calloc(m->sample_count + 1, sizeof *w->sum);
    w->reached = malloc((m->patch_count + 1) * sizeof *w->reached);
    w->is_reached = calloc(m->patch_count + 1, sizeof *w->is_reached);
    w->element = calloc(s->method == COLUMN_PIXELS ? m->element_count + 1 : 1, sizeof *w->element);
    bool all = w->cube.ids && w->batch && w->sum && w->reached && w->is_reached && w->element;
    for (int i = 0; i < 4; i++) {
        w->parts[i].factors = calloc(m->sample_count + 1, sizeof *w->parts[i].factors);
        all = all && w->parts[i].factors;
    }
    return all;
}

column_worker *column_worker_create(const column_setup *setup, char *message, size_t message_size) {
    int n = setup->resolution > setup->resolution_light ? setup->resolution : setup->resolution_light;
    column_worker *w = calloc(1, sizeof *w);
    if (!w) return NULL;
    w->setup = setup;
    snprintf(message, message_size, "out of memory");
    const item_geometry *drawn = setup->method == COLUMN_PIXELS ? &setup->elements->items : &setup->items;
    const item_buffer_desc desc = { .geometry = drawn,
                                    .width = n,
                                    .height = 3 * n,
                                    .backend = setup->backend,
                                    .marks_holes = setup->scene->tree && setup->method != COLUMN_PIXELS };
    if (allocate(w, setup)) w->items = item_buffer_open(&desc, message, message_size);
    if (w->items) return w;
    column_worker_destroy(w);
    return NULL;
}

void column_worker_destroy(column_worker *w) {
    if (!w) return;
    item_buffer_destroy(w->items);
    free(w->cube.ids);
    free(w->batch);
    free(w->sum);
    free(w->element);
    free(w->reached);
    free(w->is_reached);
    for (int i = 0; i < 4; i++) free(w->parts[i].factors);
    free(w);
}

void column_mark_reached(column_worker *w, uint32_t patch_index) {
    if (w->is_reached[patch_index]) return;
    w->is_reached[patch_index] = true;
    w->reached[w->reached_count++] = patch_index;
}

static int compare_indices(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

column *column_create(size_t run_count, size_t factor_count) {
    column *c = calloc(1, sizeof *c);
    if (!c) return NULL;
    c->runs = malloc((run_count + 1) * sizeof *c->runs);
    c->factors = malloc((factor_count + 1) * sizeof *c->factors);
    c->run_count = run_count;
    c->factor_count = factor_count;
    if (c->runs && c->factors) return c;
    column_destroy(c);
    return NULL;
}

/* A column that gives away more than there is, is brought down to it [Baum89, eq. 11]; in a closed room, where all must
 * arrive, one that misses a few percent is brought up. A larger deficit stays: it is light that samples cannot see. In
 * an open scene the hemi-cube is no measure: it knows the centre of the shooter, the column its whole. */
static double normalisation(double total, double front) {
    if (total <= 0.0) return 1.0;
    double ratio = 1.0 / total;
    bool closed = front > 1.0 - TOLERANCE_CLOSED;
    return ratio < 1.0 || (closed && ratio <= 1.0 + TOLERANCE_CLOSURE_EXCESS) ? ratio : 1.0;
}

/* Moves the dense sums of the reached patches into a column, in patch order, and clears them. */
static column *collect(column_worker *w, double area) {
    const mesh *m = w->setup->mesh;
    size_t factor_count = 0, next = 0;
    qsort(w->reached, w->reached_count, sizeof *w->reached, compare_indices);
    for (size_t i = 0; i < w->reached_count; i++) factor_count += m->patches[w->reached[i]].sample_count;
    column *c = column_create(w->reached_count, factor_count);
    double total = 0.0;
    for (size_t i = 0; i < w->reached_count; i++) {
        const patch *receiver = &m->patches[w->reached[i]];
        double received = 0.0;
        for (uint32_t s = receiver->first_sample; s < receiver->first_sample + receiver->sample_count; s++) {
            received += m->sample_area[s] * w->sum[s];
            if (c) c->factors[next++] = (float)w->sum[s];
            w->sum[s] = 0.0;
        }
        if (c)
            c->runs[i] =
                (column_run){ w->reached[i], (uint32_t)(next - receiver->sample_count), received / receiver->area };
        w->is_reached[w->reached[i]] = false;
        total += received;
    }
    w->statistics.total = total / area;
    bool as_found = w->setup->method == COLUMN_PIXELS;
    w->statistics.scale = as_found ? 1.0 : normalisation(w->statistics.total, w->statistics.closure.front);
    return c;
}

static void finish(column *c, const column *statistics) {
    column head = *statistics;
    head.runs = c->runs, head.run_count = c->run_count;
    head.factors = c->factors, head.factor_count = c->factor_count;
    *c = head;
    for (size_t i = 0; i < c->run_count; i++) c->runs[i].factor *= c->scale;
    for (size_t i = 0; i < c->factor_count; i++) {
        c->factors[i] *= (float)c->scale;
        if (c->factors[i] > c->largest) c->largest = c->factors[i];
    }
}

static void give(column_worker *w, const column_piece *piece) {
    if (w->setup->method == COLUMN_PIXELS)
        column_give_pixels(w, piece);
    else
        column_give_hybrid(w, piece);
}

column *column_compute_piece(column_worker *w, const column_piece *piece) {
    memset(&w->statistics, 0, sizeof w->statistics);
    w->reached_count = 0;
    w->failed = false;
    give(w, piece);
    column *c = collect(w, piece->area);
    if (c) finish(c, &w->statistics);
    if (!w->failed) return c;
    column_destroy(c);
    return NULL;
}

column_piece column_whole_patch(const mesh *m, uint32_t patch_index) {
    const patch *p = &m->patches[patch_index];
    column_piece whole = { .patch = patch_index, .area = p->area };
    whole.shape.count = patch_corner_count(p);
    for (int i = 0; i < whole.shape.count; i++)
        vec3_copy(whole.shape.corner[i], m->vertices + 3 * (size_t)p->corner[i]);
    return whole;
}

column *column_compute(column_worker *w, uint32_t patch_index) {
    column_piece whole = column_whole_patch(w->setup->mesh, patch_index);
    return column_compute_piece(w, &whole);
}

void column_destroy(column *c) {
    if (!c) return;
    free(c->runs);
    free(c->factors);
    free(c);
}

size_t column_bytes(const column *c) {
    return sizeof *c + c->run_count * sizeof *c->runs + c->factor_count * sizeof *c->factors;
}
