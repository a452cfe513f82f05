/* SPDX-License-Identifier: MIT */
#include "radiance.h"

#include "base/jobs.h"
#include "base/splitmix.h"
#include "geometry/vec3.h"

#include <math.h>

/* Sobol's points serve the first surfaces of a path; further on little is left that they could make even. */
enum { EVEN_BOUNCES = 3 };

/* Roulette begins there, by the root of what is carried. Error squared times processor seconds on pillar-room, for 128
 * paths: from the first surface on by what is carried 3.4e-3, from the third so 2.6e-3, by its root 2.3e-3; no better
 * later. */
enum { ROULETTE_FROM = 3 };

/* Roulette ends a path of albedo 0.999 after some thousand bounces; this one is for two mirrors of rounding. */
enum { BOUNCES_MAX = 100000 };

/* Points a worker takes at a time. */
enum { CHUNK = 32 };

typedef struct path {
    const radiance_tracer *tracer;
    uint64_t set;
    uint32_t index;
    traced_point at;
    double carried[3]; /* product of reflectances over the chances of survival */
    double *X;
} path;

static void add(path *p, double weight, const double radiance[3]) {
    for (int c = 0; c < 3; c++) p->X[c] += weight * p->carried[c] * radiance[c];
}

static void numbers(const path *p, int bounce, double u[SOBOL_DIMENSIONS]) {
    uint64_t key = splitmix(p->set ^ splitmix(p->tracer->seed + 0x51ed27u * (uint64_t)bounce));
    if (bounce < EVEN_BOUNCES) {
        sobol_get(&p->tracer->points, p->index, key, u);
        return;
    }
    key = splitmix(key ^ p->index);
    for (int d = 0; d < SOBOL_DIMENSIONS; d++) u[d] = splitmix_unit(key + (uint64_t)d);
}

static void cosine_direction(const double n[3], double u, double v, double out[3]) {
    double sign = n[2] < 0 ? -1 : 1, a = -1 / (sign + n[2]), b = n[0] * n[1] * a; /* [Duff et al., JCGT 6(1), 2017] */
    double x[3] = { 1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0] }, y[3] = { b, sign + n[1] * n[1] * a, -n[1] };
    double r = sqrt(u), angle = 2 * PI * v, up = sqrt(fmax(0, 1 - u));
    for (int k = 0; k < 3; k++) out[k] = r * (cos(angle) * x[k] + sin(angle) * y[k]) + up * n[k];
}

static void sample_light(path *p, const double u[2]) {
    traced_light_sample light;
    if (!traced_lights_sample(p->tracer->lights, &p->at, u, &light)) return;
    double cosine = vec3_dot(light.toward, p->at.shading);
    if (!(cosine > 0 && vec3_dot(light.toward, p->at.horizon) > 0)) return;
    double passed[3], arrived[3];
    if (traced_scene_blocked(p->tracer->scene, &p->at, light.toward, light.distance, passed)) return;
    double other = light.sizeless ? 0 : cosine / PI;
    for (int c = 0; c < 3; c++) arrived[c] = passed[c] * light.radiance[c];
    add(p, cosine / PI / (light.density + other), arrived);
}

static double mean_of(const double x[3]) {
    return (x[0] + x[1] + x[2]) / 3;
}

static uint64_t key_of(const path *p, uint64_t what) {
    return splitmix(splitmix(p->set + what) ^ p->index);
}

/* Does the path go on through a pane? As often as the pane lets light through, of what it sends on at all. */
static bool passes(path *p, const double straight[3], const double rho[3], const double diffuse[3], uint64_t key) {
    double through = mean_of(straight), all = through + mean_of(rho) + mean_of(diffuse);
    bool goes = splitmix_unit(key) * all < through;
    for (int c = 0; c < 3; c++) p->carried[c] *= goes ? straight[c] * all / through : all / (all - through);
    return goes;
}

/* Light leaves by either side of what transmits diffusely: the path goes on from one. */
static void choose_side(path *p, const double rho[3], const double diffuse[3], uint64_t key) {
    double through = mean_of(diffuse), all = through + mean_of(rho);
    bool turned = through > 0 && splitmix_unit(key) * all < through;
    double chance = !(all > 0) ? 1 : (turned ? through : all - through) / all;
    for (int c = 0; c < 3; c++) p->carried[c] *= (turned ? diffuse[c] : rho[c]) / chance;
    if (turned) traced_point_turn(&p->at);
}

/* What leaves a surface towards the path that came from there by a direction of that density. */
static void add_emission(path *p, const traced_point *from, const traced_point *met, double own,
                         const double emission[3]) {
    if (vec3_is_zero(emission)) return;
    double other = traced_lights_density_at(p->tracer->lights, from, met);
    add(p, other > 0 ? own / (own + other) : 1, emission);
}

/* False: the path ends there. */
static bool reflect(path *p, int bounce, double u, double v) {
    const traced_scene *s = p->tracer->scene;
    double direction[3], rho[3], emission[3], straight[3], diffuse[3];
    traced_point met, from = p->at;
    cosine_direction(p->at.shading, u, v, direction);
    if (!(vec3_dot(direction, p->at.horizon) > 0)) return false; /* into the facet itself */
    double own = fmax(vec3_dot(direction, p->at.shading), 0) / PI;
    for (uint64_t pane = 0;; pane++) {
        traced_what what = traced_scene_hit(s, &from, direction, &met);
        if (what == TRACED_SKY) {
            traced_scene_sky(s, direction, emission);
            double other = traced_lights_density_of_sky(p->tracer->lights, direction);
            add(p, other > 0 ? own / (own + other) : 1, emission);
            return false;
        }
        traced_scene_shade(s, met.triangle, met.weights, rho, emission);
        traced_scene_transmittance(s, met.triangle, met.weights, straight, diffuse);
        if (what == TRACED_SURFACE) add_emission(p, &p->at, &met, own, emission);
        if (vec3_is_zero(straight) ||
            !passes(p, straight, rho, diffuse, key_of(p, (uint64_t)bounce * 0x9e3779b9u + pane))) {
            if (what != TRACED_SURFACE) return false;
            break;
        }
        from = met;
        traced_point_turn(&from);
    }
    p->at = met;
    choose_side(p, rho, diffuse, key_of(p, (uint64_t)bounce * 0x85ebca6bu + 1));
    return true;
}

static bool survives(path *p, uint64_t key) {
    double chance = fmin(sqrt(fmax(p->carried[0], fmax(p->carried[1], p->carried[2]))), 1);
    if (!(splitmix_unit(key) < chance)) return false;
    for (int c = 0; c < 3; c++) p->carried[c] /= chance;
    return true;
}

void radiance_sample(const radiance_tracer *tracer, const traced_point *at, uint64_t set, uint32_t index, double X[3]) {
    path p = { tracer, splitmix(set ^ splitmix(tracer->seed)), index, *at, { 1, 1, 1 }, X };
    double u[SOBOL_DIMENSIONS];
    X[0] = X[1] = X[2] = 0;
    for (int bounce = 0; bounce < BOUNCES_MAX; bounce++) {
        numbers(&p, bounce, u);
        sample_light(&p, &u[2]);
        if (!reflect(&p, bounce, u[0], u[1])) return;
        if (bounce >= ROULETTE_FROM && !survives(&p, splitmix(p.set + index) + (uint64_t)bounce * 0x2545f491u)) return;
    }
}

/* ---- many points ------------------------------------------------------------------------------------------------- */

typedef struct task {
    const radiance_tracer *tracer;
    const traced_point *at;
    size_t point_count;
    uint32_t first, count;
    double *sums, *squares;
} task;

static void add_chunk(void *user, size_t item, unsigned worker) {
    const task *t = user;
    size_t end = (item + 1) * CHUNK < t->point_count ? (item + 1) * CHUNK : t->point_count;
    (void)worker;
    for (size_t p = item * CHUNK; p < end; p++)
        for (uint32_t i = t->first; i < t->first + t->count; i++) {
            double X[3];
            radiance_sample(t->tracer, &t->at[p], p, i, X);
            for (size_t c = 0; c < 3; c++) {
                t->sums[3 * p + c] += X[c];
                if (t->squares) t->squares[3 * p + c] += X[c] * X[c];
            }
        }
}

bool radiance_add(const radiance_tracer *tracer, const traced_point *at, size_t point_count, uint32_t first,
                  uint32_t count, unsigned threads, double *sums, double *squares) {
    task t = { tracer, at, point_count, first, count, sums, squares };
    jobs *j = jobs_create(threads);
    bool ok = j && jobs_run(j, (point_count + CHUNK - 1) / CHUNK, add_chunk, NULL, &t);
    jobs_destroy(j);
    return ok;
}
