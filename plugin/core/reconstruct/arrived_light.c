/* SPDX-License-Identifier: MIT
 * See arrived_light.h.
 */
#include "reconstruct/arrived_light.h"

#include "geometry/vec3.h"
#include "mesh/shading_normals.h"

/* Up to so many paths to lights are followed from a point. */
enum { PATHS_MAX = 4096 };

/* Whoever looks around sees neither what a pane leaves of the sky, nor holes. */
static bool sees_sky(const scene *s, const lights *from) {
    return from && from->has_sky && !s->panes && !s->tree;
}

bool arrived_light_open(const scene *s, const mesh *m, const double *arrived, const lights *from, int sun_directions,
                        arrived_light *out) {
    *out = (arrived_light){ .mesh = m, .scene = s, .arrived = arrived };
    if (!arrived || !from) return true;
    out->lights = (point_lights){
        .scene = s, .mesh = m, .lights = from->punctual, .count = from->punctual_count, .sun_directions = sun_directions
    };
    if (point_lights_paths(&out->lights) > PATHS_MAX) return true;
    if (sees_sky(s, from)) out->sky = from;
    if (from->punctual_count == 0) return true;
    out->lights.opaque = surface_bvh_create(s);
    return out->lights.opaque;
}

void arrived_light_close(arrived_light *a) {
    surface_bvh_destroy(a->lights.opaque);
}

/* Nothing where lights are not asked for. */
static bool lights_at(const arrived_light *a, const element *e, const lit_point *p, pane_crossings *scratch,
                      double E[3]) {
    E[0] = E[1] = E[2] = 0.0;
    return !a->lights.opaque || e->is_foot || point_lights_irradiance(&a->lights, p, scratch, E);
}

void arrived_light_add_sky(const arrived_light *a, const double direction[3], double weight, double L[3]) {
    double toward[3], from_there[3];
    if (!a->sky) return;
    vec3_copy(toward, direction);
    vec3_normalize(toward);
    lights_sky_radiance(a->sky, toward, from_there);
    vec3_add_scaled(L, L, weight, from_there);
}

/* What arrived at the samples by other ways, by their nearness; sum[c] is 0 before. */
static bool mean_of_samples(const arrived_light *a, const element *e, const double point[3], pane_crossings *scratch,
                            double sum[3]) {
    const mesh *m = a->mesh;
    const surface *f = &a->scene->surfaces[m->patches[e->patch].surface];
    double weights = 0.0, direct[3];
    for (size_t s = e->first_sample; s < (size_t)e->first_sample + (size_t)element_corner_count(e); s++) {
        const double at[3] = { m->x[s], m->y[s], m->z[s] };
        const lit_point there = { e->patch, at, mesh_sample_normal(m, f, s), sqrt(m->sample_area[s]) };
        double distance = vec3_distance(at, point), weight = 1.0 / (distance * distance + 1e-6 * e->area);
        if (!lights_at(a, e, &there, scratch, direct)) return false;
        weights += weight;
        for (size_t c = 0; c < 3; c++) sum[c] += weight * (a->arrived[3 * s + c] - direct[c]);
    }
    for (int c = 0; c < 3 && weights > 0.0; c++) sum[c] /= weights;
    return true;
}

bool arrived_light_add(const arrived_light *a, const element *e, const double point[3], const double normal[3],
                       pane_crossings *scratch, double E[3]) {
    const lit_point here = { e->patch, point, normal, 0.0 };
    double others[3] = { 0, 0, 0 }, direct[3];
    if (!a->arrived) return true;
    if (!a->sky && !mean_of_samples(a, e, point, scratch, others)) return false;
    if (!lights_at(a, e, &here, scratch, direct)) return false;
    for (int c = 0; c < 3; c++) E[c] += (others[c] + direct[c]) / PI;
    return true;
}
