/* SPDX-License-Identifier: MIT
 * How far is linear interpolation over elements off, where and in all? What rows say is noisy, and noise is
 * not linear either: what the same measure finds in the noise alone is left out.
 */
#ifndef HEMIBAKE_CORE_BAKE_INTERPOLATION_ERROR_H
#define HEMIBAKE_CORE_BAKE_INTERPOLATION_ERROR_H

#include "adapt/leaf_light.h"
#include "base/jobs.h"

/* adapt_setup.indicate. */
bool interpolation_error_indicate(const mesh *leaves, const leaf_light *light, const bool *crossed, jobs *j,
                                  double *errors, double *levels);

/* Squares of it, and of radiance, integrated over each element; what noise alone makes is taken off, so that a sum may
 * be below 0. False when out of memory. */
bool interpolation_error_measure(const mesh *m, const leaf_light *light, const bool *crossed, jobs *j, double *errors,
                                 double *levels);

#endif
