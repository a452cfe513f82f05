/* SPDX-License-Identifier: MIT
 * See row_aims.h.
 */
#include "solver/row_aims.h"

#include "base/morton.h"
#include "geometry/vec3.h"
#include "solver/row_rays.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* Elements of a group, and groups that are taken together for a wider look. Measured on a room with a window of a
 * thousandth of the hemisphere: 4,000 samples of 16 rays find it some dozens of times. */
enum { GROUP = 256, GROUPS_AROUND = 8 };

/* What is brighter than the mean by this factor is worth aiming at. */
static const double BRIGHT = 1.5;

/* A ball reaches further than the third nearest of the others, so that balls cover what they were picked from: what
 * they miss is left to rays by the cosine, which weigh much. At least and at most so much of the distance that it is
 * seen from. */
enum { NEAREST = 3 };
static const double WIDER = 1.5, RADIUS_MIN = 0.01, RADIUS_MAX = 0.3;

/* An opening is as far as what is seen beside it at less than this angle (sine); beyond, it is the open sky. */
static const double BESIDE_OPENING = 0.26;

/* So many of the surfaces that a group sees are looked at for that. */
enum { SEEN_MAX = 2048 };

typedef struct aiming {
    const row_rays *rays;
    const double *luminance;
    const row_aims *from;
    row_aims *out;
    row_target *around; /* around[ROW_AIMS_AROUND*i+k], of larger groups ... */
    uint32_t *around_count;
} aiming;

/* ---- groups ---- */

static void center_of(const mesh *m, size_t element_index, double out[3]) {
    const element *e = &m->elements[element_index];
    int corners = element_corner_count(e);
    out[0] = out[1] = out[2] = 0.0;
    for (int k = 0; k < corners; k++) vec3_add_scaled(out, out, 1.0 / corners, m->vertices + 3 * (size_t)e->corner[k]);
}

/* Which of the six sides of a box an element faces; the last are those that reflect nothing, whose light nobody asks
 * for. Neighbours that face elsewhere see other things: the outside of a wall sees all of the sky. */
static uint64_t side_of(const row_rays *r, const element *e) {
    const double *n = r->scene->surfaces[r->mesh->patches[e->patch].surface].normal;
    const double *rho = e->material->rho;
    if (!(rho[0] + rho[1] + rho[2] > 0.0)) return 6;
    int k = fabs(n[0]) > fabs(n[1]) ? 0 : 1;
    if (fabs(n[2]) > fabs(n[k])) k = 2;
    return (uint64_t)(2 * k + (n[k] < 0.0));
}

/* Elements side by side along a curve that fills space: each run of them is a group. */
static bool order_elements(const row_rays *r, row_aims *out) {
    const mesh *m = r->mesh;
    size_t count = m->element_count;
    morton_place *places = block_new(m->memory, (count + 1) * sizeof *places);
    for (size_t e = 0; places && e < count; e++) {
        double center[3];
        center_of(m, e, center);
        places[e] = (morton_place){ morton_code(center, r->scene->center, r->scene->radius), (uint32_t)e };
        places[e].code |= side_of(r, &m->elements[e]) << MORTON_BITS;
    }
    if (places) morton_sort(places, count);
    for (size_t i = 0; places && i < count; i++) {
        out->order[i] = places[i].index;
        out->of_element[places[i].index] = (uint32_t)(i / GROUP);
    }
    block_free(places);
    return places;
}

/* ---- what rays met ---- */

/* A sample, whose aims are needed only where the sky is uneven: where else a ray's direction is asked for, they are
 * found then. */
static row_place place_of(const aiming *a, uint32_t e, int corner, row_aim *aim) {
    if (row_sky_is_even(a->rays)) return (row_place){ .element = e, .corner = corner };
    return row_place_aimed(a->rays, a->from, e, corner, aim);
}

static double luminance_of(const aiming *a, const row_place *at, size_t i) {
    const row_rays *r = a->rays;
    uint32_t met = r->met[row_begin(r, at->element, at->corner) + i];
    double L[3];
    if (met <= ROW_MET_ELEMENT) return a->luminance[met];
    if (met == ROW_MET_PANES)
        return row_panes_luminance(&r->panes, r->mesh->elements[at->element].first_sample + (size_t)at->corner,
                                   (uint32_t)i, a->luminance);
    if (met == ROW_MET_BACK || !r->lights->has_sky) return 0.0;
    row_sky(r, at, i, L);
    return PI * (L[0] + L[1] + L[2]);
}

static double weight_of(const aiming *a, const row_place *at, size_t i) {
    return (double)a->rays->weight[row_begin(a->rays, at->element, at->corner) + i];
}

/* Mean and variance of what a sample's rays met, added. */
static void add_level(const aiming *a, const row_place *at, double *mean, double *variance) {
    double sum = 0.0, squares = 0.0, count = (double)row_count(a->rays, at->element);
    for (size_t j = 0; j < row_count(a->rays, at->element); j++) {
        double L = luminance_of(a, at, j), w = weight_of(a, at, j);
        sum += w * L, squares += w * L * L;
    }
    *mean += sum;
    *variance += fmax(squares - sum * sum, 0.0) * count / (count - 1.0);
}

static void level_job(void *user, size_t index, unsigned worker) {
    const aiming *a = user;
    row_group *g = &a->out->groups[index];
    double samples = 0.0;
    (void)worker;
    for (size_t i = GROUP * index; i < GROUP * (index + 1) && i < a->out->element_count; i++) {
        uint32_t e = a->out->order[i];
        int corners = element_corner_count(&a->rays->mesh->elements[e]);
        double variance = 0.0;
        for (int k = 0; k < corners; k++) {
            row_aim aim;
            const row_place at = place_of(a, e, k, &aim);
            add_level(a, &at, &g->mean, &variance);
        }
        a->out->variance[e] = (float)(variance / corners);
        g->variance += variance;
        samples += corners;
    }
    g->mean /= samples, g->variance /= samples;
}

/* ---- picking ---- */

/* Rays of the elements order[first .. end) whose light is above a level, each by what it is above it. */
typedef struct picking {
    const aiming *a;
    size_t first, end;
    double level, total, step, next; /* step 0: only the total is found */
    row_target *targets;
    uint32_t count, most;
    double (*seen)[3]; /* centres of what the rays met */
    size_t seen_count;
} picking;

/* Where a ray that met the sky passed what else is seen most nearly; false: that is not near. */
static bool opening_of(const picking *p, const double from[3], const double direction[3], double *distance) {
    double best = BESIDE_OPENING * BESIDE_OPENING;
    *distance = 0.0;
    for (size_t i = 0; i < p->seen_count; i++) {
        double to[3];
        vec3_sub(to, p->seen[i], from);
        double square = vec3_dot(to, to), along = vec3_dot(to, direction);
        double sine = 1.0 - along * along / square;
        if (along <= 0.0 || sine >= best) continue;
        best = sine, *distance = sqrt(square);
    }
    return *distance > 0.0;
}

static row_target target_of(const picking *p, const row_place *at, size_t i) {
    const row_rays *r = p->a->rays;
    double direction[3], distance = 0.0;
    uint32_t met;
    row_target out = { .radius = 0.0 };
    row_aim aim;
    const row_place placed = row_place_aimed(r, p->a->from, at->element, at->corner, &aim), *at_all = &placed;
    row_direction(r, at_all, i, direction);
    bool is_sky = r->met[row_begin(r, at->element, at->corner) + i] == ROW_MET_SKY;
    bool is_near = is_sky ? opening_of(p, at_all->from, direction, &distance)
                          : rays_measure(r->rays, at_all->from, direction, &met, &distance) == RAY_FRONT;
    vec3_copy(out.at, direction);
    if (is_near)
        vec3_add_scaled(out.at, at_all->from, distance, direction);
    else
        out.radius = -1.0;
    return out;
}

static void look_at_row(picking *p, const row_place *at) {
    size_t count = row_count(p->a->rays, at->element);
    for (size_t i = 0; i < count; i++) {
        double above = luminance_of(p->a, at, i) - p->level;
        if (above <= 0.0) continue;
        p->total += above * weight_of(p->a, at, i);
        if (p->step <= 0.0 || p->total < p->next || p->count == p->most) continue;
        p->targets[p->count++] = target_of(p, at, i);
        p->next += p->step * floor(1.0 + (p->total - p->next) / p->step);
    }
}

static void look_at_all(picking *p) {
    p->total = 0.0;
    for (size_t i = p->first; i < p->end; i++) {
        uint32_t e = p->a->out->order[i];
        for (int k = 0; k < element_corner_count(&p->a->rays->mesh->elements[e]); k++) {
            row_aim aim;
            const row_place at = place_of(p->a, e, k, &aim);
            look_at_row(p, &at);
        }
    }
}

static void collect_seen(picking *p) {
    const row_rays *r = p->a->rays;
    size_t all = 0, step;
    for (size_t i = p->first; i < p->end; i++) all += row_count(r, p->a->out->order[i]);
    step = 1 + all / SEEN_MAX;
    for (size_t i = p->first, k = 0; i < p->end; i++) {
        size_t e = p->a->out->order[i];
        for (size_t j = 0; j < row_count(r, e); j++, k++)
            if (k % step == 0 && r->met[r->begin[e] + j] <= ROW_MET_ELEMENT && p->seen_count < SEEN_MAX)
                center_of(r->mesh, r->met[r->begin[e] + j], p->seen[p->seen_count++]);
    }
}

static uint32_t pick(const aiming *a, size_t first_group, size_t group_count, double mean, row_target *targets,
                     uint32_t most) {
    picking p = { .a = a, .first = GROUP * first_group, .level = BRIGHT * mean, .targets = targets, .most = most };
    p.end = GROUP * (first_group + group_count);
    if (p.end > a->out->element_count) p.end = a->out->element_count;
    look_at_all(&p);
    if (!(p.total > 0.0)) return 0;
    p.step = p.total / most, p.next = 0.5 * p.step;
    p.seen = block_new(a->rays->mesh->memory, SEEN_MAX * sizeof *p.seen);
    if (p.seen) collect_seen(&p);
    look_at_all(&p);
    block_free(p.seen);
    return p.count;
}

static void around_job(void *user, size_t index, unsigned worker) {
    aiming *a = user;
    double mean = 0.0;
    size_t first = GROUPS_AROUND * index, count = 0;
    (void)worker;
    for (; count < GROUPS_AROUND && first + count < a->out->group_count; count++)
        mean += a->out->groups[first + count].mean;
    a->around_count[index] =
        pick(a, first, count, mean / (double)count, a->around + ROW_AIMS_AROUND * index, ROW_AIMS_AROUND);
}

static void set_radius(row_group *g, uint32_t i) {
    double nearest[NEAREST];
    for (int k = 0; k < NEAREST; k++) nearest[k] = INFINITY;
    for (uint32_t j = 0; j < g->target_count; j++) {
        if (j == i || (g->targets[j].radius < 0.0) != (g->targets[i].radius < 0.0)) continue;
        double distance = vec3_distance(g->targets[i].at, g->targets[j].at);
        for (int k = 0; k < NEAREST; k++)
            if (distance < nearest[k]) {
                double moved = nearest[k];
                nearest[k] = distance, distance = moved;
            }
    }
    double radius = fmax(WIDER * nearest[NEAREST - 1], 1e-30);
    g->targets[i].radius = g->targets[i].radius < 0.0 ? -radius : radius;
}

static void group_job(void *user, size_t index, unsigned worker) {
    aiming *a = user;
    row_group *g = &a->out->groups[index];
    (void)worker;
    g->target_count = pick(a, index, 1, g->mean, g->targets, ROW_AIMS_OWN);
    uint32_t around = a->around_count[index / GROUPS_AROUND];
    memcpy(g->targets + g->target_count, a->around + ROW_AIMS_AROUND * (index / GROUPS_AROUND),
           around * sizeof *g->targets);
    g->target_count += around;
    for (uint32_t i = 0; i < g->target_count; i++) set_radius(g, i);
}

bool row_aims_create(const row_rays *r, const row_aims *from, jobs *j, const double *luminance, row_aims *out) {
    size_t count = r->mesh->element_count, groups = (count + GROUP - 1) / GROUP;
    size_t larger = (groups + GROUPS_AROUND - 1) / GROUPS_AROUND;
    allocator *memory = r->mesh->memory;
    *out = (row_aims){ .of_element = block_new(memory, (count + 1) * sizeof *out->of_element),
                       .order = block_new(memory, (count + 1) * sizeof *out->order),
                       .element_count = count,
                       .group_count = groups,
                       .groups = block_zeroed(memory, groups + 1, sizeof *out->groups),
                       .variance = block_new(memory, (count + 1) * sizeof *out->variance) };
    aiming a = { r,
                 luminance,
                 from,
                 out,
                 block_new(memory, (ROW_AIMS_AROUND * larger + 1) * sizeof *a.around),
                 block_zeroed(memory, larger + 1, sizeof *a.around_count) };
    bool ok = out->of_element && out->order && out->groups && out->variance && a.around && a.around_count &&
              order_elements(r, out);
    if (ok) {
        jobs_run(j, groups, level_job, NULL, &a);
        jobs_run(j, larger, around_job, NULL, &a);
        jobs_run(j, groups, group_job, NULL, &a);
    }
    block_free_all(a.around, a.around_count);
    return ok;
}

void row_aims_free(row_aims *a) {
    block_free_all(a->of_element, a->order, a->groups, a->variance);
    memset(a, 0, sizeof *a);
}

/* ---- aiming ---- */

void row_aims_at(const row_aims *a, uint32_t element_index, const double from[3], const double normal[3],
                 row_aim *out) {
    const row_group *g = row_aims_group(a, element_index);
    out->count = 0;
    for (uint32_t i = 0; i < g->target_count; i++) {
        double to[3], radius = g->targets[i].radius;
        if (radius < 0.0)
            vec3_copy(to, g->targets[i].at);
        else
            vec3_sub(to, g->targets[i].at, from);
        double distance = vec3_normalize(to);
        double sine = fmin(fmax(fabs(radius) / fmax(distance, 1e-30), RADIUS_MIN), RADIUS_MAX);
        if (!(distance > 0.0) || vec3_dot(to, normal) <= -sine) continue;
        double cosine = sqrt(1.0 - sine * sine);
        out->x[out->count] = (float)to[0], out->y[out->count] = (float)to[1], out->z[out->count] = (float)to[2];
        out->cosine[out->count] = (float)cosine;
        out->density[out->count++] = (float)((1.0 + cosine) / (2 * PI * sine * sine));
    }
    for (int i = 0; i < out->count; i++) out->density[i] /= (float)out->count;
}

void row_aim_direction(const row_aim *a, double which, const double point[2], double out[3]) {
    int i = (int)(which * a->count);
    const double axis[3] = { a->x[i], a->y[i], a->z[i] };
    double u[3], v[3], height = 1.0 - point[0] * (1.0 - (double)a->cosine[i]), angle = 2 * PI * point[1];
    double radius = sqrt(fmax(1.0 - height * height, 0.0));
    vec3_tangents(axis, u, v);
    for (int k = 0; k < 3; k++) out[k] = radius * (cos(angle) * u[k] + sin(angle) * v[k]) + height * axis[k];
}

double row_aim_density(const row_aim *a, const double direction[3]) {
    const float x = (float)direction[0], y = (float)direction[1], z = (float)direction[2];
    float sum = 0.0f;
    for (int i = 0; i < a->count; i++)
        sum += a->x[i] * x + a->y[i] * y + a->z[i] * z >= a->cosine[i] ? a->density[i] : 0.0f;
    return (double)sum;
}
