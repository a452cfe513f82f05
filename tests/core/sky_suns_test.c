/* SPDX-License-Identifier: MIT
 * Are suns of a panorama found, as bright and wide as they are, and is what is left what they have not? Discs on skies.
 */
#include "check.h"

#include "geometry/vec3.h"
#include "light/sky_suns.h"

#include <math.h>
#include <stdlib.h>

enum { WIDTH = 512, HEIGHT = 256 };

static const double WHITE[3] = { 1, 1, 1 };

typedef struct found {
    float *texels;
    sky_image image;
    punctual suns[SKY_IMAGE_SUNS];
    size_t count;
} found;

/* Of radiance 1, 2, 3. */
static found even_sky(void) {
    found f = { .texels = malloc(3 * (size_t)WIDTH * HEIGHT * sizeof *f.texels) };
    for (size_t i = 0; i < 3 * (size_t)WIDTH * HEIGHT; i++) f.texels[i] = (float)(1 + i % 3);
    f.image = (sky_image){ .radiance = f.texels, .width = WIDTH, .height = HEIGHT };
    return f;
}

static void toward(double azimuth, double altitude, double out[3]) {
    vec3_copy(out, (double[]){ cos(altitude) * cos(azimuth), sin(altitude), cos(altitude) * sin(azimuth) });
}

/* Adds radiance to texels whose middles are so near to a direction; W/m2 of one band that these have. */
static double add_disc(found *f, const double direction[3], double radius, double radiance) {
    double sum = 0.0;
    for (uint32_t row = 0; row < HEIGHT; row++)
        for (uint32_t column = 0; column < WIDTH; column++) {
            double at[3];
            sky_image_direction(&f->image, row, column, at);
            if (vec3_dot(at, direction) < cos(radius)) continue;
            for (size_t c = 0; c < 3; c++) f->texels[3 * ((size_t)row * WIDTH + column) + c] += (float)radiance;
            sum += radiance * 2 * PI / WIDTH *
                   (sin(PI * (0.5 - (double)row / HEIGHT)) - sin(PI * (0.5 - (double)(row + 1) / HEIGHT)));
        }
    return sum;
}

static void search(found *f) {
    CHECK(sky_suns_find(NULL, WHITE, &f->image, f->suns, &f->count));
    CHECK_EQUAL(f->image.sun_count, f->count);
}

/* W/m2 of all directions, one band. */
static double flux_left(const found *f, int c) {
    sky s;
    double sum = 0.0;
    CHECK(sky_create(NULL, WHITE, &f->image, 1, &s));
    for (size_t i = 0; i < s.patch_count; i++) sum += s.patches[i].flux[c];
    sky_free(&s);
    return sum;
}

static void an_even_sky_has_no_sun(void) {
    found f = even_sky();
    search(&f);
    CHECK_EQUAL(f.count, 0);
    free(f.texels);
}

/* As a lamp's shade or a window: rays meet it often enough. */
static void what_is_wide_is_no_sun(void) {
    found f = even_sky();
    double direction[3];
    toward(1, 0.5, direction);
    add_disc(&f, direction, 0.3, 100);
    search(&f);
    CHECK_EQUAL(f.count, 0);
    free(f.texels);
}

/* Direction, light and width; and all that the panorama had is in the sun or left. */
static void a_sun_is_as_bright_and_wide_as_it_is_and_what_is_left_is_the_rest(void) {
    found f = even_sky();
    double direction[3];
    toward(-2, 0.7, direction);
    const double flux = add_disc(&f, direction, 0.03, 1e4);
    search(&f);
    CHECK_EQUAL(f.count, 1);
    const punctual *sun = &f.suns[0];
    CHECK_EQUAL(sun->kind, PUNCTUAL_DIRECTIONAL);
    /* Texels are 0.012 wide. */
    CHECK_NEAR(vec3_dot(sun->direction, direction), -1.0, 1e-5);
    CHECK_NEAR(sun->angular_diameter, 0.06, 0.006);
    for (int c = 0; c < 3; c++) {
        CHECK_NEAR(sun->intensity[c] / flux, 1.0, 1e-3);
        CHECK_NEAR(flux_left(&f, c) + sun->intensity[c], 4 * PI * (1 + c) + flux, 1e-4 * flux);
    }
    free(f.texels);
}

/* Half of its light within a sixth of the whole: the shadow's edge is as sharp as the middle is. */
static void what_glows_around_a_sun_does_not_widen_it(void) {
    found f = even_sky();
    double direction[3];
    toward(2, 0.3, direction);
    const double sharp = add_disc(&f, direction, 0.02, 1e4), glow = add_disc(&f, direction, 0.06, 300);
    search(&f);
    CHECK_EQUAL(f.count, 1);
    CHECK(glow > 0.2 * sharp);
    CHECK(f.suns[0].angular_diameter > 0.03 && f.suns[0].angular_diameter < 0.05);
    CHECK_NEAR(f.suns[0].intensity[0] / (sharp + glow), 1.0, 0.02);
    free(f.texels);
}

/* The glint is brighter than both suns. */
static void two_suns_and_a_glint_are_two_suns(void) {
    found f = even_sky();
    double first[3], second[3], glint[3];
    toward(-2, 0.7, first), toward(0.5, 1.1, second), toward(1.5, -0.4, glint);
    const double of_first = add_disc(&f, first, 0.03, 2e4), of_second = add_disc(&f, second, 0.02, 3e4);
    const double of_glint = add_disc(&f, glint, 0.006, 4e4 - 3e4);
    add_disc(&f, glint, 0.006, 3e4);
    search(&f);
    CHECK(of_glint > 0.0);
    CHECK_EQUAL(f.count >= 2, true);
    double found_first = 0.0, found_second = 0.0;
    for (size_t i = 0; i < f.count; i++) {
        if (vec3_dot(f.suns[i].direction, first) < -0.999) found_first += f.suns[i].intensity[1];
        if (vec3_dot(f.suns[i].direction, second) < -0.999) found_second += f.suns[i].intensity[1];
    }
    CHECK_NEAR(found_first / of_first, 1.0, 0.01);
    CHECK_NEAR(found_second / of_second, 1.0, 0.01);
    free(f.texels);
}

/* Of a black sky with one texel that shines all is the sun's; zeros may have a sign. */
static void a_lone_texel_is_a_sun_as_wide_as_it_is(void) {
    found f = even_sky();
    double direction[3];
    for (size_t i = 0; i < 3 * (size_t)WIDTH * HEIGHT; i++) f.texels[i] = i % 2 ? 0.0f : -0.0f;
    sky_image_direction(&f.image, 60, 100, direction);
    const double flux = add_disc(&f, direction, 1e-3, 1e4);
    search(&f);
    CHECK_EQUAL(f.count, 1);
    CHECK_NEAR(f.suns[0].intensity[2] / flux, 1.0, 1e-9);
    CHECK_NEAR(vec3_dot(f.suns[0].direction, direction), -1.0, 1e-12);
    CHECK(f.suns[0].angular_diameter > 0.008 && f.suns[0].angular_diameter < 0.016);
    free(f.texels);
}

int main(void) {
    RUN(an_even_sky_has_no_sun);
    RUN(what_is_wide_is_no_sun);
    RUN(a_sun_is_as_bright_and_wide_as_it_is_and_what_is_left_is_the_rest);
    RUN(what_glows_around_a_sun_does_not_widen_it);
    RUN(two_suns_and_a_glint_are_two_suns);
    RUN(a_lone_texel_is_a_sun_as_wide_as_it_is);
    return check_end();
}
