/* SPDX-License-Identifier: MIT
 * See interpolation_error.h.
 */
#include "bake/interpolation_error.h"

#include "adapt/error_indicator.h"
#include "reconstruct/fit_samples.h"

#include <math.h>

/* An element is only believed to be off by more than noise from so many times as much on. */
static const double SURE = 3.0;

/* Of irradiance at samples, which may be the light or its noise. uneven: of the light. */
static bool indicate(const mesh *m, const leaf_light *light, const double *irradiance, const float *uneven,
                     const bool *crossed, double *errors, double *levels) {
    fit_samples samples;
    const fit_samples_input in = { .mesh = m,
                                   .vertex_nodes = m->nodes,
                                   .irradiance = irradiance,
                                   .row_sum = light->row_sum,
                                   .direct_row_sum = light->direct_row_sum,
                                   .uneven = uneven,
                                   .crossed = crossed };
    bool ok = fit_samples_create(&in, &samples);
    const error_indicator_input seen = { .mesh = m,
                                         .node = samples.nodes,
                                         .node_count = m->node_count,
                                         .radiance = samples.radiance,
                                         .weight = samples.weight,
                                         .uneven = samples.uneven };
    ok = ok && error_indicator_measure(&seen, errors, levels);
    fit_samples_free(&samples);
    return ok;
}

/* Of the light and of its noise, at a time. */
typedef struct indication {
    const mesh *mesh;
    const leaf_light *light;
    const bool *crossed;
    const double *of[2];
    double *errors[2], *levels[2];
    bool ok[2];
} indication;

static void indicate_job(void *user, size_t i, unsigned worker) {
    indication *a = user;
    (void)worker;
    a->ok[i] =
        indicate(a->mesh, a->light, a->of[i], i ? NULL : a->light->uneven, a->crossed, a->errors[i], a->levels[i]);
}

/* errors, levels: of what samples receive; noise: of what the halves of rows differ in. False when out of memory. */
static bool indicate_both(const mesh *m, const leaf_light *light, const bool *crossed, jobs *j, double *errors,
                          double *noise, double *levels) {
    double *of_noise = block_new(m->memory, (m->element_count + 1) * sizeof *of_noise);
    indication a = {
        m, light, crossed, { light->irradiance, light->half_difference }, { errors, noise }, { levels, of_noise }, { 0 }
    };
    if (of_noise) jobs_run(j, 2, indicate_job, NULL, &a);
    block_free(of_noise);
    return a.ok[0] && a.ok[1];
}

/* What noise alone is off by on element e: as much to an area as around it, at least. */
static double noise_around(const mesh *m, const double *noise, size_t e) {
    return fmax(noise[e], mesh_mean_around(m, noise, e) * m->elements[e].area);
}

bool interpolation_error_indicate(const mesh *leaves, const leaf_light *light, const bool *crossed, jobs *j,
                                  double *errors, double *levels) {
    if (!light->half_difference)
        return indicate(leaves, light, light->irradiance, light->uneven, crossed, errors, levels);
    double *noise = block_new(leaves->memory, (leaves->element_count + 1) * sizeof *noise);
    bool ok = noise && indicate_both(leaves, light, crossed, j, errors, noise, levels);
    for (size_t e = 0; ok && e < leaves->element_count; e++) {
        double by_noise = noise_around(leaves, noise, e);
        errors[e] = errors[e] > SURE * by_noise ? errors[e] - by_noise : 0.0;
    }
    block_free(noise);
    return ok;
}

bool interpolation_error_measure(const mesh *m, const leaf_light *light, const bool *crossed, jobs *j, double *errors,
                                 double *levels) {
    double *noise = block_new(m->memory, (m->element_count + 1) * sizeof *noise);
    bool ok = noise && indicate_both(m, light, crossed, j, errors, noise, levels);
    for (size_t e = 0; ok && e < m->element_count; e++) errors[e] -= noise[e];
    block_free(noise);
    return ok;
}
