/* SPDX-License-Identifier: MIT
 * See weighted_normals.h. Vertices in one place that have one normal are one, whatever else files split them for.
 */
#include "mesh/weighted_normals.h"

#include "base/pair_map.h"
#include "geometry/places.h"
#include "geometry/triangle.h"

#include <string.h>

/* One less the cosine up to which two normals look the same way: 0.36 degrees, more than normals of 8 bits are off by.
 */
static const double ANOTHER = 2e-5;

/* The mean by area is taken where, by area, faces lean from it less than half as much as from the file's normal, and as
 * they do where each counts alike: what leans is small. One less the cosine is as the square of the angle. Facets of a
 * smooth shape lean alike from all of these, also where a mesh has them on one side alone. */
static const double LEANS_MORE = 4.0;

/* The faces around a vertex. */
typedef struct fan {
    double sum[3], plain[3]; /* of their normals by area, and of these alike, on the side of the vertex's normal */
    double area, count;
} fan;

typedef struct weighing {
    const source_mesh *mesh;
    size_t vertex_count, triangle_count;
    uint32_t *place, *root; /* of vertices: root is the first one that has the same place and normal */
    fan *fans;              /* of roots */
    pair_map roots;
} weighing;

/* The normal of a triangle times its area. */
static double area_of(const weighing *w, size_t triangle, double out[3]) {
    double p[3][3];
    triangle_from_floats(p, w->mesh->positions, w->mesh->indices + 3 * triangle);
    triangle_cross(out, p[0], p[1], p[2]);
    for (int k = 0; k < 3; k++) out[k] *= 0.5;
    return vec3_length(out);
}

/* The unit normal of a vertex; false: it has none. */
static bool normal_of(const weighing *w, uint32_t vertex, double out[3]) {
    vec3_from_floats(out, w->mesh->normals + 3 * (size_t)vertex);
    return vec3_normalize(out) > 0.0;
}

/* Does any corner have another normal than its face? Meshes with hard edges alone have none. */
static bool any_leans(const weighing *w) {
    for (size_t t = 0; t < w->triangle_count; t++) {
        double face[3], n[3], area = area_of(w, t, face);
        for (size_t k = 0; k < 3; k++)
            if (normal_of(w, w->mesh->indices[3 * t + k], n) && fabs(vec3_dot(n, face)) < (1.0 - ANOTHER) * area)
                return true;
    }
    return false;
}

/* The vertex that stands for all in one place with one normal; NULL when out of memory. */
static uint32_t *root_at(weighing *w, uint32_t vertex) {
    uint32_t bits[3];
    memcpy(bits, w->mesh->normals + 3 * (size_t)vertex, sizeof bits);
    uint64_t place = w->place[vertex];
    return pair_map_at(&w->roots, place << 32 | bits[0], (uint64_t)bits[1] << 32 | bits[2], vertex);
}

static bool find_roots(weighing *w, allocator *memory) {
    uint32_t *slots = block_new(memory, places_slot_count(w->vertex_count) * sizeof *slots);
    if (slots) places_find_floats(w->mesh->positions, w->vertex_count, slots, w->place);
    bool ok = slots;
    block_free(slots);
    for (uint32_t v = 0; ok && v < w->vertex_count; v++) {
        const uint32_t *root = root_at(w, v);
        ok = root;
        if (ok) w->root[v] = *root;
    }
    return ok;
}

static void add_faces(weighing *w) {
    for (size_t t = 0; t < w->triangle_count; t++) {
        double face[3], n[3], area = area_of(w, t, face);
        for (size_t k = 0; k < 3; k++) {
            uint32_t v = w->mesh->indices[3 * t + k];
            fan *of = &w->fans[w->root[v]];
            if (!(area > 0.0) || !normal_of(w, v, n)) continue;
            double side = vec3_dot(n, face) < 0.0 ? -1.0 : 1.0;
            vec3_add_scaled(of->sum, of->sum, side, face);
            vec3_add_scaled(of->plain, of->plain, side / area, face);
            of->area += area, of->count += 1.0;
        }
    }
}

/* Sets the mean by area where the file's normal leans much more than it does; true: it is set. */
static bool weigh(const weighing *w, uint32_t vertex, float out[3]) {
    const fan *of = &w->fans[w->root[vertex]];
    double n[3], mean[3];
    vec3_copy(mean, of->sum);
    if (!normal_of(w, vertex, n) || !(of->area > 0.0) || !(vec3_normalize(mean) > 0.0)) return false;
    double leans = 1.0 - vec3_dot(of->sum, n) / of->area, least = 1.0 - vec3_dot(of->sum, mean) / of->area;
    double alike = 1.0 - vec3_dot(of->plain, mean) / of->count;
    if (fmin(leans, alike) <= fmax(ANOTHER, LEANS_MORE * least)) return false;
    for (int k = 0; k < 3; k++) out[k] = (float)mean[k];
    return true;
}

static bool take_means(const weighing *w, source_mesh *m, arena *memory) {
    float *normals = arena_alloc(memory, 3 * w->vertex_count, sizeof *normals);
    bool any = false;
    if (!normals) return false;
    memcpy(normals, m->normals, 3 * w->vertex_count * sizeof *normals);
    for (uint32_t v = 0; v < w->vertex_count; v++) any |= weigh(w, v, normals + 3 * (size_t)v);
    if (any) m->normals = normals;
    return true;
}

bool weighted_normals(source_mesh *m, size_t vertex_count, size_t triangle_count, arena *memory) {
    weighing w = {
        .mesh = m, .vertex_count = vertex_count, .triangle_count = triangle_count, .roots = { .memory = memory->memory }
    };
    if (!m->normals || !any_leans(&w)) return true;
    w.place = block_new(memory->memory, (vertex_count + 1) * sizeof *w.place);
    w.root = block_new(memory->memory, (vertex_count + 1) * sizeof *w.root);
    w.fans = block_zeroed(memory->memory, vertex_count + 1, sizeof *w.fans);
    bool ok = w.place && w.root && w.fans && find_roots(&w, memory->memory);
    if (ok) add_faces(&w);
    ok = ok && take_means(&w, m, memory);
    pair_map_free(&w.roots);
    block_free_all(w.place, w.root, w.fans);
    return ok;
}
