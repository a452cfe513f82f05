/* SPDX-License-Identifier: MIT */
#include "reconstruct/residual.h"

#include "base/splitmix.h"
#include "base/spread.h"
#include "base/tolerance.h"
#include "formfactor/emitter_visibility.h"
#include "formfactor/hemicube.h"
#include "geometry/area_share.h"
#include "geometry/vec3.h"
#include "mesh/shading_normals.h"
#include "reconstruct/arrived_light.h"
#include "reconstruct/patch_light.h"
#include "reconstruct/strongest_emitters.h"

#include <stdio.h>
#include <string.h>

/* So many points are looked at however late it is: an estimate from fewer would be a guess. */
enum { POINTS_LEAST = 24 };

enum { MESSAGE_SIZE = 128, BANDS = PATCH_LIGHT_BANDS };

/* Up to so many pairs of emitter and surface all surfaces are asked whether they hide an emitter from a point; beyond
 * it those in the hemi-cube, which misses what is smaller than its pixels. */
static const double PAIRS_MAX = 2e5;

/* Of the points, this share is spread by area alone; the others go where what is shown changes most. */
static const double EVEN_SHARE = 0.4;

/* Of the mean reflectance that multiplies what is one-sided: beyond it the estimate says nothing. */
static const double HIGHEST_RHO = 0.99;

typedef struct point_result {
    double r[BANDS], gathered[BANDS], rho;
    double weight; /* m2 that the point stands for, but for a factor */
    double counts; /* 1, or 0 */
} point_result;

typedef struct residual_worker {
    item_buffer *items;
    hemicube cube;
    uint32_t *seen; /* surfaces in the hemi-cube */
    uint32_t *blockers;
    uint32_t *stamp;          /* stamp[surface]: the last point that saw it, counted from 1 */
    uint32_t *looked_at;      /* looked_at[patch]: the last point that asks for it as an emitter, counted from 1 */
    strong_emitter *emitters; /* that a point asks for */
    pane_crossings crossings;
} residual_worker;

typedef struct residual {
    const residual_setup *setup;
    patch_light *patches;
    uint32_t *emitters;    /* patches that emit */
    double *emitter_light; /* emitter_light[3*i+c]: radiance of emitters[i] */
    size_t emitter_count;
    bool asks_all; /* all surfaces may hide an emitter */
    arrived_light arrived;
    double *chance; /* chance[e]: that a point lies on an element up to and with e, but for a factor */
    point_result *points;
    size_t stride; /* from one to the next that is looked at */
    residual_worker *workers;
    kept_pass kept;
    char (*messages)[MESSAGE_SIZE];
} residual;

/* In [0, 1), a function of the seed, the point and which of its numbers this is. */
static double uniform(const residual *r, size_t point, unsigned which) {
    return splitmix_unit(splitmix(r->setup->seed ^ splitmix(point)) + which);
}

/* ---- what is shown ---- */

static const material *patch_material(const residual *r, uint32_t patch_index) {
    return &r->setup->mesh->patches[patch_index].material;
}

/* The mean of the texture that stays on an element, by which what is shown is multiplied. */
static double texture_mean(const residual *r, size_t element_index, int c) {
    if (!r->setup->untextured) return 1.0;
    double untextured = r->setup->untextured[element_index].rho[c];
    return untextured > 0.0 ? r->setup->mesh->elements[element_index].material->rho[c] / untextured : 1.0;
}

/* A random point of an element as it is shown, with the normal and colour interpolated there. Areas in reference
 * coordinates are to each other as those of a planar quad's triangles nearly are; exactly so for parallelograms. */
static void place_point(const residual *r, size_t point, size_t element_index, double position[3], double normal[3],
                        double L[BANDS]) {
    const mesh *m = r->setup->mesh;
    const element *e = &m->elements[element_index];
    uint32_t vertices[3];
    const uint32_t *node = r->setup->node + ELEMENT_PLACES * element_index;
    double u = uniform(r, point, 2), v = uniform(r, point, 3), w[3];
    uint8_t place[3];
    if (element_corner_count(e) == 3 && u + v > 1) u = 1 - u, v = 1 - v;
    element_locate(e, r->setup->diagonal[element_index], u, v, place, w);
    for (int k = 0; k < 3; k++) position[k] = L[k] = 0.0;
    for (int i = 0; i < 3; i++) {
        vertices[i] = element_vertex(e, place[i]);
        vec3_add_scaled(position, position, w[i], m->vertices + 3 * (size_t)vertices[i]);
        for (int c = 0; c < BANDS; c++) L[c] += w[i] * r->setup->colors[3 * (size_t)node[place[i]] + (size_t)c];
    }
    for (int c = 0; c < BANDS; c++) L[c] *= texture_mean(r, element_index, c);
    shading_normals_mix(m, &r->setup->scene->surfaces[m->patches[e->patch].surface], vertices, w, 3, normal);
}

/* ---- what is gathered ---- */

/* Radiance / pi of what a run of pixels of one row shows, weighted: a patch's plane of light, where the rays of the
 * pixels meet the patch's own plane. Along a row a ray is start + s along, so that each product is linear in s. */
static void add_run(const residual *r, const hemicube *h, uint32_t piece, size_t q, size_t count, double E[BANDS]) {
    const patch_light *p = &r->patches[piece];
    const surface *f = &r->setup->scene->surfaces[r->setup->patches->surface[piece]];
    const hemicube_row row = hemicube_row_at(h, q);
    const double *weights = r->setup->weights + q, height = -surface_height(f, h->eye);
    const double speed = vec3_dot(f->normal, row.start), turn = vec3_dot(f->normal, row.along);
    double level[BANDS], climb[BANDS], bend[BANDS], sum[BANDS] = { 0 }, to_eye[3];
    vec3_sub(to_eye, h->eye, p->center);
    for (int c = 0; c < BANDS; c++) {
        level[c] = p->L[c] + vec3_dot(p->slope[c], to_eye);
        climb[c] = vec3_dot(p->slope[c], row.start), bend[c] = vec3_dot(p->slope[c], row.along);
    }
    for (size_t k = 0; k < count; k++) {
        double s = row.s + (double)k * row.step, toward = speed + s * turn, t = toward != 0.0 ? height / toward : 0.0;
        for (int c = 0; c < BANDS; c++) {
            double L = level[c] + t * (climb[c] + s * bend[c]);
            sum[c] += L > 0.0 ? weights[k] * L : 0.0;
        }
    }
    for (int c = 0; c < BANDS; c++) E[c] += sum[c];
}

/* The same of a run that shows nothing; an even sky is alike in all its pixels. */
static void add_sky(const residual *r, const hemicube *h, size_t q, size_t count, double E[BANDS]) {
    const lights *above = r->arrived.sky;
    const hemicube_row row = hemicube_row_at(h, q);
    double weight = 0.0;
    for (size_t k = 0; above && k < count; k++) {
        double direction[3];
        weight += r->setup->weights[q + k];
        if (!above->sky_image.radiance && k + 1 < count) continue;
        vec3_add_scaled(direction, row.start, row.s + (double)k * row.step, row.along);
        arrived_light_add_sky(&r->arrived, direction, weight, E);
        weight = 0.0;
    }
}

/* Few emitters are all asked for, and no pixel of one counts. */
static bool is_asked_for(const residual *r, const residual_worker *w, size_t point, uint32_t piece) {
    if (r->emitter_count <= STRONGEST_EMITTERS_MAX) return material_emits(patch_material(r, piece));
    return w->looked_at[piece] == (uint32_t)point + 1;
}

/* E[c] / pi from all that is not asked for as an emitter. Lists the surfaces seen; returns the share of backs. */
static double gather_pixels(residual *r, residual_worker *w, size_t point, double E[BANDS], size_t *seen_count) {
    const residual_setup *setup = r->setup;
    size_t n = (size_t)setup->resolution, pixel_count = 3 * n * n;
    double back = 0.0;
    for (size_t q = 0, end; q < pixel_count; q = end) {
        uint32_t id = w->cube.ids[q];
        size_t row_end = (q / n + 1) * n;
        for (end = q + 1; end < row_end && w->cube.ids[end] == id;) end++;
        if (id == 0) add_sky(r, &w->cube, q, end - q, E);
        if (id == 0) continue;
        uint32_t surface_index = setup->patches->surface[setup->patches->triangle_piece[id - 1]];
        if (w->stamp[surface_index] != (uint32_t)point + 1) w->seen[(*seen_count)++] = surface_index;
        w->stamp[surface_index] = (uint32_t)point + 1;
        uint32_t piece = mesh_items_facing(setup->patches, setup->scene, id, w->cube.eye);
        if (piece == NO_INDEX)
            for (size_t k = q; k < end; k++) back += setup->weights[k];
        else if (!is_asked_for(r, w, point, piece))
            add_run(r, &w->cube, piece, q, end - q, E);
    }
    return back;
}

static bool gather_emitters(const residual *r, const residual_worker *w, size_t emitters, size_t seen_count,
                            const double point[3], const double normal[3], double E[BANDS]) {
    const mesh *m = r->setup->mesh;
    const emitter_visibility sight = { r->setup->scene, r->asks_all ? NULL : w->seen, seen_count, w->blockers };
    for (size_t i = 0; i < emitters; i++) {
        const strong_emitter *one = &w->emitters[i];
        const polygon emitter = mesh_polygon(m, m->patches[one->patch].corner);
        double factor;
        if (!emitter_visibility_factor(&sight, &emitter, point, normal, &factor)) return false;
        for (int c = 0; c < BANDS; c++) E[c] += one->share * factor * r->patches[one->patch].L[c];
    }
    return true;
}

/* ---- points ---- */

static bool open_worker(residual *r, unsigned worker) {
    const residual_setup *s = r->setup;
    residual_worker *w = &r->workers[worker];
    int n = s->resolution;
    allocator *memory = jobs_memory(s->jobs);
    const item_buffer_desc desc = {
        .geometry = &s->patches->items, .width = n, .height = 3 * n, .backend = s->backend, .memory = memory
    };
    /* One that could not be opened is not tried again. */
    if (w->items || r->messages[worker][0]) return w->items;
    snprintf(r->messages[worker], MESSAGE_SIZE, "out of memory");
    w->cube = (hemicube){ .resolution = n, .ids = block_new(memory, 3 * (size_t)n * (size_t)n * sizeof *w->cube.ids) };
    w->seen = block_new(memory, (s->scene->surface_count + 1) * sizeof *w->seen);
    w->blockers = block_new(memory, (s->scene->surface_count + 1) * sizeof *w->blockers);
    w->stamp = block_zeroed(memory, s->scene->surface_count + 1, sizeof *w->stamp);
    w->looked_at = block_zeroed(memory, s->mesh->patch_count + 1, sizeof *w->looked_at);
    w->emitters = block_new(memory, (r->emitter_count + 1) * sizeof *w->emitters);
    if (w->cube.ids && w->seen && w->blockers && w->stamp && w->looked_at && w->emitters)
        w->items = item_buffer_open(&desc, r->messages[worker], MESSAGE_SIZE);
    if (w->items) r->messages[worker][0] = 0;
    return w->items != NULL;
}

static void close_worker(void *user, size_t item, unsigned worker) {
    residual_worker *w = &((residual *)user)->workers[worker];
    (void)item;
    item_buffer_destroy(w->items);
    block_free_all(w->cube.ids, w->seen, w->blockers, w->stamp, w->looked_at, w->emitters, w->crossings.all);
}

static void measure_point(void *user, size_t turn, unsigned worker) {
    residual *r = user;
    const residual_setup *s = r->setup;
    size_t item = turn * r->stride % s->point_count;
    if (turn >= POINTS_LEAST && watcher_over(&s->watch)) return;
    point_result *out = &r->points[item];
    const kept_part kept = { out, sizeof *out };
    if (kept_take_numbers(&r->kept, item, &kept, 1, 0)) {
        item_pool_count_as_used(s->patches->items.pool, s->backend);
        return;
    }
    double position[3], normal[3], eye[3], lifted[3], L[BANDS], E[BANDS] = { 0 };
    size_t seen_count = 0;
    if (!open_worker(r, worker)) return;
    residual_worker *w = &r->workers[worker];
    size_t count = s->mesh->element_count;
    double share = ((double)item + uniform(r, item, 0)) / (double)s->point_count;
    size_t index = area_share_find(r->chance, count, share * r->chance[count - 1]);
    out->weight = s->mesh->elements[index].area / (r->chance[index] - (index ? r->chance[index - 1] : 0.0));
    const surface *f = &s->scene->surfaces[s->mesh->patches[s->mesh->elements[index].patch].surface];
    const double *rho = s->mesh->elements[index].material->rho;
    place_point(r, item, index, position, normal, L);
    vec3_add_scaled(eye, position, TOLERANCE_EYE_LIFT * s->scene->radius, f->normal);
    shading_normals_lift(s->mesh, f, position, lifted);
    hemicube_place(&w->cube, eye, normal, 2 * PI * uniform(r, item, 4));
    if (!hemicube_draw(&w->cube, w->items, s->scene->center)) {
        snprintf(r->messages[worker], MESSAGE_SIZE, "a hemi-cube could not be drawn");
        return;
    }
    size_t emitters = strongest_emitters_choose(s->scene, s->mesh, r->emitters, r->emitter_light, r->emitter_count,
                                                position, normal, w->emitters);
    for (size_t i = 0; i < emitters; i++) w->looked_at[w->emitters[i].patch] = (uint32_t)item + 1;
    out->counts = gather_pixels(r, w, item, E, &seen_count) <= TOLERANCE_BURIED;
    if (out->counts && (!gather_emitters(r, w, emitters, seen_count, lifted, normal, E) ||
                        !arrived_light_add(&r->arrived, &s->mesh->elements[index], position, normal, &w->crossings, E)))
        snprintf(r->messages[worker], MESSAGE_SIZE, "out of memory");
    for (int c = 0; c < BANDS; c++) {
        out->gathered[c] = rho[c] * E[c];
        out->r[c] = L[c] - out->gathered[c];
        out->rho += rho[c] / BANDS;
    }
    if (!r->messages[worker][0]) kept_give(&r->kept, item, &kept, 1);
}

/* Weighted sums over the points that count. */
typedef struct point_sums {
    double weight, rho, square, level;
    double off[BANDS], all[BANDS];
    size_t points;
} point_sums;

static void sum_points(const residual *r, point_sums *out) {
    memset(out, 0, sizeof *out);
    for (size_t i = 0; i < r->setup->point_count; i++) {
        const point_result *p = &r->points[i];
        if (!p->counts) continue;
        out->points++;
        out->weight += p->weight;
        out->rho += p->weight * p->rho;
        out->square += p->weight * vec3_dot(p->r, p->r);
        out->level += p->weight * vec3_dot(p->gathered, p->gathered);
        for (int c = 0; c < BANDS; c++) {
            out->off[c] += p->weight * p->r[c];
            out->all[c] += p->weight * p->gathered[c];
        }
    }
}

/* Standard error of the sum of squares. Large errors are rare, and a sample is more likely to miss them than to have
 * too many. */
static double uncertainty(const residual *r, const point_sums *sums) {
    double variance = 0.0, mean = sums->square / (double)sums->points;
    for (size_t i = 0; i < r->setup->point_count; i++) {
        const point_result *p = &r->points[i];
        double d = p->weight * vec3_dot(p->r, p->r) - mean;
        if (p->counts) variance += d * d;
    }
    return sqrt(variance);
}

static void summarise(const residual *r, residual_result *out) {
    point_sums s;
    sum_points(r, &s);
    out->points = s.points;
    if (s.points == 0 || s.level <= 0.0) return;
    double one_sided = vec3_dot(s.off, s.off) / s.weight, rho = fmin(s.rho / s.weight, HIGHEST_RHO);
    double spread = fmax(s.square - one_sided, 0.0) + uncertainty(r, &s);
    out->spread = sqrt(spread / s.level);
    out->bias = (s.off[0] + s.off[1] + s.off[2]) / (s.all[0] + s.all[1] + s.all[2]);
    out->error = sqrt((spread + one_sided / ((1 - rho) * (1 - rho))) / s.level);
}

static bool allocate(residual *r) {
    const mesh *m = r->setup->mesh;
    unsigned workers = jobs_worker_count(r->setup->jobs);
    allocator *memory = jobs_memory(r->setup->jobs);
    r->patches = block_new(memory, (m->patch_count + 1) * sizeof *r->patches);
    r->emitters = block_new(memory, (m->patch_count + 1) * sizeof *r->emitters);
    r->emitter_light = block_new(memory, 3 * (m->patch_count + 1) * sizeof *r->emitter_light);
    r->chance = block_new(memory, (m->element_count + 1) * sizeof *r->chance);
    r->points = block_zeroed(memory, r->setup->point_count + 1, sizeof *r->points);
    r->workers = block_zeroed(memory, workers, sizeof *r->workers);
    r->messages = block_zeroed(memory, workers, sizeof *r->messages);
    return r->patches && r->emitters && r->emitter_light && r->chance && r->points && r->workers && r->messages &&
           arrived_light_open(r->setup->scene, m, r->setup->arrived, r->setup->lights, r->setup->sun_directions,
                              &r->arrived);
}

/* How much an element may be off: the span of what was solved for on it, or of what is shown if that is wider. */
static double span_of(const residual *r, size_t index) {
    const element *e = &r->setup->mesh->elements[index];
    double span = 0.0;
    for (size_t c = 0; c < BANDS; c++) {
        double low = INFINITY, high = -INFINITY, mean = texture_mean(r, index, (int)c);
        for (size_t k = 0; k < (size_t)element_corner_count(e); k++) {
            double solved = r->setup->samples[3 * (e->first_sample + k) + c];
            double shown = r->setup->colors[3 * (size_t)r->setup->node[ELEMENT_PLACES * index + k] + c] * mean;
            low = fmin(low, fmin(solved, shown)), high = fmax(high, fmax(solved, shown));
        }
        span += high - low;
    }
    return span;
}

/* A point falls on an element with the chance (EVEN_SHARE / area of all + the rest of it span / span of all) area. */
static void set_probabilities(residual *r) {
    const mesh *m = r->setup->mesh;
    double area = 0.0, spans = 0.0, sum = 0.0;
    for (size_t e = 0; e < m->element_count; e++) {
        bool emits = material_emits(patch_material(r, m->elements[e].patch));
        r->chance[e] = emits ? 0.0 : span_of(r, e);
        if (!emits) area += m->elements[e].area, spans += r->chance[e] * m->elements[e].area;
    }
    for (size_t e = 0; e < m->element_count; e++) {
        bool emits = material_emits(patch_material(r, m->elements[e].patch));
        double uneven = spans > 0.0 ? (1 - EVEN_SHARE) * r->chance[e] / spans : 0.0;
        if (!emits) sum += m->elements[e].area * (EVEN_SHARE / area + uneven);
        r->chance[e] = sum;
    }
}

static void measure_mesh(residual *r) {
    const mesh *m = r->setup->mesh;
    for (uint32_t p = 0; p < m->patch_count; p++) {
        patch_light_fit(r->setup->scene, m, r->setup->samples, r->setup->trust, p, &r->patches[p]);
        if (!material_emits(patch_material(r, p))) continue;
        for (int c = 0; c < BANDS; c++) r->emitter_light[BANDS * r->emitter_count + (size_t)c] = r->patches[p].L[c];
        r->emitters[r->emitter_count++] = p;
    }
    r->asks_all = (double)r->emitter_count * (double)r->setup->scene->surface_count <= PAIRS_MAX;
    set_probabilities(r);
}

static bool wait(void *user) {
    const watcher *w = &((const residual *)user)->setup->watch;
    return !w->wait || w->wait(w->user);
}

const char *residual_measure(const residual_setup *setup, residual_result *out, char *message, size_t message_size) {
    residual r = { .setup = setup, .stride = spread_stride(setup->point_count), .kept = jobs_begin_pass(setup->jobs) };
    const char *failure = NULL;
    memset(out, 0, sizeof *out);
    if (allocate(&r)) {
        measure_mesh(&r);
        if (r.chance[setup->mesh->element_count - 1] > 0.0)
            jobs_run(setup->jobs, setup->point_count, measure_point, wait, &r);
    } else {
        snprintf(message, message_size, "out of memory");
        failure = message;
    }
    for (unsigned w = 0; !failure && w < jobs_worker_count(setup->jobs); w++)
        if (r.messages[w][0]) snprintf(message, message_size, "%s", r.messages[w]), failure = message;
    if (r.workers) jobs_run_on_each_worker(setup->jobs, close_worker, &r);
    if (!failure) summarise(&r, out);
    arrived_light_close(&r.arrived);
    block_free_all(r.patches, r.emitters, r.emitter_light, r.chance, r.points, r.workers, r.messages);
    return failure;
}
