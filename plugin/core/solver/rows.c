/* SPDX-License-Identifier: MIT
 * See rows.h.
 */
#include "solver/rows.h"

#include "base/arena.h"
#include "base/splitmix.h"
#include "base/tolerance.h"
#include "geometry/vec3.h"
#include "visibility/rays.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* Iterations end when what those to come would change is less than this share of the light. */
static const double SETTLED = 1e-4;
enum { ITERATIONS_MAX = 400 };

/* From one iteration to the next the share of the change that is left is steady where it moves by less than this share
 * of what is missing of 1, which bounds what extrapolation is off by; and it counts as no more than SHARE_MAX. */
static const double STEADY = 0.1, SHARE_MAX = 0.9995;

/* So many elements are one job. */
enum { ELEMENTS_A_JOB = 64 };

/* What a ray met that is no element. */
#define MET_BACK (UINT32_MAX - 1)
#define MET_SKY  UINT32_MAX

typedef struct rows {
    const rows_setup *setup;
    rows_result *out;
    rays *rays;
    size_t ray_count; /* of a sample */
    uint32_t *met;    /* met[ray_count*s+i] */
    double *sky;      /* sky[3*s+c]: irradiance of sample s from the sky */
    double *B, *next; /* B[3*e+c]: what element e reflects */
    double *kept;     /* the same before the last extrapolation */
    double *noise;    /* noise[e]: squared half differences, integrated over the element */
    double *level;    /* level[e]: squared irradiance that is reflected, likewise */
} rows;

static size_t job_count(const rows *r) {
    return (r->setup->mesh->element_count + ELEMENTS_A_JOB - 1) / ELEMENTS_A_JOB;
}

static size_t job_end(const rows *r, size_t job) {
    size_t end = (job + 1) * ELEMENTS_A_JOB;
    return end < r->setup->mesh->element_count ? end : r->setup->mesh->element_count;
}

/* ---- casting ---- */

/* Direction i of a sample: by the cosine about the normal, one in each of strata x strata cells of the disc. */
static void direction_of(const rows *r, size_t sample, size_t i, const double axes[3][3], double out[3]) {
    uint64_t key = splitmix(r->setup->seed ^ splitmix(sample)) + 2 * i;
    size_t n = (size_t)r->setup->strata;
    double u = ((double)(i / n) + splitmix_unit(key)) / (double)n;
    double v = ((double)(i % n) + splitmix_unit(key + 1)) / (double)n;
    double radius = sqrt(u), angle = 2 * PI * v, height = sqrt(fmax(1.0 - u, 0.0));
    for (int k = 0; k < 3; k++)
        out[k] = radius * cos(angle) * axes[0][k] + radius * sin(angle) * axes[1][k] + height * axes[2][k];
}

/* Where facets are shaded smooth, some directions would go into the surface itself: they are mirrored by it, so that a
 * sample still has all of its rays. */
static void turn_to_front(double direction[3], const double normal[3]) {
    double height = vec3_dot(direction, normal);
    if (height < 0.0) vec3_add_scaled(direction, direction, -2.0 * height, normal);
}

static void cast_sample(rows *r, size_t s, const surface *f) {
    const mesh *m = r->setup->mesh;
    const double *normal = mesh_sample_normal(m, f, s);
    double axes[3][3], axis[3] = { 0, 0, 0 }, from[3], L[3];
    const double place[3] = { m->x[s], m->y[s], m->z[s] };
    size_t met_fronts = 0, escaped = 0;
    vec3_copy(axes[2], normal);
    axis[fabs(normal[0]) < 0.6 ? 0 : 1] = 1.0;
    vec3_cross(axes[0], axis, normal);
    vec3_normalize(axes[0]);
    vec3_cross(axes[1], normal, axes[0]);
    vec3_add_scaled(from, place, TOLERANCE_EYE_LIFT * r->setup->scene->radius, f->normal);
    for (size_t i = 0; i < r->ray_count; i++) {
        double direction[3];
        uint32_t hit = MET_BACK;
        direction_of(r, s, i, axes, direction);
        turn_to_front(direction, f->normal);
        ray_end end = rays_follow(r->rays, from, direction, &hit);
        r->met[r->ray_count * s + i] = end == RAY_FRONT ? hit : end == RAY_SKY ? MET_SKY : MET_BACK;
        met_fronts += end == RAY_FRONT;
        if (end != RAY_SKY) continue;
        escaped++;
        lights_sky_radiance(r->setup->lights, direction, L);
        for (size_t c = 0; c < 3; c++) r->sky[3 * s + c] += PI * L[c] / (double)r->ray_count;
    }
    r->out->row_sum[s] = (double)(met_fronts + (r->setup->lights->has_sky ? escaped : 0)) / (double)r->ray_count;
}

static void cast_job(void *user, size_t job, unsigned worker) {
    rows *r = user;
    const mesh *m = r->setup->mesh;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < job_end(r, job); e++) {
        const element *one = &m->elements[e];
        const surface *f = &r->setup->scene->surfaces[m->patches[one->patch].surface];
        for (int k = 0; k < element_corner_count(one); k++) cast_sample(r, one->first_sample + (size_t)k, f);
    }
}

/* ---- iterating ---- */

/* Irradiance of a sample from what elements reflect, by every step-th of its rays from first on. */
static void gather_sample(const rows *r, size_t s, size_t first, size_t step, double E[3]) {
    const uint32_t *met = r->met + r->ray_count * s;
    E[0] = E[1] = E[2] = 0.0;
    for (size_t i = first; i < r->ray_count; i += step)
        if (met[i] < MET_BACK) vec3_add_scaled(E, E, 1.0, r->B + 3 * (size_t)met[i]);
    for (int c = 0; c < 3; c++) E[c] *= (double)step / (double)r->ray_count;
}

static void iterate_job(void *user, size_t job, unsigned worker) {
    rows *r = user;
    const mesh *m = r->setup->mesh;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < job_end(r, job); e++) {
        const element *one = &m->elements[e];
        double *B = r->next + 3 * e;
        B[0] = B[1] = B[2] = 0.0;
        for (int k = 0; k < element_corner_count(one); k++) {
            size_t s = one->first_sample + (size_t)k;
            double *E = r->out->irradiance + 3 * s;
            gather_sample(r, s, 0, 1, E);
            for (size_t c = 0; c < 3; c++) {
                E[c] += r->sky[3 * s + c] + r->setup->direct[3 * s + c];
                B[c] += one->material->rho[c] * E[c] * m->sample_area[s] / one->area;
            }
        }
    }
}

static bool report(const rows *r, double fraction) {
    if (r->setup->progress && !r->setup->progress(r->setup->progress_user, fraction)) r->out->cancelled = true;
    return !r->out->cancelled;
}

/* What an iteration changed, and what there is, summed over area. */
static double change_of(const rows *r, double *level) {
    const mesh *m = r->setup->mesh;
    double change = 0.0;
    *level = 0.0;
    for (size_t e = 0; e < m->element_count; e++)
        for (size_t c = 3 * e; c < 3 * e + 3; c++) {
            change += m->elements[e].area * fabs(r->next[c] - r->B[c]);
            *level += m->elements[e].area * r->next[c];
        }
    return change;
}

/* Keeps what there is, and adds what the iterations to come would, if each changes this share of what the last did. */
static void extrapolate(rows *r, double share) {
    double rest = share / (1.0 - share);
    size_t count = 3 * r->setup->mesh->element_count;
    memcpy(r->kept, r->next, count * sizeof *r->kept);
    for (size_t k = 0; k < count; k++) r->next[k] = fmax(r->next[k] + rest * (r->next[k] - r->B[k]), 0.0);
}

/* Iterations alone always settle, since no row reflects all. Changes fall by the same share each time once what dies
 * out faster has died out: the rest of the series is known then and is added at once, without which rooms that reflect
 * nearly everything would take thousands of iterations. Where that does not help, as with several such rooms, it is
 * taken back and not tried again. */
static void settle(rows *r) {
    double last = 0.0, last_share = 0.0, before = 0.0; /* before: the change before the last extrapolation */
    bool may_extrapolate = true;
    for (r->out->iterations = 1; r->out->iterations <= ITERATIONS_MAX && report(r, 0.9); r->out->iterations++) {
        double level;
        jobs_run(r->setup->jobs, job_count(r), iterate_job, NULL, r);
        double change = change_of(r, &level), share = last > 0.0 ? fmin(change / last, SHARE_MAX) : 0.0;
        if (before > 0.0 && !(change < before)) {
            memcpy(r->B, r->kept, 3 * r->setup->mesh->element_count * sizeof *r->B);
            may_extrapolate = false, before = last = last_share = 0.0;
            continue;
        }
        r->out->residual_w = change * (share > 0.0 ? share / (1.0 - share) : 1.0);
        bool is_done = may_extrapolate && last > 0.0 ? r->out->residual_w <= SETTLED * level
                                                     : change <= (may_extrapolate ? SETTLED : 1.0) * SETTLED * level;
        bool extrapolates =
            may_extrapolate && !is_done && last_share > 0.0 && fabs(share - last_share) < STEADY * (1.0 - share);
        if (extrapolates) extrapolate(r, share);
        double *swapped = r->B;
        r->B = r->next, r->next = swapped;
        before = extrapolates ? change : 0.0;
        last = extrapolates ? 0.0 : change;
        last_share = extrapolates ? 0.0 : share;
        if (is_done) break;
    }
}

/* ---- what it says of itself ---- */

static void judge_job(void *user, size_t job, unsigned worker) {
    rows *r = user;
    const mesh *m = r->setup->mesh;
    (void)worker;
    for (size_t e = job * ELEMENTS_A_JOB; e < job_end(r, job); e++) {
        const element *one = &m->elements[e];
        r->noise[e] = r->level[e] = 0.0;
        for (int k = 0; k < element_corner_count(one); k++) {
            size_t s = one->first_sample + (size_t)k;
            double even[3], odd[3];
            gather_sample(r, s, 0, 2, even);
            gather_sample(r, s, 1, 2, odd);
            for (size_t c = 0; c < 3; c++) {
                double rho = one->material->rho[c], half = 0.5 * rho * (even[c] - odd[c]);
                double E = rho * r->out->irradiance[3 * s + c];
                r->noise[e] += m->sample_area[s] * half * half;
                r->level[e] += m->sample_area[s] * E * E;
            }
        }
    }
}

static void sum_up(rows *r) {
    const mesh *m = r->setup->mesh;
    double noise = 0.0, level = 0.0;
    for (size_t e = 0; e < m->element_count; e++) {
        const element *one = &m->elements[e];
        size_t cast = 0, lost = 0;
        noise += r->noise[e], level += r->level[e];
        for (int k = 0; k < element_corner_count(one); k++) {
            size_t s = one->first_sample + (size_t)k;
            for (size_t i = 0; i < r->ray_count; i++) lost += r->met[r->ray_count * s + i] >= MET_BACK;
            cast += r->ray_count;
            for (size_t c = 0; c < 3; c++) {
                r->out->sky_w += m->sample_area[s] * r->sky[3 * s + c];
                r->out->absorbed_w += m->sample_area[s] * (1.0 - one->material->rho[c]) * r->out->irradiance[3 * s + c];
            }
        }
        for (size_t c = 3 * e; c < 3 * e + 3; c++)
            r->out->escaped_w += one->area * r->B[c] * (double)lost / (double)cast;
    }
    r->out->noise = level > 0.0 ? sqrt(noise / level) : 0.0;
}

/* ---- all of it ---- */

static bool allocate(rows *r) {
    const mesh *m = r->setup->mesh;
    allocator *memory = jobs_memory(r->setup->jobs);
    r->ray_count = (size_t)r->setup->strata * (size_t)r->setup->strata;
    r->met = block_new(memory, (r->ray_count * m->sample_count + 1) * sizeof *r->met);
    r->sky = block_zeroed(memory, 3 * m->sample_count + 1, sizeof *r->sky);
    r->B = block_zeroed(memory, 3 * m->element_count + 1, sizeof *r->B);
    r->next = block_zeroed(memory, 3 * m->element_count + 1, sizeof *r->next);
    r->kept = block_zeroed(memory, 3 * m->element_count + 1, sizeof *r->kept);
    r->noise = block_new(memory, (m->element_count + 1) * sizeof *r->noise);
    r->level = block_new(memory, (m->element_count + 1) * sizeof *r->level);
    r->out->irradiance = block_zeroed(memory, 3 * m->sample_count + 1, sizeof *r->out->irradiance);
    r->out->row_sum = block_zeroed(memory, m->sample_count + 1, sizeof *r->out->row_sum);
    return r->met && r->sky && r->B && r->next && r->kept && r->noise && r->level && r->out->irradiance &&
           r->out->row_sum;
}

static bool wait(void *user) {
    return report(user, 0.5);
}

static void solve(rows *r) {
    jobs_run(r->setup->jobs, job_count(r), cast_job, wait, r);
    if (r->out->cancelled) return;
    settle(r);
    jobs_run(r->setup->jobs, job_count(r), judge_job, NULL, r);
    sum_up(r);
}

const char *rows_solve(const rows_setup *setup, rows_result *out, char *message, size_t message_size) {
    rows r = { .setup = setup, .out = out };
    arena memory = { .memory = setup->mesh->memory };
    mesh_items items;
    const char *failure = "out of memory";
    memset(out, 0, sizeof *out);
    if (allocate(&r) && mesh_items_create(setup->scene, setup->mesh, MESH_ELEMENTS, &memory, &items)) {
        r.rays = rays_create(setup->scene, &items, message, message_size);
        failure = r.rays ? NULL : message;
        if (!failure) solve(&r);
    }
    rays_destroy(r.rays);
    arena_free(&memory);
    block_free(r.met);
    block_free(r.sky);
    block_free(r.B);
    block_free(r.next);
    block_free(r.kept);
    block_free(r.noise);
    block_free(r.level);
    return failure;
}

void rows_result_free(rows_result *r) {
    block_free(r->irradiance);
    block_free(r->row_sum);
    memset(r, 0, sizeof *r);
}
