/* SPDX-License-Identifier: MIT */
#include "mesh/triangulation.h"

#include <string.h>

int element_ring(const element *e, uint8_t ring[ELEMENT_PLACES]) {
    int corners = element_corner_count(e), count = 0;
    for (int k = 0; k < corners; k++) {
        ring[count++] = (uint8_t)k;
        if (e->hanging & 1 << k) ring[count++] = (uint8_t)(4 + k);
    }
    return count;
}

int element_triangles(const element *e, int diagonal, uint8_t triangle[ELEMENT_TRIANGLES_MAX][3]) {
    uint8_t ring[ELEMENT_PLACES];
    int count = element_ring(e, ring), first = diagonal && count == 4 ? 1 : 0;
    for (int k = 0; e->hanging && k < count; k++) {
        if (ring[k] < 4) continue;
        first = k;
        break;
    }
    for (int i = 0; i + 2 < count; i++) {
        triangle[i][0] = ring[first];
        triangle[i][1] = ring[(first + i + 1) % count];
        triangle[i][2] = ring[(first + i + 2) % count];
    }
    return count - 2;
}

static void place_coordinates(int corners, int place, double at[2]) {
    static const double quad[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } },
                        three[3][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 } };
    const double *a = corners == 4 ? quad[place % 4] : three[place % 4];
    const double *b = corners == 4 ? quad[(place + 1) % 4] : three[(place % 4 + 1) % 3];
    for (int k = 0; k < 2; k++) at[k] = place < 4 ? a[k] : 0.5 * (a[k] + b[k]);
}

static void barycentric(int corners, const uint8_t triangle[3], double u, double v, double weights[3]) {
    double p[3][2];
    for (int i = 0; i < 3; i++) place_coordinates(corners, triangle[i], p[i]);
    double ax = p[1][0] - p[0][0], ay = p[1][1] - p[0][1], bx = p[2][0] - p[0][0], by = p[2][1] - p[0][1];
    double x = u - p[0][0], y = v - p[0][1], area = ax * by - ay * bx;
    weights[1] = (x * by - y * bx) / area;
    weights[2] = (ax * y - ay * x) / area;
    weights[0] = 1 - weights[1] - weights[2];
}

void element_locate(const element *e, int diagonal, double u, double v, uint8_t place[3], double weights[3]) {
    uint8_t triangle[ELEMENT_TRIANGLES_MAX][3];
    int corners = element_corner_count(e), count = element_triangles(e, diagonal, triangle);
    double deepest = -INFINITY;
    for (int i = 0; i < count; i++) {
        double w[3];
        barycentric(corners, triangle[i], u, v, w);
        double depth = fmin(w[0], fmin(w[1], w[2]));
        if (depth <= deepest) continue;
        deepest = depth;
        memcpy(place, triangle[i], 3);
        memcpy(weights, w, sizeof w);
    }
}
