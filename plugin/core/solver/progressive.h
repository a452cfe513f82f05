/* SPDX-License-Identifier: MIT
 * How bright is every sample once the light has settled? Progressive refinement [Cohen88]: find the patch with the most
 * unshot power, get its form-factor column, distribute its light; again, until little is unshot.
 *
 * Columns are kept. Distribution therefore works on patch averages (a few thousand numbers a shot); the samples are
 * gathered from the kept columns once at the end, which gives the same sums.
 */
#ifndef HEMIBAKE_CORE_SOLVER_PROGRESSIVE_H
#define HEMIBAKE_CORE_SOLVER_PROGRESSIVE_H

#include "base/jobs.h"
#include "formfactor/column.h"
#include "solver/energy.h"

typedef struct progressive_point {
    double t_s, unshot_fraction, error_estimate;
    uint32_t shots;
} progressive_point;

typedef struct progressive_setup {
    column_setup columns;
    jobs *jobs;
    double unshot_target;  /* fraction of the emitted power */
    double error_target;   /* 0: none */
    double error_floor;    /* part of the estimated error that shooting does not remove */
    double time_limit_s;   /* 0: none */
    double start_s;        /* the clock when the bake began */
    uint64_t memory_limit; /* bytes of kept columns */
    double (*clock)(void); /* seconds */
    bool (*progress)(void *user, double fraction, uint32_t shots, double unshot_fraction); /* may be NULL */
    void *progress_user;
    const volatile int *finish; /* not 0: stop shooting; may be NULL */
} progressive_setup;

typedef struct progressive_result {
    double *irradiance;       /* irradiance[3*s+c] of sample s, W/m2; from malloc */
    double *reach;            /* reach[s]: sum of the form factors sample s received; from malloc */
    bool *crossed;            /* crossed[p]: something stands on patch p, so some of its samples may be inside it */
    progressive_point *curve; /* from malloc */
    size_t curve_count;
    energy_books books;
    uint32_t shots, hemicubes, column_count, split_count, clipped_count, light_count;
    uint64_t analytic, evaluations, column_bytes;
    double unshot_fraction;
    double closure_min, closure_mean, closure_max;
    double factor_error; /* power-weighted rms of column totals against what the hemi-cubes say */
    double unshot_error; /* estimated relative error of reflected light by what is unshot */
    double factors_s, solve_s;
    bool converged, cancelled;
} progressive_result;

/* NULL on success, else why it failed. */
const char *progressive_solve(const progressive_setup *setup, progressive_result *out, char *message,
                              size_t message_size);
void progressive_result_free(progressive_result *r);

#endif
