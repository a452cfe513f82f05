/* SPDX-License-Identifier: MIT */
#include "scene/scene.h"

#include "geometry/places.h"
#include "geometry/polygon.h"

bool surface_measure(surface *f, const double *vertices) {
    double corner[4][3];
    size_t count = (size_t)surface_corner_count(f);
    for (size_t i = 0; i < count; i++) vec3_copy(corner[i], vertices + 3 * (size_t)f->corner[i]);
    polygon_loop_vector_area((polygon_loop){ (const double(*)[3])corner, count }, f->normal);
    f->area = vec3_normalize(f->normal);
    f->plane = vec3_dot(f->normal, vertices + 3 * (size_t)f->corner[0]);
    return f->area > 0.0;
}

uint32_t *scene_find_places(const scene *s, uint32_t *place_count) {
    return places_new(s->memory, s->vertices, s->vertex_count, place_count);
}

void scene_measure(scene *s) {
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t v = 0; v < s->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], s->vertices[3 * v + k]);
            high[k] = fmax(high[k], s->vertices[3 * v + k]);
        }
    }
    vec3_mid(s->center, low, high);
    s->radius = 0.5 * vec3_distance(low, high);
}
