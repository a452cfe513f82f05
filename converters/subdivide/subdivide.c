/* SPDX-License-Identifier: MIT
 * Which triangles, normals and attributes approximate the subdivision surface of a mesh? Cage, limit, then triangles.
 */
#include "subdivide.h"

#include "cage.h"
#include "osd_shim.h"

#include "geometry/triangle.h"

#include <string.h>

/* Of two diagonals one is shorter if it is by more than this, relative to squared length: float32 input and double
 * refinement leave equal ones equal to far less. */
#define DIAGONAL_NOISE 1e-6

/* ---- triangles ------------------------------------------------------------------------------------------------- */

static void cut_quad(const osd_points *points, const int *corners, uint32_t *out) {
    const double *p[4];
    for (int k = 0; k < 4; k++) p[k] = points->positions + 3 * (size_t)corners[k];
    double first = vec3_distance_squared(p[0], p[2]), second = vec3_distance_squared(p[1], p[3]);
    int start = second < (1.0 - DIAGONAL_NOISE) * first ? 1 : 0;
    const int order[6] = { 0, 1, 2, 0, 2, 3 };
    for (int i = 0; i < 6; i++) out[i] = (uint32_t)corners[(order[i] + start) % 4];
}

static uint32_t count_triangles(const osd_points *points) {
    uint32_t count = 0;
    for (size_t f = 0; f < points->facet_count; f++) count += points->facets[4 * f + 3] < 0 ? 1 : 2;
    return count;
}

static void cut_facets(const osd_points *points, uint32_t *indices) {
    for (size_t f = 0; f < points->facet_count; f++) {
        const int *corners = points->facets + 4 * f;
        if (corners[3] >= 0)
            cut_quad(points, corners, indices);
        else
            for (size_t k = 0; k < 3; k++) indices[k] = (uint32_t)corners[k];
        indices += corners[3] >= 0 ? 6 : 3;
    }
}

/* ---- normals --------------------------------------------------------------------------------------------------- */

/* Sums of facet normals weighted by area: sums[3*v+k]. */
static void sum_facets(const osd_points *points, const subdivide_surface *out, double *sums) {
    for (size_t t = 0; t < out->triangle_count; t++) {
        const uint32_t *corners = out->indices + 3 * t;
        double n[3];
        triangle_cross(n, points->positions + 3 * (size_t)corners[0], points->positions + 3 * (size_t)corners[1],
                       points->positions + 3 * (size_t)corners[2]);
        for (int i = 0; i < 3; i++)
            for (size_t k = 0; k < 3; k++) sums[3 * (size_t)corners[i] + k] += n[k];
    }
}

/* The limit normal; the facets' where tangents vanish or, at a point where the cage touches itself, are those of
 * another sheet; up where there is not even a facet. */
static void store_normal(const double *limit, const double *facets, float *out) {
    const double up[3] = { 0.0, 0.0, 1.0 };
    const double *n = limit;
    if (!(vec3_dot(n, n) > 0.0) || vec3_dot(n, facets) <= 0.0) n = facets;
    if (!(vec3_length(n) > 0.0)) n = up;
    double length = vec3_length(n);
    for (int k = 0; k < 3; k++) out[k] = (float)(n[k] / length);
}

static hemi_result store_normals(const osd_points *points, subdivide_surface *out) {
    double *facets = hemi_allocate_zeroed(out->memory, 3 * (size_t)points->vertex_count, sizeof *facets);
    if (!facets) return HEMI_ERROR_MEMORY;
    sum_facets(points, out, facets);
    for (size_t v = 0; v < points->vertex_count; v++)
        store_normal(points->normals + 3 * v, facets + 3 * v, out->normals + 3 * v);
    hemi_deallocate(out->memory, facets);
    return HEMI_OK;
}

/* ---- surface --------------------------------------------------------------------------------------------------- */

static float *to_floats(const hemi_allocator *memory, const double *values, size_t count) {
    float *out = hemi_allocate(memory, count * sizeof *out + 1);
    for (size_t i = 0; out && i < count; i++) out[i] = (float)values[i];
    return out;
}

static hemi_result store_surface(const cage *c, const osd_points *points, subdivide_surface *out) {
    out->vertex_count = points->vertex_count;
    out->triangle_count = count_triangles(points);
    out->positions = to_floats(out->memory, points->positions, 3 * (size_t)out->vertex_count);
    out->normals = hemi_allocate(out->memory, 3 * (size_t)out->vertex_count * sizeof *out->normals);
    out->indices = hemi_allocate(out->memory, 3 * (size_t)out->triangle_count * sizeof *out->indices);
    if (!out->positions || !out->normals || !out->indices) return HEMI_ERROR_MEMORY;
    if (c->value_width) {
        out->attributes = to_floats(out->memory, points->values, (size_t)c->value_width * out->vertex_count);
        out->attribute_count = c->value_width;
        if (!out->attributes) return HEMI_ERROR_MEMORY;
    }
    cut_facets(points, out->indices);
    return store_normals(points, out);
}

/* Triangles that the cage becomes: every corner of a Catmull-Clark face makes a quad, every Loop triangle makes four;
 * every further level makes four of one. */
static uint64_t predicted_triangles(const cage *c, hemi_subdivision_scheme scheme, uint32_t level) {
    uint64_t first = scheme == HEMI_SUBDIVISION_LOOP ? 4 * (uint64_t)c->face_count : 2 * (uint64_t)c->corner_count;
    return first << 2 * (level - 1);
}

static hemi_result check_size(const cage *c, const hemi_subdivision_desc *how, uint32_t max_triangles, char *message) {
    uint64_t most = max_triangles ? max_triangles : SUBDIVIDE_TRIANGLES_DEFAULT;
    if (most > SUBDIVIDE_TRIANGLES_MAX) most = SUBDIVIDE_TRIANGLES_MAX;
    uint64_t count = predicted_triangles(c, how->scheme, how->level);
    if (count <= most) return HEMI_OK;
    return subdivide_fail(HEMI_ERROR_LIMIT, message,
                          "subdivision level %lu makes %llu triangles; at most %llu are allowed",
                          (unsigned long)how->level, (unsigned long long)count, (unsigned long long)most);
}

static hemi_result subdivide_cage(const cage *c, const hemi_subdivision_desc *how, subdivide_surface *out,
                                  char *message) {
    osd_points points;
    hemi_result result = osd_limit(c, how, &points, message);
    if (result != HEMI_OK) return result;
    result = store_surface(c, &points, out);
    osd_points_destroy(&points);
    out->cage_faces = c->face_count;
    out->cage_quads = c->quad_count;
    out->dropped_triangles = c->dropped_triangles;
    return result == HEMI_OK ? result : subdivide_fail(result, message, "out of memory for the subdivision surface");
}

hemi_result subdivide_mesh(const hemi_allocator *memory, const hemi_mesh_desc *mesh, uint32_t max_triangles,
                           subdivide_surface *out, char message[SUBDIVIDE_MESSAGE_SIZE]) {
    cage c;
    *out = (subdivide_surface){ .memory = memory };
    message[0] = '\0';
    if (!mesh) return subdivide_fail(HEMI_ERROR_ARGUMENT, message, "no mesh to subdivide");
    const hemi_subdivision_desc *how = mesh->subdivision;
    if (!how || how->scheme == HEMI_SUBDIVISION_NONE || (unsigned)how->scheme > HEMI_SUBDIVISION_BILINEAR)
        return subdivide_fail(HEMI_ERROR_ARGUMENT, message,
                              "the subdivision scheme is not Catmull-Clark, Loop or bilinear");
    if ((unsigned)how->tessellation > HEMI_TESSELLATION_ADAPTIVE || (unsigned)how->boundary > HEMI_BOUNDARY_NONE ||
        (unsigned)how->face_varying > HEMI_FACE_VARYING_ALL)
        return subdivide_fail(HEMI_ERROR_ARGUMENT, message,
                              "the tessellation, boundary or face-varying rule is unknown");
    if (how->level < 1 || how->level > SUBDIVIDE_LEVEL_MAX)
        return subdivide_fail(HEMI_ERROR_ARGUMENT, message, "the subdivision level is not from 1 to 8");
    if (mesh->triangle_count > SUBDIVIDE_TRIANGLES_MAX)
        return subdivide_fail(HEMI_ERROR_LIMIT, message, "the control cage has too many triangles to be refined");
    hemi_result result = cage_create(memory, mesh, &c, message);
    if (result != HEMI_OK) return result;
    result = check_size(&c, how, max_triangles, message);
    if (result == HEMI_OK) result = subdivide_cage(&c, how, out, message);
    cage_destroy(&c);
    if (result != HEMI_OK) subdivide_surface_destroy(out);
    return result;
}

void subdivide_surface_destroy(subdivide_surface *surface) {
    if (!surface) return;
    hemi_deallocate(surface->memory, surface->positions);
    hemi_deallocate(surface->memory, surface->normals);
    hemi_deallocate(surface->memory, surface->attributes);
    hemi_deallocate(surface->memory, surface->indices);
    *surface = (subdivide_surface){ .memory = surface->memory };
}
