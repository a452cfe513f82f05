/* SPDX-License-Identifier: MIT
 * See light_groups.h.
 */
#include "bake/light_groups.h"

#include "bake/rows_stage.h"
#include "geometry/vec3.h"
#include "reconstruct/noise_filter.h"
#include "solver/kept_rows.h"

#include <math.h>
#include <string.h>

static const char NO_MEMORY[] = "out of memory";

/* ---- what a group is ---- */

/* Lights and emitters of one group; sizes as of all. */
typedef struct group_lights {
    lights lights;
    punctual *punctual;
    bool *is_dark; /* of patches */
    direct_light direct;
    double *arrived; /* direct.irradiance, or zeros */
} group_lights;

static bool take_group(const bake_setup *setup, uint32_t group, group_lights *out) {
    const lights *all = setup->lights;
    const mesh *m = setup->scene.mesh;
    const light_groups_input *of = &setup->groups;
    out->lights = *all;
    out->punctual = block_new(m->memory, (all->punctual_count + 1) * sizeof *out->punctual);
    out->is_dark = block_new(m->memory, m->patch_count + 1);
    if (!out->punctual || !out->is_dark) return false;
    out->lights.punctual = out->punctual, out->lights.punctual_count = 0;
    for (size_t i = 0; i < all->punctual_count; i++)
        if ((i < all->given_count ? of->of_light[i] : of->of_sky) == group)
            out->punctual[out->lights.punctual_count++] = all->punctual[i];
    out->lights.has_sky = all->has_sky && of->of_sky == group;
    for (size_t p = 0; p < m->patch_count; p++)
        out->is_dark[p] = of->of_mesh[setup->scene.scene->surfaces[m->patches[p].surface].mesh] != group;
    return true;
}

static const char *arrive(const bake_setup *setup, group_lights *g, char *message, size_t size) {
    const mesh *m = setup->scene.mesh;
    direct_light_setup how = direct_light_setup_of(setup, NULL, NULL);
    const char *failure = NULL;
    if (g->lights.punctual_count > 0) failure = lights_arrive(&g->lights, false, &how, &g->direct, message, size);
    g->arrived =
        failure || g->direct.irradiance ? NULL : block_zeroed(m->memory, 3 * m->sample_count + 1, sizeof(double));
    return failure || g->direct.irradiance || g->arrived ? failure : NO_MEMORY;
}

static void free_group(group_lights *g) {
    direct_light_free(&g->direct);
    block_free_all(g->punctual, g->is_dark, g->arrived);
}

/* ---- settling ---- */

/* Adds a group to the sum; the first one is it. */
static void add(const mesh *m, const rows_result *one, rows_result *sum) {
    for (size_t i = 0; i < 3 * m->sample_count; i++) {
        sum->irradiance[i] += one->irradiance[i];
        sum->half_difference[i] += one->half_difference[i];
    }
    for (size_t s = 0; s < m->sample_count; s++) sum->row_sum[s] = fmax(sum->row_sum[s], one->row_sum[s]);
    sum->emitters_w += one->emitters_w, sum->lights_w += one->lights_w, sum->sky_w += one->sky_w,
        sum->escaped_w += one->escaped_w;
    sum->absorbed_w += one->absorbed_w, sum->residual_w += one->residual_w;
}

static bool open_sum(const mesh *m, rows_result *sum) {
    *sum = (rows_result){ .irradiance = block_zeroed(m->memory, 3 * m->sample_count + 1, sizeof(double)),
                          .half_difference = block_zeroed(m->memory, 3 * m->sample_count + 1, sizeof(double)),
                          .row_sum = block_zeroed(m->memory, m->sample_count + 1, sizeof(double)) };
    return sum->irradiance && sum->half_difference && sum->row_sum;
}

/* Noise of each group is filtered as that of the whole is. */
static bool filter(const bake_setup *setup, const group_lights *g, const rows_result *found) {
    const noise_filter_input noisy = { .scene = setup->scene.scene,
                                       .mesh = setup->scene.mesh,
                                       .jobs = setup->jobs,
                                       .exact = g->direct.irradiance,
                                       .row_sum = found->row_sum,
                                       .irradiance = found->irradiance,
                                       .half_difference = found->half_difference };
    return noise_filter(&noisy);
}

static const char *settle_group(const bake_setup *setup, watcher *watch, kept_rows *rows, uint32_t group,
                                rows_result *sum, light_group *out, char *message, size_t message_size) {
    group_lights g = { 0 };
    rows_result found = { 0 };
    const char *failure = take_group(setup, group, &g) ? arrive(setup, &g, message, message_size) : NO_MEMORY;
    const kept_rows_setup how = { .lights = &g.lights,
                                  .direct = g.direct.irradiance ? g.direct.irradiance : g.arrived,
                                  .is_dark = g.is_dark,
                                  .bounces = setup->options->bounces,
                                  .go_on = watch->wait,
                                  .user = watch->user };
    if (!failure) failure = kept_rows_settle(rows, &how, &found);
    if (!failure) add(setup->scene.mesh, &found, sum);
    if (!failure && !filter(setup, &g, &found)) failure = NO_MEMORY;
    if (!failure) out->irradiance = found.irradiance, found.irradiance = NULL;
    sum->cancelled = sum->cancelled || found.cancelled;
    rows_result_free(&found);
    free_group(&g);
    return failure;
}

const char *light_groups_settle(const bake_setup *setup, watcher watch, kept_rows *rows, bake_result *out,
                                char *message, size_t message_size) {
    const mesh *m = setup->scene.mesh;
    rows_result sum = { 0 };
    out->groups.all = block_zeroed(m->memory, setup->options->light_groups + 1, sizeof *out->groups.all);
    const char *failure = out->groups.all && open_sum(m, &sum) ? NULL : NO_MEMORY;
    for (uint32_t g = 0; !failure && !sum.cancelled && g < setup->options->light_groups; g++, out->groups.count++)
        failure = settle_group(setup, &watch, rows, g, &sum, &out->groups.all[g], message, message_size);
    if (!failure && !sum.cancelled) rows_stage_take(setup, &sum, &out->direct, &out->solution);
    rows_result_free(&sum);
    return failure;
}

/* ---- colours ---- */

/* What samples show of a group; incident: what a white surface that does not emit would. */
static void set_radiance(const bake_setup *setup, uint32_t group, const light_group *g, bool incident,
                         double *radiance) {
    const mesh *m = setup->scene.mesh;
    for (size_t i = 0; i < m->element_count; i++) {
        const element *e = &m->elements[i];
        const material *a = e->material;
        bool emits = !incident &&
                     setup->groups.of_mesh[setup->scene.scene->surfaces[m->patches[e->patch].surface].mesh] == group;
        for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)element_corner_count(e); s++)
            for (size_t c = 0; c < 3; c++)
                radiance[3 * s + c] =
                    ((emits ? a->M[c] : 0.0) + (incident ? 1.0 : a->rho[c]) * g->irradiance[3 * s + c]) / PI;
    }
}

/* Makes parts add up to the whole. A group has no less than nothing: where they add up to nothing, each gets as much.
 */
static void share(const light_groups *g, bool incident, const vertex_fit_result *whole, size_t nodes) {
    for (size_t i = 0; i < 3 * nodes; i++) {
        double sum = 0.0;
        for (size_t k = 0; k < g->count; k++)
            sum += (incident ? &g->all[k].incident : &g->all[k].radiance)->radiance[i];
        for (size_t k = 0; k < g->count; k++) {
            double *part = &(incident ? &g->all[k].incident : &g->all[k].radiance)->radiance[i];
            *part = sum > 0.0 ? *part * (whole->radiance[i] / sum) : whole->radiance[i] / (double)g->count;
        }
    }
}

typedef struct fitting {
    const bake_setup *setup;
    const vertex_colors_setup *how;
    const vertex_colors *colors;
    const light_groups *groups;
    bool ok;
} fitting;

static bool fit_as(const fitting *f, bool incident, double *radiance) {
    const vertex_fit_result *whole = incident ? &f->colors->irradiance : &f->colors->radiance;
    const vertex_fit_input in = { .mesh = f->setup->scene.mesh,
                                  .node = f->colors->samples.nodes,
                                  .node_count = f->how->triangles.node_count,
                                  .radiance = radiance,
                                  .emits = f->colors->samples.emits,
                                  .weight = f->colors->samples.weight,
                                  .diagonal = whole->diagonal,
                                  .jobs = f->setup->jobs };
    bool ok = true;
    for (uint32_t k = 0; ok && k < f->groups->count; k++) {
        light_group *g = &f->groups->all[k];
        set_radiance(f->setup, k, g, incident, radiance);
        ok = vertex_fit(&in, incident ? &g->incident : &g->radiance);
    }
    if (ok) share(f->groups, incident, whole, in.node_count);
    return ok;
}

static void fit_alone(void *user) {
    fitting *f = user;
    const mesh *m = f->setup->scene.mesh;
    double *radiance = block_new(m->memory, (3 * m->sample_count + 1) * sizeof *radiance);
    f->ok = radiance && fit_as(f, false, radiance) && (!f->how->fits_irradiance || fit_as(f, true, radiance));
    block_free(radiance);
}

static bool wait(void *user) {
    const watcher *w = &((const fitting *)user)->how->watch;
    return !w->wait || w->wait(w->user);
}

const char *light_groups_fit(const bake_setup *setup, const vertex_colors_setup *how, const vertex_colors *colors,
                             const light_groups *g) {
    fitting f = { .setup = setup, .how = how, .colors = colors, .groups = g };
    if (g->count == 0) return NULL;
    jobs_run_alone(fit_alone, wait, &f);
    return f.ok ? NULL : NO_MEMORY;
}

void light_groups_free(light_groups *g) {
    for (size_t k = 0; g->all && k < g->count; k++) {
        block_free(g->all[k].irradiance);
        vertex_fit_free(&g->all[k].radiance);
        vertex_fit_free(&g->all[k].incident);
    }
    block_free(g->all);
    *g = (light_groups){ 0 };
}
