/* SPDX-License-Identifier: MIT
 * Is what was baked black, and why? A viewer shows black alike where a material is black, where vertex colours are 0
 * and where no light gets; what has to be done about it differs.
 */
#ifndef HEMIBAKE_CLI_BLACKNESS_H
#define HEMIBAKE_CLI_BLACKNESS_H

#include "shut_in.h"

enum { BLACKNESS_LINE_SIZE = 512 };

typedef struct blackness {
    double dark_fraction;           /* of the vertices of what does not emit: below 1/255 as they are shown */
    double reflecting_fraction;     /* of the area of what does not emit: on meshes that show any light */
    char line[BLACKNESS_LINE_SIZE]; /* what is black and what to do; empty: nothing is wrong */
} blackness;

/* Radiance that shows as nothing with an exposure. */
double blackness_unlit(double ev);

/* views: of each mesh, in linear Rec.709. ev: what they are shown with. cameras_are_dark: all that the asset's cameras
 * see is unlit. */
void blackness_find(const lights_from *from, const hemi_mesh_view *views, double ev, bool cameras_are_dark,
                    const shut_in *shut, blackness *out);

#endif
