/* SPDX-License-Identifier: MIT
 * See kept_rows.h.
 */
#include "solver/kept_rows.h"

#include "base/splitmix.h"
#include "solver/packed_direction.h"

static size_t count_sky(const kept_rows *k, size_t e) {
    size_t count = 0, all = row_count(&k->rays, e) * (size_t)element_corner_count(&k->rays.mesh->elements[e]);
    for (size_t i = k->rays.begin[e]; i < k->rays.begin[e] + all; i++) count += k->rays.hit[i] == ROW_HIT_SKY;
    return count;
}

/* ---- casting ---- */

typedef struct casting {
    kept_rows *kept;
    row_guiding guiding; /* with the groups of the elements that there were */
    bool (*wait)(void *user);
    void *user;
} casting;

static bool wait_for(void *user) {
    const casting *c = user;
    return !c->wait || c->wait(c->user);
}

static void cast_job(void *user, size_t job, unsigned worker) {
    const casting *c = user;
    (void)worker;
    for (size_t e = job * KEPT_ROWS_A_JOB; e < kept_rows_job_end(c->kept->rays.mesh->element_count, job); e++)
        row_rays_cast(&c->kept->rays, (uint32_t)e, 0, c->guiding.groups ? &c->guiding : NULL);
}

static void direction_job(void *user, size_t job, unsigned worker) {
    const casting *c = user;
    const row_rays *r = &c->kept->rays;
    (void)worker;
    for (size_t e = job * KEPT_ROWS_A_JOB; e < kept_rows_job_end(c->kept->rays.mesh->element_count, job); e++) {
        uint32_t *next = c->kept->sky_direction + c->kept->sky_begin[e];
        for (int k = 0; k < element_corner_count(&r->mesh->elements[e]); k++) {
            row_lobes lobes;
            const row_sampler at =
                row_sampler_guided(r, c->guiding.groups ? &c->guiding : NULL, (uint32_t)e, k, &lobes);
            for (size_t i = 0; i < row_count(r, e); i++) {
                double direction[3];
                if (r->hit[row_begin(r, e, k) + i] != ROW_HIT_SKY) continue;
                row_direction(r, &at, i, direction);
                *next++ = packed_direction(direction);
            }
        }
    }
}

static bool open(kept_rows *k, const mesh *parts, const uint32_t *roots) {
    const final_gather *with = k->with;
    allocator *memory = parts->memory;
    size_t samples = parts->sample_count, count = parts->element_count;
    k->rays = (row_rays){ .scene = with->scene,
                          .mesh = parts,
                          .lights = with->lights,
                          .rays = with->rays,
                          .seed = kept_rows_seed(with),
                          .row_sum = block_zeroed(memory, samples + 1, sizeof(double)),
                          .sky = block_zeroed(memory, 6 * samples + 1, sizeof(double)) };
    k->roots = block_new(memory, (count + 1) * sizeof *k->roots);
    k->sky_begin = block_new(memory, (count + 1) * sizeof *k->sky_begin);
    row_counts *counts = block_zeroed(memory, count + 1, sizeof *counts);
    if (!counts || !k->roots || !k->sky_begin) return block_free(counts), false;
    for (size_t e = 0; e < count; e++) {
        k->roots[e] = roots ? roots[e] : (uint32_t)e;
        if (with->counts) counts[e] = with->counts[k->roots[e]];
    }
    return row_rays_open(&k->rays, counts) && k->rays.row_sum && k->rays.sky &&
           row_panes_create(with->scene, parts, parts, &k->rays.panes);
}

kept_rows *kept_rows_open(final_gather *with, const mesh *parts, const uint32_t *roots) {
    kept_rows *k = block_zeroed(parts->memory, 1, sizeof *k);
    if (!k) return final_gather_free(with), NULL;
    k->with = with;
    if (open(k, parts, roots)) return k;
    kept_rows_free(k);
    return NULL;
}

/* Parts are guided as their elements were. */
static bool open_guiding(casting *c) {
    const kept_rows *k = c->kept;
    size_t count = k->rays.mesh->element_count;
    c->guiding = k->with->guiding;
    c->guiding.of_element = block_new(k->rays.mesh->memory, (count + 1) * sizeof *c->guiding.of_element);
    for (size_t e = 0; c->guiding.of_element && c->guiding.groups && e < count; e++)
        c->guiding.of_element[e] = k->with->guiding.of_element[k->roots[e]];
    return c->guiding.of_element;
}

static bool keep_directions(casting *c) {
    kept_rows *k = c->kept;
    size_t total = 0;
    for (size_t e = 0; e < k->rays.mesh->element_count; e++) k->sky_begin[e] = total, total += count_sky(k, e);
    k->sky_direction = block_new(k->rays.mesh->memory, (total + 1) * sizeof *k->sky_direction);
    if (k->sky_direction)
        jobs_run(k->with->jobs, kept_rows_job_count(k->rays.mesh->element_count), direction_job, NULL, c);
    return k->sky_direction;
}

kept_rows *kept_rows_cast(final_gather *with, const mesh *parts, const uint32_t *roots, bool (*wait)(void *user),
                          void *user) {
    casting c = { .kept = kept_rows_open(with, parts, roots), .wait = wait, .user = user };
    if (!c.kept) return NULL;
    bool ok = open_guiding(&c) &&
              jobs_run(with->jobs, kept_rows_job_count(c.kept->rays.mesh->element_count), cast_job, wait_for, &c) &&
              keep_directions(&c) && !c.kept->rays.panes.failed;
    block_free(c.guiding.of_element);
    if (ok) return c.kept;
    kept_rows_free(c.kept);
    return NULL;
}

void kept_rows_free(kept_rows *k) {
    if (!k) return;
    row_rays_free(&k->rays);
    row_panes_free(&k->rays.panes);
    final_gather_free(k->with);
    block_free_all(k->rays.row_sum, k->rays.sky, k->roots, k->sky_direction, k->sky_begin, k);
}
