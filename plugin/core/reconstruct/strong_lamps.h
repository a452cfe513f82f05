/* SPDX-License-Identifier: MIT
 * Which lamps does a point ask for one by one? Few: all whose front it sees. Where a picture glows on thousands of
 * patches, what hides which part of each takes too long: the strongest are asked for, as they were if nothing hid any,
 * and the rest is left to a hemi-cube, as all other light is.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_STRONG_LAMPS_H
#define HEMIBAKE_CORE_RECONSTRUCT_STRONG_LAMPS_H

#include "formfactor/polygon.h"
#include "mesh/mesh.h"

/* Beyond MAX lamps the STRONGEST are chosen. */
enum { STRONG_LAMPS_MAX = 256, STRONG_LAMPS_STRONGEST = 64 };

typedef struct strong_lamp {
    uint32_t patch;
    double light; /* sum of rgb without what hides it; 0 where all are asked for */
} strong_lamp;

polygon strong_lamp_polygon(const mesh *m, uint32_t patch_index);

/* lamps[i]: patches that emit, radiance[3*i+c]. Fills chosen, which has room for all of them; returns how many. */
size_t strong_lamps_choose(const scene *s, const mesh *m, const uint32_t *lamps, const double *radiance,
                           size_t lamp_count, const double point[3], const double normal[3], strong_lamp *chosen);

#endif
