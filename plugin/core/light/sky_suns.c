/* SPDX-License-Identifier: MIT
 * See sky_suns.h.
 */
#include "light/sky_suns.h"

#include "geometry/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Steradians in which suns and what glows around them are searched: a disc of 11 degrees. */
static const double AREA = 0.03;

/* Radians around its brightest texel that are one sun's: two thirds of that disc. */
static const double RADIUS = 0.064;

/* What a sun gives of all light, at least. Of less rays are as good. */
static const double LEAST_SHARE = 0.01;

/* So many bright places are looked at: a glint may be brighter than the sun. */
enum { TRIES = 32 };

/* Texels by how bright they are: floats in the order of their first bits, a sixteenth of each power of two apart. */
enum { BINS = 4096, BIN_SHIFT = 19 };

typedef struct bright_texel {
    double direction[3], above[3]; /* above: W/m2 beyond what is left, of a surface that faces it */
    double brightness, solid_angle;
    double distance; /* radians from a sun's centre */
} bright_texel;

typedef struct sun_search {
    const sky_image *image;
    bright_texel *texels;
    size_t count;
    double limit, all; /* brightness that is left; W/m2 of all directions, mean of the bands */
} sun_search;

static double brightness_of(const sky_image *image, size_t texel) {
    const float *L = image->radiance + 3 * texel;
    return ((double)L[0] + (double)L[1] + (double)L[2]) / 3.0;
}

static double solid_angle_of_row(const sky_image *image, uint32_t row) {
    double high = PI * (0.5 - (double)row / image->height), low = PI * (0.5 - (double)(row + 1) / image->height);
    return 2 * PI / image->width * (sin(high) - sin(low));
}

static size_t bin_of(double brightness) {
    float value = (float)brightness;
    uint32_t bits;
    if (!(value > 0.0f)) return 0; /* a zero may have a sign */
    memcpy(&bits, &value, sizeof bits);
    return bits >> BIN_SHIFT;
}

/* The upper end of a bin. */
static double bin_end(size_t bin) {
    uint32_t bits = (uint32_t)(bin + 1) << BIN_SHIFT;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* What is brighter covers no more than AREA. */
static void set_limit(sun_search *s, double *solid_angles) {
    const sky_image *image = s->image;
    for (uint32_t row = 0; row < image->height; row++) {
        const double each = solid_angle_of_row(image, row);
        for (uint32_t column = 0; column < image->width; column++) {
            const double brightness = brightness_of(image, (size_t)row * image->width + column);
            s->all += each * brightness;
            solid_angles[bin_of(brightness)] += each;
        }
    }
    size_t bin = BINS;
    for (double sum = 0.0; bin > 0 && sum + solid_angles[bin - 1] <= AREA; bin--) sum += solid_angles[bin - 1];
    s->limit = bin > 0 ? bin_end(bin - 1) : 0.0;
}

/* Where nothing is as bright the limit may be no number. */
static bool is_bright(const sun_search *s, double brightness) {
    return brightness > s->limit;
}

static size_t count_bright(const sun_search *s) {
    size_t count = 0, texels = (size_t)s->image->width * s->image->height;
    for (size_t i = 0; i < texels; i++) count += is_bright(s, brightness_of(s->image, i));
    return count;
}

static void list_bright(sun_search *s) {
    const sky_image *image = s->image;
    for (uint32_t row = 0; row < image->height; row++)
        for (uint32_t column = 0; column < image->width; column++) {
            const size_t at = (size_t)row * image->width + column;
            const double brightness = brightness_of(image, at);
            if (!is_bright(s, brightness)) continue;
            bright_texel *t = &s->texels[s->count++];
            *t = (bright_texel){ .brightness = brightness, .solid_angle = solid_angle_of_row(image, row) };
            sky_image_direction(image, row, column, t->direction);
            for (size_t c = 0; c < 3; c++)
                t->above[c] = (double)image->radiance[3 * at + c] * (1.0 - s->limit / brightness) * t->solid_angle;
        }
}

static int compare_distances(const void *a, const void *b) {
    const bright_texel *x = a, *y = b;
    return (x->distance > y->distance) - (x->distance < y->distance);
}

static double flux_of(const bright_texel *t) {
    return (t->above[0] + t->above[1] + t->above[2]) / 3.0;
}

/* A disc has half of its light within 1/sqrt(2) of its radius; what glows around the sun must not make it as wide. The
 * texels that are taken for it come first. */
static double diameter_of(sun_search *s, const double center[3], size_t taken, double flux) {
    for (size_t i = 0; i < taken; i++) {
        bright_texel *t = &s->texels[i];
        const double apart = vec3_distance(t->direction, center);
        t->distance = sqrt(apart * apart + t->solid_angle / 6.0); /* rms of a square's points */
    }
    qsort(s->texels, taken, sizeof *s->texels, compare_distances);
    double sum = 0.0;
    size_t i = 0;
    while (i + 1 < taken && (sum += flux_of(&s->texels[i])) < 0.5 * flux) i++;
    return 2 * sqrt(2.0) * s->texels[i].distance;
}

/* Takes the texels around the brightest from those that are left. False: they are no sun. */
static bool take_sun(sun_search *s, const double radiance[3], double center[3], punctual *sun) {
    size_t brightest = 0, taken = 0;
    double intensity[3] = { 0, 0, 0 }, mean[3] = { 0, 0, 0 }, flux = 0.0;
    for (size_t i = 1; i < s->count; i++)
        if (s->texels[i].brightness > s->texels[brightest].brightness) brightest = i;
    vec3_copy(center, s->texels[brightest].direction);
    for (size_t i = 0; i < s->count; i++) {
        const bright_texel t = s->texels[i];
        if (vec3_dot(t.direction, center) < cos(RADIUS)) continue;
        flux += flux_of(&t);
        vec3_add_scaled(mean, mean, flux_of(&t), t.direction);
        vec3_add_scaled(intensity, intensity, 1.0, t.above);
        s->texels[i] = s->texels[taken], s->texels[taken++] = t;
    }
    vec3_normalize(mean);
    *sun = (punctual){ .kind = PUNCTUAL_DIRECTIONAL, .angular_diameter = diameter_of(s, mean, taken, flux) };
    for (int c = 0; c < 3; c++) sun->intensity[c] = radiance[c] * intensity[c], sun->direction[c] = -mean[c];
    s->texels += taken, s->count -= taken;
    return flux >= LEAST_SHARE * s->all;
}

bool sky_suns_find(allocator *memory, const double radiance[3], sky_image *image, punctual *suns, size_t *count) {
    sun_search s = { .image = image };
    double *solid_angles = block_zeroed(memory, BINS, sizeof *solid_angles);
    *count = 0;
    if (!solid_angles) return false;
    set_limit(&s, solid_angles);
    block_free(solid_angles);
    bright_texel *all = s.texels = block_new(memory, (count_bright(&s) + 1) * sizeof *s.texels);
    if (!all) return false;
    list_bright(&s);
    for (int tries = 0; tries < TRIES && *count < SKY_IMAGE_SUNS && s.count > 0; tries++)
        *count += take_sun(&s, radiance, image->sun[*count], &suns[*count]);
    image->sun_count = *count, image->limit = s.limit, image->cos_of_sun = cos(RADIUS);
    block_free(all);
    return true;
}
