/* SPDX-License-Identifier: MIT */
#include "light/sky.h"

#include "geometry/vec3.h"

#include <string.h>

enum { TREGENZA_ROWS = 7 };

static const int TREGENZA[TREGENZA_ROWS] = { 30, 30, 24, 24, 18, 12, 6 };
/* Strides of the two-dimensional sequence that fills a square most evenly: 1/p and 1/p^2 with p^3 = p + 1. */
static const double PLASTIC[2] = { 0.75487766624669276, 0.56984029099805327 };

/* Altitudes and azimuths, radians; of the lower hemisphere altitudes are negative. The cap has every azimuth. */
typedef struct cell {
    double low, high, west, east;
} cell;

static int row_count(int fineness) {
    return TREGENZA_ROWS * fineness;
}

static int cells_in_row(int fineness, int row) {
    return TREGENZA[row / fineness] * fineness;
}

static double row_height(int fineness) {
    return 0.5 * PI / (row_count(fineness) + 0.5);
}

static size_t hemisphere_count(int fineness) {
    size_t count = 1;
    for (int row = 0; row < row_count(fineness); row++) count += (size_t)cells_in_row(fineness, row);
    return count;
}

size_t sky_patch_count(int fineness) {
    return 2 * hemisphere_count(fineness);
}

/* Cell index of the upper hemisphere. */
static cell cell_of(int fineness, size_t index) {
    double height = row_height(fineness);
    for (int row = 0; row < row_count(fineness); row++) {
        size_t n = (size_t)cells_in_row(fineness, row);
        if (index < n)
            return (cell){ row * height, (row + 1) * height, 2 * PI * (double)index / (double)n,
                           2 * PI * (double)(index + 1) / (double)n };
        index -= n;
    }
    return (cell){ 0.5 * PI - 0.5 * height, 0.5 * PI, 0, 2 * PI };
}

/* int dw and int w dw over a cell, in closed form. */
static void integrate(const cell *c, double flux, double *solid_angle, double moment[3]) {
    double across = c->east - c->west, sines = sin(c->high) - sin(c->low);
    /* int cos^2 of the altitude */
    double squares = 0.5 * (c->high - c->low) + 0.25 * (sin(2 * c->high) - sin(2 * c->low));
    *solid_angle = flux * across * sines;
    moment[0] = flux * squares * (sin(c->east) - sin(c->west));
    moment[1] = flux * across * 0.5 * (sin(c->high) + sin(c->low)) * sines;
    moment[2] = flux * squares * (cos(c->west) - cos(c->east));
}

/* ---- patches ---- */

/* Sums, before they are made means. */
typedef struct building {
    cell cell;
    double flux[3], moment[3][3];
    double solid_angle;
} building;

/* Somewhere inside the cell, evenly over all cells, so that walls along an axis do not meet a row of ties. */
static void inside(const cell *c, size_t index, double out[3]) {
    double a = fmod(0.5 + PLASTIC[0] * (double)(index + 1), 1.0), b = fmod(0.5 + PLASTIC[1] * (double)(index + 1), 1.0);
    double sine = sin(c->low) + a * (sin(c->high) - sin(c->low));
    sky_image_toward(asin(sine), c->west + b * (c->east - c->west), out);
}

/* A patch of even light is looked at anywhere in it; the more its light comes from one spot, the nearer to that. */
static void aim(const building *b, size_t index, sky_patch *out) {
    double any[3], from[3] = { 0, 0, 0 }, even[3], weight, total = 0.0;
    inside(&b->cell, index, any);
    for (int c = 0; c < 3; c++) {
        vec3_add_scaled(from, from, 1.0, b->moment[c]);
        total += b->flux[c];
    }
    integrate(&b->cell, 1.0, &weight, even);
    double spread_even = 1.0 - vec3_length(even) / weight, spread = 1.0 - vec3_normalize(from) / total;
    double share = fmin(fmax(spread / spread_even, 0.0), 1.0);
    for (int k = 0; k < 3; k++) out->toward[k] = (1.0 - share) * from[k] + share * any[k];
    vec3_normalize(out->toward);
}

/* False without light. */
static bool set_patch(const building *b, size_t index, sky_patch *out) {
    if (!(b->flux[0] + b->flux[1] + b->flux[2] > 0.0)) return false;
    for (int c = 0; c < 3; c++) {
        out->flux[c] = b->flux[c];
        for (int k = 0; k < 3; k++) out->mean[c][k] = b->flux[c] > 0.0 ? b->moment[c][k] / b->flux[c] : 0.0;
    }
    out->half = 0.5 * sqrt(b->solid_angle);
    aim(b, index, out);
    return true;
}

static void set_cells(int fineness, building *all) {
    size_t n = hemisphere_count(fineness);
    for (size_t i = 0; i < 2 * n; i++) {
        double moment[3];
        all[i].cell = cell_of(fineness, i % n);
        if (i >= n) all[i].cell = (cell){ -all[i].cell.high, -all[i].cell.low, all[i].cell.west, all[i].cell.east };
        integrate(&all[i].cell, 1.0, &all[i].solid_angle, moment);
    }
}

/* ---- panoramas ---- */

/* The cell that holds a direction. */
static size_t find_cell(int fineness, double altitude, double azimuth) {
    size_t first = altitude < 0.0 ? hemisphere_count(fineness) : 0;
    int row = (int)(fabs(altitude) / row_height(fineness));
    if (row >= row_count(fineness)) return first + hemisphere_count(fineness) - 1;
    for (int r = 0; r < row; r++) first += (size_t)cells_in_row(fineness, r);
    size_t n = (size_t)cells_in_row(fineness, row), at = (size_t)(azimuth / (2 * PI) * (double)n);
    return first + (at < n ? at : n - 1);
}

/* Texels are taken in parts that are smaller than a patch, each where its centre lies. */
static void fill_from_image(const double radiance[3], const sky_image *image, int fineness, building *all) {
    double step = row_height(fineness) / 8;
    uint32_t parts_v = (uint32_t)ceil(PI / image->height / step),
             parts_u = (uint32_t)ceil(2 * PI / image->width / step);
    uint32_t rows = image->height * parts_v, columns = image->width * parts_u;
    for (uint32_t v = 0; v < rows; v++) {
        double high = PI * (0.5 - (double)v / rows), low = PI * (0.5 - (double)(v + 1) / rows);
        for (uint32_t u = 0; u < columns; u++) {
            double L[3];
            sky_image_radiance(image, v / parts_v, u / parts_u, L);
            cell part = { low, high, 2 * PI * ((double)u / columns - 0.5), 2 * PI * ((double)(u + 1) / columns - 0.5) };
            double east = 0.5 * (part.west + part.east);
            building *b = &all[find_cell(fineness, 0.5 * (low + high), east < 0.0 ? east + 2 * PI : east)];
            for (int c = 0; c < 3; c++) {
                double flux, moment[3];
                integrate(&part, radiance[c] * L[c], &flux, moment);
                b->flux[c] += flux;
                vec3_add_scaled(b->moment[c], b->moment[c], 1.0, moment);
            }
        }
    }
}

bool sky_create(allocator *memory, const double radiance[3], const sky_image *image, int fineness, sky *out) {
    size_t count = sky_patch_count(fineness);
    building *all = block_zeroed(memory, count, sizeof *all);
    *out = (sky){ .patches = block_new(memory, count * sizeof *out->patches) };
    if (all && out->patches) {
        set_cells(fineness, all);
        if (image) fill_from_image(radiance, image, fineness, all);
        for (size_t i = 0; !image && i < count; i++)
            for (int c = 0; c < 3; c++) integrate(&all[i].cell, radiance[c], &all[i].flux[c], all[i].moment[c]);
        for (size_t i = 0; i < count; i++) out->patch_count += set_patch(&all[i], i, &out->patches[out->patch_count]);
    }
    bool ok = all && out->patches;
    block_free(all);
    if (!ok) sky_free(out);
    return ok;
}

void sky_free(sky *s) {
    block_free(s->patches);
    memset(s, 0, sizeof *s);
}

/* A patch that the surface's horizon cuts is seen where it looks with the chance (c + half) / 2 half, c the cosine of
 * its mean direction, and gives (c + half)^2 / 4 half: so (c + half) / 2 whenever it is seen is right in the mean. */
static double mean_cosine(double c, double half) {
    return c >= half ? c : fmax(0.5 * (c + half), 0.0);
}

bool sky_patch_irradiance(const sky_patch *p, const double normal[3], double E[3]) {
    if (vec3_dot(normal, p->toward) <= 0.0) return false;
    for (int c = 0; c < 3; c++) E[c] = p->flux[c] * mean_cosine(vec3_dot(normal, p->mean[c]), p->half);
    return true;
}
