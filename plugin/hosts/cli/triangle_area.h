/* SPDX-License-Identifier: MIT
 * How large is a triangle of a mesh, and which way does it face?
 */
#ifndef HEMIBAKE_CLI_TRIANGLE_AREA_H
#define HEMIBAKE_CLI_TRIANGLE_AREA_H

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* m2 in the world; normal: of that length, out of the side that corner runs round counter-clockwise, as long as the
 * transform does not mirror. */
static inline double triangle_area(const float *positions, const double transform[16], const uint32_t corner[3],
                                   double normal[3]) {
    double p[3][3], a[3], b[3];
    for (int i = 0; i < 3; i++) hemi_transform_point(transform, positions + 3 * (size_t)corner[i], p[i]);
    for (int k = 0; k < 3; k++) a[k] = p[1][k] - p[0][k], b[k] = p[2][k] - p[0][k];
    for (int k = 0; k < 3; k++) normal[k] = 0.5 * (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
    return sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
}

/* m2 in the world, of all triangles. */
static inline double mesh_area(const float *positions, const double transform[16], const uint32_t *indices,
                               size_t triangle_count) {
    double area = 0.0, normal[3];
    for (size_t t = 0; t < triangle_count; t++) area += triangle_area(positions, transform, indices + 3 * t, normal);
    return area;
}

#endif
