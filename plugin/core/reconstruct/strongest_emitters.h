/* SPDX-License-Identifier: MIT
 * Which emitters does a point ask for one by one? Few: all whose front it sees. Where a picture glows on thousands of
 * patches, what hides which part of each takes too long: the strongest are asked for, as they were if nothing hid any,
 * and the rest is left to a hemi-cube, as all other light is. Of what lets light through, as the bodies of lamps do, a
 * hemi-cube shows nothing: the strongest of it stand for the rest.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_STRONGEST_EMITTERS_H
#define HEMIBAKE_CORE_RECONSTRUCT_STRONGEST_EMITTERS_H

#include "mesh/mesh.h"

/* Beyond MAX emitters the STRONGEST are chosen. */
enum { STRONGEST_EMITTERS_MAX = 256, STRONGEST_EMITTERS_POLYGONS = 64 };

typedef struct strong_emitter {
    uint32_t patch;
    double light; /* sum of rgb without what hides it; 0 where all are asked for */
    double share; /* what it gives of its factor: less by its holes, more where it stands for others */
} strong_emitter;

/* emitters[i]: patches that emit, radiance[3*i+c]. Fills chosen, which has room for all of them; returns how many. */
size_t strongest_emitters_choose(const scene *s, const mesh *m, const uint32_t *emitters, const double *radiance,
                                 size_t emitter_count, const double point[3], const double normal[3],
                                 strong_emitter *chosen);

#endif
