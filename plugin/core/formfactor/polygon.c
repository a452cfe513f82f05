/* SPDX-License-Identifier: MIT
 * See polygon.h.
 */
#include "formfactor/polygon.h"

#include "base/vec3.h"

static const double TWO_PI = 6.28318530717958647692;

static void polygon_push(polygon *p, const double corner[3]) {
    if (p->count < POLYGON_CORNERS_MAX) vec3_copy(p->corner[p->count++], corner);
}

void polygon_clip(polygon *out, const polygon *in, const double normal[3], double plane) {
    out->count = 0;
    for (int i = 0; i < in->count; i++) {
        const double *a = in->corner[i], *b = in->corner[(i + 1) % in->count];
        double height_a = vec3_dot(normal, a) - plane, height_b = vec3_dot(normal, b) - plane;
        if (height_a >= 0.0) polygon_push(out, a);
        if ((height_a > 0.0 && height_b < 0.0) || (height_a < 0.0 && height_b > 0.0)) {
            double edge[3], cut[3];
            vec3_sub(edge, b, a);
            vec3_add_scaled(cut, a, height_a / (height_a - height_b), edge);
            polygon_push(out, cut);
        }
    }
}

/* n . Gamma of one edge. angle / |a x b| tends to 1 / (a . b) as the edge shrinks to nothing in sight. An edge through
 * the point itself (a . b < 0, a x b = 0) bounds nothing that is above the horizon. */
static double edge_term(const double a[3], const double b[3], const double normal[3]) {
    double cross[3];
    vec3_cross(cross, a, b);
    double sine = vec3_length(cross), cosine = vec3_dot(a, b);
    if (sine > 0.0) return vec3_dot(normal, cross) * (atan2(sine, cosine) / sine);
    return cosine > 0.0 ? vec3_dot(normal, cross) / cosine : 0.0;
}

double polygon_factor(const polygon *p, const double point[3], const double normal[3]) {
    polygon above;
    polygon_clip(&above, p, normal, vec3_dot(normal, point));
    double sum = 0.0;
    for (int i = 0; i < above.count; i++) {
        double a[3], b[3];
        vec3_sub(a, above.corner[i], point);
        vec3_sub(b, above.corner[(i + 1) % above.count], point);
        sum += edge_term(a, b, normal);
    }
    /* Seen from its front a polygon runs clockwise about the line of sight, so its sum is negative. */
    return -sum / TWO_PI;
}

void polygon_quarter(const polygon *p, polygon quarter[4]) {
    double mid[4][3], center[3] = { 0, 0, 0 };
    int n = p->count;
    for (int i = 0; i < n; i++) vec3_mid(mid[i], p->corner[i], p->corner[(i + 1) % n]);
    for (int q = 0; q < 4; q++) quarter[q].count = 0;
    if (n == 4) vec3_mid(center, mid[0], mid[2]);
    for (int i = 0; i < n; i++) {
        polygon_push(&quarter[i], p->corner[i]);
        polygon_push(&quarter[i], mid[i]);
        if (n == 4) polygon_push(&quarter[i], center);
        polygon_push(&quarter[i], mid[(i + n - 1) % n]);
    }
    for (int i = 0; n == 3 && i < 3; i++) polygon_push(&quarter[3], mid[i]);
}

void polygon_vector_area(const polygon *p, double out[3]) {
    out[0] = out[1] = out[2] = 0.0;
    for (int i = 1; i + 1 < p->count; i++) {
        double u[3], v[3], n[3];
        vec3_sub(u, p->corner[i], p->corner[0]);
        vec3_sub(v, p->corner[i + 1], p->corner[0]);
        vec3_cross(n, u, v);
        vec3_add_scaled(out, out, 0.5, n);
    }
}

void polygon_centroid(const polygon *p, double out[3]) {
    double total = 0.0, moment[3] = { 0, 0, 0 };
    for (int i = 1; i + 1 < p->count; i++) {
        double u[3], v[3], n[3];
        vec3_sub(u, p->corner[i], p->corner[0]);
        vec3_sub(v, p->corner[i + 1], p->corner[0]);
        vec3_cross(n, u, v);
        double area = vec3_length(n);
        for (int k = 0; k < 3; k++) moment[k] += area * (u[k] + v[k]) / 3.0;
        total += area;
    }
    vec3_copy(out, p->corner[0]);
    if (total > 0.0) vec3_add_scaled(out, p->corner[0], 1.0 / total, moment);
}
