/* SPDX-License-Identifier: MIT
 * What radiance do samples show, and how far is each to be trusted? What vertex colours are fitted to, and what says
 * where elements are too large.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_FIT_SAMPLES_H
#define HEMIBAKE_CORE_RECONSTRUCT_FIT_SAMPLES_H

#include "mesh/triangulation.h"

typedef struct fit_samples_input {
    const mesh *mesh;
    const uint32_t *vertex_nodes; /* the colour node of each of its vertices */
    const double *irradiance;     /* irradiance[3*s+c] of the samples, W/m2 */
    const double *row_sum;        /* row_sum[s]: sum of form factors */
    const float *direct_row_sum;  /* the same of lights and sky; NULL: none */
    const float *uneven;          /* as in direct_light; NULL: none */
    const bool *crossed;          /* of patches */
} fit_samples_input;

typedef struct fit_samples {
    double *radiance;    /* radiance[3*s+c] */
    double *weight;      /* weight[s], m2: the sample's area, or less where it is inside something */
    uint32_t *nodes;     /* nodes[ELEMENT_PLACES*e+i] of place i of element e */
    bool *emits;         /* of elements */
    const float *uneven; /* of the input */
} fit_samples;

/* With the materials of the elements. False when out of memory. */
bool fit_samples_create(const fit_samples_input *in, fit_samples *out);
void fit_samples_free(fit_samples *s);

/* L = (M + rho E) / pi, with materials[e] of element e, or its own if that is NULL. */
void fit_samples_set_radiance(const fit_samples_input *in, const material *materials, fit_samples *out);

#endif
