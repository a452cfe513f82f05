/* SPDX-License-Identifier: MIT
 * Is the ground, or a dome that glows, far larger than what is on or in it, and how large are elements out there?
 *
 * A street of a hundred metres on a plane of two kilometres would get elements as wide as its houses, if they were
 * shared out over all area alike. They are shared out over what lies by the things instead, and away from these they
 * grow with the distance.
 */
#ifndef HEMIBAKE_TESSELLATE_WIDE_GROUND_H
#define HEMIBAKE_TESSELLATE_WIDE_GROUND_H

#include <hemibake/hemibake.h>

#include <stdbool.h>

typedef struct wide_ground {
    bool is_there;
    bool is_plane;            /* all of it lies in one plane, so that none of it is in the shade of another part */
    double center[3], radius; /* of a ball around all that is neither, m, world */
    double low[3], high[3];   /* the box around that and what is beside it */
} wide_ground;

/* A scene, as far as it is asked for here. */
typedef struct wide_ground_scene {
    const hemi_mesh_desc *meshes;
    size_t mesh_count;
    const hemi_material_desc *materials; /* of the meshes */
    const hemi_light_desc *lights;       /* point and spot lights are among the things */
    size_t light_count;
} wide_ground_scene;

/* What elements are shared out over, m2: the area of all triangles, or, where that is much less, of what is neither
 * and of the ground beside it. */
double wide_ground_find(const wide_ground_scene *in, wide_ground *out);

/* How large elements at an edge are at least, m: 0 by the things, and where no ground is wide. It is the same for both
 * orders of the ends. */
double wide_ground_size(const wide_ground *g, const double p[3], const double q[3]);

#endif
