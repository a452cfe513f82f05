/* SPDX-License-Identifier: MIT
 * See final_gather.h.
 */
#include "solver/final_gather.h"

#include "base/splitmix.h"
#include "solver/row_emitters.h"
#include "solver/row_gather.h"
#include "solver/row_kept.h"

#include <string.h>

enum { ELEMENTS_A_JOB = ROW_KEPT_ELEMENTS };

/* Makes the nets of parts others than those of the elements that they are parts of. */
static const uint64_t OF_PARTS = UINT64_C(0x70617274);

typedef struct gathering {
    const final_gather *from;
    const mesh *fine;
    row_rays rays;
    row_sharing sharing;
    row_guiding guiding; /* with the groups of the elements that there were */
    final_gather_result *out;
    kept_pass kept;
    bool (*wait)(void *user);
    void *wait_user;
} gathering;

final_gather *final_gather_open(const scene *s, const mesh *m, jobs *j, double open_distance, char *message,
                                size_t message_size) {
    final_gather *r = block_zeroed(m->memory, 1, sizeof *r);
    *message = 0;
    if (!r) return NULL;
    r->scene = s, r->mesh = m, r->jobs = j;
    r->memory.memory = m->memory;
    if (mesh_items_create(s, m, MESH_ELEMENTS, &r->memory, &r->items))
        r->rays = rays_create(s, &r->items, message, message_size);
    if (r->rays && open_distance > 0.0) rays_reach(r->rays, open_distance);
    if (r->rays && final_gather_own_elements(r)) return r;
    final_gather_free(r);
    return NULL;
}

bool final_gather_own_elements(final_gather *r) {
    size_t bytes = (r->mesh->element_count + 1) * sizeof *r->own.elements;
    r->own = *r->mesh;
    r->own.elements = block_new(r->mesh->memory, bytes);
    if (!r->own.elements) return false;
    memcpy(r->own.elements, r->mesh->elements, r->mesh->element_count * sizeof *r->own.elements);
    r->mesh = &r->own;
    return true;
}

bool final_gather_keep_split(final_gather *r, const bool *marks, uint32_t count) {
    if (!r || r->mesh != &r->own) return true;
    split_record *s = &r->splits;
    size_t needed = s->mark_count + count;
    if (!block_grow(r->own.memory, (void **)&s->counts, &s->pass_capacity, s->pass_count, sizeof *s->counts) ||
        !block_reserve(r->own.memory, (void **)&s->marks, &s->mark_capacity, needed, sizeof *s->marks))
        return false;
    s->counts[s->pass_count++] = count;
    for (size_t i = 0; i < count; i++) s->marks[s->mark_count++] = marks[i];
    return true;
}

bool final_gather_keep_roots(final_gather *r, const leaf *leaves, uint32_t count) {
    if (!r || r->mesh != &r->own) return true;
    r->roots = block_new(r->own.memory, ((size_t)count + 1) * sizeof *r->roots);
    for (uint32_t i = 0; r->roots && i < count; i++) r->roots[i] = leaves[i].root;
    return r->roots;
}

void final_gather_free(final_gather *r) {
    if (!r) return;
    rays_destroy(r->rays);
    arena_free(&r->memory);
    row_guiding_free(&r->guiding);
    block_free_all(r->counts, r->B, r->own.elements, r->roots, r->splits.counts, r->splits.marks, r);
}

void final_gather_result_free(final_gather_result *r) {
    block_free_all(r->irradiance, r->row_sum, r->half_difference);
    memset(r, 0, sizeof *r);
}

static bool wait(void *user) {
    const gathering *r = user;
    return !r->wait || r->wait(r->wait_user);
}

static void gather_job(void *user, size_t job, unsigned worker) {
    gathering *r = user;
    static const uint16_t first[ELEMENTS_A_JOB];
    size_t begin = job * ELEMENTS_A_JOB, all = r->fine->element_count;
    size_t end = begin + ELEMENTS_A_JOB < all ? begin + ELEMENTS_A_JOB : all;
    const row_kept_job kept = { &r->rays, &r->kept, begin, end, r->from->mesh->element_count, first };
    (void)worker;
    bool is_kept = row_kept_take(&kept);
    for (size_t e = begin; e < end; e++) {
        if (!row_sharing_is_own(&r->sharing, e)) continue;
        if (!is_kept) row_rays_cast(&r->rays, (uint32_t)e, 0, r->guiding.groups ? &r->guiding : NULL);
        for (int k = 0; k < element_corner_count(&r->fine->elements[e]); k++) {
            double E[3], *to = r->out->irradiance + 3 * (r->fine->elements[e].first_sample + (size_t)k);
            row_gather(&r->rays, r->from->B, e, k, E);
            for (int c = 0; c < 3; c++) to[c] += E[c];
        }
    }
    if (!is_kept) row_kept_give(&kept);
}

/* False: out of memory, or those who share the parts are lost. */
static bool give(const gathering *r) {
    return row_sharing_give_samples(&r->sharing, r->out->irradiance, 3 * sizeof(double)) &&
           row_sharing_give_samples(&r->sharing, r->out->row_sum, sizeof(double));
}

/* False when out of memory. */
static bool open(gathering *r, const uint32_t *roots) {
    const final_gather *from = r->from;
    allocator *memory = r->fine->memory;
    size_t samples = r->fine->sample_count, count = r->fine->element_count;
    *r->out = (final_gather_result){ .irradiance = block_zeroed(memory, 3 * samples + 1, sizeof(double)),
                                     .row_sum = block_zeroed(memory, samples + 1, sizeof(double)),
                                     .half_difference = block_zeroed(memory, 3 * samples + 1, sizeof(double)) };
    r->rays = (row_rays){ .scene = from->scene,
                          .mesh = r->fine,
                          .lights = from->lights,
                          .rays = from->rays,
                          .seed = splitmix(from->seed ^ OF_PARTS),
                          .sharing = &r->sharing,
                          .row_sum = r->out->row_sum,
                          .sky = block_zeroed(memory, 6 * samples + 1, sizeof(double)) };
    r->guiding = from->guiding;
    r->guiding.of_element = block_new(memory, (count + 1) * sizeof *r->guiding.of_element);
    row_counts *counts = block_new(memory, (count + 1) * sizeof *counts);
    if (!counts || !r->guiding.of_element) return block_free(counts), false;
    for (size_t e = 0; e < count; e++) counts[e] = from->counts[roots[e]];
    for (size_t e = 0; e < count && from->guiding.groups; e++)
        r->guiding.of_element[e] = from->guiding.of_element[roots[e]];
    return row_sharing_open(jobs_ranks(from->jobs), r->fine, NULL, ELEMENTS_A_JOB, &r->sharing) &&
           row_panes_create(from->scene, r->fine, from->mesh, &r->rays.panes) && row_rays_open(&r->rays, counts) &&
           r->out->irradiance && r->out->row_sum && r->out->half_difference && r->rays.sky;
}

static bool gather_emitters(gathering *r) {
    const final_gather *from = r->from;
    const row_emitters_setup setup = { .scene = from->scene,
                                       .mesh = r->fine,
                                       .hit = from->mesh,
                                       .rays = from->rays,
                                       .lights = from->lights,
                                       .jobs = from->jobs,
                                       .seed = splitmix(from->seed ^ OF_PARTS),
                                       .ray_count = from->emitter_rays,
                                       .wait = wait,
                                       .wait_user = r,
                                       .irradiance = r->out->irradiance,
                                       .half_difference = r->out->half_difference };
    return from->emitter_rays == 0 || row_emitters_gather(&setup);
}

bool final_gather_solve(const final_gather *from, const mesh *fine, const uint32_t *roots, bool (*asked)(void *user),
                        void *user, final_gather_result *out) {
    gathering r = { .from = from, .fine = fine, .out = out, .wait = asked, .wait_user = user };
    size_t count = (fine->element_count + ELEMENTS_A_JOB - 1) / ELEMENTS_A_JOB;
    bool ok = open(&r, roots) && gather_emitters(&r);
    r.kept = jobs_begin_pass(from->jobs);
    bool all = ok && jobs_run(from->jobs, count, gather_job, wait, &r);
    if (all)
        ok = !r.rays.panes.failed && give(&r) && row_gather_halves(&r.rays, from->B, from->jobs, out->half_difference);
    if (!all || !ok) final_gather_result_free(out), out->cut = ok;
    row_rays_free(&r.rays);
    row_panes_free(&r.rays.panes);
    row_sharing_free(&r.sharing);
    block_free_all(r.rays.sky, r.guiding.of_element);
    return ok;
}
