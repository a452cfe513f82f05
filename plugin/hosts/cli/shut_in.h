/* SPDX-License-Identifier: MIT
 * Which light gets nowhere? Paths of light from wall to wall (geometry/light_walk.h) say which lamps light nothing but
 * what closely surrounds them, whether the sky that was asked for gets to anything, and how much of what is dark is
 * closed in.
 */
#ifndef HEMIBAKE_CLI_SHUT_IN_H
#define HEMIBAKE_CLI_SHUT_IN_H

#include "lights_from.h"
#include "name_list.h"

enum { SHUT_IN_LINE_SIZE = 512 };

typedef struct shut_in {
    char lamps[SHUT_IN_LINE_SIZE], sky[SHUT_IN_LINE_SIZE]; /* empty: nothing is wrong */
    double dark_fraction; /* of the area of what is baked: without light, and closed in, where there is room to stand */
    name_list dark;       /* meshes on which that is */
} shut_in;

/* views: of each mesh, in linear Rec.709. dark: radiance that shows as nothing. False: out of memory. */
bool shut_in_find(const lights_from *from, const hemi_mesh_view *views, double dark, const options *o, shut_in *out);

#endif
