/* SPDX-License-Identifier: MIT */
#include "formfactor/sample_factors.h"

#include <math.h>
#include <string.h>

/* Samples whose vectors are found at a time. */
enum { SAMPLES_AT_A_TIME = 64 };

static void add_smooth(const mesh *m, const polygon *above, size_t first, size_t count, double *factors) {
    static const double axes[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    double vector[3][SAMPLES_AT_A_TIME];
    memset(vector, 0, sizeof vector);
    for (int k = 0; k < 3; k++)
        polygon_factor_batch(above, axes[k], m->x + first, m->y + first, m->z + first, count, vector[k]);
    for (size_t i = 0; i < count; i++) {
        const double *n = m->shading + 3 * (first + i);
        factors[i] += fmax(n[0] * vector[0][i] + n[1] * vector[1][i] + n[2] * vector[2][i], 0.0);
    }
}

void sample_factors_add(const mesh *m, const surface *facing, bool is_smooth, const polygon *above, size_t first,
                        size_t count, double *factors) {
    if (!is_smooth) {
        polygon_factor_batch(above, facing->normal, m->x + first, m->y + first, m->z + first, count, factors);
        return;
    }
    for (size_t begin = 0; begin < count; begin += SAMPLES_AT_A_TIME) {
        size_t left = count - begin;
        add_smooth(m, above, first + begin, left < SAMPLES_AT_A_TIME ? left : SAMPLES_AT_A_TIME, factors + begin);
    }
}
