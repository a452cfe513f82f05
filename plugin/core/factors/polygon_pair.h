/* SPDX-License-Identifier: MIT
 * What fraction of the light that leaves one polygon reaches another, if nothing stands between? By Stokes' theorem the
 * double integral over the areas is one over the outlines [Sparrow63; Hottel67, sec. 2.5]:
 *
 *     A1 F12 = 1/(2 pi) integral over outline 1, integral over outline 2 of  ln r  dx1 . dx2
 *
 * The inner integral along an edge has a closed form, so that one integral along a line is left. (That one, too, has a
 * closed form, in dilogarithms of complex arguments [Schroeder93]; its many terms cancel near all that is degenerate.)
 */
#ifndef HEMIBAKE_CORE_FACTORS_POLYGON_PAIR_H
#define HEMIBAKE_CORE_FACTORS_POLYGON_PAIR_H

#include "factors/adaptive.h"
#include "geometry/polygon.h"

/* F from the first to the second. Both planar, of any shape, wherever they lie: what is behind the other does not
 * count. An evaluation is one point of the outline with all of the other outline, or one point of the area where the
 * method is that of element_factor.h (far apart). Rules for bad polygons as there. request may be NULL. */
factor_estimate polygon_pair_factor(polygon_loop from, polygon_loop to, const factor_request *request);

#endif
