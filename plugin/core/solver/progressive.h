/* SPDX-License-Identifier: MIT
 * How bright is every sample once the light has settled? Progressive refinement [Cohen88]: find the shooter with the
 * most unshot power, get its form-factor column, distribute its light; again, until little is unshot.
 *
 * All methods are this loop; what differs is where columns come from and what may be done with a shooter:
 *
 *     method      column                              shooter
 *     hybrid      [Baum89, sec. 5], column.h          over-shoots
 *     analytic    the same, closed forms everywhere   over-shoots
 *     pr          pixels and reciprocity [Cohen88]    cut by gradient and by factors above 1
 *     fm          rows of hemi-cubes on elements      over-shoots (Southwell relaxation of eq. 1: what is unshot is the
 *                                                     residual of the equations)
 *
 * Over-shooting [Feda92]: a shooter also gives the light that it would get back from what the others have unshot now,
 * and owes it until it comes.
 *
 * Columns are kept. Distribution therefore works on patch averages (a few thousand numbers a shot); the samples are
 * gathered from the kept columns once at the end, which gives the same sums. In a closed room, when every patch has its
 * column, the rows are closed (row_closure.h) and all that was shot is shot again through them, which costs
 * milliseconds. At last near receivers get what the slope of a shooter's radiosity gives them (shooter_gradient.h):
 * then the solution is finished.
 *
 * Same bits for any number of threads: every sum runs in index order.
 */
#ifndef HEMIBAKE_CORE_SOLVER_PROGRESSIVE_H
#define HEMIBAKE_CORE_SOLVER_PROGRESSIVE_H

#include "solver/energy.h"
#include "solver/shooter_gradient.h"

typedef enum solver_method {
    SOLVER_HYBRID,
    SOLVER_ANALYTIC,
    SOLVER_PR,
    SOLVER_FM,
    SOLVER_ROWS /* rows.h */,
    SOLVER_AUTO /* none yet */
} solver_method;

typedef struct progressive_point {
    double t_s, unshot_fraction, unshot_error;
    uint32_t shots;
    uint64_t analytic, evaluations; /* of the columns so far */
} progressive_point;

/* What was decided about one shooter. */
typedef struct progressive_shooter {
    uint32_t patch, shots, hemicubes;
    uint64_t path; /* 0: the whole patch; see subpatch */
    uint64_t analytic, evaluations;
    bool split;
} progressive_shooter;

typedef struct progressive_setup {
    solver_method method;
    column_setup columns;      /* its method is set by the solver */
    const mesh_items *patches; /* for SOLVER_FM */
    jobs *jobs;
    const double *arrived;     /* arrived[3*s+c]: irradiance of sample s by what is no surface, W/m2; NULL: none */
    bool plain_order;          /* no over-shooting */
    bool open_rows;            /* no closing of rows */
    bool even_shooters;        /* no correction by the gradients of shooters */
    double unshot_target;      /* fraction of the emitted power, or of what is reflected where that is far less */
    bool unshot_is_of_emitted; /* of the emitted power, whatever is reflected */
    double error_target;       /* 0: none */
    double time_limit_s;       /* 0: none */
    double start_s;            /* the clock when the bake began */
    uint64_t memory_limit;     /* bytes of kept columns */
    double (*clock)(void);     /* seconds */
    bool (*progress)(void *user, double fraction, uint32_t shots, double unshot_fraction); /* may be NULL */
    void *progress_user;
    /* What samples have received after each shot that makes a point of the curve; may be NULL. For measuring: it costs
     * a gathering each. */
    void (*observe)(void *user, const progressive_point *point, const double *irradiance);
    void *observe_user;
    const volatile int *stop; /* not 0: stop shooting; may be NULL */
} progressive_setup;

typedef struct progressive_result {
    double *irradiance; /* irradiance[3*s+c] of sample s, W/m2; from block_new */
    double *row_sum;    /* row_sum[s]: sum of the form factors sample s received; from block_new */
    double
        *half_difference; /* half_difference[3*s+c]: by rows, an error like that of the irradiance; NULL: by columns */
    bool by_rows;         /* and then, of the samples that were solved for, as in rows_result: */
    double ray_noise, emitter_noise;
    bool *crossed;            /* crossed[p]: something stands on patch p, so some of its samples may be inside it */
    progressive_point *curve; /* from block_new */
    progressive_shooter *shooters; /* those that have a column or had one, in patch order; from block_new */
    size_t curve_count, shooter_count;
    energy_books books;
    uint32_t shots, hemicubes, column_count, split_count, clipped_count, light_count;
    uint64_t analytic, evaluations, column_bytes;
    double unshot_fraction; /* of |unshot|: over-shooting leaves some of it negative */
    double closure_min, closure_mean, closure_max;
    double factor_error; /* power-weighted rms of column totals against what the hemi-cubes say */
    double unshot_error; /* estimated relative error of reflected light by what is unshot */
    double factors_s, solve_s;
    bool rows_closed, corrected, converged, cancelled;
    shooters kept;      /* the shooters with the columns that are still there */
    column_store store; /* which computes them again; it knows where this result is, which may not move */
    /* How uneven the shooters are, with which the samples were corrected; empty where they were not. */
    shooter_gradient gradient;
    struct kept_rows *kept_rows;       /* by rows, where they are kept; else NULL */
    struct final_gather *final_gather; /* what parts of elements gather from by rows, or NULL */
} progressive_result;

/* Bytes that the method must have at once, whatever the memory limit: the matrix of fm, 0 for the others. */
uint64_t progressive_memory(const progressive_setup *setup);

/* NULL on success, else why it failed. out stays where it is until it is freed, before setup->jobs. */
const char *progressive_solve(const progressive_setup *setup, progressive_result *out, char *message,
                              size_t message_size);

/* Lets go of the shooters and their columns. */
void progressive_forget_shooters(progressive_result *r);
/* Lets go of what samples have received. */
void progressive_forget_samples(progressive_result *r);
void progressive_result_free(progressive_result *r);

#endif
