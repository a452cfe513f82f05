/* SPDX-License-Identifier: MIT
 * How is light shot until little of it is unshot? The shooter with the most unshot power, its column, its light to all
 * others [Cohen88]; again. A shooter also gives the light that it would get back from what the others have unshot now,
 * and owes it until it comes [Feda92]. Private to progressive.c, which says what is shot and through which rows.
 */
#ifndef HEMIBAKE_CORE_SOLVER_SHOOTING_H
#define HEMIBAKE_CORE_SOLVER_SHOOTING_H

#include "solver/progressive.h"

typedef struct shooting {
    const progressive_setup *setup;
    progressive_result *out;
    const mesh *mesh;
    shooters *shooters; /* of out, as the next */
    column_store *store;
    bool subdivides, over_shoots;
    double *radiosity;       /* of the samples of one patch */
    double *observed;        /* irradiance for setup->observe; may be NULL */
    double unshot_magnitude; /* |unshot|, W */
    double reflected;        /* W */
    double mean_rho;
    double factor_error_sum, factor_error_weight;
    double fraction; /* of the work, as reported; never falls */
    bool out_of_time;
} shooting;

/* Opens the books: what is emitted, and what arrives from outside, is unshot. */
void shooting_emit(shooting *s);

/* Tells whoever watches how far it is; false: cancelled. Notices when time is over. */
bool shooting_report(shooting *s);

/* Every patch gains rho F B from a shooter that has its column; what it does not reflect is absorbed. */
void shooting_distribute(shooting *s, uint32_t index, const double B[3]);

/* Past the memory limit a column delivers to the samples at once and is let go. */
void shooting_make_room(shooting *s, uint32_t index);

/* Shoots until little enough is unshot, time is over or whoever watches cancels. NULL, or why it failed. */
const char *shooting_run(shooting *s);

/* Shoots what dim places have unshot, of all that have had columns. NULL, or why it failed. */
const char *shooting_shoot_dim(shooting *s);

#endif
