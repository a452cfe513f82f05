/* SPDX-License-Identifier: MIT
 * Does this surface stand between these two points? An item buffer says which surface may; this says whether it does,
 * in double precision, so that the edge of a shadow is not the edge of a pixel.
 */
#ifndef HEMIBAKE_CORE_VISIBILITY_OCCLUSION_H
#define HEMIBAKE_CORE_VISIBILITY_OCCLUSION_H

#include "scene/scene.h"

/* Where the segment from -> to crosses the surface's plane, as a fraction of it. False when it runs along the plane. */
bool occlusion_crossing(const surface *f, const double from[3], const double to[3], double *t);

/* Is the point at fraction t of the segment inside the surface's polygon? */
bool occlusion_inside(const scene *s, const surface *f, const double from[3], const double to[3], double t);

#endif
