/* SPDX-License-Identifier: MIT
 * Which points fill a cube evenly, and which directions a hemisphere by the cosine? The same on every run.
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_EVEN_POINTS_H
#define HEMIBAKE_CORE_GEOMETRY_EVEN_POINTS_H

#include "geometry/vec3.h"

/* The k-th coordinate of point i of a sequence that fills the unit cube of four dimensions evenly: multiples of powers
 * of 1/g, g^5 = g + 1. */
static inline double even_point(size_t i, int k) {
    static const double steps[4] = { 0.85667488385450288, 0.73389185662146350, 0.62870672103799270,
                                     0.53859725722361160 };
    double x = 0.5 + steps[k] * (double)(i + 1);
    return x - floor(x);
}

/* The weights of a triangle's corners at an even point of the square. */
static inline void even_weights(double weights[3], double a, double b) {
    double root = sqrt(a);
    weights[0] = 1 - root, weights[1] = root * (1 - b), weights[2] = root * b;
}

/* A unit direction off a surface, as often as the cosine of its angle to the normal. */
static inline void even_direction(double out[3], const double normal[3], double a, double b) {
    double u[3], v[3], radius = sqrt(a), turn = 2 * PI * b;
    vec3_tangents(normal, u, v);
    for (int k = 0; k < 3; k++) out[k] = sqrt(1 - a) * normal[k];
    vec3_add_scaled(out, out, radius * cos(turn), u);
    vec3_add_scaled(out, out, radius * sin(turn), v);
}

#endif
