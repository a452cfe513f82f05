/* SPDX-License-Identifier: MIT
 * What is near a segment, what is nearest to a point, and what is in any part of space? A binary tree of boxes around
 * whatever has a box, each cut in two halves of as many items along its longest side. What the items are is the
 * callers' business, who look at those of one leaf at a time.
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_BVH_H
#define HEMIBAKE_CORE_GEOMETRY_BVH_H

#include "base/jobs.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct bvh_node {
    float low[3], high[3];
    uint32_t first, count; /* of a leaf: its items; count 0: the children are nodes `first` and `first + 1` */
} bvh_node;

/* In the caller's memory. */
typedef struct bvh {
    bvh_node *nodes; /* twice as many as items */
    uint32_t *items; /* in the order of leaves */
    uint32_t node_count;
} bvh;

/* An item and the box around it. middle[k] is what items are sorted by along axis k, in any unit. */
typedef struct bvh_box {
    float low[3], high[3], middle[3];
    uint32_t item;
} bvh_box;

/* Sets the box around points; the middle is the sum of the points. What is no float is rounded outwards. */
void bvh_box_set(bvh_box *box, uint32_t item, const double (*points)[3], int count, double margin);

/* boxes: of all items; sorted by it. The same tree with any jobs, and with none (NULL). */
void bvh_build(jobs *j, bvh *tree, bvh_box *boxes, size_t count);

/* Does one of the items, which are those of a leaf that a segment meets, end the search? */
typedef bool (*bvh_stops)(void *user, const uint32_t *items, uint32_t count);

/* Asks about all leaves that the segment meets until one ends the search; true if one did. */
bool bvh_segment(const bvh *tree, const double from[3], const double to[3], bvh_stops stops, void *user);

/* The lesser of `least` and the distances of these items. */
typedef double (*bvh_nearest)(void *user, const uint32_t *items, uint32_t count, double least);

/* Asks about all leaves that are nearer to the point than `least`, which the answers make smaller; the nearer of two
 * boxes first. */
void bvh_closest(const bvh *tree, const double point[3], double least, bvh_nearest nearest, void *user);

/* May an item of this node be one that is looked for? */
typedef bool (*bvh_enters)(void *user, const bvh_node *node);

/* What is done with the items of a leaf; false ends the search. */
typedef bool (*bvh_takes)(void *user, const uint32_t *items, uint32_t count);

/* Goes through all leaves whose boxes, and those around them, may be entered; false if a leaf ended the search. */
bool bvh_visit(const bvh *tree, bvh_enters enters, bvh_takes takes, void *user);

#endif
