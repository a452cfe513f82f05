/* SPDX-License-Identifier: MIT */
#include "formfactor/near_distance.h"

#include "geometry/polygon.h"
#include "geometry/vec3.h"

/* Directions of the pixels from the centre of a shooter in the plane z = 0. The lowest row is that of 100 pixels. */
static void pixel_direction(near_distance_pixel pixel, double out[3]) {
    static const double directions[NEAR_DISTANCE_PIXEL_COUNT][3] = { { 0, 0, 1 }, { 1, 1, 1 }, { 1, 0, 0.01 } };
    vec3_copy(out, directions[pixel]);
    vec3_normalize(out);
}

static void element_normal(near_distance_normal kind, const double direction[3], double out[3]) {
    const double down[3] = { 0, 0, -1 }, sideways[3] = { -1, 0, 0 };
    double inward[3] = { -direction[0], -direction[1], 0 };
    if (kind == NEAR_DISTANCE_PARALLEL) {
        vec3_copy(out, down);
    } else if (kind == NEAR_DISTANCE_RADIAL) {
        for (int k = 0; k < 3; k++) out[k] = -direction[k];
    } else {
        vec3_copy(out, vec3_normalize(inward) > 0.0 ? inward : sideways);
    }
}

double near_distance_error(near_distance_pixel pixel, near_distance_normal normal, double distance) {
    static const polygon square = { { { -.5, -.5, 0 }, { .5, -.5, 0 }, { .5, .5, 0 }, { -.5, .5, 0 } }, 4 };
    double direction[3], facing[3], point[3] = { 0, 0, 0 };
    pixel_direction(pixel, direction);
    element_normal(normal, direction, facing);
    vec3_add_scaled(point, point, distance, direction);
    double exact = polygon_factor(&square, point, facing);
    double cosines = -vec3_dot(facing, direction) * direction[2];
    return cosines / (PI * distance * distance) / exact - 1.0;
}

static double worst_error(double distance) {
    double worst = 0.0;
    for (int pixel = 0; pixel < NEAR_DISTANCE_PIXEL_COUNT; pixel++)
        for (int normal = 0; normal < NEAR_DISTANCE_NORMAL_COUNT; normal++) {
            if (pixel == NEAR_DISTANCE_CENTER && normal == NEAR_DISTANCE_PERPENDICULAR) continue;
            worst = fmax(worst,
                         fabs(near_distance_error((near_distance_pixel)pixel, (near_distance_normal)normal, distance)));
        }
    return worst;
}

double near_distance(double bound) {
    /* Far away the error falls with the square of the distance, so the search comes from there; errors of the curves'
     * zero crossings nearer by do not count. */
    double far = 1.0, near;
    while (worst_error(far) > bound && far < 1e6) far *= 2.0;
    near = far;
    while (worst_error(near) <= bound && near > 1e-3) near *= 0.95;
    for (int i = 0; i < 50; i++) {
        double middle = 0.5 * (near + far);
        if (worst_error(middle) > bound)
            near = middle;
        else
            far = middle;
    }
    return far;
}
