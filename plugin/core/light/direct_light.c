/* SPDX-License-Identifier: MIT */
#include "light/direct_light.h"

#include "base/spread.h"
#include "geometry/vec3.h"
#include "mesh/shading_normals.h"
#include "scene/contact_lines.h"
#include "visibility/panes.h"

#include <stdio.h>
#include <string.h>

enum { BATCH = 32, BATCH_IN_TIME = 16, ADDING_PATCHES = 16, MESSAGE_SIZE = 160 };

/* So many directions of the sky are looked in, however late it is: shadows have a direction by then. And so many lights
 * that have a place are looked from. */
enum { SKY_LEAST = 16, PLACED_LEAST = 16 };

/* Somewhere to look from, and what comes that way. */
typedef struct light_sample {
    const punctual *light; /* NULL: a patch of the sky */
    const sky_patch *part;
    double toward[3]; /* unit, where its light is parallel */
    double share;     /* of the light's directions */
    int face;         /* of the cube around a point, or -1 */
} light_sample;

/* What belongs to a thread. */
typedef struct light_worker {
    item_buffer *items;
    uint32_t *ids;
    shadow_tested tested;
    pane_crossings crossings;
    int resolution;
    char message[MESSAGE_SIZE];
} light_worker;

typedef struct direct_lighting {
    const direct_light_setup *setup;
    direct_light *out;
    light_sample *light_samples;
    size_t light_sample_count, first; /* first: of the batch */
    size_t parallel, lights, all;     /* light samples: of suns, then of what has a place, then of the sky */
    uint64_t *lit;                    /* bit s of lit[k*words ...]: light sample first + k reaches sample s */
    size_t words;
    shadow_blockers blockers;
    light_worker *workers;
    kept_pass kept;
    double *before; /* irradiance before what time may run out in, then row_sum */
    bool failed;
} direct_lighting;

/* ---- light samples ---- */

static void list_light(direct_lighting *a, const punctual *light) {
    int count =
        light->kind != PUNCTUAL_DIRECTIONAL ? SHADOW_VIEW_FACES : punctual_directions(light, a->setup->sun_directions);
    for (int k = 0; k < count; k++) {
        light_sample *b = &a->light_samples[a->light_sample_count++];
        *b = (light_sample){ .light = light, .share = 1.0, .face = k };
        if (light->kind != PUNCTUAL_DIRECTIONAL) continue;
        b->face = -1;
        b->share = 1.0 / count;
        punctual_toward(light, k, count, b->toward);
    }
}

/* Where time may run out those with a place are spread over all of them, too, after the others. */
static void list_lights(direct_lighting *a) {
    const direct_light_setup *setup = a->setup;
    const size_t stride = setup->deadline_s > 0.0 ? spread_stride(setup->light_count) : 1;
    for (int placed = 0; placed < 2; placed++) {
        if (placed) a->parallel = a->light_sample_count;
        for (size_t i = 0; i < setup->light_count && !(placed && setup->only_parallel); i++) {
            const punctual *one = &setup->lights[i * stride % setup->light_count];
            if ((one->kind != PUNCTUAL_DIRECTIONAL) == placed) list_light(a, one);
        }
    }
    a->lights = a->light_sample_count;
}

static bool list_light_samples(direct_lighting *a) {
    const direct_light_setup *setup = a->setup;
    size_t most = setup->sky ? setup->sky->patch_count : 0;
    int widest = setup->sun_directions > SHADOW_VIEW_FACES ? setup->sun_directions : SHADOW_VIEW_FACES;
    a->light_samples = block_zeroed(jobs_memory(setup->jobs), most + setup->light_count * (size_t)widest + 1,
                                    sizeof *a->light_samples);
    if (!a->light_samples) return false;
    list_lights(a);
    size_t stride = setup->deadline_s > 0.0 ? spread_stride(most) : 1;
    for (size_t i = 0; i < most; i++) {
        light_sample *b = &a->light_samples[a->light_sample_count++];
        *b = (light_sample){ .part = &setup->sky->patches[i * stride % most], .share = 1.0, .face = -1 };
        vec3_copy(b->toward, b->part->toward);
    }
    return true;
}

/* What it gives a point of a surface that it reaches, and what is around it as far as a sample of that area stands for;
 * false: nothing. */
static bool light_sample_irradiance(const light_sample *b, const double point[3], double area, const double normal[3],
                                    double E[3]) {
    if (!b->light) return sky_patch_irradiance(b->part, normal, E);
    if (!punctual_irradiance(b->light, b->toward, point, sqrt(area), normal, E)) return false;
    for (int c = 0; c < 3; c++) E[c] *= b->share;
    return true;
}

/* ---- looking ---- */

static void close_worker(light_worker *w) {
    item_buffer_destroy(w->items);
    block_free(w->ids);
    shadow_tested_free(&w->tested);
    w->items = NULL;
    w->ids = NULL;
}

/* Clearing costs as much as the buffer is large, so the sky has smaller ones than the lights before it. */
static bool open_worker(const direct_lighting *a, int resolution, light_worker *w) {
    allocator *memory = jobs_memory(a->setup->jobs);
    const item_buffer_desc desc = { .geometry = a->setup->items,
                                    .width = resolution,
                                    .marks_holes = a->setup->scene->tree != NULL,
                                    .height = SHADOW_VIEW_BUFFERS * resolution,
                                    .memory = memory };
    if (w->items && w->resolution == resolution) return true;
    close_worker(w);
    w->resolution = resolution;
    w->ids = block_new(memory, SHADOW_VIEW_BUFFERS * (size_t)resolution * (size_t)resolution * sizeof *w->ids);
    if (w->ids && shadow_tested_create(memory, a->setup->scene->surface_count, &w->tested))
        w->items = item_buffer_open(&desc, w->message, sizeof w->message);
    return w->items;
}

static void mark_patch(const direct_lighting *a, const light_sample *b, const shadow_view *view, shadow_tested *tested,
                       const patch *p, uint64_t *lit) {
    const direct_light_setup *setup = a->setup;
    const surface *f = &setup->scene->surfaces[p->surface];
    for (uint32_t s = p->first_sample; s < p->first_sample + p->sample_count; s++) {
        double point[3], E[3];
        shading_normals_lift_sample(setup->mesh, f, p->is_smooth, s, point);
        if (!shadow_view_holds(view, point) ||
            !light_sample_irradiance(b, point, setup->mesh->sample_area[s], mesh_sample_normal(setup->mesh, f, s), E))
            continue;
        if (shadow_view_reaches(view, &a->blockers, tested, p->surface, point)) lit[s / 64] |= UINT64_C(1) << (s % 64);
    }
}

static void draw_item(void *user, size_t item, unsigned worker) {
    direct_lighting *a = user;
    const direct_light_setup *setup = a->setup;
    const light_sample *b = &a->light_samples[a->first + item];
    light_worker *w = &a->workers[worker];
    int resolution = b->light ? setup->resolution : setup->resolution_sky;
    uint64_t *lit = a->lit + item * a->words;
    const kept_part kept = { lit, a->words * sizeof *lit };
    if (kept_take(&a->kept, a->first + item, &kept, 1)) {
        item_pool_count_as_used(setup->items->pool, ITEM_BACKEND_DEFAULT);
        return;
    }
    if (!open_worker(a, resolution, w)) {
        a->failed = true;
        return;
    }
    shadow_view view = { .resolution = resolution, .ids = w->ids };
    if (b->face < 0)
        shadow_view_against(&view, setup->scene, b->toward);
    else
        shadow_view_around(&view, b->light->position, b->face);
    bool is_drawn = shadow_view_draw(&view, w->items, setup->scene->center);
    if (!is_drawn) a->failed = true;
    memset(lit, 0, a->words * sizeof *lit);
    for (size_t p = 0; p < setup->mesh->patch_count; p++) {
        const patch *one = &setup->mesh->patches[p];
        const surface *f = &setup->scene->surfaces[one->surface];
        double toward = b->face < 0 ? vec3_dot(f->normal, b->toward) : surface_height(f, b->light->position);
        if (toward > 0.0 || one->is_smooth) mark_patch(a, b, &view, &w->tested, one, lit);
    }
    if (is_drawn) kept_give(&a->kept, a->first + item, &kept, 1);
}

/* GL contexts belong to the threads that made them, so each worker lets go of its own. */
static void close_item(void *user, size_t item, unsigned worker) {
    direct_lighting *a = user;
    (void)item;
    close_worker(&a->workers[worker]);
}

/* ---- adding up ---- */

/* What panes leave of the light of a light sample on its way to a point of a surface. */
static bool pass_panes(const direct_lighting *a, const light_sample *b, uint32_t surface_index, const double point[3],
                       pane_crossings *crossings, double E[3]) {
    const scene *s = a->setup->scene;
    double from[3], T[3];
    if (!s->panes) return true;
    if (b->face < 0)
        vec3_add_scaled(from, point, 3.0 * s->radius, b->toward);
    else
        vec3_copy(from, b->light->position);
    if (!panes_transmit(s->panes, surface_sheet(s, surface_index), point, from, crossings, T)) return false;
    for (int c = 0; c < 3; c++) E[c] *= T[c];
    return true;
}

static void add_sample(direct_lighting *a, size_t count, uint32_t s, uint32_t surface_index,
                       pane_crossings *crossings) {
    const mesh *m = a->setup->mesh;
    const surface *f = &a->setup->scene->surfaces[surface_index];
    const double *normal = mesh_sample_normal(m, f, s);
    const double point[3] = { m->x[s], m->y[s], m->z[s] };
    for (size_t k = 0; k < count; k++) {
        const light_sample *b = &a->light_samples[a->first + k];
        double E[3] = { 0, 0, 0 };
        if (!(a->lit[k * a->words + s / 64] >> (s % 64) & 1) ||
            !light_sample_irradiance(b, point, m->sample_area[s], normal, E))
            continue;
        if (!pass_panes(a, b, surface_index, point, crossings, E)) a->failed = true;
        for (int c = 0; c < 3; c++) a->out->irradiance[3 * (size_t)s + (size_t)c] += E[c];
        double share = b->light ? b->share : 4 * b->part->half * b->part->half * vec3_dot(normal, b->toward) / PI;
        a->out->row_sum[s] += (float)share;
    }
}

static void add_item(void *user, size_t item, unsigned worker) {
    direct_lighting *a = user;
    const mesh *m = a->setup->mesh;
    size_t left = a->light_sample_count - a->first, count = left < BATCH ? left : BATCH;
    for (size_t p = item * ADDING_PATCHES; p < (item + 1) * ADDING_PATCHES && p < m->patch_count; p++)
        for (uint32_t i = 0; i < m->patches[p].element_count; i++) {
            const element *e = &m->elements[m->patches[p].first_element + i];
            for (uint32_t k = 0; k < (uint32_t)element_corner_count(e) && !e->is_foot; k++)
                add_sample(a, count, e->first_sample + k, m->patches[p].surface, &a->workers[worker].crossings);
        }
}

/* Power at fronts so far, W. */
static double arrived(const direct_lighting *a) {
    double sum = 0.0;
    for (size_t s = 0; s < a->setup->mesh->sample_count; s++)
        for (size_t c = 0; c < 3; c++) sum += a->out->irradiance[3 * s + c] * a->setup->mesh->sample_area[s];
    return sum;
}

/* A batch may take long: whoever cancels is heard while it goes on. */
static bool go_on(void *user) {
    direct_lighting *a = user;
    const direct_light_setup *setup = a->setup;
    if (setup->progress && !setup->progress(setup->progress_user, (double)a->first / (double)a->all))
        a->out->cancelled = true;
    return !a->out->cancelled;
}

/* What there is before light samples that time may run out in. False when out of memory. */
static bool keep_before(direct_lighting *a) {
    size_t samples = a->setup->mesh->sample_count;
    if (!(a->setup->deadline_s > 0.0)) return true;
    if (!a->before) a->before = block_new(jobs_memory(a->setup->jobs), (4 * samples + 1) * sizeof *a->before);
    if (!a->before) return false;
    memcpy(a->before, a->out->irradiance, 3 * samples * sizeof *a->before);
    for (size_t s = 0; s < samples; s++) a->before[3 * samples + s] = (double)a->out->row_sum[s];
    return true;
}

static double flux_of(const direct_lighting *a, size_t first, size_t end) {
    double sum = 0.0;
    for (size_t k = first; k < end; k++)
        for (int c = 0; c < 3; c++) {
            const light_sample *b = &a->light_samples[k];
            sum += b->light ? b->light->intensity[c] : b->part->flux[c];
        }
    return sum;
}

/* The light samples from first to end stand for all until last. */
static void extrapolate(direct_lighting *a, size_t first, size_t end, size_t last) {
    size_t samples = a->setup->mesh->sample_count;
    double seen = flux_of(a, first, end), more = seen > 0.0 ? flux_of(a, first, last) / seen : 1.0;
    for (size_t i = 0; i < 3 * samples; i++)
        a->out->irradiance[i] = a->before[i] + more * (a->out->irradiance[i] - a->before[i]);
    for (size_t s = 0; s < samples; s++) {
        double before = a->before[3 * samples + s];
        a->out->row_sum[s] = (float)(before + more * ((double)a->out->row_sum[s] - before));
    }
}

/* One batch of light samples. NULL: done or cancelled. */
static const char *look(direct_lighting *a, size_t end) {
    const direct_light_setup *setup = a->setup;
    a->light_sample_count = end; /* of this batch, for add_item */
    if (!jobs_run(setup->jobs, end - a->first, draw_item, go_on, a)) return NULL;
    if (a->failed) return "out of memory, or no item buffer for the lights";
    jobs_run(setup->jobs, (setup->mesh->patch_count + ADDING_PATCHES - 1) / ADDING_PATCHES, add_item, NULL, a);
    a->first = end;
    return a->failed ? "out of memory" : NULL;
}

/* From first to last, least of which are looked from however late it is. */
static const char *look_while_there_is_time(direct_lighting *a, size_t first, size_t last, size_t least) {
    const direct_light_setup *setup = a->setup;
    const char *failure = keep_before(a) ? NULL : "out of memory";
    const size_t batch = setup->deadline_s > 0.0 ? BATCH_IN_TIME : BATCH;
    a->first = first;
    while (!failure && a->first < last && !a->out->cancelled) {
        failure = look(a, a->first + batch < last ? a->first + batch : last);
        bool is_late = setup->deadline_s > 0.0 && setup->clock() > setup->deadline_s;
        if (failure || a->first >= last || !is_late || a->first < first + least) continue;
        extrapolate(a, first, a->first, last);
        break;
    }
    if (!failure) go_on(a);
    return failure;
}

static const char *run(direct_lighting *a) {
    a->all = a->light_sample_count;
    const char *failure = look_while_there_is_time(a, 0, a->parallel, a->parallel);
    if (!failure && !a->out->cancelled)
        failure = look_while_there_is_time(a, a->parallel, a->lights, PLACED_LEAST * (size_t)SHADOW_VIEW_FACES);
    a->out->punctual_w = arrived(a);
    if (!failure && !a->out->cancelled) failure = look_while_there_is_time(a, a->lights, a->all, SKY_LEAST);
    a->out->sky_w = arrived(a) - a->out->punctual_w;
    return failure;
}

const char *direct_light_compute(const direct_light_setup *setup, direct_light *out, char *message,
                                 size_t message_size) {
    unsigned workers = jobs_worker_count(setup->jobs);
    size_t samples = setup->mesh->sample_count;
    allocator *memory = jobs_memory(setup->jobs);
    direct_lighting a = { .setup = setup, .out = out, .words = samples / 64 + 1, .kept = jobs_begin_pass(setup->jobs) };
    const char *failure = "out of memory";
    *out = (direct_light){ .irradiance = block_zeroed(memory, 3 * samples + 1, sizeof *out->irradiance),
                           .row_sum = block_zeroed(memory, samples + 1, sizeof *out->row_sum) };
    a.lit = block_new(memory, BATCH * a.words * sizeof *a.lit);
    a.workers = block_zeroed(memory, workers, sizeof *a.workers);
    if (out->irradiance && out->row_sum && a.lit && a.workers && list_light_samples(&a) &&
        (a.light_sample_count == 0 || shadow_blockers_create(setup->scene, setup->triangle_surface, &a.blockers)))
        failure = run(&a);
    for (unsigned w = 0; a.workers && w < workers; w++)
        if (failure && *a.workers[w].message) {
            snprintf(message, message_size, "%s", a.workers[w].message);
            failure = message;
        }
    if (a.workers) jobs_run_on_each_worker(setup->jobs, close_item, &a);
    shadow_blockers_free(&a.blockers);
    for (unsigned w = 0; a.workers && w < workers; w++) block_free(a.workers[w].crossings.all);
    block_free_all(a.before, a.workers, a.lit, a.light_samples);
    return failure;
}

void direct_light_free(direct_light *a) {
    block_free_all(a->irradiance, a->row_sum);
    memset(a, 0, sizeof *a);
}
