/* SPDX-License-Identifier: MIT
 * Does this surface stand between these two points? An item buffer says which surface may; this says whether it does,
 * in double precision, so that the edge of a shadow is not the edge of a pixel.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_OCCLUSION_H
#define HEMIBAKE_CORE_VISIBILITY_OCCLUSION_H

#include "scene/scene.h"

/* Where the segment from -> to crosses the surface's plane, as a fraction of it. False when both ends are on one side:
 * most candidates are, so it is told before anything is divided. */
static inline bool occlusion_crossing(const surface *f, const double from[3], const double to[3], double *t) {
    double a = surface_height(f, from), b = surface_height(f, to);
    if ((a > 0.0) == (b > 0.0)) return false;
    *t = a / (a - b);
    return true;
}

/* Is the point at fraction t of the segment inside the surface's polygon, and not in a hole? A pane hides nothing. */
bool occlusion_inside(const scene *s, const surface *f, const double from[3], const double to[3], double t);

/* Does a facet of a smooth surface hide light from a place that was lifted from it (mesh/shading_normals.h)? Where the
 * surface is hollow nothing is lifted, and light from behind the facet has come through it. */
bool occlusion_by_own(const scene *s, const surface *f, const double from[3], const double place[3]);

/* Decides by depth whether a surface too small for the item buffer hides a point of another: it stands before it, at
 * fraction t, by more than the bias. there, here: the footprint of a pixel at the small one and at the point, m. */
bool occlusion_by_small(const surface *f, const surface *own, const double from[3], const double to[3], double t,
                        double there, double here);

/* The edge, from corner i to the next, that the point at fraction t is furthest outside; -1 if it is inside all. */
int occlusion_edge_beside(const scene *s, const surface *f, const double from[3], const double to[3], double t);

#endif
