/* SPDX-License-Identifier: MIT */
#include "solver/full_matrix.h"

#include "base/tolerance.h"

#include <stdio.h>

enum { MESSAGE_SIZE = 128 };

typedef struct row_worker {
    item_buffer *items;
    hemicube cube;
    double *row; /* row[p]: weights of the pixels that show patch p */
} row_worker;

typedef struct full_matrix {
    const full_matrix_setup *setup;
    column **columns;
    row_worker *workers;
    hemicube_closure *closure; /* of each element */
    char (*messages)[MESSAGE_SIZE];
} full_matrix;

uint64_t full_matrix_bytes(const mesh *m) {
    return (uint64_t)m->patch_count * m->sample_count * sizeof(float);
}

static bool open_worker(full_matrix *f, unsigned worker) {
    const column_setup *c = f->setup->columns;
    row_worker *w = &f->workers[worker];
    int n = c->resolution;
    allocator *memory = jobs_memory(f->setup->jobs);
    const item_buffer_desc desc = {
        .geometry = &f->setup->patches->items, .width = n, .height = 3 * n, .backend = c->backend, .memory = memory
    };
    /* One that could not be opened is not tried again. */
    if (w->items || f->messages[worker][0]) return w->items;
    w->cube = (hemicube){ .resolution = n, .ids = block_new(memory, 3 * (size_t)n * (size_t)n * sizeof *w->cube.ids) };
    w->row = block_zeroed(memory, c->mesh->patch_count + 1, sizeof *w->row);
    snprintf(f->messages[worker], MESSAGE_SIZE, "out of memory");
    if (w->cube.ids && w->row) w->items = item_buffer_open(&desc, f->messages[worker], MESSAGE_SIZE);
    if (w->items) f->messages[worker][0] = 0;
    return w->items != NULL;
}

static void close_worker(void *user, size_t item, unsigned worker) {
    row_worker *w = &((full_matrix *)user)->workers[worker];
    (void)item;
    item_buffer_destroy(w->items);
    block_free_all(w->cube.ids, w->row);
}

static void count_pixels(const full_matrix *f, row_worker *w, hemicube_closure *closure) {
    const column_setup *c = f->setup->columns;
    size_t pixel_count = 3 * (size_t)c->resolution * (size_t)c->resolution;
    for (size_t q = 0; q < pixel_count; q++) {
        uint32_t id = w->cube.ids[q];
        uint32_t p = id ? mesh_items_facing(f->setup->patches, c->scene, id, w->cube.eye) : NO_INDEX;
        if (id == 0)
            closure->sky += c->weights[q];
        else if (p == NO_INDEX)
            closure->back += c->weights[q];
        else
            closure->front += c->weights[q], w->row[p] += c->weights[q];
    }
}

/* The row of one element, written to the samples of all columns. */
static void row_item(void *user, size_t item, unsigned worker) {
    full_matrix *f = user;
    const column_setup *c = f->setup->columns;
    const mesh *m = c->mesh;
    const element *e = &m->elements[item];
    const surface *facing = &c->scene->surfaces[m->patches[e->patch].surface];
    if (!open_worker(f, worker)) return;
    row_worker *w = &f->workers[worker];
    const polygon shape = mesh_polygon(m, e->corner);
    double center[3], eye[3];
    polygon_centroid(&shape, center);
    vec3_add_scaled(eye, center, TOLERANCE_EYE_LIFT * c->scene->radius, facing->normal);
    hemicube_place(&w->cube, eye, facing->normal, 0.0);
    if (!hemicube_draw(&w->cube, w->items, c->scene->center))
        snprintf(f->messages[worker], MESSAGE_SIZE, "a hemi-cube could not be drawn");
    count_pixels(f, w, &f->closure[item]);
    for (size_t p = 0; p < m->patch_count; p++) {
        for (int k = 0; k < shape.count; k++) f->columns[p]->factors[e->first_sample + (uint32_t)k] = (float)w->row[p];
        w->row[p] = 0.0;
    }
}

/* Patch averages (eq. 3), and where the light of a patch goes: what its own elements see. */
static void finish_column(full_matrix *f, size_t index) {
    const mesh *m = f->setup->columns->mesh;
    column *c = f->columns[index];
    const patch *own = &m->patches[index];
    for (size_t p = 0; p < m->patch_count; p++) {
        const patch *to = &m->patches[p];
        double received = 0.0;
        for (uint32_t s = to->first_sample; s < to->first_sample + to->sample_count; s++) {
            received += m->sample_area[s] * c->factors[s];
            c->largest = fmax(c->largest, c->factors[s]);
        }
        c->runs[p] = (column_run){ (uint32_t)p, to->first_sample, received / to->area, { 1, 1, 1 } };
        c->total += received / own->area;
    }
    for (uint32_t e = own->first_element; e < own->first_element + own->element_count; e++) {
        double share = m->elements[e].area / own->area;
        c->closure.front += share * f->closure[e].front;
        c->closure.back += share * f->closure[e].back;
        c->closure.sky += share * f->closure[e].sky;
    }
    c->hemicubes = own->element_count;
    c->evaluations = m->element_count;
    c->scale = 1.0;
}

static bool allocate(full_matrix *f) {
    const mesh *m = f->setup->columns->mesh;
    unsigned workers = jobs_worker_count(f->setup->jobs);
    allocator *memory = jobs_memory(f->setup->jobs);
    f->workers = block_zeroed(memory, workers, sizeof *f->workers);
    f->messages = block_zeroed(memory, workers, sizeof *f->messages);
    f->closure = block_zeroed(memory, m->element_count + 1, sizeof *f->closure);
    if (!f->workers || !f->messages || !f->closure) return false;
    for (size_t p = 0; p < m->patch_count; p++)
        if (!(f->columns[p] = column_create(memory, m->patch_count, m->sample_count))) return false;
    return true;
}

static bool wait(void *user) {
    const full_matrix_setup *setup = ((full_matrix *)user)->setup;
    return !setup->wait || setup->wait(setup->wait_user);
}

const char *full_matrix_compute(const full_matrix_setup *setup, column **columns, char *message, size_t message_size) {
    full_matrix f = { .setup = setup, .columns = columns };
    const mesh *m = setup->columns->mesh;
    const char *failure = NULL;
    bool ok = allocate(&f), all = false;
    if (!ok)
        snprintf(message, message_size, "out of memory for a matrix of %llu MiB",
                 (unsigned long long)(full_matrix_bytes(m) >> 20)),
            failure = message;
    if (ok) all = jobs_run(setup->jobs, m->element_count, row_item, wait, &f);
    for (unsigned w = 0; ok && w < jobs_worker_count(setup->jobs); w++)
        if (f.messages[w][0]) snprintf(message, message_size, "%s", f.messages[w]), failure = message;
    if (f.workers) jobs_run_on_each_worker(setup->jobs, close_worker, &f);
    if (all && !failure)
        for (size_t p = 0; p < m->patch_count; p++) finish_column(&f, p);
    for (size_t p = 0; (!all || failure) && p < m->patch_count; p++) {
        column_destroy(columns[p]);
        columns[p] = NULL;
    }
    block_free_all(f.workers, f.messages, f.closure);
    return failure;
}
