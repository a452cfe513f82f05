/* SPDX-License-Identifier: MIT
 * Which faces and shared vertices does the control cage have? Sorting finds the edges that
 * two faces share; every order is one of indices, so the same mesh always gives the same cage. */
#include "cage_builder.h"

#include "geometry/places.h"
#include "geometry/vec3.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

hemi_result subdivide_fail(hemi_result result, char *message, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, SUBDIVIDE_MESSAGE_SIZE, format, arguments);
    va_end(arguments);
    return result;
}

hemi_result cage_out_of_memory(const cage_builder *b) {
    return subdivide_fail(HEMI_ERROR_MEMORY, b->message, "out of memory for a control cage of %lu triangles",
                          (unsigned long)b->mesh->triangle_count);
}

/* ---- checks ---------------------------------------------------------------------------------------------------- */

static hemi_result check_triangles(const cage_builder *b) {
    const hemi_mesh_desc *mesh = b->mesh;
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
        uint32_t v = mesh->indices[i];
        if (v >= mesh->vertex_count)
            return subdivide_fail(HEMI_ERROR_DATA, b->message, "index %lu of triangle %zu is out of range",
                                  (unsigned long)v, i / 3);
        for (size_t k = 0; k < 3; k++)
            if (!isfinite(mesh->positions[3 * (size_t)v + k]))
                return subdivide_fail(HEMI_ERROR_DATA, b->message, "vertex %lu is not finite", (unsigned long)v);
    }
    return HEMI_OK;
}

/* A face of n corners is a fan of n - 2 triangles around its first corner. */
static hemi_result check_fans(const cage_builder *b) {
    const hemi_mesh_desc *mesh = b->mesh;
    uint64_t t = 0;
    for (uint32_t f = 0; f < b->how->face_count; f++) {
        uint32_t size = b->how->face_sizes[f];
        if (size < 3 || t + size - 2 > mesh->triangle_count)
            return subdivide_fail(HEMI_ERROR_DATA, b->message,
                                  "face %lu has fewer than 3 corners, or more than triangles", (unsigned long)f);
        const uint32_t *fan = mesh->indices + 3 * t;
        for (size_t k = 1; k + 2 < size; k++)
            if (fan[3 * k] != fan[0] || fan[3 * k + 1] != fan[3 * k - 1])
                return subdivide_fail(HEMI_ERROR_DATA, b->message,
                                      "the triangles of face %lu are no fan around a corner", (unsigned long)f);
        t += size - 2;
    }
    if (b->how->face_count == 0 || t == mesh->triangle_count) return HEMI_OK;
    return subdivide_fail(HEMI_ERROR_DATA, b->message, "the faces hold %llu triangles of %lu", (unsigned long long)t,
                          (unsigned long)mesh->triangle_count);
}

static hemi_result check_mesh(const cage_builder *b) {
    const hemi_mesh_desc *mesh = b->mesh;
    if (mesh->triangle_count == 0)
        return subdivide_fail(HEMI_ERROR_DATA, b->message, "a control cage without triangles");
    if (!mesh->positions || !mesh->indices || (b->how->face_count && !b->how->face_sizes))
        return subdivide_fail(HEMI_ERROR_ARGUMENT, b->message,
                              "a control cage without positions, indices or face sizes");
    hemi_result result = check_triangles(b);
    return result == HEMI_OK ? check_fans(b) : result;
}

/* ---- welding --------------------------------------------------------------------------------------------------- */

/* The cage has a vertex for each place that a triangle uses, where the first mesh vertex that is used there lies, and
 * in the order in which these come. b->welded has the places, and gets the cage's vertices. */
static void number_vertices(const cage_builder *b, uint32_t *vertex_at, uint8_t *used) {
    const hemi_mesh_desc *mesh = b->mesh;
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) used[mesh->indices[i]] = 1;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) vertex_at[v] = UINT32_MAX;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t *number = &vertex_at[b->welded[v]];
        if (used[v] && *number == UINT32_MAX) {
            *number = b->out->vertex_count++;
            vec3_from_floats(b->out->positions + 3 * (size_t)*number, mesh->positions + 3 * (size_t)v);
        }
        b->welded[v] = used[v] ? *number : UINT32_MAX;
    }
}

static hemi_result weld(cage_builder *b) {
    const hemi_allocator *memory = b->out->memory;
    size_t vertices = b->mesh->vertex_count;
    uint32_t *slots = hemi_allocate(memory, places_slot_count(vertices) * sizeof *slots);
    uint32_t *vertex_at = hemi_allocate(memory, vertices * sizeof *vertex_at);
    uint8_t *used = hemi_allocate_zeroed(memory, vertices, sizeof *used);
    b->welded = hemi_allocate(memory, vertices * sizeof *b->welded);
    b->out->positions = hemi_allocate(memory, 3 * vertices * sizeof *b->out->positions);
    bool ok = slots && vertex_at && used && b->welded && b->out->positions;
    if (ok) {
        places_find_floats(b->mesh->positions, vertices, slots, b->welded);
        number_vertices(b, vertex_at, used);
    }
    hemi_deallocate(memory, slots);
    hemi_deallocate(memory, vertex_at);
    hemi_deallocate(memory, used);
    return ok ? HEMI_OK : cage_out_of_memory(b);
}

/* ---- faces of the mesh ----------------------------------------------------------------------------------------- */

/* Corner k of the face whose fan begins with triangle t. */
static uint32_t fan_corner(const hemi_mesh_desc *mesh, size_t t, uint32_t k) {
    return k < 2 ? mesh->indices[3 * t + k] : mesh->indices[3 * (t + k - 2) + 2];
}

/* Adds a face without the corners that lie on the one before; what is left of fewer than three is dropped. */
static hemi_result add_face(cage_builder *b, uint32_t origin, size_t t, uint32_t size) {
    uint32_t begin = b->corner_count, end = begin;
    for (uint32_t k = 0; k < size; k++) {
        uint32_t source = fan_corner(b->mesh, t, k), v = b->welded[source];
        if (end > begin && b->corners[end - 1] == v) continue;
        b->sources[end] = source;
        b->corners[end++] = v;
    }
    while (end > begin + 1 && b->corners[end - 1] == b->corners[begin]) end--;
    b->out->dropped_triangles += end - begin < 3 ? size - 2 : size - (end - begin);
    if (end - begin < 3) return HEMI_OK;
    for (uint32_t i = begin; i < end; i++) {
        if (b->stamps[b->corners[i]] == b->face_count + 1)
            return subdivide_fail(HEMI_ERROR_DATA, b->message, "face %lu comes to one point twice",
                                  (unsigned long)origin);
        b->stamps[b->corners[i]] = b->face_count + 1;
    }
    b->origins[b->face_count++] = origin;
    b->first[b->face_count] = b->corner_count = end;
    return HEMI_OK;
}

static hemi_result make_mesh_faces(cage_builder *b) {
    const hemi_mesh_desc *mesh = b->mesh;
    size_t triangles = mesh->triangle_count, t = 0;
    b->mesh_face_count = b->how->face_count ? b->how->face_count : mesh->triangle_count;
    b->sources = hemi_allocate(b->out->memory, 3 * triangles * sizeof *b->sources);
    b->corners = hemi_allocate(b->out->memory, 3 * triangles * sizeof *b->corners);
    b->first = hemi_allocate_zeroed(b->out->memory, triangles + 1, sizeof *b->first);
    b->origins = hemi_allocate(b->out->memory, triangles * sizeof *b->origins);
    b->stamps = hemi_allocate_zeroed(b->out->memory, b->out->vertex_count, sizeof *b->stamps);
    if (!b->sources || !b->corners || !b->first || !b->origins || !b->stamps) return cage_out_of_memory(b);
    for (uint32_t f = 0; f < b->mesh_face_count; f++) {
        uint32_t size = b->how->face_count ? b->how->face_sizes[f] : 3;
        hemi_result result = add_face(b, f, t, size);
        if (result != HEMI_OK) return result;
        t += size - 2;
    }
    if (b->face_count == 0)
        return subdivide_fail(HEMI_ERROR_DATA, b->message, "no face of the control cage has three different corners");
    return HEMI_OK;
}

static hemi_result check_scheme(cage_builder *b) {
    for (uint32_t f = 0; b->how->scheme == HEMI_SUBDIVISION_LOOP && f < b->face_count; f++)
        if (b->first[f + 1] - b->first[f] != 3)
            return subdivide_fail(
                HEMI_ERROR_UNSUPPORTED, b->message,
                "face %lu has %lu corners, but Loop's scheme is one of triangles; ask for Catmull-Clark",
                (unsigned long)b->origins[f], (unsigned long)(b->first[f + 1] - b->first[f]));
    return HEMI_OK;
}

/* ---- edges ----------------------------------------------------------------------------------------------------- */

static int compare_edges(const void *left, const void *right) {
    const cage_edge *a = left, *b = right;
    if (a->low != b->low) return a->low < b->low ? -1 : 1;
    if (a->high != b->high) return a->high < b->high ? -1 : 1;
    return a->face < b->face ? -1 : a->face > b->face;
}

bool cage_same_edge(const cage_edge *a, const cage_edge *b) {
    return a->low == b->low && a->high == b->high;
}

static hemi_result sort_edges(cage_builder *b) {
    b->edges = hemi_allocate(b->out->memory, b->corner_count * sizeof *b->edges);
    if (!b->edges) return cage_out_of_memory(b);
    for (uint32_t f = 0; f < b->face_count; f++)
        for (uint32_t c = b->first[f]; c < b->first[f + 1]; c++) {
            uint32_t next = c + 1 < b->first[f + 1] ? c + 1 : b->first[f], from = b->corners[c], to = b->corners[next];
            b->edges[c] = (cage_edge){ from < to ? from : to, from < to ? to : from, f, c, next };
        }
    qsort(b->edges, b->corner_count, sizeof *b->edges, compare_edges);
    return HEMI_OK;
}

static hemi_result bad_edge(const cage_builder *b, const cage_edge *e, const char *fault) {
    const double *p = b->out->positions + 3 * (size_t)e->low, *q = b->out->positions + 3 * (size_t)e->high;
    return subdivide_fail(HEMI_ERROR_DATA, b->message, "the edge from (%g %g %g) to (%g %g %g) %s", p[0], p[1], p[2],
                          q[0], q[1], q[2], fault);
}

static bool is_upward(const cage_builder *b, const cage_edge *e) {
    return b->corners[e->corner] == e->low;
}

static hemi_result check_edges(cage_builder *b) {
    for (size_t i = 1; i < b->corner_count; i++) {
        const cage_edge *e = &b->edges[i];
        if (!cage_same_edge(e, e - 1)) continue;
        if (i >= 2 && cage_same_edge(e, e - 2))
            return bad_edge(b, e, "has more than two faces: a subdivision surface has at most two");
        if (is_upward(b, e) == is_upward(b, e - 1))
            return bad_edge(b, e, "has two faces that are wound against each other");
    }
    return HEMI_OK;
}

static hemi_result check_valence(cage_builder *b) {
    uint32_t *valence = hemi_allocate_zeroed(b->out->memory, b->out->vertex_count, sizeof *valence);
    if (!valence) return cage_out_of_memory(b);
    uint32_t most = 0;
    for (size_t i = 0; i < b->corner_count; i++) {
        if (i > 0 && cage_same_edge(&b->edges[i], &b->edges[i - 1])) continue;
        uint32_t low = ++valence[b->edges[i].low], high = ++valence[b->edges[i].high];
        if (low > most) most = low;
        if (high > most) most = high;
    }
    hemi_deallocate(b->out->memory, valence);
    if (most <= CAGE_VALENCE_MAX) return HEMI_OK;
    return subdivide_fail(HEMI_ERROR_LIMIT, b->message,
                          "%lu edges of the control cage meet in one vertex; at most %d may", (unsigned long)most,
                          CAGE_VALENCE_MAX);
}

/* ---- faces of the cage ----------------------------------------------------------------------------------------- */

static void add_cage_corner(cage_builder *b, uint32_t c, uint32_t *final_sources) {
    final_sources[b->out->corner_count] = b->sources[c];
    b->out->corners[b->out->corner_count++] = (int)b->corners[c];
}

/* A quad takes the place of the earlier one of its two triangles. */
static void add_cage_faces(cage_builder *b, uint32_t *final_sources) {
    for (uint32_t f = 0; f < b->face_count; f++) {
        uint32_t quad[4];
        if (b->partners[f] == SIZE_MAX) {
            b->pieces[f] = b->out->face_count;
            for (uint32_t c = b->first[f]; c < b->first[f + 1]; c++) add_cage_corner(b, c, final_sources);
            b->out->sizes[b->out->face_count++] = (int)(b->first[f + 1] - b->first[f]);
        } else if (b->edges[b->partners[f]].face == f) {
            cage_quad_corners(b, b->partners[f], quad);
            b->pieces[f] = b->pieces[b->edges[b->partners[f] + 1].face] = b->out->face_count;
            for (int k = 0; k < 4; k++) add_cage_corner(b, quad[k], final_sources);
            b->out->sizes[b->out->face_count++] = 4;
        }
    }
}

static hemi_result make_faces(cage_builder *b) {
    cage *out = b->out;
    uint32_t *final_sources = hemi_allocate(b->out->memory, b->corner_count * sizeof *final_sources);
    b->partners = hemi_allocate(b->out->memory, b->face_count * sizeof *b->partners);
    b->pieces = hemi_allocate(b->out->memory, b->face_count * sizeof *b->pieces);
    out->sizes = hemi_allocate(b->out->memory, b->face_count * sizeof *out->sizes);
    out->corners = hemi_allocate(b->out->memory, b->corner_count * sizeof *out->corners);
    hemi_result result = HEMI_OK;
    if (!final_sources || !b->partners || !b->pieces || !out->sizes || !out->corners) result = cage_out_of_memory(b);
    for (uint32_t f = 0; result == HEMI_OK && f < b->face_count; f++) b->partners[f] = SIZE_MAX;
    if (result == HEMI_OK && b->how->scheme == HEMI_SUBDIVISION_CATMULL_CLARK && b->how->face_count == 0)
        result = cage_pair_triangles(b);
    if (result == HEMI_OK) {
        add_cage_faces(b, final_sources);
        result = cage_add_features(b, final_sources);
    }
    hemi_deallocate(b->out->memory, final_sources);
    return result;
}

hemi_result cage_create(const hemi_allocator *memory, const hemi_mesh_desc *mesh, cage *out,
                        char message[SUBDIVIDE_MESSAGE_SIZE]) {
    cage_builder b = { .mesh = mesh, .how = mesh->subdivision, .out = out, .message = message };
    *out = (cage){ .memory = memory };
    hemi_result (*const stages[])(cage_builder *) = { weld,       make_mesh_faces, cage_mark_holes, check_scheme,
                                                      sort_edges, check_edges,     check_valence,   make_faces };
    hemi_result result = check_mesh(&b);
    for (size_t i = 0; result == HEMI_OK && i < sizeof stages / sizeof *stages; i++) result = stages[i](&b);
    void *scratch[] = { b.welded, b.sources, b.corners,  b.first, b.origins,
                        b.pieces, b.edges,   b.partners, b.holes, b.stamps };
    for (size_t i = 0; i < sizeof scratch / sizeof *scratch; i++) hemi_deallocate(memory, scratch[i]);
    if (result != HEMI_OK) cage_destroy(out);
    return result;
}

void cage_destroy(cage *c) {
    void *arrays[] = { c->positions, c->sizes,           c->corners, c->creases, c->crease_sharpness,
                       c->points,    c->point_sharpness, c->holes,   c->values,  c->value_corners };
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) hemi_deallocate(c->memory, arrays[i]);
    *c = (cage){ .memory = c->memory };
}
