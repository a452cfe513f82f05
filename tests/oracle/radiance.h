/* SPDX-License-Identifier: MIT
 * How bright is a point of a surface? One path at a time: at each surface a light is sampled and a direction by the
 * cosine, weighted against each other by the balance heuristic [Veach 1995]; Russian roulette ends paths by what they
 * still carry, and nothing else does.
 *
 *     L = L_e + rho <X>,     X: the mean radiance that a path brings, E / pi
 */
#ifndef HEMIBAKE_ORACLE_RADIANCE_H
#define HEMIBAKE_ORACLE_RADIANCE_H

#include "sobol.h"
#include "traced_lights.h"

typedef struct radiance_tracer {
    const traced_scene *scene;
    const traced_lights *lights;
    sobol points;
    uint64_t seed;
} radiance_tracer;

/* Path number index of the set named by a number (of the point): X[c] of one sample. */
void radiance_sample(const radiance_tracer *tracer, const traced_point *at, uint64_t set, uint32_t index, double X[3]);

/* Adds X of count paths, from number first on, to sums[3*p+c] of each point, and their squares to squares[3*p+c], if
 * that is not NULL. The same sums for any number of threads (0: one for each core). False: out of
 * memory. */
bool radiance_add(const radiance_tracer *tracer, const traced_point *at, size_t point_count, uint32_t first,
                  uint32_t count, unsigned threads, double *sums, double *squares);

#endif
