/* SPDX-License-Identifier: MIT
 * Which point of a surface is nearest, among the parts that face the same way? For handing what is known on a proxy
 * to the mesh it stands for.
 */
#ifndef HEMIBAKE_SIMPLIFY_CLOSEST_POINT_H
#define HEMIBAKE_SIMPLIFY_CLOSEST_POINT_H

#include "base/block.h"
#include "base/jobs.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A tree of boxes around triangles. */
typedef struct closest_point closest_point;

typedef struct closest_point_hit {
    uint32_t triangle; /* UINT32_MAX: the surface is empty */
    double weights[3]; /* of its corners */
    double distance;
} closest_point_hit;

/* The arrays must outlive it. memory: NULL for the C library. NULL when out of memory. */
closest_point *closest_point_create(allocator *memory, jobs *j, const float *positions, const uint32_t *indices,
                                    size_t triangle_count);
void closest_point_destroy(closest_point *n);

/* A triangle that faces another way than the normal (by more than 60 degrees) counts as further away by `turned`, and
 * one that faces away from it by twice that. normal may be 0: no way. guess: a triangle that is likely near; the result
 * does not depend on it, except for which of two triangles with a common point there. */
closest_point_hit closest_point_find(const closest_point *n, const float point[3], const float normal[3], double turned,
                                     uint32_t guess);

/* to[c], c < width: what from[width*v+c] of the vertices is there, by the indices that the tree was made of. from:
 * NULL, nothing. */
void closest_point_interpolate(const closest_point_hit *hit, const uint32_t *indices, const float *from, size_t width,
                               float *to);

#endif
