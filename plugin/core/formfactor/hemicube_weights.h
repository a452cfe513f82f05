/* SPDX-License-Identifier: MIT
 * What does each pixel of a hemi-cube weigh? Its delta form factor, as an exact integral over the pixel:
 *
 *   top   1/(2 pi) [ x/sqrt(1+x^2) atan(y/sqrt(1+x^2)) + y/sqrt(1+y^2) atan(x/sqrt(1+y^2)) ]   at its corners
 *   side  1/(2 pi) [ atan y - atan(y/sqrt(1+z^2)) / sqrt(1+z^2) ]                              at its corners
 *
 * (the double integrals of 1/(pi (1+x^2+y^2)^2) and z/(pi (1+y^2+z^2)^2)), so that they sum to 1 to rounding. The
 * midpoint rule of [Cohen85] gives 1.0021 at 16 x 16 pixels.
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_HEMICUBE_WEIGHTS_H
#define HEMIBAKE_CORE_FORMFACTOR_HEMICUBE_WEIGHTS_H

#include "formfactor/hemicube.h"

/* weights[y*resolution+x] in the layout of hemicube.h: resolution x 3 resolution pixels. resolution is even. */
void hemicube_weights(int resolution, double *weights);

/* Where the power that leaves the eye goes, as fractions that sum to 1. */
typedef struct hemicube_closure {
    double front, back, sky;
} hemicube_closure;

/* Sums the weights of the pixels that show fronts, backs and sky. triangle_surface[t]: the surface of triangle t. */
hemicube_closure hemicube_close(const hemicube *h, const double *weights, const scene *s,
                                const uint32_t *triangle_surface);

#endif
