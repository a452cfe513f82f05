/* SPDX-License-Identifier: MIT */
#include "scene/alpha_mask.h"

#include "geometry/vec3.h"

#include <stddef.h>

enum { POINTS_LEAST = 128, POINTS_MOST = 1024, POINTS_A_TEXEL = 4 };

static const double COVERAGE_LEAST = 1e-6;

/* Strides of the two-dimensional sequence that fills a square most evenly: 1/p and 1/p^2 with p^3 = p + 1. */
static const double PLASTIC[2] = { 0.75487766624669276, 0.56984029099805327 };

alpha_mask alpha_mask_over_triangle(const alpha_mask_map *map, const double *const corner[3], const double values[9]) {
    alpha_mask out = { .map = map };
    double e1[3], e2[3], n[3], g1[3], g2[3];
    vec3_sub(e1, corner[1], corner[0]);
    vec3_sub(e2, corner[2], corner[0]);
    vec3_cross(n, e1, e2);
    double n2 = vec3_dot(n, n);
    vec3_cross(g1, e2, n); /* g1 . e1 = n2, g1 . e2 = 0 */
    vec3_cross(g2, n, e1); /* g2 . e2 = n2, g2 . e1 = 0 */
    for (int k = 0; k < 3; k++) {
        double *row = out.row[k], a = values[3 + k] - values[k], b = values[6 + k] - values[k];
        for (int i = 0; i < 3 && n2 > 0.0; i++) row[i] = (a * g1[i] + b * g2[i]) / n2;
        row[3] = values[k] - vec3_dot(row, corner[0]);
    }
    return out;
}

void alpha_mask_place(const alpha_mask *c, const double point[3], double uvw[3]) {
    for (int k = 0; k < 3; k++) uvw[k] = vec3_dot(c->row[k], point) + c->row[k][3];
}

static uint32_t texel_at(double at, uint32_t count, alpha_mask_wrap wrap) {
    double turn = at >= 0.0 && at < 1.0 ? 0.0 : floor(at), inside = at - turn;
    if (wrap == ALPHA_MASK_CLAMP) inside = fmin(fmax(at, 0.0), 1.0);
    if (wrap == ALPHA_MASK_MIRROR && fmod(turn, 2.0) != 0.0) inside = 1.0 - inside;
    double texel = inside * count;
    return texel >= count ? count - 1 : texel > 0.0 ? (uint32_t)texel : 0;
}

double alpha_mask_map_alpha(const alpha_mask_map *m, const double uvw[3]) {
    uint32_t column = texel_at(uvw[0], m->width, m->wrap[0]), row = texel_at(uvw[1], m->height, m->wrap[1]);
    return m->alpha[(size_t)row * m->width + column] / 255.0 * uvw[2];
}

bool alpha_mask_map_is_hole(const alpha_mask_map *m, const double uvw[3]) {
    return alpha_mask_map_alpha(m, uvw) < m->cutoff;
}

bool alpha_mask_is_hole(const alpha_mask *c, const double point[3]) {
    double uvw[3];
    alpha_mask_place(c, point, uvw);
    return alpha_mask_map_is_hole(c->map, uvw);
}

/* Of a number from 0 to 2^31. */
static double fraction(double x) {
    return x - (double)(int)x;
}

double alpha_mask_coverage(const alpha_mask *c, const double *const corner[4], int corner_count) {
    double at[4][3] = { { 0 } }, seen = 0.0;
    for (int i = 0; i < corner_count; i++) alpha_mask_place(c, corner[i], at[i]);
    double area = 0.0; /* under the polygon, of the map */
    for (int i = 0; i < corner_count; i++) {
        const double *p = at[i], *q = at[(i + 1) % corner_count];
        area += 0.5 * (p[0] * q[1] - q[0] * p[1]);
    }
    double wanted = POINTS_A_TEXEL * (fabs(area) * c->map->width * c->map->height);
    int points = wanted < POINTS_LEAST ? POINTS_LEAST : wanted < POINTS_MOST ? (int)wanted : POINTS_MOST;
    for (int i = 0; i < points; i++) {
        double s = fraction(0.5 + PLASTIC[0] * (i + 1)), t = fraction(0.5 + PLASTIC[1] * (i + 1)), uvw[3];
        bool fold = corner_count == 3 && s + t > 1.0;
        if (fold) s = 1.0 - s, t = 1.0 - t;
        const double *last = at[corner_count - 1], opposite = corner_count == 4 ? s * t : 0.0;
        for (int k = 0; k < 3; k++)
            uvw[k] = at[0][k] + s * (at[1][k] - at[0][k]) + t * (last[k] - at[0][k]) +
                     opposite * (at[0][k] - at[1][k] + at[2][k] - last[k]);
        seen += !alpha_mask_map_is_hole(c->map, uvw);
    }
    return fmax(seen / points, COVERAGE_LEAST);
}
