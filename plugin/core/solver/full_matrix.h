/* SPDX-License-Identifier: MIT
 * What are all form factors at once? The full matrix [Baum89, sec. 3]: a hemi-cube on every element counts the pixels
 * of every patch, which gives the element-to-patch row F_ej (eq. 7); patch factors are their averages (eq. 3). The
 * matrix is handed over as one column a patch, so that whatever solves with columns solves it.
 *
 * It takes memory as elements times patches, where progressive refinement needs a column at a time.
 */
#ifndef HEMIBAKE_CORE_SOLVER_FULL_MATRIX_H
#define HEMIBAKE_CORE_SOLVER_FULL_MATRIX_H

#include "base/jobs.h"
#include "formfactor/column.h"

typedef struct full_matrix_setup {
    const column_setup *columns; /* scene, mesh, resolution, weights, back end */
    const mesh_items *patches;
    jobs *jobs;
    bool (*wait)(void *user); /* as jobs_wait_fn; may be NULL */
    void *wait_user;
} full_matrix_setup;

/* Bytes that the matrix of this mesh takes. */
uint64_t full_matrix_bytes(const mesh *m);

/* Fills columns[p] of every patch; all are NULL when waiting was ended early. NULL, or why it failed: message. */
const char *full_matrix_compute(const full_matrix_setup *setup, column **columns, char *message, size_t message_size);

#endif
