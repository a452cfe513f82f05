/* SPDX-License-Identifier: MIT
 * Which meshes lie in the place of an earlier one, corner for corner? Exporters write a primitive once for each of its
 * materials. The first is what others see and what is solved; the copies get the light that arrives there, and make of
 * it what their own materials do. Cages and what is cut out are taken as they are.
 */
#ifndef HEMIBAKE_API_COINCIDENT_H
#define HEMIBAKE_API_COINCIDENT_H

#include "freeze.h"

/* Sets f->copy_of, and leaves copies without triangles. False when out of memory. */
bool coincident_find(const hemi_scene *in, frozen *f);

/* What a copy makes of irradiance / pi at a vertex of the pieces of the mesh that it lies in. */
typedef struct coincident_light {
    double radiance[3], shown[3]; /* shown: what a texture that stays multiplies */
} coincident_light;

/* attributes: room for three times those of the mesh. */
void coincident_shade(const hemi_scene *in, const frozen *f, size_t copy, uint32_t vertex, const double incident[3],
                      double *attributes, coincident_light *out);

#endif
