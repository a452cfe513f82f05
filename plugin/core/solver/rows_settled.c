/* SPDX-License-Identifier: MIT
 * See rows_settled.h.
 */
#include "solver/rows_settled.h"

#include "base/splitmix.h"
#include "solver/row_emitters.h"
#include "solver/row_gather.h"

#include <string.h>

enum { ELEMENTS_A_JOB = 64 };

/* Makes the nets of parts others than those of the elements that they are parts of. */
static const uint64_t OF_PARTS = UINT64_C(0x70617274);

typedef struct receiving {
    const rows_settled *settled;
    const mesh *fine;
    row_rays rays;
    row_aims aims; /* with the groups of the elements that there were */
    rows_received *out;
    bool (*wait)(void *user);
    void *wait_user;
} receiving;

void rows_settled_free(rows_settled *r) {
    if (!r) return;
    rays_destroy(r->rays);
    arena_free(&r->memory);
    row_aims_free(&r->aims);
    block_free_all(r->counts, r->B, r);
}

void rows_received_free(rows_received *r) {
    block_free_all(r->irradiance, r->row_sum, r->halves);
    memset(r, 0, sizeof *r);
}

static bool wait(void *user) {
    const receiving *r = user;
    return !r->wait || r->wait(r->wait_user);
}

static void receive_job(void *user, size_t job, unsigned worker) {
    receiving *r = user;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < (job + 1) * ELEMENTS_A_JOB && e < r->fine->element_count; e++) {
        row_rays_cast(&r->rays, (uint32_t)e, 0, r->aims.groups ? &r->aims : NULL);
        for (int k = 0; k < element_corner_count(&r->fine->elements[e]); k++) {
            double E[3], *to = r->out->irradiance + 3 * (r->fine->elements[e].first_sample + (size_t)k);
            row_gather(&r->rays, r->settled->B, e, k, E);
            for (int c = 0; c < 3; c++) to[c] += E[c];
        }
    }
}

/* False when out of memory. */
static bool open(receiving *r, const uint32_t *roots) {
    const rows_settled *from = r->settled;
    allocator *memory = r->fine->memory;
    size_t samples = r->fine->sample_count, count = r->fine->element_count;
    *r->out = (rows_received){ .irradiance = block_zeroed(memory, 3 * samples + 1, sizeof(double)),
                               .row_sum = block_zeroed(memory, samples + 1, sizeof(double)),
                               .halves = block_zeroed(memory, 3 * samples + 1, sizeof(double)) };
    r->rays = (row_rays){ .scene = from->scene,
                          .mesh = r->fine,
                          .lights = from->lights,
                          .rays = from->rays,
                          .seed = splitmix(from->seed ^ OF_PARTS),
                          .row_sum = r->out->row_sum,
                          .sky = block_zeroed(memory, 6 * samples + 1, sizeof(double)) };
    r->aims = from->aims;
    r->aims.of_element = block_new(memory, (count + 1) * sizeof *r->aims.of_element);
    row_counts *counts = block_new(memory, (count + 1) * sizeof *counts);
    if (!counts || !r->aims.of_element) return block_free(counts), false;
    for (size_t e = 0; e < count; e++) counts[e] = from->counts[roots[e]];
    for (size_t e = 0; e < count && from->aims.groups; e++) r->aims.of_element[e] = from->aims.of_element[roots[e]];
    return row_rays_open(&r->rays, counts) && r->out->irradiance && r->out->row_sum && r->out->halves && r->rays.sky;
}

static bool ask_emitters(receiving *r) {
    const rows_settled *from = r->settled;
    const row_emitters_setup setup = { .scene = from->scene,
                                       .mesh = r->fine,
                                       .met = from->mesh,
                                       .rays = from->rays,
                                       .jobs = from->jobs,
                                       .seed = splitmix(from->seed ^ OF_PARTS),
                                       .ray_count = from->emitter_rays,
                                       .wait = wait,
                                       .wait_user = r,
                                       .irradiance = r->out->irradiance,
                                       .doubt = r->out->halves };
    return from->emitter_rays == 0 || row_emitters_give(&setup);
}

bool rows_receive(const rows_settled *from, const mesh *fine, const uint32_t *roots, bool (*asked)(void *user),
                  void *user, rows_received *out) {
    receiving r = { .settled = from, .fine = fine, .out = out, .wait = asked, .wait_user = user };
    size_t count = (fine->element_count + ELEMENTS_A_JOB - 1) / ELEMENTS_A_JOB;
    bool ok = open(&r, roots) && ask_emitters(&r);
    if (ok && jobs_run(from->jobs, count, receive_job, wait, &r))
        row_gather_halves(&r.rays, from->B, from->jobs, out->halves);
    else
        rows_received_free(out), out->cut = ok;
    row_rays_free(&r.rays);
    block_free_all(r.rays.sky, r.aims.of_element);
    return ok;
}
