/* SPDX-License-Identifier: MIT
 * Which part of a polygon does a point see past these blockers? Exactly: from the point, every blocker cuts a pyramid
 * out of what lies behind it, and what is left of the polygon is a list of convex fragments. With the closed form over
 * the fragments, the form factor of a partly hidden polygon is as exact as that of a free one.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_VISIBLE_PART_H
#define HEMIBAKE_CORE_VISIBILITY_VISIBLE_PART_H

#include "base/block.h"
#include "geometry/polygon.h"

/* A convex polygon that may stand between a shooter and a receiver. */
typedef struct blocker {
    polygon shape;
    double normal[3]; /* unit */
    double plane;     /* normal . x on the blocker */
} blocker;

typedef struct blocker_list {
    blocker *blockers;
    size_t count, capacity;
    allocator *memory; /* NULL: the C library */
} blocker_list;

/* Two polygons that face each other, and the planes they lie in (unit normals to the fronts). */
typedef struct facing_pair {
    const polygon *a, *b;
    const double *normal_a, *normal_b;
    double plane_a, plane_b;
    double margin; /* m: what is nearer than this to a plane lies in it */
} facing_pair;

/* Adds the part of a convex polygon that lies in front of both planes, if it reaches into the convex hull of the two
 * polygons. False when out of memory. */
bool blocker_list_add(blocker_list *list, const facing_pair *pair, const polygon *shape, const double normal[3],
                      double plane);
void blocker_list_free(blocker_list *list);

/* Form factor from a small area (point in the plane of pair->a or in front of it, unit normal) to what it sees of
 * target, which lies above its horizon. *lost is set when the fragments outgrew their room and the rest was left
 * unblocked; it is never cleared. */
double visible_factor(const blocker_list *list, const polygon *target, const double point[3], const double normal[3],
                      double margin, bool *lost);

#endif
