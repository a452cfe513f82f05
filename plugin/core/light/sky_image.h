/* SPDX-License-Identifier: MIT
 * What does a panorama show, and how many texels of it are needed? The whole sphere, row 0 at the zenith, y up:
 * direction d is at column (1/2 + atan2(z, x) / 2 pi) width and row (1/2 - asin(y) / pi) height.
 */
#ifndef HEMIBAKE_CORE_LIGHT_SKY_IMAGE_H
#define HEMIBAKE_CORE_LIGHT_SKY_IMAGE_H

#include "base/block.h"

#include <stdint.h>

enum { SKY_IMAGE_SUNS = 8 };

typedef struct sky_image {
    const float *radiance; /* radiance[3*(row*width+column)+c], W/m2/sr */
    uint32_t width, height;
    /* Of sky_suns.h: texels this near to one of so many unit directions are no brighter than the limit, mean of bands.
     */
    size_t sun_count;
    double sun[SKY_IMAGE_SUNS][3], cos_of_sun, limit;
} sky_image;

/* Unit. The latter: to the middle of a texel. */
void sky_image_toward(double altitude, double azimuth, double out[3]);
void sky_image_direction(const sky_image *image, uint32_t row, uint32_t column, double out[3]);

/* Of a texel, and of the one in a unit direction. */
void sky_image_radiance(const sky_image *image, uint32_t row, uint32_t column, double L[3]);
void sky_image_radiance_toward(const sky_image *image, const double direction[3], double L[3]);

/* Where a panorama has more texels than light that is reflected diffusely has use for, *image is one of fewer, without
 * its suns, of *texels, a block. False when out of memory. */
bool sky_image_reduce(allocator *memory, sky_image *image, float **texels);

#endif
