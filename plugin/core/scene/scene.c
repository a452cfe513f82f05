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
    double low[3], high[3];
    vec3_bounds(s->vertices, s->vertex_count, low, high);
    vec3_mid(s->center, low, high);
    s->radius = 0.5 * vec3_distance(low, high);
    if (s->has_surroundings) return;
    vec3_copy(s->things_center, s->center);
    s->things_radius = s->radius;
}
