/* SPDX-License-Identifier: MIT
 * Which triangle does a ray hit first? Embree's tree of the triangles of an item geometry (embree.c).
 *
 * Embree's kernels differ by instruction set in their last bits, so its device is opened with one that every x86-64
 * processor of the last ten years has: the same input gives the same bytes.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_RAY_TREE_H
#define HEMIBAKE_CORE_VISIBILITY_RAY_TREE_H

#include "visibility/item_buffer.h"

typedef struct ray_tree ray_tree;

/* u, v: weights of the second and third corner. distance: in lengths of the direction. */
typedef struct ray_tree_hit {
    uint32_t triangle;
    float distance, u, v;
} ray_tree_hit;

/* Of triangles, whose positions are copied. NULL: message says why; a build may be without Embree. */
ray_tree *ray_tree_create(allocator *memory, const item_geometry *items, char *message, size_t message_size);
void ray_tree_destroy(ray_tree *t); /* NULL is fine */

/* Does a hit count? Asked in any order, also of hits that are further than the first. */
typedef bool (*ray_tree_accept)(void *user, const ray_tree_hit *hit);

/* From a place, in the frame of the positions. accept may be NULL. False: nothing is hit from near to far. Any number
 * of threads at a time. */
bool ray_tree_first(const ray_tree *t, const float from[3], const float direction[3], float near, float far,
                    ray_tree_accept accept, void *user, ray_tree_hit *out);

#endif
