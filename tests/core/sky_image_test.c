/* SPDX-License-Identifier: MIT
 * Is a panorama of fewer texels as bright as it was, everywhere, and is what a direction shows the texel there?
 */
#include "check.h"

#include "geometry/vec3.h"
#include "light/sky_image.h"

#include <math.h>
#include <stdlib.h>

/* Light that differs by band, by row and by column. */
static sky_image panorama(uint32_t width, uint32_t height) {
    float *texels = malloc(3 * (size_t)width * height * sizeof *texels);
    for (uint32_t row = 0; row < height; row++)
        for (uint32_t column = 0; column < width; column++)
            for (uint32_t c = 0; c < 3; c++) {
                const double v = (row + 0.5) / height, u = (column + 0.5) / width;
                texels[3 * ((size_t)row * width + column) + c] =
                    (float)(2 + c + sin(20 * v + c) * cos(2 * PI * 9 * u) + (row + column) % 2);
            }
    return (sky_image){ .radiance = texels, .width = width, .height = height };
}

/* int L max(w . n, 0) dw of a band, texel by texel. */
static double irradiance(const sky_image *image, const double normal[3], int band) {
    double sum = 0.0;
    for (uint32_t row = 0; row < image->height; row++) {
        const double high = cos(PI * row / image->height), low = cos(PI * (row + 1) / image->height);
        for (uint32_t column = 0; column < image->width; column++) {
            double direction[3], L[3];
            sky_image_direction(image, row, column, direction);
            sky_image_radiance(image, row, column, L);
            sum += fmax(vec3_dot(direction, normal), 0.0) * L[band] * (high - low) * 2 * PI / image->width;
        }
    }
    return sum;
}

static void compare_light(const sky_image *before, const sky_image *after, double bound) {
    for (int i = 0; i < 9; i++) {
        double normal[3];
        sky_image_toward(1.5 - 0.4 * i, 2.0 * i, normal);
        CHECK_NEAR(irradiance(after, normal, i % 3) / irradiance(before, normal, i % 3), 1.0, bound);
    }
}

static void reduce(uint32_t width, uint32_t height, uint32_t expected_width, uint32_t expected_height) {
    const sky_image large = panorama(width, height);
    sky_image image = large;
    float *texels;
    CHECK(sky_image_reduce(NULL, &image, &texels));
    CHECK(texels && image.radiance == texels);
    CHECK_EQUAL(image.width, expected_width);
    CHECK_EQUAL(image.height, expected_height);
    compare_light(&large, &image, 5e-4);
    block_free(texels), free((void *)large.radiance);
}

static void a_large_panorama_becomes_one_of_fewer_texels_and_the_same_light(void) {
    reduce(2048, 1024, 512, 256);
    reduce(1500, 700, 512, 256);
    reduce(1024, 200, 512, 200);
}

static void a_small_one_stays(void) {
    const sky_image small = panorama(512, 256);
    sky_image image = small;
    float *texels;
    CHECK(sky_image_reduce(NULL, &image, &texels));
    CHECK(!texels && image.radiance == small.radiance);
    free((void *)small.radiance);
}

/* What was made a light of its own does not come back. */
static void a_sun_that_was_taken_is_left_out(void) {
    sky_image image = panorama(2048, 1024);
    float *bright = (float *)image.radiance + 3 * (300 * 2048 + 1000), *texels;
    for (int c = 0; c < 3; c++) bright[c] = 1e6f;
    sky_image_direction(&image, 300, 1000, image.sun[0]);
    image.sun_count = 1, image.cos_of_sun = cos(0.01), image.limit = 8;
    const float *given = image.radiance;
    CHECK(sky_image_reduce(NULL, &image, &texels));
    CHECK_EQUAL(image.sun_count, 0);
    for (size_t i = 0; i < 3 * (size_t)image.width * image.height; i++) CHECK(image.radiance[i] < 8);
    block_free(texels), free((void *)given);
}

static void a_direction_shows_the_texel_there(void) {
    const sky_image image = panorama(32, 16);
    for (uint32_t row = 0; row < 16; row++)
        for (uint32_t column = 0; column < 32; column++) {
            double direction[3], L[3], expected[3];
            sky_image_direction(&image, row, column, direction);
            sky_image_radiance(&image, row, column, expected);
            sky_image_radiance_toward(&image, direction, L);
            CHECK_NEAR(vec3_distance(L, expected), 0.0, 0.0);
        }
    free((void *)image.radiance);
}

int main(void) {
    RUN(a_large_panorama_becomes_one_of_fewer_texels_and_the_same_light);
    RUN(a_small_one_stays);
    RUN(a_sun_that_was_taken_is_left_out);
    RUN(a_direction_shows_the_texel_there);
    return check_end();
}
