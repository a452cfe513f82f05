/* SPDX-License-Identifier: MIT
 * The lobes of row_guiding.h: which cones are the targets of a group, as seen from a sample? Every ray asks for the
 * density of every lobe, so the loops over lobes are free of branches and calls, eight lobes at a time, whose sums are
 * added in one order: compiled for several instruction sets, all give the same bits.
 */
#include "solver/row_guiding.h"

#include "base/target_clones.h"
#include "geometry/vec3.h"

enum { LANES = 8 };

_Static_assert(ROW_LOBES_MAX % LANES == 0, "lobes fill lanes");

/* A ball is at least and at most so much of the distance that it is seen from. */
static const double RADIUS_MIN = 0.01, RADIUS_MAX = 0.3;

/* Targets as seen from a sample, those below its horizon too. */
typedef struct seen_targets {
    double x[ROW_LOBES_MAX], y[ROW_LOBES_MAX], z[ROW_LOBES_MAX]; /* the way there, at first not of length 1 */
    double radius[ROW_LOBES_MAX];
    double cosine[ROW_LOBES_MAX], pdf[ROW_LOBES_MAX];
    double above[ROW_LOBES_MAX]; /* the normal: not positive where no part of it is */
} seen_targets;

TARGET_CLONES("avx2", "default") static void set_cones(seen_targets *t, int count, double nx, double ny, double nz) {
    for (int i = 0; i < count; i++) {
        double x = t->x[i], y = t->y[i], z = t->z[i], distance = sqrt(x * x + y * y + z * z);
        double inverse = distance > 0.0 ? 1.0 / distance : 0.0;
        double sine = t->radius[i] * inverse;
        sine = sine > RADIUS_MIN ? sine : RADIUS_MIN;
        sine = sine < RADIUS_MAX ? sine : RADIUS_MAX;
        double cosine = sqrt(1.0 - sine * sine);
        x *= inverse, y *= inverse, z *= inverse;
        t->x[i] = x, t->y[i] = y, t->z[i] = z;
        t->above[i] = distance > 0.0 ? x * nx + y * ny + z * nz + sine : 0.0;
        t->cosine[i] = cosine;
        t->pdf[i] = (1.0 + cosine) / (sine * sine);
    }
}

void row_guiding_lobes(const row_guiding *a, uint32_t element_index, const double from[3], const double normal[3],
                       row_lobes *out) {
    const row_group *g = row_guiding_group(a, element_index);
    seen_targets seen;
    int count = (int)g->target_count, n = 0;
    out->glow = a->glow, out->glow_count = 0;
    for (int i = 0; i < count; i++) {
        const row_target *t = &g->targets[i];
        double away = t->radius > 0.0 ? 1.0 : 0.0;
        seen.x[i] = t->at[0] - away * from[0];
        seen.y[i] = t->at[1] - away * from[1];
        seen.z[i] = t->at[2] - away * from[2];
        seen.radius[i] = fabs(t->radius);
    }
    set_cones(&seen, count, normal[0], normal[1], normal[2]);
    for (int i = 0; i < count; i++) {
        if (!(seen.above[i] > 0.0)) continue;
        if (g->targets[i].radius == 0.0) {
            out->glow_count++;
            continue;
        }
        out->x[n] = (float)seen.x[i], out->y[n] = (float)seen.y[i], out->z[n] = (float)seen.z[i];
        out->cosine[n] = (float)seen.cosine[i];
        out->pdf[n++] = (float)seen.pdf[i];
    }
    out->count = n;
    float share = (float)(1.0 / (2 * PI * (row_lobes_any(out) ? n + out->glow_count : 1)));
    for (int i = 0; i < n; i++) out->pdf[i] *= share;
    for (; n % LANES; n++) out->x[n] = out->y[n] = out->z[n] = out->pdf[n] = 0.0f, out->cosine[n] = 2.0f;
}

void row_lobes_direction(const row_lobes *a, const double point[2], double out[3]) {
    double which = point[0] * (a->count + a->glow_count);
    int i = (int)which;
    if (i >= a->count) {
        sky_glow_direction(a->glow, (double[]){ (which - a->count) / a->glow_count, point[1] }, out);
        return;
    }
    const double axis[3] = { a->x[i], a->y[i], a->z[i] };
    double u[3], v[3], height = 1.0 - (which - i) * (1.0 - (double)a->cosine[i]), angle = 2 * PI * point[1];
    double radius = sqrt(fmax(1.0 - height * height, 0.0));
    vec3_tangents(axis, u, v);
    for (int k = 0; k < 3; k++) out[k] = radius * (cos(angle) * u[k] + sin(angle) * v[k]) + height * axis[k];
}

TARGET_CLONES("avx2", "default") static double add_densities(const row_lobes *a, float x, float y, float z) {
    float sum[LANES] = { 0 };
    for (int i = 0; i < a->count; i += LANES)
        for (int k = 0; k < LANES; k++) {
            float along = a->x[i + k] * x + a->y[i + k] * y + a->z[i + k] * z;
            sum[k] += along >= a->cosine[i + k] ? a->pdf[i + k] : 0.0f;
        }
    return (double)(((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7])));
}

double row_lobes_pdf(const row_lobes *a, const double direction[3]) {
    double density = add_densities(a, (float)direction[0], (float)direction[1], (float)direction[2]);
    if (a->glow_count > 0) density += sky_glow_pdf(a->glow, direction) * a->glow_count / (a->count + a->glow_count);
    return density;
}
