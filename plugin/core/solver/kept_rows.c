/* SPDX-License-Identifier: MIT
 * See kept_rows.h.
 */
#include "solver/kept_rows.h"

#include "base/splitmix.h"
#include "geometry/vec3.h"
#include "solver/row_emitters.h"
#include "solver/row_gather.h"
#include "solver/row_iteration.h"

#include <math.h>
#include <string.h>

enum { ELEMENTS_A_JOB = 64 };

/* Makes the nets of kept rows others than those of the rows that elements were solved with. */
static const uint64_t OF_KEPT = UINT64_C(0x6b657074);

static const char NO_MEMORY[] = "out of memory";

static size_t job_count(const kept_rows *k) {
    return (k->rays.mesh->element_count + ELEMENTS_A_JOB - 1) / ELEMENTS_A_JOB;
}

static size_t job_end(const kept_rows *k, size_t job) {
    size_t end = (job + 1) * ELEMENTS_A_JOB;
    return end < k->rays.mesh->element_count ? end : k->rays.mesh->element_count;
}

/* ---- directions to the sky, as points of the unfolded octahedron, 16 bits each way ---- */

static uint32_t pack_direction(const double d[3]) {
    double sum = fabs(d[0]) + fabs(d[1]) + fabs(d[2]), u = d[0] / sum, v = d[1] / sum;
    if (d[2] < 0.0) {
        double folded = (1.0 - fabs(v)) * (u < 0.0 ? -1.0 : 1.0);
        v = (1.0 - fabs(u)) * (v < 0.0 ? -1.0 : 1.0);
        u = folded;
    }
    return (uint32_t)floor(0.5 + 32767.5 * (u + 1.0)) << 16 | (uint32_t)floor(0.5 + 32767.5 * (v + 1.0));
}

static void unpack_direction(uint32_t packed, double d[3]) {
    double u = (packed >> 16) / 32767.5 - 1.0, v = (packed & 0xffff) / 32767.5 - 1.0;
    d[0] = u, d[1] = v, d[2] = 1.0 - fabs(u) - fabs(v);
    if (d[2] < 0.0) {
        d[0] = (1.0 - fabs(v)) * (u < 0.0 ? -1.0 : 1.0);
        d[1] = (1.0 - fabs(u)) * (v < 0.0 ? -1.0 : 1.0);
    }
    vec3_normalize(d);
}

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
    for (size_t e = job * ELEMENTS_A_JOB; e < job_end(c->kept, job); e++)
        row_rays_cast(&c->kept->rays, (uint32_t)e, 0, c->guiding.groups ? &c->guiding : NULL);
}

static void direction_job(void *user, size_t job, unsigned worker) {
    const casting *c = user;
    const row_rays *r = &c->kept->rays;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < job_end(c->kept, job); e++) {
        uint32_t *next = c->kept->sky_direction + c->kept->sky_begin[e];
        for (int k = 0; k < element_corner_count(&r->mesh->elements[e]); k++) {
            row_lobes lobes;
            const row_sampler at =
                row_sampler_guided(r, c->guiding.groups ? &c->guiding : NULL, (uint32_t)e, k, &lobes);
            for (size_t i = 0; i < row_count(r, e); i++) {
                double direction[3];
                if (r->hit[row_begin(r, e, k) + i] != ROW_HIT_SKY) continue;
                row_direction(r, &at, i, direction);
                *next++ = pack_direction(direction);
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
                          .seed = splitmix(with->seed ^ OF_KEPT),
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
           row_panes_create(with->scene, parts, &k->rays.panes);
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
    if (k->sky_direction) jobs_run(k->with->jobs, job_count(k), direction_job, NULL, c);
    return k->sky_direction;
}

kept_rows *kept_rows_cast(final_gather *with, const mesh *parts, const uint32_t *roots, bool (*wait)(void *user),
                          void *user) {
    casting c = { .kept = kept_rows_open(with, parts, roots), .wait = wait, .user = user };
    if (!c.kept) return NULL;
    bool ok = open_guiding(&c) && jobs_run(with->jobs, job_count(c.kept), cast_job, wait_for, &c) &&
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

/* ---- settling ---- */

typedef struct settling {
    kept_rows *kept;
    const kept_rows_setup *setup;
    rows_result *out;
    double *direct;
    double *of_parts; /* of_parts[3*e+c]: what part e reflects */
    const double *B;
    row_iteration light;
} settling;

/* What the rays of an element bring from the sky, and their sum. */
static void set_sky(settling *g, size_t e) {
    row_rays *r = &g->kept->rays;
    const uint32_t *next = g->kept->sky_direction + g->kept->sky_begin[e];
    for (int k = 0; k < element_corner_count(&r->mesh->elements[e]); k++) {
        size_t s = r->mesh->elements[e].first_sample + (size_t)k, cursor = 0, begin = row_begin(r, e, k);
        r->row_sum[s] = 0.0;
        memset(r->sky + 6 * s, 0, 6 * sizeof *r->sky);
        for (size_t i = 0; i < row_count(r, e); i++) {
            double direction[3] = { 0, 0, 0 }, L[3], T[3] = { 1, 1, 1 }, w = (double)r->weight[begin + i];
            bool is_sky = r->hit[begin + i] == ROW_HIT_SKY;
            if (is_sky) unpack_direction(*next++, direction);
            if (r->hit[begin + i] == ROW_HIT_BACK) continue;
            r->row_sum[s] += w;
            if (!is_sky || !g->setup->lights->has_sky) continue;
            lights_sky_radiance(g->setup->lights, direction, L);
            if (r->panes.of_sample) row_panes_sky(&r->panes, s, (uint32_t)i, &cursor, T);
            for (size_t c = 0; c < 3; c++)
                r->sky[6 * s + 3 * (size_t)row_half(&r->counts[e], i) + c] += PI * w * L[c] * T[c];
        }
    }
}

static void sky_job(void *user, size_t job, unsigned worker) {
    settling *g = user;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < job_end(g->kept, job); e++) set_sky(g, e);
}

static void gather_job(void *user, size_t job, unsigned worker) {
    settling *g = user;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < job_end(g->kept, job); e++)
        row_gather_element(&g->kept->rays, g->B, e, g->direct, g->out->irradiance, g->of_parts + 3 * e);
}

static void reflect_job(void *user, size_t job, unsigned worker) {
    settling *g = user;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < job_end(g->kept, job); e++)
        row_panes_reflect(&g->kept->rays.panes, e, g->out->irradiance, g->of_parts + 3 * e);
}

/* Elements reflect what their parts do. */
static void gather_all(void *user, const double *B, double *next) {
    settling *g = user;
    const kept_rows *k = g->kept;
    const mesh *parts = k->rays.mesh;
    g->B = B;
    jobs_run(k->with->jobs, job_count(k), gather_job, NULL, g);
    if (k->rays.panes.other_side) jobs_run(k->with->jobs, job_count(k), reflect_job, NULL, g);
    memset(next, 0, 3 * g->light.element_count * sizeof *next);
    for (size_t e = 0; e < parts->element_count; e++) {
        double *to = next + 3 * (size_t)k->roots[e];
        vec3_add_scaled(to, to, parts->elements[e].area / k->with->mesh->elements[k->roots[e]].area,
                        g->of_parts + 3 * e);
    }
}

static bool go_on(void *user) {
    const settling *g = user;
    if (g->setup->go_on && !g->setup->go_on(g->setup->user)) g->out->cancelled = true;
    return !g->out->cancelled;
}

/* The mesh of the parts, of which some emit nothing; *patches is to be freed. False when out of memory. */
static bool light_some(const settling *g, patch **patches, mesh *out) {
    *out = *g->kept->rays.mesh;
    *patches = NULL;
    if (!g->setup->is_dark) return true;
    *patches = block_new(out->memory, (out->patch_count + 1) * sizeof **patches);
    if (!*patches) return false;
    memcpy(*patches, out->patches, out->patch_count * sizeof **patches);
    for (size_t p = 0; p < out->patch_count; p++)
        if (g->setup->is_dark[p]) memset((*patches)[p].material.M, 0, sizeof(*patches)[p].material.M);
    out->patches = *patches;
    return true;
}

/* False when out of memory. */
static bool gather_emitters(settling *g) {
    const final_gather *with = g->kept->with;
    patch *patches;
    mesh lit;
    bool ok = light_some(g, &patches, &lit);
    const row_emitters_setup setup = { .scene = with->scene,
                                       .mesh = &lit,
                                       .hit = with->mesh,
                                       .rays = with->rays,
                                       .jobs = with->jobs,
                                       .seed = splitmix(with->seed ^ OF_KEPT),
                                       .ray_count = with->emitter_rays,
                                       .wait = go_on,
                                       .wait_user = g,
                                       .irradiance = g->direct,
                                       .half_difference = g->out->half_difference };
    if (ok && with->emitter_rays > 0 && mesh_emits(&lit)) ok = row_emitters_gather(&setup);
    if (ok) g->out->emitters_w += row_gather_added(&lit, g->direct, g->setup->direct);
    block_free(patches);
    return ok;
}

static bool allocate(settling *g) {
    const mesh *m = g->kept->rays.mesh;
    allocator *memory = m->memory;
    size_t bands = 3 * m->sample_count + 1;
    g->out->irradiance = block_zeroed(memory, bands, sizeof(double));
    g->out->half_difference = block_zeroed(memory, bands, sizeof(double));
    g->out->row_sum = block_zeroed(memory, m->sample_count + 1, sizeof(double));
    g->direct = block_zeroed(memory, bands, sizeof(double));
    g->of_parts = block_zeroed(memory, 3 * m->element_count + 1, sizeof(double));
    g->light = (row_iteration){ .memory = memory,
                                .elements = g->kept->with->mesh->elements,
                                .element_count = g->kept->with->mesh->element_count,
                                .gather = gather_all,
                                .go_on = go_on,
                                .user = g };
    return row_iteration_open(&g->light) && g->out->irradiance && g->out->half_difference && g->out->row_sum &&
           g->direct && g->of_parts;
}

static bool all_go_on(void *user) {
    (void)user;
    return true;
}

/* False when out of memory. */
static bool settle(settling *g) {
    kept_rows *k = g->kept;
    const mesh *m = k->rays.mesh;
    if (g->setup->direct) memcpy(g->direct, g->setup->direct, 3 * m->sample_count * sizeof *g->direct);
    if (!gather_emitters(g)) return false;
    k->rays.lights = g->setup->lights;
    jobs_run(k->with->jobs, job_count(k), sky_job, NULL, g);
    memcpy(g->out->row_sum, k->rays.row_sum, m->sample_count * sizeof(double));
    if (g->setup->bounces != 0)
        row_iteration_bounces(&g->light, g->setup->bounces < 0 ? 0 : g->setup->bounces, all_go_on);
    else
        row_iteration_settle(&g->light, ROW_ITERATION_CONVERGED);
    g->out->iterations = g->light.count, g->out->residual_w = g->light.residual_w;
    return row_gather_books(&k->rays, g->out->irradiance, g->of_parts, k->with->jobs, &g->out->sky_w,
                            &g->out->absorbed_w, &g->out->escaped_w) &&
           row_gather_halves(&k->rays, g->light.B, k->with->jobs, g->out->half_difference) &&
           row_panes_combine_sides(&k->rays.panes, g->out->irradiance);
}

const char *kept_rows_settle(kept_rows *k, const kept_rows_setup *setup, rows_result *out) {
    settling g = { .kept = k, .setup = setup, .out = out };
    *out = (rows_result){ .ray_share = 1.0 };
    bool ok = allocate(&g) && settle(&g);
    row_iteration_free(&g.light);
    block_free_all(g.direct, g.of_parts);
    if (!ok) rows_result_free(out);
    return ok ? NULL : NO_MEMORY;
}
