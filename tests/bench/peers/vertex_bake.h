/* SPDX-License-Identifier: MIT
 * What light have the vertices of a uniform tessellation? The paths of a vertex start in turn from each of the
 * triangles around it.
 */
#ifndef HEMIBAKE_PEERS_VERTEX_BAKE_H
#define HEMIBAKE_PEERS_VERTEX_BAKE_H

#include "radiance.h"
#include "tessellation.h"

typedef struct vertex_bake {
    const radiance_tracer *tracer;
    tessellation tessellation;
    uint32_t samples; /* paths a vertex so far */
    double *sums;     /* sums[3*v+c] of X */
} vertex_bake;

/* All false: out of memory. */
bool vertex_bake_create(const radiance_tracer *tracer, double edge, vertex_bake *out);
void vertex_bake_destroy(vertex_bake *b);
bool vertex_bake_add(vertex_bake *b, uint32_t samples, unsigned threads);

/* radiance[3*v+c] so far. */
void vertex_bake_get(const vertex_bake *b, float *radiance);

#endif
