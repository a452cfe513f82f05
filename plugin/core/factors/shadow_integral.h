/* SPDX-License-Identifier: MIT
 * What is the integral over a polygon of a function with straight kinks or steps, as shadows have, and how far off may
 * it be? Globally adaptive: of all triangles the one with the largest error estimate is quartered. A kink that runs
 * between points inside and an edge is seen by none of them, on every level; so corners are points too: a straight line
 * through a triangle has a corner on its other side.
 *
 * An error estimate is the larger of what degree 5 and degree 2 on the same seven points [Radon48] differ by, and of
 * what the values at the corners differ from a smooth function's, as a share of the triangle. Measured on shadows with
 * known edges: the true error is at most half of the reported one; without the corners it was up to five times as
 * large.
 */
#ifndef HEMIBAKE_CORE_FACTORS_SHADOW_INTEGRAL_H
#define HEMIBAKE_CORE_FACTORS_SHADOW_INTEGRAL_H

#include "factors/adaptive.h"
#include "geometry/polygon.h"

#include <stdint.h>

typedef double (*shadow_integrand)(void *user, const double point[3]);

/* The integral over a convex, planar shape; tolerance: absolute. Stops past evaluation_limit with what is there. */
factor_estimate shadow_integrate(const polygon *shape, shadow_integrand f, void *user, double tolerance,
                                 uint64_t evaluation_limit, allocator *memory);

#endif
