/* SPDX-License-Identifier: MIT
 * Where does the estimated error of what is shown lie? Over all it is known; over the surface it is spread as the error
 * indicator finds radiance not to be linear (adapt/error_indicator.h): with f the square that the indicator gives to an
 * area, and <f> its mean over all that does not emit,
 *
 *     error(v) = estimate x sqrt( f around v / <f> ),
 *
 * so that the mean square over the area is the square of the estimate. A one-sided error is not seen by it.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_VERTEX_ERRORS_H
#define HEMIBAKE_CORE_RECONSTRUCT_VERTEX_ERRORS_H

#include "reconstruct/fit_samples.h"

/* errors[v] of the colour nodes, from block_new: as a share of the rms radiance of what does not emit; 0 where there is
 * only what does. estimate: the same of all. NULL when out of memory. */
double *vertex_errors_find(const mesh *m, const fit_samples *samples, double estimate);

#endif
