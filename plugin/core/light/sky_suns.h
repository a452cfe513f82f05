/* SPDX-License-Identifier: MIT
 * What in a panorama is so small and bright that it is looked to as a sun? Rays meet the sun of an outdoor panorama
 * once in thousands, and then it is all that their sample knows; a patch of the sky is looked at in one direction.
 *
 * The brightest AREA of the sphere is searched: what is brighter than the rest there, if it is a fair share of all
 * light. Around its brightest texel a disc is a sun; again, until no more is found. Texels in the discs are left as
 * bright as the brightest of the rest.
 */
#ifndef HEMIBAKE_CORE_LIGHT_SKY_SUNS_H
#define HEMIBAKE_CORE_LIGHT_SKY_SUNS_H

#include "light/punctual.h"
#include "light/sky.h"

/* Directional lights, W/m2 of a panorama times radiance[c], whose texels are dimmed in the image. *count: how many, at
 * most SKY_IMAGE_SUNS. False when out of memory. */
bool sky_suns_find(allocator *memory, const double radiance[3], sky_image *image, punctual *suns, size_t *count);

#endif
