/* SPDX-License-Identifier: MIT
 * Triangles are walked in their order, and every so many square metres there is a point, in its triangle where an
 * additive recurrence of two irrational steps puts it, which leaves no gaps.
 */
#include "bake_probes.h"

#include "triangle_area.h"

#include <stdlib.h>

/* As many as the probes of a scene of tests, and more: they cost nothing. */
static const double PROBES = 50000.0;

/* Fractions of 1 by the plastic number, whose multiples fill a square evenly. */
static const double STEP[2] = { 0.7548776662466927, 0.5698402909980532 };

static void place(const match_mesh *m, const uint32_t *corner, const double normal[3], double area, size_t index,
                  probe *out) {
    double a = fmod(0.5 + (double)index * STEP[0], 1.0), b = fmod(0.5 + (double)index * STEP[1], 1.0);
    if (a + b > 1.0) a = 1.0 - a, b = 1.0 - b;
    const double weights[3] = { 1.0 - a - b, a, b };
    double side = hemi_transform_determinant(m->mesh->transform) < 0.0 ? -1.0 : 1.0;
    *out = (probe){ .standard_error = 0.0f };
    for (int i = 0; i < 3; i++) {
        double x[3];
        hemi_transform_point(m->mesh->transform, m->mesh->positions + 3 * (size_t)corner[i], x);
        for (int k = 0; k < 3; k++) {
            out->position[k] += (float)(weights[i] * x[k]);
            out->radiance[k] += (float)(weights[i] * (double)m->radiance[3 * (size_t)corner[i] + (size_t)k]);
        }
    }
    for (int k = 0; k < 3; k++) out->normal[k] = (float)(side * normal[k] / area);
}

bool bake_probes_make(const match_mesh *meshes, size_t count, probe_set *out) {
    double total = 0.0, walked = 0.0;
    for (size_t i = 0; i < count; i++) {
        const hemi_mesh_desc *m = meshes[i].mesh;
        total += mesh_area(m->positions, m->transform, m->indices, m->triangle_count);
    }
    *out = (probe_set){ malloc(((size_t)PROBES + 2) * sizeof *out->probes), 0 };
    for (size_t i = 0; out->probes && i < count; i++)
        for (size_t t = 0; t < meshes[i].mesh->triangle_count; t++) {
            const uint32_t *corner = meshes[i].mesh->indices + 3 * t;
            double normal[3],
                area = triangle_area(meshes[i].mesh->positions, meshes[i].mesh->transform, corner, normal);
            walked += area;
            while (area > 0.0 && (double)out->count < PROBES && ((double)out->count + 0.5) / PROBES * total <= walked) {
                place(&meshes[i], corner, normal, area, out->count, &out->probes[out->count]);
                out->count++;
            }
        }
    return out->probes;
}
