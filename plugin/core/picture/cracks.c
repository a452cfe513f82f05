/* SPDX-License-Identifier: MIT */
#include "picture/cracks.h"

#include "geometry/vec3.h"

#include <math.h>

/* Of the way to the next sample. Item buffers round corners to 1/256 of it, grids of files often to more. */
static const double CRACK = 0.125;

static const int AXES[][2] = { { 1, 0 }, { 0, 1 }, { 1, 1 }, { 1, -1 } };

static uint32_t id_at(const crack_view *v, int x, int y) {
    if (x < 0 || y < 0 || x >= v->width || y >= v->height) return 0;
    return v->ids[(size_t)y * (size_t)v->width + (size_t)x];
}

/* a, b, c: from the eye. */
static void corners_of(const crack_view *v, uint32_t id, double at[3][3]) {
    const uint32_t *corner = v->picture->indices + 3 * (size_t)(id - 1);
    for (int i = 0; i < 3; i++) vec3_sub(at[i], v->picture->positions + 3 * (size_t)corner[i], v->eye);
}

/* Along a ray to the plane of a triangle; infinite where nothing is. */
static double distance_to(const crack_view *v, uint32_t id, const double ray[3]) {
    double at[3][3], u[3], w[3], n[3];
    if (!id) return INFINITY;
    corners_of(v, id, at);
    vec3_sub(u, at[1], at[0]);
    vec3_sub(w, at[2], at[0]);
    vec3_cross(n, u, w);
    double toward = vec3_dot(n, ray), t = vec3_dot(n, at[0]) / toward;
    return toward != 0.0 && t > 0.0 ? t : INFINITY;
}

/* An edge and the eye span a plane, whose distance from a ray in the picture is what the ray misses the edge by. */
static bool passes_close(const crack_view *v, uint32_t id, const double ray[3]) {
    double at[3][3], n[3], across[3];
    if (v->holes && v->holes[id - 1]) return false;
    corners_of(v, id, at);
    vec3_cross(n, at[1], at[2]);
    double side = vec3_dot(n, at[0]) < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < 3; i++) {
        vec3_cross(n, at[(i + 1) % 3], at[(i + 2) % 3]);
        vec3_add_scaled(across, n, -vec3_dot(n, v->forward), v->forward);
        if (side * vec3_dot(n, ray) < -CRACK * v->step * vec3_length(across)) return false;
    }
    return true;
}

uint32_t crack_closed(const crack_view *v, int x, int y, const double ray[3]) {
    uint32_t own = id_at(v, x, y);
    double own_distance = -1.0; /* not known yet */
    for (size_t i = 0; i < sizeof AXES / sizeof *AXES; i++) {
        const int *to = AXES[i];
        const uint32_t sides[2] = { id_at(v, x + to[0], y + to[1]), id_at(v, x - to[0], y - to[1]) };
        if (!sides[0] || !sides[1] || sides[0] == own || sides[1] == own) continue;
        if (own_distance < 0.0) own_distance = distance_to(v, own, ray);
        if (!(distance_to(v, sides[0], ray) < own_distance && distance_to(v, sides[1], ray) < own_distance)) continue;
        for (int k = 0; k < 2; k++)
            if (passes_close(v, sides[k], ray)) return sides[k];
    }
    return own;
}
