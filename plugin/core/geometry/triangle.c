/* SPDX-License-Identifier: MIT
 * See triangle.h.
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

/* Of the triangle 0, u, v that is a line, or nearly: the nearest point of any edge. */
static double nearest_on_edges(double w[3], const double u[3], const double v[3], const double p[3]) {
    double best = INFINITY, one[3];
    for (int i = 0; i < 3; i++) {
        double square = nearest_on_edge(one, u, v, p, i);
        if (square >= best) continue;
        best = square;
        memcpy(w, one, sizeof one);
    }
    return best;
}

/* Which part of the triangle is nearest is a matter of signs [Ericson05, 5.1.5]: of what p is ahead of each corner
 * along the edges there, and of its weights, which are s, t and the rest of the determinant. */
double triangle_nearest(double w[3], const double a[3], const double b[3], const double c[3], const double x[3]) {
    double u[3], v[3], p[3];
    vec3_sub(u, b, a);
    vec3_sub(v, c, a);
    vec3_sub(p, x, a);
    const double uu = vec3_dot(u, u), uv = vec3_dot(u, v), vv = vec3_dot(v, v), up = vec3_dot(u, p),
                 vp = vec3_dot(v, p);
    const double determinant = uu * vv - uv * uv, s = vv * up - uv * vp, t = uu * vp - uv * up;
    const double from_b = vp - uv - (up - uu), from_c = up - uv - (vp - vv); /* along the edge from b to c, and back */
    if (!(determinant > TOLERANCE_DEGENERATE * uu * vv)) return nearest_on_edges(w, u, v, p);
    if (up <= 0.0 && vp <= 0.0)
        w[1] = 0.0, w[2] = 0.0;
    else if (up >= uu && from_b <= 0.0)
        w[1] = 1.0, w[2] = 0.0;
    else if (vp >= vv && from_c <= 0.0)
        w[1] = 0.0, w[2] = 1.0;
    else if (t <= 0.0 && up >= 0.0 && up <= uu)
        w[1] = up / uu, w[2] = 0.0;
    else if (s <= 0.0 && vp >= 0.0 && vp <= vv)
        w[1] = 0.0, w[2] = vp / vv;
    else if (s + t >= determinant)
        w[2] = from_b / (from_b + from_c), w[1] = 1.0 - w[2];
    else
        w[1] = s / determinant, w[2] = t / determinant;
    w[0] = 1.0 - w[1] - w[2];
    vec3_add_scaled(p, p, -w[1], u);
    vec3_add_scaled(p, p, -w[2], v);
    return vec3_dot(p, p);
}
