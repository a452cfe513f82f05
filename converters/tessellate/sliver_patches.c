/* SPDX-License-Identifier: MIT
 * How many patches do long and thin triangles take beyond what their area does, how many elements do small ones, and
 * how large is what there is much of? A triangle is halved until its edges are as short as a patch's: a fat one gives
 * no more than four times as many as its area has.
 */
#include "tessellate.h"

#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

static void measure(const hemi_mesh_desc *m, size_t t, double *length, double *area) {
    double p[3][3];
    for (size_t k = 0; k < 3; k++)
        hemi_transform_point(m->transform, m->positions + 3 * (size_t)m->indices[3 * t + k], p[k]);
    *length = sqrt(triangle_longest_squared(p[0], p[1], p[2])), *area = triangle_area(p[0], p[1], p[2]);
}

static double patches_of(const hemi_mesh_desc *m, size_t t, double patch_size) {
    double length, area;
    measure(m, t, &length, &area);
    return fmax(length / patch_size - 1.0 - 4.0 * area / (patch_size * patch_size), 0.0);
}

size_t tessellate_sliver_patches(const hemi_mesh_desc *meshes, size_t count, double patch_size) {
    double patches = 0.0;
    for (size_t i = 0; i < count; i++)
        for (size_t t = 0; t < meshes[i].triangle_count; t++) patches += patches_of(&meshes[i], t, patch_size);
    return (size_t)fmin(patches, UINT32_MAX);
}

/* So many elements where the area alone would give one are crowded: here it is worth asking whether they merge. */
static const double CROWDED = 2.5;

/* Pieces' longest edges are between 0.7 and 1.4 elements long. */
double tessellate_crowding(allocator *memory, const hemi_mesh_desc *meshes, size_t count, double element_size) {
    double elements = 0.0, all = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double elements_before = elements, all_before = all;
        for (size_t t = 0; t < meshes[i].triangle_count; t++) {
            double length, area;
            measure(&meshes[i], t, &length, &area);
            area /= element_size * element_size;
            elements += fmax(fmax(length / element_size, 2.0 * area), 1.0);
            all += area;
        }
        const double own = all - all_before;
        if (elements - elements_before > CROWDED * own && tessellate_is_flat_grid(&meshes[i], memory))
            elements = elements_before + 2.0 * own;
    }
    return all > 0.0 ? elements / all : 1.0;
}

/* Areas are counted in bins, so many to a factor of two. */
enum { BINS_OF_TWO = 4, TWOS = 256, BINS = BINS_OF_TWO * TWOS };
static const double COMMON_SHARE = 0.25;

static size_t bin_of(double area) {
    int twos;
    double mantissa = frexp(area, &twos), bin = BINS_OF_TWO * (twos + TWOS / 2 + 2.0 * mantissa - 1.0);
    return (size_t)fmin(fmax(bin, 0.0), BINS - 1);
}

double tessellate_common_size(allocator *memory, const hemi_mesh_desc *meshes, size_t count) {
    double areas[BINS] = { 0 }, all = 0.0, smaller = 0.0;
    for (size_t i = 0; i < count; i++) {
        const bool merges = tessellate_is_flat_grid(&meshes[i], memory);
        for (size_t t = 0; t < meshes[i].triangle_count; t++) {
            double length, area;
            measure(&meshes[i], t, &length, &area);
            all += area;
            if (!merges) areas[bin_of(area)] += area;
        }
    }
    for (int bin = 0; bin < BINS; bin++) {
        smaller += areas[bin];
        if (smaller >= COMMON_SHARE * all && all > 0.0)
            return sqrt(2.0 * ldexp(0.5 + 0.5 * (bin % BINS_OF_TWO + 1) / BINS_OF_TWO, bin / BINS_OF_TWO - TWOS / 2));
    }
    return INFINITY;
}
