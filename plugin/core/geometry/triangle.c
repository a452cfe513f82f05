/* SPDX-License-Identifier: MIT
 * See triangle.h. The nearest point is looked for on the plane, then on the edges.
 */
#include "geometry/triangle.h"

#include <string.h>

static double clamp01(double x) {
    return x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
}

/* Of the triangle 0, u, v: weights of the corners at the point nearest to p on the edge from corner i to the next. */
static double nearest_on_edge(double w[3], const double u[3], const double v[3], const double p[3], int i) {
    static const double ORIGIN[3] = { 0.0, 0.0, 0.0 };
    const double *corner[3] = { ORIGIN, u, v }, *start = corner[i];
    double along[3], off[3];
    vec3_sub(along, corner[(i + 1) % 3], start);
    vec3_sub(off, p, start);
    double square = vec3_dot(along, along), t = square > 0.0 ? clamp01(vec3_dot(off, along) / square) : 0.0;
    w[0] = w[1] = w[2] = 0.0;
    w[i] = 1.0 - t;
    w[(i + 1) % 3] = t;
    vec3_add_scaled(off, off, -t, along);
    return vec3_dot(off, off);
}

double triangle_nearest(double w[3], const double a[3], const double b[3], const double c[3], const double x[3]) {
    double u[3], v[3], p[3], best = INFINITY, one[3];
    vec3_sub(u, b, a);
    vec3_sub(v, c, a);
    vec3_sub(p, x, a);
    if (triangle_weights(w, a, b, c, x) && w[1] >= 0.0 && w[2] >= 0.0 && w[1] + w[2] <= 1.0) {
        vec3_add_scaled(p, p, -w[1], u);
        vec3_add_scaled(p, p, -w[2], v);
        return vec3_dot(p, p);
    }
    for (int i = 0; i < 3; i++) {
        double square = nearest_on_edge(one, u, v, p, i);
        if (square >= best) continue;
        best = square;
        memcpy(w, one, sizeof one);
    }
    return best;
}
