/* SPDX-License-Identifier: MIT
 * See sky_glow.h.
 */
#include "light/sky_glow.h"

#include "geometry/vec3.h"

#include <math.h>

enum { ROWS = SKY_GLOW_ROWS, COLUMNS = SKY_GLOW_COLUMNS };

/* What is brighter than the mean by this factor is drawn from, unless it gives less than this share of all light: rays
 * by the cosine find what is wider, and what gives little may be noisy. */
static const double BRIGHT = 4.0, LEAST_SHARE = 0.05;

/* Texels that are larger than a cell are taken in parts. */
static uint32_t parts_of(uint32_t texels, uint32_t cells) {
    return texels % cells == 0 ? 1 : (4 * cells + texels - 1) / texels;
}

/* light[row][column]: what comes from each cell, mean of the bands. Returns the sum. */
static double add_texels(const sky_image *image, double light[ROWS][COLUMNS]) {
    const uint32_t parts_v = parts_of(image->height, ROWS), parts_u = parts_of(image->width, COLUMNS);
    const uint32_t height = image->height * parts_v, width = image->width * parts_u;
    double sum = 0.0;
    for (uint32_t v = 0; v < height; v++) {
        const double high = cos(PI * v / height), low = cos(PI * (v + 1) / height);
        for (uint32_t u = 0; u < width; u++) {
            double L[3];
            sky_image_radiance(image, v / parts_v, u / parts_u, L);
            const double brought = (high - low) * (L[0] + L[1] + L[2]);
            light[(uint64_t)v * ROWS / height][(uint64_t)u * COLUMNS / width] += brought;
            sum += brought;
        }
    }
    return sum;
}

static double solid_angle_of(int row) {
    return 2 * PI / COLUMNS * (cos(PI * row / ROWS) - cos(PI * (row + 1) / ROWS));
}

static void set_rows(sky_glow *g, double bright) {
    for (int row = 0; row < ROWS; row++) {
        double *sums = g->columns[row];
        for (int column = 0; column < COLUMNS; column++) sums[column + 1] = sums[column] + g->pdf[row][column];
        const double all = sums[COLUMNS];
        g->rows[row + 1] = g->rows[row] + all / bright;
        for (int column = 0; column < COLUMNS; column++) {
            sums[column + 1] = all > 0.0 ? sums[column + 1] / all : 0.0;
            g->pdf[row][column] /= bright * solid_angle_of(row);
        }
    }
}

bool sky_glow_find(allocator *memory, const sky_image *image, sky_glow **out) {
    sky_glow *g = *out = block_zeroed(memory, 1, sizeof *g);
    if (!g) return false;
    const double sum = add_texels(image, g->pdf), least = BRIGHT * sum / (4 * PI);
    double bright = 0.0;
    for (int i = 0; i < ROWS * COLUMNS; i++) {
        double *light = &g->pdf[i / COLUMNS][i % COLUMNS];
        if (!(*light > least * solid_angle_of(i / COLUMNS))) *light = 0.0;
        bright += *light;
    }
    if (bright > LEAST_SHARE * sum) {
        set_rows(g, bright);
        return true;
    }
    block_free(g);
    *out = NULL;
    return true;
}

/* The last of count parts, whose sums are given, that begins below x and is not empty; *x: where in it. */
static int part_at(const double *sums, int count, double *x) {
    int low = 0, high = count;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        *(sums[middle] <= *x ? &low : &high) = middle;
    }
    const double width = sums[low + 1] - sums[low];
    *x = width > 0.0 ? fmin((*x - sums[low]) / width, 1.0) : 0.5;
    return low;
}

void sky_glow_direction(const sky_glow *g, const double point[2], double out[3]) {
    double v = point[0] * g->rows[ROWS], u = point[1];
    const int row = part_at(g->rows, ROWS, &v), column = part_at(g->columns[row], COLUMNS, &u);
    const double high = cos(PI * row / ROWS), low = cos(PI * (row + 1) / ROWS);
    const double height = high + v * (low - high), azimuth = 2 * PI * ((column + u) / COLUMNS - 0.5);
    const double across = sqrt(fmax(1.0 - height * height, 0.0));
    out[0] = across * cos(azimuth), out[1] = height, out[2] = across * sin(azimuth);
}

double sky_glow_pdf(const sky_glow *g, const double direction[3]) {
    const double v = 0.5 - asin(direction[1]) / PI, u = 0.5 + atan2(direction[2], direction[0]) / (2 * PI);
    const int row = (int)fmin(fmax(v * ROWS, 0.0), ROWS - 1);
    return g->pdf[row][(int)fmin(fmax(u * COLUMNS, 0.0), COLUMNS - 1)];
}
