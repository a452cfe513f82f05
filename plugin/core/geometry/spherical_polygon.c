/* SPDX-License-Identifier: MIT */
#include "geometry/spherical_polygon.h"

#include "base/tolerance.h"
#include "geometry/vec3.h"

#include <math.h>

/* The solid angle of three unit vectors [Oosterom83], and the angle of the planes through a and b and through a and
 * c. */
static void measure(const double a[3], const double b[3], const double c[3], double *area, double *angle) {
    double across[3], ab[3], ac[3];
    vec3_cross(across, b, c);
    double volume = fabs(vec3_dot(a, across));
    *area = 2.0 * atan2(volume, 1.0 + vec3_dot(a, b) + vec3_dot(b, c) + vec3_dot(c, a));
    vec3_cross(ab, a, b), vec3_cross(ac, a, c);
    *angle = atan2(volume, vec3_dot(ab, ac));
}

void spherical_polygon_set(spherical_polygon *out, const polygon *p, const double from[3]) {
    out->solid_angle = 0.0, out->triangles = 0;
    if (p->count < 3 || p->count > SPHERICAL_CORNERS_MAX) return;
    for (int i = 0; i < p->count; i++) {
        vec3_sub(out->corner[i], p->corner[i], from);
        if (!(vec3_normalize(out->corner[i]) > 0.0)) return;
    }
    out->triangles = p->count - 2;
    for (int i = 0; i < out->triangles; i++) {
        measure(out->corner[0], out->corner[i + 1], out->corner[i + 2], &out->area[i], &out->angle[i]);
        out->solid_angle += out->area[i];
    }
}

/* The unit vector at a right angle to unit vector a, in the plane of a and b, on the side of b. False: they are one. */
static bool perpendicular(double out[3], const double a[3], const double b[3]) {
    vec3_add_scaled(out, b, -vec3_dot(a, b), a);
    return vec3_normalize(out) > 0.0;
}

/* On the arc from b to c: where the triangle of a, b and there has that share of the whole area. */
static void cut_arc(const double a[3], const double b[3], const double c[3], double angle, double area, double out[3]) {
    double side[3];
    double turn = area - angle, sine = sin(turn), cosine = cos(turn), sine_of_a = sin(angle), cosine_of_a = cos(angle);
    double u = cosine - cosine_of_a, v = sine + sine_of_a * vec3_dot(a, b);
    double below = (v * sine + u * cosine) * sine_of_a;
    double along = below != 0.0 ? ((v * cosine - u * sine) * cosine_of_a - v) / below : 1.0;
    along = fmin(fmax(along, -1.0), 1.0);
    vec3_copy(out, c);
    if (!perpendicular(side, a, c)) return;
    for (int k = 0; k < 3; k++) out[k] = along * a[k] + sqrt(1.0 - along * along) * side[k];
}

void spherical_polygon_direction(const spherical_polygon *s, const double square[2], double out[3]) {
    double left = square[0] * s->solid_angle, end[3], side[3];
    int i = 0;
    for (; i < s->triangles - 1 && left >= s->area[i]; i++) left -= s->area[i];
    const double *a = s->corner[0], *b = s->corner[i + 1], *c = s->corner[i + 2];
    cut_arc(a, b, c, s->angle[i], fmin(left, s->area[i]), end);
    /* From b towards the arc's end, evenly by the height of the cap round b. */
    double height = square[1] * 0.5 * vec3_distance_squared(end, b), along = 1.0 - height;
    vec3_copy(out, b);
    if (!perpendicular(side, b, end)) return;
    double across = sqrt(fmax(height * (2.0 - height), 0.0));
    for (int k = 0; k < 3; k++) out[k] = along * b[k] + across * side[k];
    vec3_normalize(out);
}
