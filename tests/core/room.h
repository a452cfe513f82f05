/* SPDX-License-Identifier: MIT
 * How does a test of the core get a scene to work on? Quads in a grid of patches and elements, laid out as the solver
 * wants them, without file formats or the library's front door.
 *
 *     room r = { 0 };
 *     uint32_t grey = room_material(&r, 0.5, 0.0);
 *     room_box(&r, low, high, true, grey, 2, 2);
 *     room_finish(&r);
 *     ...
 *     room_free(&r);
 */
#ifndef HEMIBAKE_TESTS_CORE_ROOM_H
#define HEMIBAKE_TESTS_CORE_ROOM_H

#include "base/tolerance.h"
#include "formfactor/column.h"
#include "formfactor/hemicube_weights.h"
#include "geometry/vec3.h"
#include "solver/subdivision.h"

#include <stdlib.h>
#include <string.h>

enum { ROOM_SURFACES_MAX = 512, ROOM_PATCHES_MAX = 4096, ROOM_ELEMENTS_MAX = 65536, ROOM_VERTICES_MAX = 131072 };

typedef struct room {
    arena memory;
    double *vertices;
    size_t vertex_count;
    surface surfaces[ROOM_SURFACES_MAX];
    size_t surface_count;
    material materials[8];
    size_t material_count;
    patch *patches;
    element *elements;
    float *positions; /* of the item geometry */
    uint32_t *indices, *triangle_surface;
    double *weights, *weights_light;
    scene scene;
    mesh mesh;
    item_geometry items;
} room;

static inline void room_start(room *r) {
    memset(r, 0, sizeof *r);
    r->vertices = arena_alloc(&r->memory, 3 * ROOM_VERTICES_MAX, sizeof *r->vertices);
    r->patches = arena_alloc(&r->memory, ROOM_PATCHES_MAX, sizeof *r->patches);
    r->elements = arena_alloc(&r->memory, ROOM_ELEMENTS_MAX, sizeof *r->elements);
    if (!r->vertices || !r->patches || !r->elements) abort();
}

static inline void room_free(room *r) {
    arena_free(&r->memory);
    free(r->weights);
    free(r->weights_light);
}

/* Grey in all three bands. */
static inline uint32_t room_material(room *r, double rho, double M) {
    r->materials[r->material_count] = (material){ .rho = { rho, rho, rho }, .M = { M, M, M } };
    return (uint32_t)r->material_count++;
}

static inline uint32_t room_vertex(room *r, const double position[3]) {
    if (r->vertex_count >= ROOM_VERTICES_MAX) abort();
    vec3_copy(r->vertices + 3 * r->vertex_count, position);
    return (uint32_t)r->vertex_count++;
}

static inline void room_make_space(const room *r, size_t surfaces, size_t patches, size_t elements) {
    if (r->surface_count + surfaces > ROOM_SURFACES_MAX || r->mesh.patch_count + patches > ROOM_PATCHES_MAX ||
        r->mesh.element_count + elements > ROOM_ELEMENTS_MAX)
        abort();
}

/* How a quad is cut: patches along its two sides, and elements along those of each patch. */
typedef struct room_cuts {
    int patches_u, patches_v, elements_u, elements_v;
} room_cuts;

/* A planar quad whose corners run counter-clockwise seen from its front. Returns the surface; its patches are the next
 * ones of the mesh, rows from corner 0 to 1 first. */
static inline uint32_t room_grid(room *r, const double corner[4][3], uint32_t material_index, const room_cuts *cuts) {
    int nu = cuts->patches_u * cuts->elements_u, nv = cuts->patches_v * cuts->elements_v;
    int patches = cuts->patches_u * cuts->patches_v, elements = cuts->elements_u * cuts->elements_v;
    uint32_t first = (uint32_t)r->vertex_count, index = (uint32_t)r->surface_count;
    size_t patch_count = r->mesh.patch_count, element_count = r->mesh.element_count;
    room_make_space(r, 1, (size_t)patches, (size_t)(patches * elements));
    for (int y = 0; y <= nv; y++)
        for (int x = 0; x <= nu; x++) {
            double p[3], u = (double)x / nu, v = (double)y / nv;
            for (int k = 0; k < 3; k++)
                p[k] = (1 - v) * ((1 - u) * corner[0][k] + u * corner[1][k]) +
                       v * ((1 - u) * corner[3][k] + u * corner[2][k]);
            room_vertex(r, p);
        }
#define ROOM_AT(x, y) (first + (uint32_t)((y) * (nu + 1) + (x)))
#define ROOM_CELL(x, y, w, h)                                                                                          \
    { ROOM_AT(x, y), ROOM_AT((x) + (w), y), ROOM_AT((x) + (w), (y) + (h)), ROOM_AT(x, (y) + (h)) }
    r->surfaces[r->surface_count++] =
        (surface){ .corner = ROOM_CELL(0, 0, nu, nv), .material = material_index, .twin = NO_INDEX };
    surface_measure(&r->surfaces[index], r->vertices);
    for (int p = 0; p < patches; p++) {
        int x0 = p % cuts->patches_u * cuts->elements_u, y0 = p / cuts->patches_u * cuts->elements_v;
        r->patches[patch_count++] = (patch){ .corner = ROOM_CELL(x0, y0, cuts->elements_u, cuts->elements_v),
                                             .surface = index,
                                             .first_element = (uint32_t)element_count,
                                             .element_count = (uint32_t)elements };
        for (int e = 0; e < elements; e++)
            r->elements[element_count++] =
                (element){ .corner = ROOM_CELL(x0 + e % cuts->elements_u, y0 + e / cuts->elements_u, 1, 1) };
    }
#undef ROOM_CELL
#undef ROOM_AT
    r->mesh.patch_count = patch_count;
    r->mesh.element_count = element_count;
    return index;
}

/* The quad at a with sides u and v, its front u x v, as patches x patches patches of elements x elements elements. */
static inline uint32_t room_quad(room *r, const double a[3], const double u[3], const double v[3],
                                 uint32_t material_index, int patches, int elements) {
    double corner[4][3];
    for (int k = 0; k < 3; k++) {
        corner[0][k] = a[k], corner[1][k] = a[k] + u[k];
        corner[2][k] = a[k] + u[k] + v[k], corner[3][k] = a[k] + v[k];
    }
    return room_grid(r, corner, material_index, &(room_cuts){ patches, patches, elements, elements });
}

/* A triangle as one patch of n x n elements. */
static inline uint32_t room_triangle(room *r, const double corner[3][3], uint32_t material_index, int n) {
    uint32_t first = (uint32_t)r->vertex_count, index = (uint32_t)r->surface_count;
    size_t element_count = r->mesh.element_count;
    room_make_space(r, 1, 1, (size_t)(n * n));
    for (int y = 0; y <= n; y++)
        for (int x = 0; x <= n - y; x++) {
            double p[3], u = (double)x / n, v = (double)y / n;
            for (int k = 0; k < 3; k++) p[k] = (1 - u - v) * corner[0][k] + u * corner[1][k] + v * corner[2][k];
            room_vertex(r, p);
        }
        /* Row y begins after n+1, n, ... vertices. */
#define ROOM_AT(x, y) (first + (uint32_t)((y) * (n + 1) - (y) * ((y)-1) / 2 + (x)))
    uint32_t whole[4] = { ROOM_AT(0, 0), ROOM_AT(n, 0), ROOM_AT(0, n), NO_INDEX };
    for (int y = 0; y < n; y++)
        for (int x = 0; x < n - y; x++) {
            r->elements[element_count++] =
                (element){ .corner = { ROOM_AT(x, y), ROOM_AT(x + 1, y), ROOM_AT(x, y + 1), NO_INDEX } };
            if (x + y < n - 1)
                r->elements[element_count++] =
                    (element){ .corner = { ROOM_AT(x + 1, y), ROOM_AT(x + 1, y + 1), ROOM_AT(x, y + 1), NO_INDEX } };
        }
#undef ROOM_AT
    r->surfaces[r->surface_count] = (surface){ .material = material_index, .twin = NO_INDEX };
    memcpy(r->surfaces[r->surface_count++].corner, whole, sizeof whole);
    surface_measure(&r->surfaces[index], r->vertices);
    r->patches[r->mesh.patch_count] = (patch){ .surface = index,
                                               .first_element = (uint32_t)r->mesh.element_count,
                                               .element_count = (uint32_t)(n * n) };
    memcpy(r->patches[r->mesh.patch_count++].corner, whole, sizeof whole);
    r->mesh.element_count = element_count;
    return index;
}

/* A sphere of planar facets, one patch each: triangles at its poles (z), trapezoids between; n x n elements a facet.
 * Its corners lie on the radius. Front outside, or inside. */
static inline void room_sphere(room *r, const double center[3], double radius, bool inside, uint32_t material_index,
                               int around, int up, int n) {
        for (int j = 0; j < up; j++)
        for (int i = 0; i < around; i++) {
            double c[4][3], triangle[3][3];
            for (int k = 0; k < 4; k++) {
                int side = k == 1 || k == 2 ? 1 : 0;
                double azimuth = 2 * PI * (i + (inside ? 1 - side : side)) / around,
                       polar = PI * (j + (k < 2 ? 1 : 0)) / up;
                c[k][0] = center[0] + radius * sin(polar) * cos(azimuth);
                c[k][1] = center[1] + radius * sin(polar) * sin(azimuth);
                c[k][2] = center[2] + radius * cos(polar);
            }
            if (j > 0 && j < up - 1) {
                room_grid(r, (const double(*)[3])c, material_index, &(room_cuts){ 1, 1, n, n });
                continue;
            }
            for (int k = 0; k < 3; k++) vec3_copy(triangle[k], c[j == 0 ? k : k == 0 ? 0 : k + 1]);
            room_triangle(r, (const double(*)[3])triangle, material_index, n);
        }
}

/* Six quads with their fronts inside or outside. Order: floor, ceiling (z), then the walls at low and high x, low and
 * high y. */
static inline void room_box(room *r, const double low[3], const double high[3], bool inside, uint32_t material_index,
                            int patches, int elements) {
    const double d[3] = { high[0] - low[0], high[1] - low[1], high[2] - low[2] };
    static const int normal_axis[3] = { 2, 0, 1 };
    for (int pair = 0; pair < 3; pair++)
        for (int side = 0; side < 2; side++) {
            int w = normal_axis[pair], i = (w + 1) % 3, k = (w + 2) % 3;
            double a[3], u[3] = { 0, 0, 0 }, v[3] = { 0, 0, 0 };
            vec3_copy(a, low);
            if (side) a[w] = high[w];
            /* i x k = +w, which points into the box on its low side. */
            bool swap = (side == 0) != inside;
            u[swap ? k : i] = d[swap ? k : i];
            v[swap ? i : k] = d[swap ? i : k];
            room_quad(r, a, u, v, material_index, patches, elements);
        }
}

/* A thin sheet: two quads back to back, of which item buffers draw the first. Returns the first. */
static inline uint32_t room_sheet(room *r, const double a[3], const double u[3], const double v[3],
                                  uint32_t material_index, int patches, int elements) {
    uint32_t front = room_quad(r, a, u, v, material_index, patches, elements);
    uint32_t back = room_quad(r, a, v, u, material_index, patches, elements);
    r->surfaces[front].twin = back;
    r->surfaces[back].twin = front;
    return front;
}

/* After the last quad: scene, mesh, and what item buffers draw. */
static inline void room_finish(room *r) {
    r->scene = (scene){ .vertices = r->vertices,
                        .vertex_count = r->vertex_count,
                        .surfaces = r->surfaces,
                        .surface_count = r->surface_count,
                        .materials = r->materials,
                        .material_count = r->material_count };
    scene_measure(&r->scene);
    r->mesh.vertices = r->vertices;
    r->mesh.vertex_count = r->vertex_count;
    r->mesh.patches = r->patches;
    r->mesh.elements = r->elements;
    if (!mesh_measure(&r->mesh, &r->memory)) abort();
    mesh_set_materials(&r->mesh, &r->scene);
    r->positions = arena_alloc(&r->memory, 3 * r->vertex_count, sizeof *r->positions);
    r->indices = arena_alloc(&r->memory, 6 * r->surface_count, sizeof *r->indices);
    r->triangle_surface = arena_alloc(&r->memory, 2 * r->surface_count, sizeof *r->triangle_surface);
    for (size_t i = 0; i < 3 * r->vertex_count; i++) r->positions[i] = (float)(r->vertices[i] - r->scene.center[i % 3]);
    size_t triangles = 0;
    for (size_t i = 0; i < r->surface_count; i++)
        for (int k = 1; k + 1 < surface_corner_count(&r->surfaces[i]) && surface_sheet(&r->scene, (uint32_t)i) == i;
             k++) {
            const uint32_t *corner = r->surfaces[i].corner;
            memcpy(r->indices + 3 * triangles, (uint32_t[]){ corner[0], corner[k], corner[k + 1] },
                   3 * sizeof(uint32_t));
            r->triangle_surface[triangles++] = (uint32_t)i;
        }
    r->items = (item_geometry){ r->positions,
                                r->vertex_count,
                                r->indices,
                                triangles,
                                (float)(TOLERANCE_NEAR_PLANE * r->scene.radius),
                                NULL,
                                NULL,
                                NULL, NULL };
}

/* How columns are computed in the tests: one resolution, closed forms nearer than five diameters [Baum89, fig. 4b]. */
static inline column_setup room_columns(room *r, int resolution, int light_depth) {
    r->weights = malloc(3 * (size_t)resolution * (size_t)resolution * sizeof *r->weights);
    hemicube_weights(resolution, r->weights);
    return (column_setup){ .scene = &r->scene,
                           .mesh = &r->mesh,
                           .items = r->items,
                           .triangle_surface = r->triangle_surface,
                           .resolution = resolution,
                           .resolution_light = resolution,
                           .weights = r->weights,
                           .weights_light = r->weights,
                           .seed = 1,
                           .shoot = subdivision_shoot,
                           .light_depth = light_depth,
                           .patch_depth = 1,
                           .light_tolerance = 0.005,
                           .near_diameters = 5.0 };
}

/* The column of a patch, or of the cluster that it leads. */
static inline column *room_column(const column_setup *setup, column_worker *w, uint32_t patch_index) {
    const subpatch whole = subpatch_of_patch(setup->scene, setup->mesh, patch_index);
    return column_compute(w, &whole);
}

#endif
