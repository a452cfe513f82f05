/* SPDX-License-Identifier: MIT
 * See punctual.h. Cone and range fade as KHR_lights_punctual says.
 */
#include "light/punctual.h"

#include "geometry/vec3.h"

static const double GOLDEN_ANGLE = 2.39996322972865332;

/* The least difference of the cosines of a cone's two angles, so that a hard edge has a slope. [KHR_lights_punctual] */
static const double CONE_LEAST = 0.001;

/* Directions across what a sample stands for, where the edge of a cone runs through it. */
enum { ACROSS_CONE = 8 };

static double square(double x) {
    return x * x;
}

static double clamp01(double x) {
    return fmin(fmax(x, 0.0), 1.0);
}

/* A cone whose two angles are one has a sharp edge. */
static double in_cone(const punctual *light, double cosine) {
    if (light->cos_inner <= light->cos_outer) return cosine >= light->cos_outer ? 1.0 : 0.0;
    double width = fmax(CONE_LEAST, light->cos_inner - light->cos_outer);
    return square(clamp01((cosine - light->cos_outer) / width));
}

/* Of a small square that is seen in a direction from the light, so many radians wide to either side, the mean where the
 * cone fades within less than that: its edge may run through the square, or all of the cone be inside. */
static double around_in_cone(const punctual *light, const double away[3], double half) {
    const double cosine = vec3_dot(light->direction, away), across = acos(fmin(fmax(cosine, -1.0), 1.0)),
                 reach = 1.5 * half;
    double u[3], v[3], sum = 0.0;
    bool is_inside = cos(fmin(across + reach, PI)) >= light->cos_inner;
    bool is_outside = cos(fmax(across - reach, 0.0)) < light->cos_outer;
    bool is_wide = 2.0 * half <= acos(light->cos_outer) - acos(light->cos_inner);
    if (is_wide || is_inside || is_outside) return in_cone(light, cosine);
    vec3_tangents(away, u, v);
    for (int i = 0; i < ACROSS_CONE * ACROSS_CONE; i++) {
        double at[3];
        vec3_copy(at, away);
        vec3_add_scaled(at, at, half * (2.0 * (i / ACROSS_CONE + 0.5) / ACROSS_CONE - 1.0), u);
        vec3_add_scaled(at, at, half * (2.0 * (i % ACROSS_CONE + 0.5) / ACROSS_CONE - 1.0), v);
        vec3_normalize(at);
        sum += in_cone(light, vec3_dot(light->direction, at));
    }
    return sum / (ACROSS_CONE * ACROSS_CONE);
}

/* Its profile in a direction from the light, between the four directions around it. */
static double in_profile(const punctual *light, const double away[3]) {
    double theta = acos(fmin(fmax(vec3_dot(light->direction, away), -1.0), 1.0)),
           phi = atan2(vec3_dot(light->aside[1], away), vec3_dot(light->aside[0], away));
    double y = theta / PI * (light->profile_rows - 1.0), x = (phi / (2.0 * PI) + 1.0) * light->profile_columns,
           sum = 0.0;
    uint32_t row = (uint32_t)fmin(y, light->profile_rows - 2.0), column = (uint32_t)x;
    double down = y - row, right = x - column;
    for (uint32_t i = 0; i < 4; i++) {
        size_t at = (size_t)light->profile_columns * (row + (i >> 1)) + (column + (i & 1)) % light->profile_columns;
        sum += (i >> 1 ? down : 1.0 - down) * (i & 1 ? right : 1.0 - right) * (double)light->profile[at];
    }
    return sum;
}

static bool scaled(const punctual *light, double scale, double E[3]) {
    for (int c = 0; c < 3; c++) E[c] = scale * light->intensity[c];
    return scale > 0.0;
}

bool punctual_irradiance(const punctual *light, const double toward[3], const double point[3], double width,
                         const double normal[3], double E[3]) {
    double to_light[3], away[3];
    if (light->kind == PUNCTUAL_DIRECTIONAL) return scaled(light, fmax(vec3_dot(normal, toward), 0.0), E);
    vec3_sub(to_light, light->position, point);
    double r = vec3_normalize(to_light), cosine = vec3_dot(normal, to_light);
    if (r == 0.0 || cosine <= 0.0) return false;
    double scale = cosine / square(r);
    if (light->range > 0.0) scale *= clamp01(1.0 - square(square(r / light->range)));
    for (int k = 0; k < 3; k++) away[k] = -to_light[k];
    if (light->kind == PUNCTUAL_SPOT) scale *= around_in_cone(light, away, 0.5 * width / r);
    if (light->profile) scale *= in_profile(light, away);
    return scaled(light, scale, E);
}

void punctual_set_aside(punctual *light, const double axis[3]) {
    double along = vec3_dot(axis, light->direction), back[3], other[3];
    vec3_add_scaled(light->aside[0], axis, -along, light->direction);
    for (int k = 0; k < 3; k++) back[k] = -light->direction[k];
    if (!(vec3_normalize(light->aside[0]) > 1e-9)) vec3_tangents(back, light->aside[0], other);
    vec3_cross(light->aside[1], back, light->aside[0]);
}

int punctual_directions(const punctual *light, int of_disc) {
    return light->angular_diameter > 0.0 ? of_disc : 1;
}

/* Points of the disc that the sun shows, seen flat: their density is even, so each stands for the same light. */
void punctual_toward(const punctual *light, int k, int count, double toward[3]) {
    double middle[3], u[3], v[3];
    for (int i = 0; i < 3; i++) toward[i] = middle[i] = -light->direction[i];
    if (count == 1) return;
    vec3_tangents(middle, u, v);
    double radius = sin(0.5 * light->angular_diameter) * sqrt((k + 0.5) / count), angle = k * GOLDEN_ANGLE;
    for (int i = 0; i < 3; i++)
        toward[i] = sqrt(1.0 - radius * radius) * middle[i] + radius * (cos(angle) * u[i] + sin(angle) * v[i]);
    vec3_normalize(toward);
}
