/* SPDX-License-Identifier: MIT
 * Where is a surface, and where is a hole in it? A leaf is a quad, and a picture of its alpha says which parts of the
 * quad are leaf (alphaMode MASK of glTF):
 *
 *     hole at x   <=>   alpha(u(x), v(x)) w(x) < cutoff
 *
 * with u, v, w affine in the place on a surface, since they interpolate linearly over it. The texel that holds (u, v)
 * decides, unfiltered.
 */
#ifndef HEMIBAKE_CORE_SCENE_ALPHA_MASK_H
#define HEMIBAKE_CORE_SCENE_ALPHA_MASK_H

#include <stdbool.h>
#include <stdint.h>

typedef enum alpha_mask_wrap { ALPHA_MASK_REPEAT, ALPHA_MASK_CLAMP, ALPHA_MASK_MIRROR } alpha_mask_wrap;

typedef struct alpha_mask_map {
    const uint8_t *alpha; /* alpha[row*width+column], row 0 at v = 0 */
    uint32_t width, height;
    alpha_mask_wrap wrap[2];
    double cutoff; /* of alpha / 255 times w */
} alpha_mask_map;

/* How one surface lies on its map: number k is row[k][0..2] . x + row[k][3], k = u, v, w. */
typedef struct alpha_mask {
    const alpha_mask_map *map;
    double row[3][4];
} alpha_mask;

/* The affine functions that have values[3*i+k] at corner i of a triangle; constant if it has no area. */
alpha_mask alpha_mask_over_triangle(const alpha_mask_map *map, const double *const corner[3], const double values[9]);

/* u, v, w at a place of the surface. */
void alpha_mask_place(const alpha_mask *c, const double point[3], double uvw[3]);

bool alpha_mask_is_hole(const alpha_mask *c, const double point[3]);
/* Alpha times w. */
double alpha_mask_map_alpha(const alpha_mask_map *m, const double uvw[3]);
bool alpha_mask_map_is_hole(const alpha_mask_map *m, const double uvw[3]);

/* The share of a planar convex polygon of 3 or 4 corners that is no hole, from some hundreds of points that are spread
 * evenly without a grid, which stripes could fall in step with; at least 1e-6, so that nothing is divided by zero. */
double alpha_mask_coverage(const alpha_mask *c, const double *const corner[4], int corner_count);

#endif
