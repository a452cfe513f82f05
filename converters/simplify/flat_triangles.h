/* SPDX-License-Identifier: MIT
 * How does a mesh get one colour a triangle? Each triangle gets three vertices of its own, which show its mean.
 */
#ifndef HEMIBAKE_SIMPLIFY_FLAT_TRIANGLES_H
#define HEMIBAKE_SIMPLIFY_FLAT_TRIANGLES_H

#include "base/block.h"

#include <stdint.h>

/* Replaces *values, so many bytes a vertex, by those of the corners of the triangles, one after the other; NULL stays
 * NULL. False when out of memory. */
bool flat_triangles_spread(allocator *memory, const uint32_t *indices, size_t triangle_count, void **values,
                           size_t bytes);

/* colors[9*t+3*k+c] of corner k of triangle t become the mean of its corners; NULL is fine. */
void flat_triangles_average(float *colors, size_t triangle_count);

#endif
