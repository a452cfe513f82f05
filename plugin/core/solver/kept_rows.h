/* SPDX-License-Identifier: MIT
 * What do the same rows say of other lights? A row is what its rays hit, and knows of no light: once elements are what
 * they will be, each sample of them casts a row that is kept, of the elements that were solved with, and any lights
 * settle on these rows without another ray to a surface:
 *
 *     E_s = direct_s + sum over rays that hit element j of w B_j + pi sum over rays that escape of w L_sky
 *     B_j = mean over the samples of the parts of element j of rho_s E_s
 *
 * Only emitters are asked anew, by shadow rays. Rays were guided to what was bright by the lights of the bake: by
 * others they are as right, since they are weighed by how they were drawn, but may be noisier, which the two halves of
 * each row say.
 */
#ifndef HEMIBAKE_CORE_SOLVER_KEPT_ROWS_H
#define HEMIBAKE_CORE_SOLVER_KEPT_ROWS_H

#include "base/splitmix.h"
#include "solver/final_gather.h"
#include "solver/rows.h"

typedef struct kept_rows {
    final_gather *with;      /* the elements that rays hit, and what shadow rays are cast in */
    row_rays rays;           /* of the samples of the parts; what they hit are elements of `with` */
    uint32_t *roots;         /* of which element each part is */
    uint32_t *sky_direction; /* where each ray went that hit the sky, in their order ... */
    size_t *sky_begin;       /* ... those of element e from sky_begin[e] on */
} kept_rows;

/* Makes the nets of kept rows others than those of the rows that elements were solved with. */
static inline uint64_t kept_rows_seed(const final_gather *with) {
    return splitmix(with->seed ^ UINT64_C(0x6b657074));
}

/* Elements go to jobs in runs of so many: how many jobs that is, and the end of one. */
enum { KEPT_ROWS_A_JOB = 64 };

static inline size_t kept_rows_job_count(size_t elements) {
    return (elements + KEPT_ROWS_A_JOB - 1) / KEPT_ROWS_A_JOB;
}

static inline size_t kept_rows_job_end(size_t elements, size_t job) {
    size_t end = (job + 1) * KEPT_ROWS_A_JOB;
    return end < elements ? end : elements;
}

/* Rows of a mesh of parts, as many rays as those of their elements, all uncast. with, roots: as below. */
kept_rows *kept_rows_open(final_gather *with, const mesh *parts, const uint32_t *roots);

/* Casts the rows of a mesh of parts; roots[e]: of which element, NULL: they are the elements. with: rows_result's,
 * which it takes. NULL when out of memory, or where wait said false. */
kept_rows *kept_rows_cast(final_gather *with, const mesh *parts, const uint32_t *roots, bool (*wait)(void *user),
                          void *user);
void kept_rows_free(kept_rows *k); /* NULL is fine */

typedef struct kept_rows_setup {
    const lights *lights; /* of which the sky is looked up here */
    const double *direct; /* direct[3*s+c]: irradiance from punctual lights; NULL: none */
    const bool *is_dark;  /* is_dark[p]: patch p emits nothing, whatever its material; NULL: none is */
    int bounces;          /* as in rows_setup */
    bool (*go_on)(void *user);
    void *user;
} kept_rows_setup;

/* As rows_solve does, but that it casts no row: noise, ray_share and final_gather are not set. NULL, or why it failed.
 */
const char *kept_rows_settle(kept_rows *k, const kept_rows_setup *setup, rows_result *out);

#endif
