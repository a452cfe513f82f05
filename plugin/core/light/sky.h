/* SPDX-License-Identifier: MIT
 * How much light comes from each part of the sky? The sphere around the scene, y up, as patches: Tregenza's 145 for
 * each hemisphere [Tregenza87], or Reinhart's, whose rows and patches are `fineness` times as many [Reinhart00].
 *
 *     rows of height 90 / (7 fineness + 1/2) degrees, each of 30 30 24 24 18 12 6 patches, times fineness; a cap on top
 *
 * Of each patch two integrals over its solid angle are kept, so that an unobstructed surface gets its irradiance
 * without an error from the subdivision: flux = int L dw and mean direction = int L w dw / flux. Whether the patch is
 * seen is decided in one direction inside it.
 */
#ifndef HEMIBAKE_CORE_LIGHT_SKY_H
#define HEMIBAKE_CORE_LIGHT_SKY_H

#include "light/sky_image.h"

typedef struct sky_patch {
    double toward[3];  /* unit: where its visibility is looked at */
    double flux[3];    /* int L dw, W/m2 */
    double mean[3][3]; /* mean[c]: int L w dw / flux[c]; shorter than 1 */
    double half;       /* about half its width, as a difference of cosines near the horizon of a surface */
} sky_patch;

typedef struct sky {
    sky_patch *patches; /* from block_new */
    size_t patch_count;
} sky;

/* How many patches both hemispheres have. */
size_t sky_patch_count(int fineness);

/* radiance[c] everywhere, times the image's if there is one. Patches without light are left out. False when out of
 * memory. */
bool sky_create(allocator *memory, const double radiance[3], const sky_image *image, int fineness, sky *out);
void sky_free(sky *s);

/* Irradiance of a surface (unit normal) that sees a patch where it looks; false: it is behind. */
bool sky_patch_irradiance(const sky_patch *p, const double normal[3], double E[3]);

#endif
