/* SPDX-License-Identifier: MIT
 * What radiance leaves each place of a patch? The plane that fits its samples best: for whoever looks at a patch from
 * afar and cannot look at its elements.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_PATCH_LIGHT_H
#define HEMIBAKE_CORE_RECONSTRUCT_PATCH_LIGHT_H

#include "mesh/mesh.h"

enum { PATCH_LIGHT_BANDS = 3 };

/* Radiance over a patch: at its centre, and its slope along x, y, z. */
typedef struct patch_light {
    double center[3]; /* of its samples */
    double L[PATCH_LIGHT_BANDS], slope[PATCH_LIGHT_BANDS][3];
} patch_light;

/* By least squares. samples[3*s+c]: radiance; trust[s]: weight of sample s. */
void patch_light_fit(const scene *s, const mesh *m, const double *samples, const double *trust, uint32_t index,
                     patch_light *out);

#endif
