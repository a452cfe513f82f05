/* SPDX-License-Identifier: MIT
 * See point_light.h.
 */
#include "light/point_light.h"

#include "geometry/vec3.h"
#include "mesh/shading_normals.h"
#include "scene/contact_lines.h"
#include "visibility/occlusion.h"

/* So many radii of the scene away there is nothing. */
static const double OUTSIDE_RADII = 3.0;

static int directions_of(const point_lights *l, const punctual *light) {
    return light->kind == PUNCTUAL_DIRECTIONAL ? punctual_directions(light, l->sun_directions) : 1;
}

size_t point_lights_paths(const point_lights *l) {
    size_t sum = 0;
    for (size_t i = 0; i < l->count; i++) sum += (size_t)directions_of(l, &l->lights[i]);
    return sum;
}

/* Adds what comes from a light by one of its directions. */
static bool add_light(const point_lights *l, const punctual *light, int k, const lit_point *p, const double place[3],
                      pane_crossings *scratch, double E[3]) {
    const scene *s = l->scene;
    const uint32_t own = l->mesh->patches[p->patch].surface, sheet = surface_sheet(s, own);
    double toward[3] = { 0, 0, 0 }, from[3], one[3], T[3] = { 1, 1, 1 };
    bool is_parallel = light->kind == PUNCTUAL_DIRECTIONAL;
    if (is_parallel) punctual_toward(light, k, directions_of(l, light), toward);
    if (!punctual_irradiance(light, toward, p->at, p->width, p->normal, one)) return true;
    if (is_parallel)
        vec3_add_scaled(from, place, OUTSIDE_RADII * s->radius, toward);
    else
        vec3_copy(from, light->position);
    if (occlusion_by_own(s, &s->surfaces[own], from, place)) return true;
    if (surface_bvh_blocks(l->opaque, s, sheet, from, place)) return true;
    if (s->panes && !panes_transmit(s->panes, sheet, p->at, from, scratch, T)) return false;
    for (int c = 0; c < 3; c++) E[c] += T[c] * one[c] / directions_of(l, light);
    return true;
}

bool point_lights_irradiance(const point_lights *l, const lit_point *p, pane_crossings *scratch, double E[3]) {
    const patch *of = &l->mesh->patches[p->patch];
    double place[3];
    bool ok = true;
    vec3_copy(place, p->at);
    if (of->is_smooth) shading_normals_lift(l->mesh, &l->scene->surfaces[of->surface], p->at, place);
    E[0] = E[1] = E[2] = 0.0;
    for (size_t i = 0; i < l->count; i++)
        for (int k = 0; ok && k < directions_of(l, &l->lights[i]); k++)
            ok = add_light(l, &l->lights[i], k, p, place, scratch, E);
    return ok;
}
