/* SPDX-License-Identifier: MIT
 * Does any surface of the scene stand between two points? For the paths of light that pass what is cut out by a
 * texture: a pixel of an item buffer names one surface, and through a hole smaller than a pixel there are others
 * behind. Such pixels are marked (item_buffer.h), and only the paths through them are asked for here.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_SURFACE_BVH_H
#define HEMIBAKE_CORE_VISIBILITY_SURFACE_BVH_H

#include "scene/scene.h"

typedef struct surface_bvh surface_bvh;

/* Of all sheets (surface_sheet). NULL when out of memory. */
surface_bvh *surface_bvh_create(const scene *s);
void surface_bvh_destroy(surface_bvh *tree); /* NULL is fine */

/* Exactly, holes included. own: the sheet that the path ends on, which does not count. */
bool surface_bvh_blocks(const surface_bvh *tree, const scene *s, uint32_t own, const double from[3],
                        const double to[3]);

#endif
