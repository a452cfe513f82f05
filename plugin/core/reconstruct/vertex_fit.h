/* SPDX-License-Identifier: MIT
 * Which vertex colours come closest to the radiosity that was solved for? Those of least squares over the surface, as
 * linear interpolation will show them [Kavan11]:
 *
 *     minimise  sum_s w_s |sum_v phi_v(s) x_v - B_s|^2  +  alpha sum over element edges A_e |x_a - x_b|^2
 *
 * and x_v inside what the trusted samples around v allow, so that no halo rings along the edge of a shadow. The second
 * term settles vertices that no sample does. What is shown are triangles (mesh/triangulation.h); a quad is cut along
 * the diagonal whose ends are more alike. Colour nodes are what vertices share: smooth neighbours have a node in
 * common, a crease does not, so hard edges stay hard.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_VERTEX_FIT_H
#define HEMIBAKE_CORE_RECONSTRUCT_VERTEX_FIT_H

#include "base/jobs.h"
#include "mesh/triangulation.h"

typedef struct vertex_fit_input {
    const mesh *mesh;
    const uint32_t *node; /* node[ELEMENT_PLACES*e+i]: the colour node of place i of element e */
    size_t node_count;
    const double *radiance;  /* radiance[3*s+c] */
    const bool *emits;       /* of elements: left out of the residual, as in [Baum89, eq. 13]; NULL: none does */
    const double *weight;    /* weight[s], m2: the sample's area, or less of it where the sample is not to be trusted */
    const uint8_t *diagonal; /* which cut quads, as in the result; NULL: chosen here */
    jobs *jobs;              /* NULL: the caller does all of it */
    const watcher *watch;    /* over: what has been reached by then; NULL: nobody waits */
} vertex_fit_input;

typedef struct vertex_fit_result {
    double *radiance;  /* radiance[3*v+c] of the nodes, >= 0; from block_new */
    uint8_t *diagonal; /* of element e: 0 cuts a quad from corner 0 to 2, 1 from 1 to 3; from block_new */
    double residual;   /* rms of fit - samples, relative to the rms of the samples, over elements that do not emit */
    int iterations;
} vertex_fit_result;

/* False when out of memory. */
bool vertex_fit(const vertex_fit_input *in, vertex_fit_result *out);
void vertex_fit_free(vertex_fit_result *r);

#endif
