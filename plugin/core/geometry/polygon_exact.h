/* SPDX-License-Identifier: MIT
 * What does the closed form of polygon.h give where doubles are too short for it?
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_POLYGON_EXACT_H
#define HEMIBAKE_CORE_GEOMETRY_POLYGON_EXACT_H

#include "geometry/polygon.h"

/* polygon_loop_factor in pairs of doubles: 30 digits less what cancels. About 40 times slower. */
double polygon_loop_factor_exact(polygon_loop loop, const double point[3], const double normal[3]);

#endif
