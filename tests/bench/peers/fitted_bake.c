/* SPDX-License-Identifier: MIT
 * See fitted_bake.h: which paths there are. fitted_solve.c fits.
 */
#include "fitted_bake.h"

#include "base/jobs.h"
#include "base/splitmix.h"
#include "geometry/vec3.h"

#include <hemibake/mesh_transform.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far the mesh may be from the surface that it shows, of the scene's radius: as converters/probes/match.h. */
static const double REACH = 2e-3;

/* Triangles a worker takes at a time. */
enum { CHUNK = 16 };

/* Tells the points of places from those of paths. */
static const uint64_t PLACES = 0x706c61636573u;

/* ---- the mesh ---------------------------------------------------------------------------------------------------- */

static void set_triangle(const fitted_bake *b, const uint32_t *vertex, fitted_triangle *t) {
    double ab[3], ac[3];
    for (int k = 0; k < 3; k++) {
        t->vertex[k] = vertex[k];
        vec3_from_floats(t->corner[k], b->positions + 3 * (size_t)vertex[k]);
    }
    vec3_sub(ab, t->corner[1], t->corner[0]);
    vec3_sub(ac, t->corner[2], t->corner[0]);
    vec3_cross(t->normal, ab, ac);
    t->area = vec3_normalize(t->normal) / 2;
}

static void add_mesh(fitted_bake *b, const hemi_mesh_desc *desc) {
    bool mirrors = desc->transform[15] != 0.0 && hemi_transform_determinant(desc->transform) < 0.0;
    uint32_t first = (uint32_t)b->vertex_count;
    for (size_t v = 0; v < desc->vertex_count; v++) {
        double at[3];
        hemi_transform_point(desc->transform, desc->positions + 3 * v, at);
        for (size_t k = 0; k < 3; k++) b->positions[3 * b->vertex_count + k] = (float)at[k];
        b->vertex_count++;
    }
    for (size_t t = 0; t < desc->triangle_count; t++) {
        uint32_t *to = b->indices + 3 * b->triangle_count;
        for (size_t k = 0; k < 3; k++) to[mirrors ? 2 - k : k] = first + desc->indices[3 * t + k];
        set_triangle(b, to, &b->triangles[b->triangle_count++]);
    }
}

bool fitted_bake_create(const radiance_tracer *tracer, const hemi_mesh_desc *meshes, size_t mesh_count,
                        fitted_bake *out) {
    size_t vertices = 0, triangles = 0;
    for (size_t i = 0; i < mesh_count; i++) {
        vertices += meshes[i].vertex_count;
        triangles += meshes[i].triangle_count;
    }
    *out = (fitted_bake){ .tracer = tracer };
    out->positions = malloc((3 * vertices + 1) * sizeof *out->positions);
    out->indices = malloc((3 * triangles + 1) * sizeof *out->indices);
    out->triangles = calloc(triangles + 1, sizeof *out->triangles);
    if (!out->positions || !out->indices || !out->triangles) return false;
    for (size_t i = 0; i < mesh_count; i++) add_mesh(out, &meshes[i]);
    double sum = 0;
    for (size_t t = 0; t < triangles; t++) sum += sqrt(out->triangles[t].area);
    for (size_t t = 0; t < triangles; t++) out->triangles[t].share = sqrt(out->triangles[t].area) / sum;
    return true;
}

void fitted_bake_destroy(fitted_bake *b) {
    free(b->positions);
    free(b->indices);
    free(b->triangles);
    memset(b, 0, sizeof *b);
}

/* ---- paths ------------------------------------------------------------------------------------------------------- */

/* Evenly over the triangle, from a point of the unit square folded along its diagonal. */
static void weights_at(double a, double b, double weights[3]) {
    if (a + b > 1) {
        a = 1 - a;
        b = 1 - b;
    }
    weights[0] = 1 - a - b;
    weights[1] = a;
    weights[2] = b;
}

static void count_path(fitted_triangle *t, const double w[3], const double L[3]) {
    t->counted++;
    for (int k = 0; k < 3; k++) {
        t->phi[k] += w[k] * w[k];
        t->phi[3 + k] += w[k] * w[(k + 1) % 3];
        for (int c = 0; c < 3; c++) t->right[k][c] += w[k] * L[c];
    }
}

static void add_path(const fitted_bake *b, size_t index) {
    fitted_triangle *t = &b->triangles[index];
    double u[SOBOL_DIMENSIONS], w[3], place[3] = { 0, 0, 0 }, rho[3], L[3], X[3] = { 0, 0, 0 };
    traced_point at;
    sobol_get(&b->tracer->points, t->paths, splitmix(index ^ splitmix(b->tracer->seed ^ PLACES)), u);
    weights_at(u[0], u[1], w);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) place[k] += w[i] * t->corner[i][k];
    uint32_t number = t->paths++;
    if (!traced_scene_locate(b->tracer->scene, place, t->normal, REACH * b->tracer->scene->radius, &at)) return;
    traced_scene_shade(b->tracer->scene, at.triangle, at.weights, rho, L);
    if (!vec3_is_zero(rho)) radiance_sample(b->tracer, &at, index, number, X);
    for (int c = 0; c < 3; c++) L[c] += rho[c] * X[c];
    count_path(t, w, L);
}

/* How many paths a triangle has of a total: its share, rounded up or down by a number of its own. */
static uint32_t paths_of(const fitted_bake *b, size_t index, double total) {
    return (uint32_t)(b->triangles[index].share * total + splitmix_unit(index));
}

static void add_chunk(void *user, size_t item, unsigned worker) {
    const fitted_bake *b = user;
    (void)worker;
    for (size_t t = item * CHUNK; t < (item + 1) * CHUNK && t < b->triangle_count; t++)
        for (uint32_t wanted = paths_of(b, t, b->paths); b->triangles[t].paths < wanted;) add_path(b, t);
}

bool fitted_bake_climb(fitted_bake *b, double paths_a_vertex, unsigned threads) {
    jobs *j = jobs_create(threads);
    b->paths = paths_a_vertex * (double)b->vertex_count;
    bool ok = j && jobs_run(j, (b->triangle_count + CHUNK - 1) / CHUNK, add_chunk, NULL, b);
    jobs_destroy(j);
    return ok;
}
