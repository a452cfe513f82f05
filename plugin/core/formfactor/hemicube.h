/* SPDX-License-Identifier: MIT
 * What does a point on a surface see? A hemi-cube [Cohen85]: five item buffers on half a cube around the normal.
 *
 * Pixels, resolution N (even), rows from 0:      tangent x bitangent = normal; turned about the normal by an angle
 *
 *     0 .. N       top      x along tangent, y along bitangent       the four sides, each N x N/2, y along the normal:
 *     N .. 3N/2    side 0   forward +tangent,   x along bitangent    +---------+
 *     3N/2 .. 2N   side 1   forward -tangent,   x along bitangent    |   top   |   N x N
 *     2N .. 5N/2   side 2   forward +bitangent, x along tangent      +---------+
 *     5N/2 .. 3N   side 3   forward -bitangent, x along tangent      | sides.. |   4 of N x N/2
 */
#ifndef HEMIBAKE_CORE_FORMFACTOR_HEMICUBE_H
#define HEMIBAKE_CORE_FORMFACTOR_HEMICUBE_H

#include "formfactor/polygon.h"
#include "scene/scene.h"
#include "visibility/item_buffer.h"

typedef struct hemicube {
    int resolution;
    double eye[3], tangent[3], bitangent[3], normal[3];
    uint32_t *ids; /* ids[y*resolution+x]: triangle + 1 of the item geometry, 0 for the sky; perhaps with ITEM_MARK */
} hemicube;

/* Where the power that leaves the eye goes, as fractions that sum to 1. */
typedef struct hemicube_closure {
    double front, back, sky;
} hemicube_closure;

/* Places the hemi-cube on a surface; angle (radians) turns it about the normal. */
void hemicube_place(hemicube *h, const double eye[3], const double normal[3], double angle);

/* Draws it. center: what item positions are relative to. */
bool hemicube_draw(hemicube *h, item_buffer *items, const double center[3]);

/* The direction of the centre of pixel q, not normalised: its component along the largest axis of the cube is 1. */
void hemicube_direction(const hemicube *h, size_t q, double out[3]);

/* Sums the weights of the pixels that show fronts, backs and sky. triangle_surface[t]: the surface of triangle t. */
hemicube_closure hemicube_close(const hemicube *h, const double *weights, const scene *s,
                                const uint32_t *triangle_surface);

/* Is a point on a surface visible from the eye? The four pixels around its direction name the candidates; each is
 * tested exactly. Surfaces of less than a few pixels are decided by depth; past what has holes all surfaces are asked.
 * triangle_surface names sheets (surface_sheet). */
bool hemicube_sees(const hemicube *h, const scene *s, const uint32_t *triangle_surface, uint32_t surface_index,
                   const double point[3]);

/* Does something stand on the piece of surface around the eye, or pass through it? Looks along the surface, through the
 * lowest pixels of the sides. */
bool hemicube_is_crossed(const hemicube *h, const scene *s, const uint32_t *triangle_surface,
                         const polygon *floor_shape);

#endif
