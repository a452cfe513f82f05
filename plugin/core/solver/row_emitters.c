/* SPDX-License-Identifier: MIT
 * See row_emitters.h.
 */
#include "solver/row_emitters.h"

#include "base/sobol.h"
#include "base/splitmix.h"
#include "base/tolerance.h"
#include "geometry/vec3.h"
#include "mesh/shading_normals.h"
#include "scene/contact_lines.h"
#include "solver/emitter_rays.h"
#include "solver/emitter_tree.h"
#include "solver/row_allocation.h"
#include "solver/row_gather.h"
#include "solver/row_sharing.h"

#include <math.h>
#include <string.h>

/* Up to so many are each sampled: a closed form costs as much as a ray or two. */
enum { FEW = 96, ELEMENTS_A_JOB = 64 };

/* Where each ray is for one of many, so many times as many rays. */
enum { MANY_TIMES = 4 };

/* Rays of a sample where there is no time for more; MANY_TIMES as many of LEAST_OF_MANY. */
enum { LEAST_RAYS = 2, LEAST_OF_MANY = 1 };

/* Where samples are very many, the first rays of each that are for one of many are no more than so many in all, for
 * each that a sample is meant to have; as many further ones make up for it where it matters. */
static const double MANY_OF_ALL = 2e6;

/* Where one of few lamps is seen through a slot, a ray in a hundred gets there, and all that a room has of it is the
 * luck of a few: elements of a job whose noise is over this share of their light ask again with so many times the rays,
 * until it is not, or a sample has as many as would find a hundredth of a lamp to a third. */
static const double NOISY = 0.5;
enum { TIMES_AGAIN = 4, RAYS_MOST = 512 };

/* So many times as many further rays as the first, of all samples, go to where the first leave most noise. */
static const double MORE_RAYS = 1.0;

/* Makes nets of rays others than those of rows, and of each other. */
static const uint64_t OF_FIRST = UINT64_C(0x9e37), OF_FURTHER = UINT64_C(0x66757274), OF_LIGHTS = UINT64_C(0x6c616d70);

typedef struct emitter_gather {
    const row_emitters_setup *setup;
    emitter_rays rays;
    int ray_count;         /* of a sample */
    double more_share;     /* further rays of all samples, in first ones */
    const uint16_t *times; /* times[e]: so many times ray_count further rays; NULL: the first */
    double *asked;         /* asked[job]: rays of each of its samples so far, but for further ones */
    double *given;         /* given[3*s+c]: by all rays so far */
    double *half;          /* half[3*s+c]: half the difference of what either half of them says */
    bool *done;            /* done[job] */
    kept_pass kept;
    row_sharing sharing;
    emitter_tree tree;
    double begin_s; /* of the first rays, by the clock of latest */
} emitter_gather;

/* Lights are asked only where they are a crowd. */
static bool are_few(const emitter_gather *g) {
    return g->tree.count <= FEW && !g->rays.lights;
}

/* ---- all, where they are few ---- */

typedef struct shares {
    double E[2][3]; /* by either half */
} shares;

static void add_to(const tree_emitter *one, double factor, double seen[2][3], shares *out) {
    for (int h = 0; h < 2; h++)
        for (int c = 0; c < 3; c++) out->E[h][c] += factor * seen[h][c] * one->M[c];
}

/* The share of one emitter that count rays see, by either half of them. */
static void sample_emitter(const emitter_gather *g, const tree_emitter *one, const receiver *r, uint32_t at,
                           uint32_t count, double seen[2][3]) {
    const emitter_aim a = emitter_aim_at(&g->rays, one, r);
    double sum[2][3] = { { 0 }, { 0 } }, weights[2] = { 0, 0 };
    for (uint32_t i = 0; i < count; i++) {
        double square[2], weight, T[3];
        sobol_2d(r->first + at + i, splitmix(r->seed + one->patch), square);
        emitter_ray_sees(&g->rays, &a, r, square, &weight, T);
        int h = 2 * i >= count;
        vec3_add_scaled(sum[h], sum[h], weight, T);
        weights[h] += weight;
    }
    for (int c = 0; c < 3; c++) {
        double all = weights[0] + weights[1] > 0.0 ? (sum[0][c] + sum[1][c]) / (weights[0] + weights[1]) : 0.0;
        for (int h = 0; h < 2; h++) seen[h][c] = weights[h] > 0.0 ? sum[h][c] / weights[h] : all;
        /* What both halves say together is what counts: the halves only say how sure it is. */
        double middle = 0.5 * (seen[0][c] + seen[1][c]);
        seen[0][c] += all - middle, seen[1][c] += all - middle;
    }
}

/* Emitters of which less than one ray's worth of light comes share rays, each going to one of them by its light. */
static void sample_faint(const emitter_gather *g, const receiver *r, const double *given, double all, double least,
                         uint32_t count, shares *out) {
    double rest = 0.0, next, passed = 0.0;
    for (size_t j = 0; j < g->tree.count; j++)
        if (given[j] < least) rest += given[j];
    if (!(rest > 0.0)) return;
    uint32_t n = 2 * (uint32_t)ceil(0.5 * count * rest / all), k = 0;
    next = rest / n * sobol_1d(r->first, (uint32_t)r->seed);
    for (size_t j = 0; j < g->tree.count; j++) {
        const tree_emitter *one = &g->tree.emitters[j];
        if (!(given[j] > 0.0) || given[j] >= least) continue;
        passed += given[j];
        if (!(next < passed) || k == n) continue;
        const emitter_aim a = emitter_aim_at(&g->rays, one, r);
        for (; next < passed && k < n; k++, next += rest / n) {
            double square[2], seen[2][3] = { { 0 }, { 0 } }, F[3];
            sobol_2d(r->first + k, splitmix(r->seed + 1), square);
            emitter_ray_factor(&g->rays, &a, r, square, F);
            vec3_add_scaled(seen[k & 1], seen[k & 1], 2.0 / n, F);
            add_to(one, rest / given[j], seen, out);
        }
    }
}

static void sample_each(const emitter_gather *g, const receiver *r, uint32_t count, shares *out) {
    double given[FEW], all = 0.0;
    for (size_t j = 0; j < g->tree.count; j++) {
        const tree_emitter *one = &g->tree.emitters[j];
        given[j] = emitter_factor(&g->rays, one, r) * one->luminance;
        all += given[j];
    }
    if (!(all > 0.0)) return;
    double least = all / count;
    for (size_t j = 0; j < g->tree.count; j++) {
        if (!(given[j] > 0.0) || given[j] < least) continue;
        const tree_emitter *one = &g->tree.emitters[j];
        double seen[2][3];
        sample_emitter(g, one, r, 0, 2 * (uint32_t)ceil(0.5 * count * given[j] / all), seen);
        add_to(one, given[j] / one->luminance, seen, out);
    }
    sample_faint(g, r, given, all, least, count, out);
}

/* ---- some, where they are many ---- */

static void sample_by_importance(const emitter_gather *g, const receiver *r, uint32_t few, shares *out) {
    uint32_t count = MANY_TIMES * few;
    emitter_cut cut;
    emitter_tree_cut(&g->tree, r->from, r->normal, &cut);
    for (uint32_t i = 0; i < count; i++) {
        double square[2], seen[2][3] = { { 0 }, { 0 } }, F[3], probability;
        sobol_2d(r->first + i, splitmix(r->seed + 1), square);
        const tree_emitter *one = emitter_cut_sample(&cut, &square[0], &probability);
        if (one && g->rays.lights) {
            light_ray_irradiance(&g->rays, one, r, F);
            vec3_add_scaled(out->E[2 * i >= count], out->E[2 * i >= count], 2.0 / (probability * count), F);
            continue;
        }
        if (!one || !emitter_may_light(one, r)) continue;
        const emitter_aim a = emitter_aim_at(&g->rays, one, r);
        emitter_ray_factor(&g->rays, &a, r, square, F);
        vec3_add_scaled(seen[2 * i >= count], seen[2 * i >= count], 2.0, F);
        add_to(one, 1.0 / (probability * count), seen, out);
    }
}

/* ---- samples ---- */

static receiver receiver_of(const emitter_gather *g, uint32_t element_index, int corner, int count,
                            pane_crossings *crossings) {
    const mesh *m = g->setup->mesh;
    const element *e = &m->elements[element_index];
    const surface *f = &g->setup->scene->surfaces[m->patches[e->patch].surface];
    size_t s = e->first_sample + (size_t)corner;
    double place[3];
    bool is_lifted = shading_normals_lift_sample(m, f, m->patches[e->patch].is_smooth, s, place);
    receiver r = { .normal = mesh_sample_normal(m, f, s),
                   .front = f->normal,
                   .plane = f->plane,
                   .width = sqrt(m->sample_area[s]),
                   .seed = splitmix(g->setup->seed ^ splitmix(element_index) ^ (g->times ? OF_FURTHER : OF_FIRST) ^
                                    (g->rays.lights ? OF_LIGHTS : 0)),
                   .first = MANY_TIMES * (uint32_t)(corner * count),
                   .sheet = surface_sheet(g->setup->scene, m->patches[e->patch].surface),
                   .crossings = crossings };
    if (is_lifted) r.front = r.normal, r.plane = vec3_dot(r.normal, place);
    vec3_add_scaled(r.from, place, TOLERANCE_EYE_LIFT * g->setup->scene->radius, f->normal);
    return r;
}

/* So many rays of a sample, beside what so many before say; 0: they are the first. */
static void gather_sample(const emitter_gather *g, uint32_t element_index, int corner, int count, double before,
                          pane_crossings *crossings) {
    const receiver r = receiver_of(g, element_index, corner, count, crossings);
    const double share = count / (count + before);
    size_t s = g->setup->mesh->elements[element_index].first_sample + (size_t)corner;
    double *given = g->given + 3 * s, *half = g->half + 3 * s;
    shares found = { { { 0, 0, 0 }, { 0, 0, 0 } } };
    if (are_few(g))
        sample_each(g, &r, (uint32_t)count, &found);
    else
        sample_by_importance(g, &r, (uint32_t)count, &found);
    for (size_t c = 0; c < 3; c++) {
        given[c] = (1.0 - share) * given[c] + share * 0.5 * (found.E[0][c] + found.E[1][c]);
        half[c] = (1.0 - share) * half[c] + share * 0.5 * (found.E[0][c] - found.E[1][c]);
    }
}

static size_t job_count(const mesh *m) {
    return (m->element_count + ELEMENTS_A_JOB - 1) / ELEMENTS_A_JOB;
}

/* While the first rays are cast: must those that are left be the least, so that all of them, and others after them, are
 * cast in time? In jobs of as many rays as are meant. */
static bool must_hurry(const emitter_gather *g) {
    const row_emitters_setup *setup = g->setup;
    const size_t all = job_count(setup->mesh);
    size_t done = 0;
    if (!setup->latest || g->times) return false;
    for (size_t job = 0; job < all; job++) done += g->done[job];
    double count = are_few(g) ? g->ray_count : MANY_TIMES * g->ray_count;
    double least = are_few(g) ? LEAST_RAYS : MANY_TIMES * LEAST_OF_MANY;
    double more = (double)(all - done) * least + (double)all * setup->rays_after;
    if (!deadline_is_near(setup->latest, g->begin_s, (double)done, more / count)) return false;
    return *setup->is_late = true;
}

static bool wait(void *user) {
    const emitter_gather *g = user;
    return (!g->setup->wait || g->setup->wait(g->setup->wait_user)) && !must_hurry(g);
}

enum { KEPT_OF_A_JOB = 2 * ELEMENTS_A_JOB + 1 };

/* What the samples of a job have, for whoever keeps it: how many rays each, kept[1 + i] of element begin + i, and as
 * many differences. */
static size_t list_kept(const emitter_gather *g, size_t begin, size_t end, kept_part kept[KEPT_OF_A_JOB]) {
    size_t count = end - begin;
    kept[0] = (kept_part){ g->asked + begin / ELEMENTS_A_JOB, sizeof *g->asked };
    for (size_t e = begin; e < end; e++) {
        const element *one = &g->setup->mesh->elements[e];
        size_t bands = 3 * (size_t)element_corner_count(one), first = 3 * (size_t)one->first_sample;
        kept[1 + e - begin] = (kept_part){ g->given + first, bands * sizeof(double) };
        kept[1 + count + e - begin] = (kept_part){ g->half + first, bands * sizeof(double) };
    }
    return 2 * count + 1;
}

/* Rays of an element of a job that are to be cast now. */
static int count_of(const emitter_gather *g, size_t e) {
    if (!row_sharing_is_own(&g->sharing, e) || g->setup->mesh->elements[e].is_foot) return 0;
    return g->times ? g->times[e] * g->ray_count : (int)g->asked[e / ELEMENTS_A_JOB];
}

static void gather_elements(const emitter_gather *g, size_t begin, size_t end, pane_crossings *crossings) {
    const double before = g->times ? g->asked[begin / ELEMENTS_A_JOB] : 0.0;
    for (size_t e = begin; e < end; e++) {
        int count = count_of(g, e);
        for (int k = 0; count > 0 && k < element_corner_count(&g->setup->mesh->elements[e]); k++)
            gather_sample(g, (uint32_t)e, k, count, before, crossings);
    }
}

/* Is what the halves differ in more than a share of all direct light that there is? */
static bool are_noisy(const emitter_gather *g, size_t begin, size_t end) {
    const mesh *m = g->setup->mesh;
    double noise = 0.0, level = 0.0;
    for (size_t e = begin; e < end; e++)
        for (size_t k = 0; k < (size_t)element_corner_count(&m->elements[e]); k++) {
            size_t s = m->elements[e].first_sample + k;
            const double *half = g->half + 3 * s;
            double E[3];
            vec3_add_scaled(E, g->setup->irradiance + 3 * s, 1.0, g->given + 3 * s);
            noise += m->sample_area[s] * vec3_dot(half, half);
            level += m->sample_area[s] * vec3_dot(E, E);
        }
    return noise > NOISY * NOISY * level;
}

static void gather_until_sure(const emitter_gather *g, size_t begin, size_t end, pane_crossings *crossings) {
    double *asked = &g->asked[begin / ELEMENTS_A_JOB];
    *asked = g->ray_count;
    gather_elements(g, begin, end, crossings);
    while (are_few(g) && g->ray_count > LEAST_RAYS && *asked < RAYS_MOST && are_noisy(g, begin, end)) {
        *asked = fmin(TIMES_AGAIN * *asked, RAYS_MOST);
        gather_elements(g, begin, end, crossings);
    }
}

/* Has any element of a job rays to cast? */
static bool any_casts(const emitter_gather *g, size_t begin, size_t end) {
    bool any = !g->times;
    for (size_t e = begin; !any && e < end; e++) any = g->times[e] > 0;
    return any;
}

static void gather_job(void *user, size_t job, unsigned worker) {
    const emitter_gather *g = user;
    const mesh *m = g->setup->mesh;
    pane_crossings crossings = { 0 };
    kept_part kept[KEPT_OF_A_JOB] = { { 0 } };
    size_t begin = job * ELEMENTS_A_JOB, left = m->element_count - begin;
    size_t end = begin + (left < ELEMENTS_A_JOB ? left : ELEMENTS_A_JOB), kept_count = list_kept(g, begin, end, kept);
    (void)worker;
    if (g->done[job] || !any_casts(g, begin, end)) return;
    g->done[job] = true;
    if (kept_take_numbers(&g->kept, job, kept, kept_count, 1 + end - begin)) return;
    if (g->times)
        gather_elements(g, begin, end, &crossings);
    else
        gather_until_sure(g, begin, end, &crossings);
    if (!*g->rays.failed) kept_give(&g->kept, job, kept, kept_count);
    block_free(crossings.all);
}

/* False: out of memory, or those who share the samples are lost. */
static bool give(const emitter_gather *g) {
    return row_sharing_give_samples(&g->sharing, g->given, 3 * sizeof(double)) &&
           row_sharing_give_samples(&g->sharing, g->half, 3 * sizeof(double));
}

/* More rays go to where they are needed. False: out of memory, or those who share the samples are lost. */
static bool gather_more(emitter_gather *g) {
    const row_emitters_setup *setup = g->setup;
    const mesh *m = setup->mesh;
    uint16_t *times = block_new(m->memory, (m->element_count + 1) * sizeof *times);
    bool ok = times && row_allocation_repeat(m, g->half, g->more_share, times);
    if (ok) {
        memset(g->done, 0, job_count(m));
        g->times = times, g->kept = jobs_begin_pass(setup->jobs);
        jobs_run(setup->jobs, job_count(m), gather_job, wait, g);
        ok = give(g);
    }
    block_free(times);
    return ok;
}

static void fit_crowd(emitter_gather *g) {
    const double samples = MANY_TIMES * ((double)g->rays.hit->sample_count + 1.0);
    const double meant = fmin(samples, MANY_OF_ALL) * g->setup->ray_count;
    while (!are_few(g) && g->ray_count > LEAST_OF_MANY && samples * g->ray_count > meant) g->ray_count /= 2;
    if (!are_few(g)) g->more_share = MORE_RAYS * fmax(meant / (samples * g->ray_count), 1.0);
}

/* From the lights, or from what emits. */
static bool gather_from(const row_emitters_setup *setup, const lights *from) {
    const mesh *m = setup->mesh;
    atomic_bool failed = false;
    emitter_gather g = { .setup = setup,
                         .rays = { .scene = setup->scene,
                                   .mesh = m,
                                   .hit = setup->hit ? setup->hit : m,
                                   .rays = setup->rays,
                                   .lights = from ? from->punctual : NULL,
                                   .failed = &failed },
                         .ray_count = setup->ray_count,
                         .more_share = MORE_RAYS,
                         .given = block_zeroed(m->memory, 3 * m->sample_count + 1, sizeof *g.given),
                         .half = block_zeroed(m->memory, 3 * m->sample_count + 1, sizeof *g.half),
                         .kept = jobs_begin_pass(setup->jobs),
                         .asked = block_zeroed(m->memory, job_count(m) + 1, sizeof *g.asked),
                         .done = block_zeroed(m->memory, job_count(m) + 1, sizeof *g.done) };
    bool ok = g.given && g.half && g.asked && g.done &&
              row_sharing_open(jobs_ranks(setup->jobs), m, NULL, ELEMENTS_A_JOB, &g.sharing) &&
              (from ? emitter_tree_of_lights(from->punctual, from->punctual_count, setup->scene, &g.tree)
                    : emitter_tree_create(m, setup->scene, &g.tree));
    g.begin_s = setup->latest ? deadline_begin(setup->latest) : 0.0;
    if (ok && g.tree.count > 0) {
        fit_crowd(&g);
        bool all = jobs_run(setup->jobs, job_count(m), gather_job, wait, &g);
        if (!all) {
            g.ray_count = are_few(&g) ? LEAST_RAYS : LEAST_OF_MANY, g.kept.in = NULL;
            jobs_run(setup->jobs, job_count(m), gather_job, NULL, &g);
        }
        if (!failed) ok = give(&g) && (!all || gather_more(&g));
    }
    for (size_t i = 0; ok && i < 3 * m->sample_count; i++) {
        setup->irradiance[i] += g.given[i];
        setup->half_difference[i] += g.half[i];
    }
    if (ok && from && setup->lights_w) *setup->lights_w += row_gather_added(m, g.given, NULL);
    emitter_tree_free(&g.tree);
    row_sharing_free(&g.sharing);
    block_free_all(g.given, g.half, g.asked, g.done);
    return ok && !failed;
}

bool row_emitters_gather(const row_emitters_setup *setup) {
    bool any_lights = setup->lights && setup->lights->is_crowd;
    return (!any_lights || gather_from(setup, setup->lights)) && gather_from(setup, NULL);
}
