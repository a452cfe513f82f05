/* SPDX-License-Identifier: MIT
 * Which colours at the vertices of a given mesh come closest to what paths say that are spread over its triangles?
 *
 *     minimise  sum_t A_t / n_t sum_s |sum_v phi_v(s) x_v - L_s|^2  +  alpha sum over edges of t A_t |x_a - x_b|^2
 *
 * as core/reconstruct/vertex_fit.h does from its samples [Kavan11]; here a sample is one path at a place of its own, so
 * that the noise of light and of places averages out at once. Triangles have paths by the root of their area, which is
 * best where all are equally noisy: a vertex's variance falls as its paths, and counts by its area.
 */
#ifndef HEMIBAKE_PEERS_FITTED_BAKE_H
#define HEMIBAKE_PEERS_FITTED_BAKE_H

#include "radiance.h"

typedef struct fitted_triangle {
    double corner[3][3], normal[3], area, share; /* of all paths */
    uint32_t vertex[3];
    uint32_t paths, counted; /* begun; of those, on a surface */
    double phi[6];           /* sums of products of weights: 00 11 22 01 12 20 */
    double right[3][3];      /* right[k][c]: sums of weight k times L_c */
} fitted_triangle;

typedef struct fitted_bake {
    const radiance_tracer *tracer;
    fitted_triangle *triangles;
    float *positions; /* positions[3*v+k], world */
    uint32_t *indices;
    size_t triangle_count, vertex_count;
    double paths; /* so far */
} fitted_bake;

/* Positions, indices and transforms of meshes are read. All false: out of memory. */
bool fitted_bake_create(const radiance_tracer *tracer, const hemi_mesh_desc *meshes, size_t mesh_count,
                        fitted_bake *out);
void fitted_bake_destroy(fitted_bake *b);

/* Until there are so many paths a vertex in the mean. */
bool fitted_bake_climb(fitted_bake *b, double paths_a_vertex, unsigned threads);

/* radiance[3*v+c] that fits best, with smoothness alpha. */
bool fitted_bake_get(const fitted_bake *b, double smoothness, float *radiance);

#endif
