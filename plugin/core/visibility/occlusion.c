/* SPDX-License-Identifier: MIT
 * See occlusion.h.
 */
#include "visibility/occlusion.h"

#include "base/tolerance.h"

bool occlusion_inside(const scene *s, const surface *f, const double from[3], const double to[3], double t) {
    int count = surface_corner_count(f);
    double direction[3], point[3];
    vec3_sub(direction, to, from);
    vec3_add_scaled(point, from, t, direction);
    for (int i = 0; i < count; i++) {
        const double *a = scene_vertex(s, f->corner[i]), *b = scene_vertex(s, f->corner[(i + 1) % count]);
        double edge[3], offset[3], side[3];
        vec3_sub(edge, b, a);
        vec3_sub(offset, point, a);
        vec3_cross(side, edge, offset);
        /* The cross product is the edge's length times the distance inside. */
        if (vec3_dot(side, f->normal) < -TOLERANCE_EDGE * s->radius * vec3_length(edge)) return false;
    }
    return !f->holes || !cutout_is_hole(f->holes, point);
}
