/* SPDX-License-Identifier: MIT
 * How bright is every sample once the light has settled, by rows instead of columns? A sample casts directions that are
 * distributed as the cosine and leave no gaps, and keeps what each of them hits: a row of the form-factor matrix,
 * estimated as a hemi-cube estimates it, with pixels of equal weight [Baum89, eq. 7]. Iterating on the rows that were
 * kept gives all bounces [Baum89, eq. 1 and 4]:
 *
 *     E_s = direct_s + sum over rays that hit element j of w B_j + pi sum over rays that escape of w L_sky
 *     B_j = rho_j E_j        what is emitted is not in B: emitters are asked by themselves (row_emitters.h), their
 *                            light is in direct_s
 *
 * A few initial rays of every sample say where light is uneven; adaptive ones go where they are of most use
 * (row_allocation.h), some of them guided to what is bright (row_guiding.h). The cost is that of rays, whatever the
 * number of surfaces. The two halves of a row's rays are two independent estimates, so their difference says how noisy
 * the row is.
 *
 * Same bytes for any number of threads: a sample's directions depend on its own number, the seed, and on what the
 * initial rays hit; sums run in order.
 */
#ifndef HEMIBAKE_CORE_SOLVER_ROWS_H
#define HEMIBAKE_CORE_SOLVER_ROWS_H

#include "base/jobs.h"
#include "light/lights.h"
#include "mesh/mesh.h"
#include "solver/energy.h"
#include "solver/final_gather.h"

/* What is known on the way; none of it falls and rises again but by noise. */
typedef struct rows_progress {
    double fraction; /* of the work, about */
    double residual; /* what iterations to come would change of what is reflected; 1 before the first */
    double noise;    /* rows_result's, of the rays so far; 1 while nothing is known of it */
} rows_progress;

typedef struct rows_setup {
    const scene *scene;
    const mesh *mesh;
    jobs *jobs;
    uint64_t seed;
    int initial_rays;     /* of every sample, a power of 2 */
    double adaptive_rays; /* of all samples, where they are of most use; 0: none */
    double noise_target;  /* rms of reflected light at samples, relative, for which fewer will do; 0: all are cast */
    const lights *lights; /* of which the sky is looked up here, and a crowd asked */
    const double *direct; /* direct[3*s+c]: irradiance from lights, and from emitters unless these are asked here */
    int emitter_rays;     /* of a sample, to what emits; 0: none, their light is in direct */
    bool (*progress)(void *user, const rows_progress *so_far); /* may be NULL; false: stop */
    void *progress_user;
    const volatile int *stop; /* not 0: no more rays, the best answer so far; may be NULL */
    double deadline_s;        /* by clock: the same from then on; 0: never */
    double least_s;           /* where deadline_s is: by then the least rays of each sample are cast */
    double (*clock)(void);
    uint64_t memory_limit; /* bytes of rays; fewer are cast where they would take more; 0: none */
    bool keeps;            /* what parts of elements can receive from: rows_result.final_gather */
    bool keeps_rows;       /* the same, and more: kept_rows.h */
    int bounces;           /* reflections before the last; 0: all, below 0: none */
    double open_distance;  /* m, past which rays see the sky; 0: none */
} rows_setup;

typedef struct rows_result {
    double *irradiance;      /* irradiance[3*s+c], direct light included; from block_new */
    double *row_sum;         /* row_sum[s]: share of the rays that do not hit a back; from block_new */
    double *half_difference; /* half_difference[3*s+c]: row_gather.h; from block_new */
    double emitters_w;       /* that arrived from emitters that were asked here */
    double lights_w;         /* that arrived from a crowd of lights */
    double sky_w;            /* that arrived from the sky at fronts */
    double escaped_w;        /* reflected light that rays carried to the sky or to backs */
    double absorbed_w;
    double noise; /* rms error of reflected light at samples by the rays, relative [Baum89, eq. 12] ... */
    double ray_noise, emitter_noise; /* ... of which those that gather have so much, and those to emitters */
    int iterations;
    double residual_w;          /* what the last iteration changed, or what the last bounce would carry on */
    double ray_share;           /* of the rays that were asked for, what the memory limit leaves */
    final_gather *final_gather; /* NULL where nothing is kept */
    bool cancelled, cut;        /* cut: stopped or late, before all rays were cast */
} rows_result;

/* NULL on success, else why it failed. */
const char *rows_solve(const rows_setup *setup, rows_result *out, char *message, size_t message_size);
void rows_result_free(rows_result *r);

#endif
