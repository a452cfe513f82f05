/* SPDX-License-Identifier: MIT
 * How do lights settle on rows that were kept? See kept_rows.h.
 */
#include "geometry/vec3.h"
#include "solver/kept_rows.h"
#include "solver/packed_direction.h"
#include "solver/row_emitters.h"
#include "solver/row_gather.h"
#include "solver/row_iteration.h"

#include <string.h>

/* Groups of elements that gather one after another, each by what those before it reflect by then (Gauss-Seidel, where
 * all at once is Jacobi): a living room settles in 6 iterations instead of 9, an office in 9 instead of 13. */
enum { GROUPS = 8 };

/* Where light settles slowly, an iteration of so many groups is as good as two of all elements. */
static const double WORTH_OF_GROUPS = 2.0;

static const char NO_MEMORY[] = "out of memory";

typedef struct settling {
    kept_rows *kept;
    const kept_rows_setup *setup;
    rows_result *out;
    double *direct;
    double *of_parts; /* of_parts[3*e+c]: what part e reflects */
    double *B;        /* what elements reflect, by the latest that is known */
    double *next;
    uint32_t *parts;      /* sorted by the elements that they are of ... */
    uint32_t *first_part; /* ... those of element e from first_part[e] on */
    size_t group_count, group;
    row_iteration light;
} settling;

static size_t part_end(const settling *g, size_t job) {
    return kept_rows_job_end(g->kept->rays.mesh->element_count, job);
}

static size_t part_jobs(const settling *g) {
    return kept_rows_job_count(g->kept->rays.mesh->element_count);
}

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
            if (is_sky) packed_direction_open(*next++, direction);
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
    for (size_t e = job * KEPT_ROWS_A_JOB; e < part_end(g, job); e++) set_sky(g, e);
}

/* What an element reflects: its parts do. */
static void add_parts(settling *g, size_t root) {
    const kept_rows *k = g->kept;
    double *to = g->next + 3 * root;
    to[0] = to[1] = to[2] = 0.0;
    for (uint32_t i = g->first_part[root]; i < g->first_part[root + 1]; i++) {
        uint32_t e = g->parts[i];
        vec3_add_scaled(to, to, k->rays.mesh->elements[e].area / k->with->mesh->elements[root].area,
                        g->of_parts + 3 * (size_t)e);
    }
}

static void gather_parts(settling *g, size_t root) {
    for (uint32_t i = g->first_part[root]; i < g->first_part[root + 1]; i++) {
        uint32_t e = g->parts[i];
        row_gather_element(&g->kept->rays, g->B, e, g->direct, g->out->irradiance, g->of_parts + 3 * (size_t)e);
    }
}

static size_t root_end(const settling *g, size_t block) {
    return kept_rows_job_end(g->light.element_count, block);
}

static size_t block_count(const settling *g) {
    return kept_rows_job_count(g->light.element_count);
}

/* Blocks of elements go round the groups. */
static void gather_job(void *user, size_t job, unsigned worker) {
    settling *g = user;
    size_t block = job * g->group_count + g->group;
    (void)worker;
    for (size_t root = block * KEPT_ROWS_A_JOB; root < root_end(g, block); root++) {
        gather_parts(g, root);
        if (!g->kept->rays.panes.other_side) add_parts(g, root);
    }
}

static void take_group(settling *g) {
    for (size_t block = g->group; block < block_count(g); block += g->group_count) {
        size_t first = 3 * block * KEPT_ROWS_A_JOB, end = 3 * root_end(g, block);
        memcpy(g->B + first, g->next + first, (end - first) * sizeof *g->B);
    }
}

static void reflect_job(void *user, size_t job, unsigned worker) {
    settling *g = user;
    (void)worker;
    for (size_t e = job * KEPT_ROWS_A_JOB; e < part_end(g, job); e++)
        row_panes_reflect(&g->kept->rays.panes, e, g->out->irradiance, g->of_parts + 3 * e);
}

static void add_job(void *user, size_t job, unsigned worker) {
    settling *g = user;
    (void)worker;
    for (size_t root = job * KEPT_ROWS_A_JOB; root < root_end(g, job); root++) add_parts(g, root);
}

/* What leaves by the other side of a sheet came to all samples before. */
static void gather_all(void *user, const double *B, double *next) {
    settling *g = user;
    const kept_rows *k = g->kept;
    memcpy(g->B, B, 3 * g->light.element_count * sizeof *g->B);
    g->next = next;
    for (g->group = 0; g->group < g->group_count; g->group++) {
        jobs_run(k->with->jobs, (block_count(g) - g->group + g->group_count - 1) / g->group_count, gather_job, NULL, g);
        if (g->group_count > 1) take_group(g);
    }
    if (!k->rays.panes.other_side) return;
    jobs_run(k->with->jobs, part_jobs(g), reflect_job, NULL, g);
    jobs_run(k->with->jobs, block_count(g), add_job, NULL, g);
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
                                       .lights = g->setup->lights,
                                       .jobs = with->jobs,
                                       .seed = kept_rows_seed(with),
                                       .ray_count = with->emitter_rays,
                                       .wait = go_on,
                                       .wait_user = g,
                                       .irradiance = g->direct,
                                       .half_difference = g->out->half_difference,
                                       .lights_w = &g->out->lights_w };
    if (ok && with->emitter_rays > 0 && (mesh_emits(&lit) || g->setup->lights->is_crowd))
        ok = row_emitters_gather(&setup);
    if (ok) g->out->emitters_w += row_gather_added(&lit, g->direct, g->setup->direct) - g->out->lights_w;
    block_free(patches);
    return ok;
}

/* Parts by the elements that they are of, in order. */
static void sort_parts(settling *g) {
    const kept_rows *k = g->kept;
    size_t roots = k->with->mesh->element_count, count = k->rays.mesh->element_count;
    for (size_t e = 0; e < count; e++) g->first_part[k->roots[e] + 1]++;
    for (size_t r = 0; r < roots; r++) g->first_part[r + 1] += g->first_part[r];
    for (size_t e = count; e-- > 0;) g->parts[--g->first_part[k->roots[e] + 1]] = (uint32_t)e;
    for (size_t r = 0; r < roots; r++) g->first_part[r] = g->first_part[r + 1];
    g->first_part[roots] = (uint32_t)count;
}

/* So many reflections are counted where all gather at once, and so are sheets' two sides. */
static size_t groups_of(const settling *g) {
    bool is_plain = g->setup->bounces != 0 || g->kept->rays.panes.other_side;
    size_t blocks = block_count(g);
    return is_plain ? 1 : blocks < GROUPS ? blocks + (blocks == 0) : GROUPS;
}

static bool allocate(settling *g) {
    const mesh *m = g->kept->rays.mesh;
    size_t roots = g->kept->with->mesh->element_count;
    allocator *memory = m->memory;
    size_t bands = 3 * m->sample_count + 1;
    g->out->irradiance = block_zeroed(memory, bands, sizeof(double));
    g->out->half_difference = block_zeroed(memory, bands, sizeof(double));
    g->out->row_sum = block_zeroed(memory, m->sample_count + 1, sizeof(double));
    g->direct = block_zeroed(memory, bands, sizeof(double));
    g->of_parts = block_zeroed(memory, 3 * m->element_count + 1, sizeof(double));
    g->B = block_zeroed(memory, 3 * roots + 1, sizeof *g->B);
    g->parts = block_zeroed(memory, m->element_count + 1, sizeof *g->parts);
    g->first_part = block_zeroed(memory, roots + 2, sizeof *g->first_part);
    g->light = (row_iteration){ .memory = memory,
                                .jobs = g->kept->with->jobs,
                                .elements = g->kept->with->mesh->elements,
                                .element_count = roots,
                                .gather = gather_all,
                                .go_on = go_on,
                                .user = g };
    bool ok = row_iteration_open(&g->light) && g->out->irradiance && g->out->half_difference && g->out->row_sum &&
              g->direct && g->of_parts && g->B && g->parts && g->first_part;
    if (!ok) return false;
    sort_parts(g);
    g->group_count = groups_of(g);
    g->light.worth = g->group_count > 1 ? WORTH_OF_GROUPS : 1.0;
    return true;
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
    jobs_run(k->with->jobs, part_jobs(g), sky_job, NULL, g);
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
    block_free_all(g.direct, g.of_parts, g.B, g.parts, g.first_part);
    if (!ok) rows_result_free(out);
    return ok ? NULL : NO_MEMORY;
}
