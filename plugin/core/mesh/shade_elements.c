/* SPDX-License-Identifier: MIT */
#include "mesh/shade_elements.h"

#include <stdatomic.h>

enum { PATCHES_A_JOB = 64 };

typedef struct shading {
    const shade_elements_setup *setup;
    shading_thread where;
    atomic_size_t first_bad;
    atomic_bool no_memory;
} shading;

static bool shade_patch(const shade_elements_setup *setup, const patch *p, double *scratch) {
    bool ok = true;
    for (size_t e = p->first_element; ok && e < (size_t)p->first_element + p->element_count; e++)
        ok = setup->shade(setup->user, e, scratch);
    return ok;
}

static void shade_job(void *user, size_t job, unsigned worker) {
    shading *g = user;
    const mesh *m = g->setup->mesh;
    double *scratch = block_new(m->memory, (g->setup->scratch + 1) * sizeof *scratch);
    size_t end = (job + 1) * PATCHES_A_JOB < m->patch_count ? (job + 1) * PATCHES_A_JOB : m->patch_count;
    (void)worker;
    if (!scratch) atomic_store(&g->no_memory, true);
    for (size_t p = job * PATCHES_A_JOB; scratch && p < end; p++) {
        if (g->setup->where(g->setup->user, &m->patches[p]) != g->where) continue;
        if (shade_patch(g->setup, &m->patches[p], scratch)) continue;
        size_t first = atomic_load(&g->first_bad);
        while (p < first && !atomic_compare_exchange_weak(&g->first_bad, &first, p)) continue;
    }
    block_free(scratch);
}

size_t shade_elements(const shade_elements_setup *setup) {
    shading g = { .setup = setup, .where = SHADED_ANYWHERE };
    size_t count = (setup->mesh->patch_count + PATCHES_A_JOB - 1) / PATCHES_A_JOB;
    atomic_init(&g.first_bad, SHADED_ALL);
    jobs_run(setup->jobs, count, shade_job, NULL, &g);
    g.where = SHADED_HERE;
    for (size_t job = 0; job < count; job++) shade_job(&g, job, 0);
    return atomic_load(&g.no_memory) ? SHADED_NO_MEMORY : atomic_load(&g.first_bad);
}
