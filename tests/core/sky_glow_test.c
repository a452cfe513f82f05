/* SPDX-License-Identifier: MIT
 * Are directions drawn from what is bright in a panorama, as densely as is said? Patches of light on even skies.
 */
#include "check.h"

#include "geometry/vec3.h"
#include "light/sky_glow.h"

#include <math.h>
#include <stdlib.h>

/* Of radiance 1, but where rows and columns are in a patch. */
static sky_image panorama(uint32_t width, uint32_t height) {
    float *texels = malloc(3 * (size_t)width * height * sizeof *texels);
    for (size_t i = 0; i < 3 * (size_t)width * height; i++) texels[i] = 1.0f;
    return (sky_image){ .radiance = texels, .width = width, .height = height };
}

static void set_patch(sky_image *image, uint32_t row, uint32_t column, uint32_t size, float radiance) {
    float *texels = (float *)image->radiance;
    for (uint32_t r = row; r < row + size; r++)
        for (uint32_t c = column; c < column + size; c++)
            for (size_t k = 0; k < 3; k++) texels[3 * ((size_t)r * image->width + c) + k] = radiance;
}

static sky_glow *find(const sky_image *image) {
    sky_glow *g;
    CHECK(sky_glow_find(NULL, image, &g));
    return g;
}

static void radiance_of(const sky_image *image, const double direction[3], double L[3]) {
    const double u = 0.5 + atan2(direction[2], direction[0]) / (2 * PI), v = 0.5 - asin(direction[1]) / PI;
    sky_image_radiance(image, (uint32_t)fmin(v * image->height, image->height - 1.0),
                       (uint32_t)fmin(u * image->width, image->width - 1.0), L);
}

static void what_is_even_or_wide_or_dim_does_not_glow(void) {
    sky_image even = panorama(64, 32), wide = panorama(64, 32), dim = panorama(512, 256);
    set_patch(&wide, 0, 0, 32, 50);
    set_patch(&dim, 100, 100, 4, 20);
    CHECK(!find(&even));
    CHECK(!find(&wide));
    CHECK(!find(&dim));
    free((void *)even.radiance), free((void *)wide.radiance), free((void *)dim.radiance);
}

enum { POINTS = 128 };

/* The mean of radiance over density, which is what is drawn from of all light; the share of directions with x > 0. */
static double estimate(const sky_image *image, const sky_glow *g, double *share) {
    double sum = 0.0, east = 0.0;
    for (int i = 0; i < POINTS * POINTS; i++) {
        const double point[2] = { (i % POINTS + 0.5) / POINTS, ((double)(i / POINTS) + 0.5) / POINTS };
        double direction[3], L[3];
        sky_glow_direction(g, point, direction);
        CHECK_NEAR(vec3_dot(direction, direction), 1.0, 1e-12);
        const double pdf = sky_glow_pdf(g, direction);
        CHECK(pdf > 0.0);
        radiance_of(image, direction, L);
        sum += L[0] / pdf;
        east += direction[0] > 0.0;
    }
    *share = east / (POINTS * POINTS);
    return sum / (POINTS * POINTS);
}

static double solid_angle(const sky_image *image, uint32_t row, uint32_t size) {
    return 2 * PI * size / image->width * (cos(PI * row / image->height) - cos(PI * (row + size) / image->height));
}

/* The density over all of the sphere, on a spiral. */
static double integral(const sky_glow *g) {
    enum { COUNT = 1 << 19 };
    double sum = 0.0;
    for (int i = 0; i < COUNT; i++) {
        const double y = 1.0 - (2 * i + 1.0) / COUNT, across = sqrt(1.0 - y * y), turn = 2.399963229728653 * i;
        sum += sky_glow_pdf(g, (double[]){ across * cos(turn), y, across * sin(turn) });
    }
    return 4 * PI * sum / COUNT;
}

/* Two softboxes, of which the one to the west is three times as bright, and what little is around them. */
static void directions_are_drawn_by_how_bright_it_is(void) {
    sky_image image = panorama(256, 128);
    double share;
    set_patch(&image, 40, 20, 12, 300); /* x < 0 */
    set_patch(&image, 30, 120, 12, 100);
    sky_glow *g = find(&image);
    CHECK(g);
    const double west = 300 * solid_angle(&image, 40, 12), east = 100 * solid_angle(&image, 30, 12);
    CHECK_NEAR(estimate(&image, g, &share) / (west + east), 1.0, 0.03);
    CHECK_NEAR(share, east / (west + east), 0.01);
    CHECK_NEAR(integral(g), 1.0, 2e-3);
    CHECK_NEAR(sky_glow_pdf(g, (double[]){ 0, -1, 0 }), 0.0, 0.0);
    block_free(g), free((void *)image.radiance);
}

/* Texels may be larger than what is drawn from. */
static void a_panorama_may_be_small(void) {
    sky_image image = panorama(8, 4);
    double share;
    set_patch(&image, 1, 6, 1, 100);
    sky_glow *g = find(&image);
    CHECK(g);
    CHECK_NEAR(estimate(&image, g, &share) / (100 * solid_angle(&image, 1, 1)), 1.0, 0.01);
    CHECK_NEAR(integral(g), 1.0, 2e-3);
    block_free(g), free((void *)image.radiance);
}

int main(void) {
    RUN(what_is_even_or_wide_or_dim_does_not_glow);
    RUN(directions_are_drawn_by_how_bright_it_is);
    RUN(a_panorama_may_be_small);
    return check_end();
}
