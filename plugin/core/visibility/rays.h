/* SPDX-License-Identifier: MIT
 * Which piece of a mesh does a ray meet first? Embree's tree of its triangles (ray_tree.h), with what is in holes
 * passed by.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_RAYS_H
#define HEMIBAKE_CORE_VISIBILITY_RAYS_H

#include "visibility/mesh_items.h"

typedef struct rays rays;

/* Is Embree in this build? */
bool rays_are_there(void);

/* Of the triangles of items, which are used until rays_destroy. NULL: message says why; a build may be without. */
rays *rays_create(const scene *s, const mesh_items *items, char *message, size_t message_size);
void rays_destroy(rays *r); /* NULL is fine */

/* From now on rays end after so many metres, and see the sky. */
void rays_reach(rays *r, double metres);

/* What a ray meets: a piece whose front it is, the back of one, or nothing. */
typedef enum ray_end { RAY_FRONT, RAY_BACK, RAY_SKY } ray_end;

/* From a point of the scene along a unit direction; *piece is set for RAY_FRONT, *distance unless it is the sky. Any
 * number of threads at a time. */
ray_end rays_measure(const rays *r, const double from[3], const double direction[3], uint32_t *piece, double *distance);

#endif
