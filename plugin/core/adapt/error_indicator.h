/* SPDX-License-Identifier: MIT
 * Where would finer elements help? Where radiance is not linear: there the slope of an element differs from that of its
 * neighbours. The slopes around a vertex are averaged, and what an element's own slope departs from the averages at its
 * vertices by is, times its size, what linear interpolation is off by [Zienkiewicz87]. Slopes are averaged where
 * colours are: over a smooth group, not across a crease.
 */
#ifndef HEMIBAKE_CORE_ADAPT_ERROR_INDICATOR_H
#define HEMIBAKE_CORE_ADAPT_ERROR_INDICATOR_H

#include "mesh/triangulation.h"

typedef struct error_indicator_input {
    const mesh *mesh;
    const uint32_t *node; /* node[ELEMENT_PLACES*e+i]: the colour node of place i of element e */
    size_t node_count;
    const double *radiance; /* radiance[3*s+c] of the samples */
    const double *weight;   /* weight[s], m2: as in vertex_fit_input */
    const float *uneven;    /* uneven[s], (W/m2)2: as in direct_light; NULL: none */
} error_indicator_input;

/* fault[e]: estimated square of what element e is off by, integrated over it, all bands; level[e]: the integrated
 * square of its radiance; both 0 for emitters. False when out of memory. */
bool error_indicator_measure(const error_indicator_input *in, double *fault, double *level);

#endif
