/* SPDX-License-Identifier: MIT
 * Where is a surface, and where is a hole in it? A leaf is a quad, and a picture of its alpha says which parts of the
 * quad are leaf (alphaMode MASK of glTF):
 *
 *     hole at x   <=>   alpha(u(x), v(x)) w(x) < cutoff
 *
 * with u, v, w affine in the place on a surface, since they interpolate linearly over it. The texel that holds (u, v)
 * decides, unfiltered.
 */
#ifndef HEMIBAKE_CORE_SCENE_CUTOUT_H
#define HEMIBAKE_CORE_SCENE_CUTOUT_H

#include <stdbool.h>
#include <stdint.h>

typedef enum cutout_wrap { CUTOUT_REPEAT, CUTOUT_CLAMP, CUTOUT_MIRROR } cutout_wrap;

typedef struct cutout_map {
    const uint8_t *alpha; /* alpha[row*width+column], row 0 at v = 0 */
    uint32_t width, height;
    cutout_wrap wrap[2];
    double cutoff; /* of alpha / 255 times w */
} cutout_map;

/* How one surface lies on its map: number k is row[k][0..2] . x + row[k][3], k = u, v, w. */
typedef struct cutout {
    const cutout_map *map;
    double row[3][4];
} cutout;

/* The affine functions that have values[3*i+k] at corner i of a triangle; constant if it has no area. */
cutout cutout_over_triangle(const cutout_map *map, const double *const corner[3], const double values[9]);

/* u, v, w at a place of the surface. */
void cutout_place(const cutout *c, const double point[3], double uvw[3]);

bool cutout_is_hole(const cutout *c, const double point[3]);

/* The share of a planar convex polygon of 3 or 4 corners that is no hole, from some hundreds of points that are spread
 * evenly without a grid, which stripes could fall in step with; at least 1e-6, so that nothing is divided by zero. */
double cutout_coverage(const cutout *c, const double *const corner[4], int corner_count);

#endif
