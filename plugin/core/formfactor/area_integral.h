/* SPDX-License-Identifier: MIT
 * What is the integral of a function over a polygon, and how far off may it be? Globally adaptive: of all triangles the
 * one with the largest error estimate is quartered, until the estimates sum to less than the tolerance. The rule is of
 * degree 5 with seven points [Radon48]; its error estimate is the difference to rules of degree 2 on its own points,
 * which is far too large for smooth functions and about right for ones with a kink, as partly hidden polygons give; and
 * at least what quartering changed, since a triangle can have all its points on one side of a kink.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_AREA_INTEGRAL_H
#define HEMIBAKE_CORE_FORMFACTOR_AREA_INTEGRAL_H

#include "formfactor/polygon.h"

#include <stdbool.h>
#include <stdint.h>

typedef double (*area_integrand)(void *user, const double point[3]);

typedef struct area_integral {
    double value, error; /* error: estimated, absolute */
    uint64_t evaluations;
    bool converged; /* error <= tolerance */
} area_integral;

/* shape: convex, planar. Stops past evaluation_limit with what is there. Memory grows with the evaluations; when there
 * is none left the result says that it did not converge. */
area_integral area_integrate(const polygon *shape, area_integrand f, void *user, double tolerance,
                             uint64_t evaluation_limit);

#endif
