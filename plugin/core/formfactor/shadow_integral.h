/* SPDX-License-Identifier: MIT
 * What is the integral over a polygon of a function with straight kinks or steps, as shadows have? area_integral.h is
 * for smooth functions; its points are all inside, and a kink that runs between them and an edge is seen by none of
 * them, on every level. Here corners are points too: a straight line through a triangle has a corner on its other side.
 *
 * An error estimate is the larger of what degree 5 and degree 2 on the same seven points [Radon48] differ by, and of
 * what the values at the corners differ from a smooth function's, as a share of the triangle. Measured on shadows with
 * known edges: the true error is at most half of the reported one; without the corners it was up to five times as
 * large.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_SHADOW_INTEGRAL_H
#define HEMIBAKE_CORE_FORMFACTOR_SHADOW_INTEGRAL_H

#include "formfactor/area_integral.h"

/* As area_integrate, globally adaptive too. */
area_integral shadow_integrate(const polygon *shape, area_integrand f, void *user, double tolerance,
                               uint64_t evaluation_limit);

#endif
