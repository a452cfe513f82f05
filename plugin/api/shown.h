/* SPDX-License-Identifier: MIT
 * What radiance do samples show, and how far is each to be trusted? What vertex colours are fitted to, and what says
 * where elements are too large.
 */
#ifndef HEMIBAKE_API_SHOWN_H
#define HEMIBAKE_API_SHOWN_H

#include "mesh/triangulation.h"

typedef struct shown_input {
    const mesh *mesh;
    const uint32_t *vertex_nodes; /* the colour node of each of its vertices */
    const double *irradiance;     /* irradiance[3*s+c] of the samples, W/m2 */
    const double *reach;          /* reach[s]: sum of form factors */
    const float *arrived_reach;   /* the same of lights and sky; NULL: none */
    const bool *crossed;          /* of patches */
} shown_input;

typedef struct shown_samples {
    double *radiance; /* radiance[3*s+c] */
    double *weight;   /* weight[s], m2: the sample's area, or less where it is inside something */
    uint32_t *nodes;  /* nodes[ELEMENT_PLACES*e+i] of place i of element e */
    bool *emits;      /* of elements */
} shown_samples;

/* With the finishes of the elements. False when out of memory. */
bool shown_create(const shown_input *in, shown_samples *out);
void shown_free(shown_samples *s);

/* L = (M + rho E) / pi, with finishes[e] of element e, or its own if that is NULL. */
void shown_set_radiance(const shown_input *in, const material *finishes, shown_samples *out);

#endif
