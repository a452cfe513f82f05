/* SPDX-License-Identifier: MIT */
#include "light/direct_light.h"

#include "geometry/vec3.h"
#include "light/light_samples.h"
#include "scene/contact_lines.h"
#include "visibility/panes.h"

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

enum { BATCH = 32, BATCH_IN_TIME = 16, ADDING_PATCHES = 16, MESSAGE_SIZE = 160 };

/* So many directions of the sky are looked in, however late it is: shadows have a direction by then. And so many lights
 * that have a place are looked from. */
enum { SKY_LEAST = 16, PLACED_LEAST = 16 };

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
    light_samples samples;
    size_t first, end;          /* of the batch */
    atomic_uint_least64_t *lit; /* bit s of lit[k*words ...]: light sample first + k reaches sample s */
    size_t words;
    shadow_blockers blockers;
    light_worker *workers;
    shadow_view shared; /* where threads look from together ... */
    size_t shared_item; /* ... for this one of the batch; lit is known already: is_kept */
    bool is_kept;
    kept_pass kept;
    seen_light *seen; /* seen[s]: so far of the light that is looked at */
    double *before;   /* irradiance before what time may run out in, then row_sum */
    bool failed;
} direct_lighting;

/* ---- looking ---- */

static void close_worker(light_worker *w) {
    item_buffer_destroy(w->items);
    block_free(w->ids);
    shadow_tested_free(&w->tested);
    w->items = NULL;
    w->ids = NULL;
}

static bool open_tested(const direct_lighting *a, light_worker *w) {
    return w->tested.last ||
           shadow_tested_create(jobs_memory(a->setup->jobs), a->setup->scene->surface_count, &w->tested);
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
    if (w->ids && open_tested(a, w)) w->items = item_buffer_open(&desc, w->message, sizeof w->message);
    return w->items;
}

/* Of the light samples of a view, count from b on, which may light it alike. lit: of the first. */
static void mark_element(const direct_lighting *a, const light_sample *b, size_t count, const shadow_view *view,
                         shadow_tested *tested, const element *e, atomic_uint_least64_t *lit) {
    const mesh *m = a->setup->mesh;
    const uint32_t surface_index = m->patches[e->patch].surface;
    const surface *f = &a->setup->scene->surfaces[surface_index];
    for (int k = 0; k < element_corner_count(e); k++) {
        const size_t s = (size_t)e->first_sample + (size_t)k;
        const double own[3] = { m->x[s], m->y[s], m->z[s] };
        bool is_asked = false;
        for (size_t i = 0; i < count; i++) {
            double point[3], E[3];
            light_sample_place(b + i, m, f, e, k, point);
            if (!shadow_view_holds(view, point)) continue;
            if (!is_asked && !light_sample_irradiance(b, own, m->sample_area[s], mesh_sample_normal(m, f, s), E)) break;
            is_asked = true;
            if (shadow_view_reaches(view, &a->blockers, tested, surface_index, point))
                atomic_fetch_or_explicit(&lit[i * a->words + s / 64], UINT64_C(1) << (s % 64), memory_order_relaxed);
        }
    }
}

/* The end of those of the batch from item on that have its view. */
static size_t end_of_view(const direct_lighting *a, size_t item) {
    return light_samples_end_of_view(&a->samples, a->first + item, a->end) - a->first;
}

/* Patches from first to end; several threads may mark those of the same view. */
static void mark_patches(direct_lighting *a, size_t item, const shadow_view *view, shadow_tested *tested, size_t first,
                         size_t end) {
    const direct_light_setup *setup = a->setup;
    const light_sample *b = &a->samples.all[a->first + item];
    const size_t count = end_of_view(a, item) - item;
    for (size_t p = first; p < end && p < setup->mesh->patch_count; p++) {
        const patch *one = &setup->mesh->patches[p];
        const surface *f = &setup->scene->surfaces[one->surface];
        double toward = b->face < 0 ? vec3_dot(f->normal, b->toward) : surface_height(f, b->light->position);
        for (uint32_t i = 0; i < one->element_count && (toward > 0.0 || one->is_smooth); i++)
            mark_element(a, b, count, view, tested, &setup->mesh->elements[one->first_element + i],
                         a->lit + item * a->words);
    }
}

static kept_part lit_part(const direct_lighting *a, size_t item) {
    return (kept_part){ a->lit + item * a->words, a->words * sizeof *a->lit };
}

/* Whether all of a view are marked already, as an earlier bake has kept them. */
static bool is_kept(direct_lighting *a, size_t item) {
    for (size_t i = item, end = end_of_view(a, item); i < end; i++) {
        const kept_part kept = lit_part(a, i);
        if (!kept_take(&a->kept, a->first + i, &kept, 1)) return false;
    }
    item_pool_count_as_used(a->setup->items->pool, ITEM_BACKEND_DEFAULT);
    return true;
}

static void keep_view(direct_lighting *a, size_t item) {
    for (size_t i = item, end = end_of_view(a, item); i < end; i++) {
        const kept_part kept = lit_part(a, i);
        kept_give(&a->kept, a->first + i, &kept, 1);
    }
}

/* Sets up the view of a light sample, of which nothing is marked then. */
static bool draw_view(direct_lighting *a, size_t item, light_worker *w, shadow_view *out) {
    const direct_light_setup *setup = a->setup;
    const light_sample *b = &a->samples.all[a->first + item];
    int resolution = b->light ? setup->resolution : setup->resolution_sky;
    bool is_open = open_worker(a, resolution, w);
    *out = (shadow_view){ .resolution = resolution, .ids = w->ids };
    if (is_open && b->face < 0)
        shadow_view_against(out, setup->scene, b->toward);
    else if (is_open)
        shadow_view_around(out, b->light->position, b->face);
    memset(a->lit + item * a->words, 0, (end_of_view(a, item) - item) * a->words * sizeof *a->lit);
    bool is_drawn = is_open && shadow_view_draw(out, w->items, setup->scene->center);
    if (!is_drawn) a->failed = true;
    return is_drawn;
}

static void draw_item(void *user, size_t item, unsigned worker) {
    direct_lighting *a = user;
    light_worker *w = &a->workers[worker];
    shadow_view view;
    bool is_of_earlier = item > 0 && a->samples.all[a->first + item].is_repeated;
    if (is_of_earlier || is_kept(a, item) || !draw_view(a, item, w, &view)) return;
    mark_patches(a, item, &view, &w->tested, 0, a->setup->mesh->patch_count);
    keep_view(a, item);
}

/* ---- looking together: a scene's one sun leaves no thread idle ---- */

enum { PATCHES_A_JOB = 1024 };

static void draw_shared(void *user, size_t item, unsigned worker) {
    direct_lighting *a = user;
    (void)item;
    a->is_kept = is_kept(a, a->shared_item) || !draw_view(a, a->shared_item, &a->workers[worker], &a->shared);
}

static void mark_shared(void *user, size_t item, unsigned worker) {
    direct_lighting *a = user;
    light_worker *w = &a->workers[worker];
    if (open_tested(a, w))
        mark_patches(a, a->shared_item, &a->shared, &w->tested, item * PATCHES_A_JOB, (item + 1) * PATCHES_A_JOB);
    else
        a->failed = true;
}

static void keep_shared(void *user, size_t item, unsigned worker) {
    direct_lighting *a = user;
    (void)item, (void)worker;
    keep_view(a, a->shared_item);
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

static bool is_lit(const direct_lighting *a, size_t k, uint32_t s) {
    return atomic_load_explicit(&a->lit[k * a->words + s / 64], memory_order_relaxed) >> (s % 64) & 1;
}

static void add_sample(direct_lighting *a, size_t count, uint32_t s, uint32_t surface_index,
                       pane_crossings *crossings) {
    const mesh *m = a->setup->mesh;
    const surface *f = &a->setup->scene->surfaces[surface_index];
    const double *normal = mesh_sample_normal(m, f, s);
    const double point[3] = { m->x[s], m->y[s], m->z[s] };
    bool lit = false, was_lit = false, is_known = false;
    double E[3] = { 0, 0, 0 }; /* by a light sample, and by those that repeat its view */
    for (size_t k = 0; k < count; k++) {
        const light_sample *b = &a->samples.all[a->first + k];
        was_lit = lit;
        lit = is_lit(a, k, s);
        is_known = is_known && b->is_repeated;
        if (lit && !is_known) {
            is_known = light_sample_irradiance(b, point, m->sample_area[s], normal, E);
            if (is_known && !pass_panes(a, b, surface_index, point, crossings, E)) a->failed = true;
        }
        lit = lit && is_known;
        if (b->direction >= 0) light_sample_see(b, was_lit, lit, E, &a->seen[s], &a->out->uneven[s]);
        if (!lit) continue;
        for (int c = 0; c < 3; c++) a->out->irradiance[3 * (size_t)s + (size_t)c] += E[c];
        double share = b->light ? b->share : 4 * b->part->half * b->part->half * vec3_dot(normal, b->toward) / PI;
        a->out->row_sum[s] += (float)share;
    }
}

static void add_item(void *user, size_t item, unsigned worker) {
    direct_lighting *a = user;
    const mesh *m = a->setup->mesh;
    size_t left = a->end - a->first, count = left < BATCH ? left : BATCH;
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
    if (setup->progress && !setup->progress(setup->progress_user, (double)a->first / (double)a->samples.count))
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

/* The light samples from first to end stand for all until last. */
static void extrapolate(direct_lighting *a, size_t first, size_t end, size_t last) {
    size_t samples = a->setup->mesh->sample_count;
    const double seen = light_samples_flux(&a->samples, first, end), all = light_samples_flux(&a->samples, first, last);
    const double more = seen > 0.0 ? all / seen : 1.0;
    for (size_t i = 0; i < 3 * samples; i++)
        a->out->irradiance[i] = a->before[i] + more * (a->out->irradiance[i] - a->before[i]);
    for (size_t s = 0; s < samples; s++) {
        double before = a->before[3 * samples + s];
        a->out->row_sum[s] = (float)(before + more * ((double)a->out->row_sum[s] - before));
    }
}

/* The same as draw_item of each, where they are few. */
static bool look_together(direct_lighting *a, size_t count) {
    jobs *j = a->setup->jobs;
    const size_t parts = (a->setup->mesh->patch_count + PATCHES_A_JOB - 1) / PATCHES_A_JOB;
    bool goes_on = true;
    for (size_t i = 0; goes_on && i < count; i = end_of_view(a, i)) {
        a->shared_item = i;
        goes_on = jobs_run(j, 1, draw_shared, go_on, a) && (a->is_kept || jobs_run(j, parts, mark_shared, go_on, a));
        if (goes_on && !a->is_kept && !a->failed) jobs_run(j, 1, keep_shared, NULL, a);
    }
    return goes_on;
}

/* One batch of light samples. NULL: done or cancelled. */
static const char *look(direct_lighting *a, size_t end) {
    const direct_light_setup *setup = a->setup;
    a->end = end;
    const size_t count = end - a->first, most = jobs_worker_count(setup->jobs) / 2;
    size_t views = 0;
    for (size_t i = 0; i < count && views <= most; i = end_of_view(a, i)) views++;
    if (!(views <= most ? look_together(a, count) : jobs_run(setup->jobs, count, draw_item, go_on, a))) return NULL;
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
        bool is_late = light_samples_are_late(setup);
        if (failure || a->first >= last || !is_late || a->first < first + least) continue;
        extrapolate(a, first, a->first, last);
        break;
    }
    if (!failure) go_on(a);
    return failure;
}

static const char *run(direct_lighting *a) {
    const light_samples *l = &a->samples;
    const char *failure = look_while_there_is_time(a, 0, l->parallel, l->parallel);
    if (!failure && !a->out->cancelled)
        failure = look_while_there_is_time(a, l->parallel, l->lights, PLACED_LEAST * l->each_placed);
    a->out->punctual_w = arrived(a);
    if (!failure && !a->out->cancelled) failure = look_while_there_is_time(a, l->lights, l->count, SKY_LEAST);
    a->out->sky_w = arrived(a) - a->out->punctual_w;
    return failure;
}

/* What lights that are looked at from several places need. False when out of memory. */
static bool make_lights(direct_lighting *a) {
    allocator *memory = jobs_memory(a->setup->jobs);
    size_t samples = a->setup->mesh->sample_count;
    size_t first = 0;
    while (first < a->samples.count && a->samples.all[first].direction < 0) first++;
    if (first == a->samples.count) return true;
    a->out->uneven = block_zeroed(memory, samples + 1, sizeof *a->out->uneven);
    a->seen = block_zeroed(memory, samples + 1, sizeof *a->seen);
    return a->out->uneven && a->seen;
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
    if (out->irradiance && out->row_sum && a.lit && a.workers && light_samples_list(setup, &a.samples) &&
        make_lights(&a) &&
        (a.samples.count == 0 || shadow_blockers_create(setup->scene, setup->triangle_surface, &a.blockers)))
        failure = run(&a);
    for (unsigned w = 0; a.workers && w < workers; w++)
        if (failure && *a.workers[w].message) {
            snprintf(message, message_size, "%s", a.workers[w].message);
            failure = message;
        }
    if (a.workers) jobs_run_on_each_worker(setup->jobs, close_item, &a);
    shadow_blockers_free(&a.blockers);
    for (unsigned w = 0; a.workers && w < workers; w++) block_free(a.workers[w].crossings.all);
    block_free_all(a.before, a.seen, a.workers, a.lit, a.samples.all);
    return failure;
}

void direct_light_free(direct_light *a) {
    block_free_all(a->irradiance, a->row_sum, a->uneven);
    memset(a, 0, sizeof *a);
}
