/* SPDX-License-Identifier: MIT
 * What fraction of the light that leaves an element reaches a polygon, if nothing stands between? The mean of the
 * closed form of polygon.h over the element:
 *
 *     F = 1/A integral over the element of F_point(x) dA(x)
 */
#ifndef HEMIBAKE_CORE_FACTORS_ELEMENT_FACTOR_H
#define HEMIBAKE_CORE_FACTORS_ELEMENT_FACTOR_H

#include "factors/adaptive.h"
#include "factors/facing.h"

/* Of the element and the polygon that facing_create took: both planar; the element convex, unless it is far from the
 * polygon. Light leaves and arrives at fronts. An evaluation is one point of the element. Whatever has no area or is
 * not finite gives 0. Otherwise the value is what the same steps give, the error is 1 and converged is false. request
 * may be NULL. */
factor_estimate element_factor(const facing *f, const factor_request *request);

#endif
