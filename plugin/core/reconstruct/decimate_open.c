/* SPDX-License-Identifier: MIT
 * How do triangles become faces whose vertices may go? See decimate_faces.h.
 */
#include "decimate_faces.h"

#include "base/tolerance.h"
#include "geometry/places.h"
#include "geometry/triangle.h"

#include <string.h>

/* No triangle becomes narrower than this, or than half of its whole face cut in two. Along the edge of a shadow light
 * changes in one direction, and long triangles are what it needs. */
static const double SHAPE = 0.1, SHAPE_OF_FACE = 0.5;

/* ---- vertices ---- */

static const double *position(const decimate_faces *m, uint32_t vertex) {
    return m->in->positions + 3 * (size_t)m->vertices[vertex].vertex;
}

/* Gives every face vertices of its own; with `count_only` says how many there will be. */
static uint32_t set_vertices(decimate_faces *m, const decimate_triangles *from, uint32_t *face_of, uint32_t *vertex_of,
                             bool count_only) {
    uint32_t count = 0;
    for (uint32_t v = 0; v < m->in->vertex_count; v++) face_of[v] = DECIMATE_NONE;
    for (size_t c = 0; c < 3 * (size_t)from->count; c++) {
        uint32_t v = from->corners[c], f = from->faces[c / 3];
        if (face_of[v] != f) {
            face_of[v] = f, vertex_of[v] = count;
            if (!count_only)
                m->vertices[count] = (decimate_vertex){ .vertex = v,
                                                        .node = m->in->nodes[v],
                                                        .face = f,
                                                        .first_corner = DECIMATE_NONE,
                                                        .place = DECIMATE_NONE,
                                                        .next = count };
            count++;
        }
        if (count_only) continue;
        m->corners[c] = vertex_of[v];
        m->next_corner[c] = m->vertices[vertex_of[v]].first_corner;
        m->vertices[vertex_of[v]].first_corner = (uint32_t)c;
    }
    return count;
}

static bool make_vertices(decimate_faces *m, const decimate_triangles *from) {
    allocator *memory = jobs_memory(m->in->jobs);
    uint32_t *face_of = block_new(memory, ((size_t)m->in->vertex_count + 1) * sizeof *face_of);
    uint32_t *vertex_of = block_new(memory, ((size_t)m->in->vertex_count + 1) * sizeof *vertex_of);
    if (face_of && vertex_of) {
        m->vertex_count = set_vertices(m, from, face_of, vertex_of, true);
        m->vertices = block_new(memory, ((size_t)m->vertex_count + 1) * sizeof *m->vertices);
    }
    if (m->vertices) set_vertices(m, from, face_of, vertex_of, false);
    block_free_all(face_of, vertex_of);
    return m->vertices;
}

/* ---- planes ---- */

/* Axes of the plane of triangles [first, end), which turn about u x v. */
static double set_axes(const decimate_faces *m, uint32_t first, uint32_t end, double u[3], double v[3]) {
    double n[3] = { 0, 0, 0 }, axis[3] = { 0, 0, 0 };
    for (uint32_t t = first; t < end; t++) {
        const uint32_t *c = m->corners + 3 * (size_t)t;
        double area[3];
        triangle_cross(area, position(m, c[0]), position(m, c[1]), position(m, c[2]));
        vec3_add_scaled(n, n, 0.5, area);
    }
    double area = vec3_normalize(n);
    int least = fabs(n[0]) <= fabs(n[1]) ? 0 : 1;
    if (fabs(n[2]) < fabs(n[least])) least = 2;
    axis[least] = 1.0;
    vec3_cross(u, n, axis);
    vec3_normalize(u);
    vec3_cross(v, n, u);
    return area;
}

/* Coordinates of the vertices of one face, and the least shape of its triangles. */
static void flatten(decimate_faces *m, uint32_t first, uint32_t end) {
    const double *origin = position(m, m->corners[3 * (size_t)first]);
    double u[3], v[3], low[2] = { 0, 0 }, high[2] = { 0, 0 }, area = set_axes(m, first, end, u, v);
    for (size_t c = 3 * (size_t)first; c < 3 * (size_t)end; c++) {
        double d[3];
        decimate_vertex *s = &m->vertices[m->corners[c]];
        vec3_sub(d, position(m, m->corners[c]), origin);
        s->at[0] = vec3_dot(d, u), s->at[1] = vec3_dot(d, v);
        for (int k = 0; k < 2; k++) low[k] = fmin(low[k], s->at[k]), high[k] = fmax(high[k], s->at[k]);
    }
    double x = high[0] - low[0], y = high[1] - low[1];
    m->shapes[m->faces[first]] = fmin(SHAPE, SHAPE_OF_FACE * area / (x * x + y * y));
}

/* ---- borders ---- */

static decimate_kind kind_of(const decimate_faces *m, uint32_t vertex) {
    const decimate_vertex *s = &m->vertices[vertex];
    decimate_ring ring;
    if (!decimate_ring_find(m, vertex, &ring) || (m->in->kept && m->in->kept[s->face])) return DECIMATE_FIXED;
    if (ring.first == DECIMATE_NONE) return DECIMATE_INSIDE;
    const double *a = m->vertices[ring.first].at, *c = m->vertices[ring.last].at;
    double u[2] = { s->at[0] - a[0], s->at[1] - a[1] }, v[2] = { c[0] - s->at[0], c[1] - s->at[1] };
    double along = u[0] * v[0] + u[1] * v[1], aside = u[0] * v[1] - u[1] * v[0];
    bool is_straight = along > 0.0 && fabs(aside) <= TOLERANCE_STRAIGHT * along;
    return is_straight ? DECIMATE_BORDER : DECIMATE_FIXED;
}

/* Vertices of borders in one place are a circle, in their order, that is fixed if one of them is. last[place]: the last
 * that is in it. */
static void join(decimate_faces *m, const uint32_t *place, uint32_t *last) {
    for (uint32_t s = 0; s < m->vertex_count; s++) {
        decimate_vertex *own = &m->vertices[s];
        if (own->kind == DECIMATE_INSIDE) continue;
        uint32_t *end = &last[place[own->vertex]];
        own->place = own->leader = own->next = *end == DECIMATE_NONE ? s : m->vertices[*end].leader;
        if (*end != DECIMATE_NONE) m->vertices[*end].next = s;
        if (own->kind == DECIMATE_FIXED) m->vertices[own->leader].kind = DECIMATE_FIXED;
        *end = s;
    }
    for (uint32_t s = 0; s < m->vertex_count; s++)
        if (m->vertices[m->vertices[s].leader].kind == DECIMATE_FIXED) m->vertices[s].kind = DECIMATE_FIXED;
}

static bool find_places(decimate_faces *m) {
    allocator *memory = jobs_memory(m->in->jobs);
    uint32_t place_count, *place = places_new(memory, m->in->positions, m->in->vertex_count, &place_count);
    uint32_t *last = place ? block_new(memory, ((size_t)place_count + 1) * sizeof *last) : NULL;
    for (uint32_t s = 0; s < m->vertex_count; s++) {
        m->vertices[s].kind = (uint8_t)kind_of(m, s);
        m->vertices[s].leader = s;
    }
    for (uint32_t p = 0; last && p < place_count; p++) last[p] = DECIMATE_NONE;
    if (last) join(m, place, last);
    block_free_all(place, last);
    return last;
}

/* ---- points ---- */

/* Edges inside a face are in two triangles, and are taken in one. */
static bool owns_edge(const decimate_faces *m, uint32_t a, uint32_t b) {
    return a < b || (m->vertices[a].kind != DECIMATE_INSIDE && m->vertices[b].kind != DECIMATE_INSIDE);
}

static bool set_points(decimate_faces *m) {
    allocator *memory = jobs_memory(m->in->jobs);
    size_t edges = 0;
    for (size_t c = 0; c < 3 * (size_t)m->triangle_count; c++)
        edges += owns_edge(m, m->corners[c], m->corners[c % 3 == 2 ? c - 2 : c + 1]);
    m->points = block_new(memory, (edges + m->vertex_count + 1) * sizeof *m->points);
    m->first_point = block_new(memory, ((size_t)m->triangle_count + 1) * sizeof *m->first_point);
    if (!m->points || !m->first_point || edges + m->vertex_count >= DECIMATE_NONE) return false;
    for (uint32_t t = 0; t < m->triangle_count; t++) m->first_point[t] = DECIMATE_NONE;
    for (size_t c = 0; c < 3 * (size_t)m->triangle_count; c++) {
        uint32_t a = m->corners[c], b = m->corners[c % 3 == 2 ? c - 2 : c + 1];
        if (!owns_edge(m, a, b)) continue;
        m->points[m->point_count] = (decimate_point){ a, b, m->first_point[c / 3] };
        m->first_point[c / 3] = m->point_count++;
    }
    return true;
}

bool decimate_faces_open(const decimate_input *in, const decimate_triangles *triangles, decimate_faces *out) {
    allocator *memory = jobs_memory(in->jobs);
    size_t corners = 3 * (size_t)triangles->count;
    *out = (decimate_faces){ .in = in, .faces = triangles->faces, .triangle_count = triangles->count };
    out->face_count = triangles->count ? triangles->faces[triangles->count - 1] + 1 : 0;
    out->corners = block_new(memory, (corners + 1) * sizeof *out->corners);
    out->next_corner = block_new(memory, (corners + 1) * sizeof *out->next_corner);
    out->shapes = block_new(memory, ((size_t)out->face_count + 1) * sizeof *out->shapes);
    if (!out->corners || !out->next_corner || !out->shapes || !make_vertices(out, triangles)) return false;
    for (uint32_t first = 0, end; first < out->triangle_count; first = end) {
        end = first + 1;
        while (end < out->triangle_count && out->faces[end] == out->faces[first]) end++;
        flatten(out, first, end);
    }
    return find_places(out) && set_points(out);
}

void decimate_faces_free(decimate_faces *m) {
    block_free_all(m->vertices, m->corners, m->next_corner, m->shapes, m->points, m->first_point);
    memset(m, 0, sizeof *m);
}
