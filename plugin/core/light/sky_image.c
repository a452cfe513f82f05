/* SPDX-License-Identifier: MIT
 * See sky_image.h.
 */
#include "light/sky_image.h"

#include "geometry/vec3.h"

#include <math.h>

/* Texels of 0.7 degrees, which stay in a processor's cache: a panorama of 8192 x 4096 took every bake 7 seconds. */
enum { ROWS_MOST = 256, COLUMNS_MOST = 512 };

void sky_image_toward(double altitude, double azimuth, double out[3]) {
    out[0] = cos(altitude) * cos(azimuth);
    out[1] = sin(altitude);
    out[2] = cos(altitude) * sin(azimuth);
}

void sky_image_direction(const sky_image *image, uint32_t row, uint32_t column, double out[3]) {
    const double altitude = PI * (0.5 - (row + 0.5) / image->height);
    sky_image_toward(altitude, 2 * PI * ((column + 0.5) / image->width - 0.5), out);
}

void sky_image_radiance(const sky_image *image, uint32_t row, uint32_t column, double L[3]) {
    const float *texel = image->radiance + 3 * ((size_t)row * image->width + column);
    double direction[3], brightness = ((double)texel[0] + (double)texel[1] + (double)texel[2]) / 3.0;
    for (int c = 0; c < 3; c++) L[c] = (double)texel[c];
    if (image->sun_count == 0 || !(brightness > image->limit)) return;
    sky_image_direction(image, row, column, direction);
    for (size_t i = 0; i < image->sun_count; i++) {
        if (vec3_dot(direction, image->sun[i]) < image->cos_of_sun) continue;
        for (int c = 0; c < 3; c++) L[c] *= image->limit / brightness;
        return;
    }
}

void sky_image_radiance_toward(const sky_image *image, const double direction[3], double L[3]) {
    const double u = 0.5 + atan2(direction[2], direction[0]) / (2 * PI), v = 0.5 - asin(direction[1]) / PI;
    const uint32_t column = (uint32_t)fmin(fmax(u * image->width, 0.0), image->width - 1.0);
    const uint32_t row = (uint32_t)fmin(fmax(v * image->height, 0.0), image->height - 1.0);
    sky_image_radiance(image, row, column, L);
}

/* Each texel belongs to the one that its middle lies in; sums[4*i+3]: what those of texel i weigh. */
static void add_texels(const sky_image *image, uint32_t rows, uint32_t columns, double *sums) {
    for (uint32_t row = 0; row < image->height; row++) {
        const double weight = cos(PI * row / image->height) - cos(PI * (row + 1.0) / image->height);
        const size_t first = (size_t)((row + 0.5) * rows / image->height) * columns;
        for (uint32_t column = 0; column < image->width; column++) {
            double L[3], *to = sums + 4 * (first + (size_t)((column + 0.5) * columns / image->width));
            sky_image_radiance(image, row, column, L);
            vec3_add_scaled(to, to, weight, L);
            to[3] += weight;
        }
    }
}

bool sky_image_reduce(allocator *memory, sky_image *image, float **texels) {
    const uint32_t rows = image->height < ROWS_MOST ? image->height : ROWS_MOST;
    const uint32_t columns = image->width < COLUMNS_MOST ? image->width : COLUMNS_MOST;
    const size_t count = (size_t)rows * columns;
    *texels = NULL;
    if (rows == image->height && columns == image->width) return true;
    double *sums = block_zeroed(memory, 4 * count, sizeof *sums);
    *texels = block_new(memory, 3 * count * sizeof **texels);
    if (sums && *texels) {
        add_texels(image, rows, columns, sums);
        for (size_t i = 0; i < 3 * count; i++)
            (*texels)[i] = (float)(sums[4 * (i / 3) + i % 3] / sums[4 * (i / 3) + 3]);
        *image = (sky_image){ .radiance = *texels, .width = columns, .height = rows };
    }
    block_free(sums);
    return sums && *texels;
}
