/* SPDX-License-Identifier: MIT */
#include "solver/gather.h"

#include <string.h>

enum { GATHER_PATCHES = 16 };

typedef struct gathering {
    const shooters *shooters;
    const uint32_t *delivering; /* in their order */
    size_t delivering_count;
    double *irradiance;
} gathering;

/* E: of the first sample of the run's patch. */
static void gather_run(const shooters *s, const shooter *from, const column_run *run, double *E) {
    const patch *p = &s->mesh->patches[run->patch];
    const float *factors = from->column->factors + run->first;
    const double *B = from->shot;
    const float *tints = from->column->tints ? from->column->tints + 3 * (size_t)run->first : NULL;
    bool emitter = shooter_emits(s, from);
    for (uint32_t k = 0; k < p->sample_count; k++) {
        double F = row_closure_close(&s->rows, p->first_sample + k, emitter, factors[k]);
        for (uint32_t c = 0; c < 3; c++) E[3 * k + c] += F * (tints ? (double)tints[3 * k + c] : 1.0) * B[c];
    }
}

static bool has_shot(const shooter *s) {
    return s->column && (s->shot[0] != 0.0 || s->shot[1] != 0.0 || s->shot[2] != 0.0);
}

/* A few receiving patches from all kept columns, in shooter order. */
static void gather_item(void *user, size_t item, unsigned worker) {
    const gathering *g = user;
    const mesh *m = g->shooters->mesh;
    uint32_t first = (uint32_t)item * GATHER_PATCHES, end = first + GATHER_PATCHES;
    (void)worker;
    for (size_t i = 0; i < g->delivering_count; i++) {
        const shooter *from = &g->shooters->all[g->delivering[i]];
        const column *c = from->column;
        for (size_t r = column_first_run(c, first); r < c->run_count && c->runs[r].patch < end; r++)
            gather_run(g->shooters, from, &c->runs[r],
                       g->irradiance + 3 * (size_t)m->patches[c->runs[r].patch].first_sample);
    }
}

/* Most shooters of a large scene deliver nothing, and asking each for every few receivers took longer than all else. */
bool gather_all(const shooters *s, jobs *j, double *irradiance) {
    uint32_t *delivering = block_new(jobs_memory(j), (s->count + 1) * sizeof *delivering);
    gathering g = { .shooters = s, .delivering = delivering, .irradiance = irradiance };
    if (!delivering) return false;
    for (uint32_t i = 0; i < s->count; i++)
        if (has_shot(&s->all[i])) delivering[g.delivering_count++] = i;
    if (g.delivering_count > 0)
        jobs_run(j, (s->mesh->patch_count + GATHER_PATCHES - 1) / GATHER_PATCHES, gather_item, NULL, &g);
    block_free(delivering);
    return true;
}

void gather_deliver(shooters *s, uint32_t index, double *irradiance) {
    shooter *from = &s->all[index];
    const column *c = from->column;
    for (size_t i = 0; i < c->run_count; i++)
        gather_run(s, from, &c->runs[i], irradiance + 3 * (size_t)s->mesh->patches[c->runs[i].patch].first_sample);
    for (int k = 0; k < 3; k++) from->shot[k] = 0.0;
}

void gather_patch(const shooters *s, uint32_t patch_index, const double *irradiance, double *E) {
    const patch *p = &s->mesh->patches[patch_index];
    memcpy(E, irradiance + 3 * (size_t)p->first_sample, 3 * (size_t)p->sample_count * sizeof *E);
    for (size_t i = 0; i < s->count; i++) {
        if (!has_shot(&s->all[i])) continue;
        const column_run *run = column_run_of_patch(s->all[i].column, patch_index);
        if (run) gather_run(s, &s->all[i], run, E);
    }
}
