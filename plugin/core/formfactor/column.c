/* SPDX-License-Identifier: MIT */
#include "formfactor/column_worker.h"

#include "base/tolerance.h"
#include "scene/contact_lines.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool allocate(column_worker *w, const column_setup *s) {
    const mesh *m = s->mesh;
    size_t n = (size_t)(s->resolution > s->resolution_light ? s->resolution : s->resolution_light);
    w->cube.ids = block_new(m->memory, 3 * n * n * sizeof *w->cube.ids);
    w->batch_capacity = mesh_most_samples(m) + 1;
    w->batch = block_new(m->memory, w->batch_capacity * sizeof *w->batch);
    w->sum = block_zeroed(m->memory, m->sample_count + 1, sizeof *w->sum);
    w->reached = block_new(m->memory, (m->patch_count + 1) * sizeof *w->reached);
    w->is_reached = block_zeroed(m->memory, m->patch_count + 1, sizeof *w->is_reached);
    w->candidates = block_new(m->memory, (s->exact_emitters ? s->scene->surface_count + 1 : 1) * sizeof *w->candidates);
    w->blockers = block_new(m->memory, (s->exact_emitters ? s->scene->surface_count + 1 : 1) * sizeof *w->blockers);
    w->element = block_zeroed(m->memory, s->method == COLUMN_PIXELS ? m->element_count + 1 : 1, sizeof *w->element);
    bool all =
        w->cube.ids && w->batch && w->sum && w->reached && w->is_reached && w->element && w->candidates && w->blockers;
    for (int i = 0; i < 4; i++) {
        w->quarters[i].factors = block_zeroed(m->memory, m->sample_count + 1, sizeof *w->quarters[i].factors);
        all = all && w->quarters[i].factors;
    }
    return all;
}

column_worker *column_worker_create(const column_setup *setup, char *message, size_t message_size) {
    int n = setup->resolution > setup->resolution_light ? setup->resolution : setup->resolution_light;
    column_worker *w = block_zeroed(setup->mesh->memory, 1, sizeof *w);
    if (!w) return NULL;
    w->setup = setup;
    snprintf(message, message_size, "out of memory");
    const item_geometry *drawn = setup->method == COLUMN_PIXELS ? &setup->elements->items : &setup->items;
    const item_buffer_desc desc = { .geometry = drawn,
                                    .width = n,
                                    .height = 3 * n,
                                    .backend = setup->backend,
                                    .marks_holes = setup->scene->tree && setup->method != COLUMN_PIXELS,
                                    .memory = setup->mesh->memory };
    if (allocate(w, setup)) w->items = item_buffer_open(&desc, message, message_size);
    if (w->items) return w;
    column_worker_destroy(w);
    return NULL;
}

void column_worker_destroy(column_worker *w) {
    if (!w) return;
    item_buffer_destroy(w->items);
    block_free_all(w->cube.ids, w->batch, w->sum, w->element, w->reached, w->is_reached, w->paths, w->seen,
                   w->candidates, w->blockers, w->crossings.all);
    for (int i = 0; i < 4; i++) block_free(w->quarters[i].factors);
    block_free(w);
}

void column_mark_reached(column_worker *w, uint32_t patch_index) {
    if (w->is_reached[patch_index]) return;
    w->is_reached[patch_index] = true;
    w->reached[w->reached_count++] = patch_index;
}

void column_add_path(column_worker *w, uint64_t path) {
    if (block_grow(w->setup->mesh->memory, (void **)&w->paths, &w->path_capacity, w->path_count, sizeof path))
        w->paths[w->path_count++] = path;
    else
        w->failed = true;
}

static int compare_indices(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

column *column_create(allocator *memory, size_t run_count, size_t factor_count) {
    column *c = block_zeroed(memory, 1, sizeof *c);
    if (!c) return NULL;
    c->runs = block_new(memory, (run_count + 1) * sizeof *c->runs);
    c->factors = block_new(memory, (factor_count + 1) * sizeof *c->factors);
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
    column *c = column_create(m->memory, w->reached_count, factor_count);
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
            c->runs[i] = (column_run){
                w->reached[i], (uint32_t)(next - receiver->sample_count), received / receiver->area, { 1, 1, 1 }
            };
        w->is_reached[w->reached[i]] = false;
        if (receiver->contact != CONTACT_COPY) total += received;
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
    head.tints = c->tints;
    head.paths = c->paths, head.path_count = c->path_count;
    head.packed = c->packed, head.packed_count = c->packed_count;
    *c = head;
    for (size_t i = 0; i < c->run_count; i++) c->runs[i].factor *= c->scale;
    for (size_t i = 0; i < c->factor_count; i++) {
        c->factors[i] *= (float)c->scale;
        if (c->factors[i] > c->largest) c->largest = c->factors[i];
    }
}

/* Light on a pane that goes on is counted where it ends. */
static void pass_panes(column_worker *w, const subpatch *shooter, column *c) {
    double total = 0.0;
    column_tint(w, shooter, c);
    for (size_t i = 0; i < c->run_count; i++) {
        const patch *receiver = &w->setup->mesh->patches[c->runs[i].patch];
        for (int k = 0; k < 3; k++)
            total += c->runs[i].factor * receiver->area * c->runs[i].tint[k] *
                     (1.0 - receiver->material.transmittance[k]) / 3.0;
    }
    w->statistics.total = total / shooter->area;
    if (w->setup->method != COLUMN_PIXELS)
        w->statistics.scale = normalisation(w->statistics.total, w->statistics.closure.front);
}

static bool keep_paths(column_worker *w, column *c) {
    c->packed = w->packed, c->packed_count = w->packed_count;
    w->packed = NULL;
    if (w->path_count == 0) return true;
    c->paths = block_new(w->setup->mesh->memory, w->path_count * sizeof *c->paths);
    if (!c->paths) return false;
    memcpy(c->paths, w->paths, w->path_count * sizeof *c->paths);
    c->path_count = w->path_count;
    return true;
}

static void shoot(column_worker *w, const subpatch *shooter) {
    if (w->setup->method == COLUMN_PIXELS)
        column_shoot_pixels(w, shooter);
    else if (shooter->emits && w->setup->exact_emitters)
        column_shoot_emitter(w, shooter);
    else
        w->setup->shoot(w, shooter);
}

column *column_compute(column_worker *w, const subpatch *shooter) {
    memset(&w->statistics, 0, sizeof w->statistics);
    w->statistics.subpatch_scale = 1.0;
    w->reached_count = w->path_count = w->packed_count = 0;
    w->failed = false;
    shoot(w, shooter);
    column *c = collect(w, shooter->area);
    if (c && !keep_paths(w, c)) w->failed = true;
    if (c && w->setup->scene->panes) pass_panes(w, shooter, c);
    if (c) finish(c, &w->statistics);
    block_free(w->packed);
    w->packed = NULL;
    if (!w->failed) return c;
    column_destroy(c);
    return NULL;
}

bool column_receive(column_worker *w, const column *c, const subpatch *shooter, const mesh *receiving,
                    const column_receiver *receivers, size_t count, float *factors) {
    size_t longest = 0, all = 0;
    for (size_t i = 0; i < count; i++) {
        all += receivers[i].sample_count;
        if (receivers[i].sample_count > longest) longest = receivers[i].sample_count;
    }
    if (!block_reserve(w->setup->mesh->memory, (void **)&w->batch, &w->batch_capacity, longest, sizeof *w->batch))
        return false;
    w->failed = false;
    memset(factors, 0, all * sizeof *factors);
    column_receive_hybrid(w, c, shooter, receiving, receivers, count, factors);
    float scale = (float)(c->scale * c->subpatch_scale);
    for (size_t k = 0; k < all; k++) factors[k] *= scale;
    return !w->failed;
}

void column_destroy(column *c) {
    if (!c) return;
    block_free_all(c->runs, c->factors, c->tints, c->paths, c->packed, c);
}

size_t column_first_run(const column *c, uint32_t patch_index) {
    size_t low = 0, high = c->run_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (c->runs[middle].patch < patch_index)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

const column_run *column_run_of_patch(const column *c, uint32_t patch_index) {
    size_t run = column_first_run(c, patch_index);
    return run < c->run_count && c->runs[run].patch == patch_index ? &c->runs[run] : NULL;
}

size_t column_bytes(const column *c) {
    return sizeof *c + c->run_count * sizeof *c->runs + c->factor_count * sizeof *c->factors +
           (c->tints ? 3 * c->factor_count * sizeof *c->tints : 0) + c->path_count * sizeof *c->paths +
           2 * c->packed_count * sizeof *c->packed;
}
