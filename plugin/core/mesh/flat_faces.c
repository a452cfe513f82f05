/* SPDX-License-Identifier: MIT
 * See flat_faces.h. Whatever is joined is compared with the first of its face, not with its neighbour, so that a curve
 * of many facets does not count as flat because each hardly turns.
 */
#include "mesh/flat_faces.h"

#include "base/tolerance.h"
#include "geometry/triangle.h"

/* By how much an attribute may depart from what the first surface's corners make of it: floats of exported grids are
 * within some roundings (6e-8), and these grow with the distance from that surface. */
static const double ATTRIBUTE_OF_A_WEIGHT = 4e-7;

/* Further from a surface than this, in its own sizes, its roundings say nothing. */
static const double WEIGHTS_MOST = 1e4;

/* Of the surfaces around an edge that many share, so many are looked at. */
enum { AROUND_MOST = 8 };

/* What is affine over a face: a triangle of the source mesh that has its first surface. */
typedef struct face_frame {
    const source_mesh *mesh;
    const uint32_t *index;
} face_frame;

/* Where surfaces come from. */
typedef struct origin {
    const scene *scene;
    const mesh_vertices *vertices;
    const source_mesh *sources;
} origin;

/* The mesh's vertex that a corner of a surface is. */
static uint32_t input_vertex(const mesh_vertices *t, const source_mesh *m, uint32_t v) {
    const float *w = t->source_weights + 3 * (size_t)v;
    int k = w[0] > 0.5f ? 0 : w[1] > 0.5f ? 1 : 2;
    return m->indices[3 * (size_t)t->source_triangles[v] + (size_t)k];
}

/* Barycentric coordinates, of the point in the plane that is nearest. */
static bool weights_of(const face_frame *b, uint32_t vertex, double w[3]) {
    double p[3][3], x[3];
    triangle_from_floats(p, b->mesh->positions, b->index);
    vec3_from_floats(x, b->mesh->positions + 3 * (size_t)vertex);
    return triangle_weights(w, p[0], p[1], p[2], x) && fabs(w[0]) + fabs(w[1]) + fabs(w[2]) <= WEIGHTS_MOST;
}

/* Are values at a vertex what the frame makes of its own? */
static bool is_affine(const face_frame *b, const float *values, size_t stride, uint32_t vertex, const double w[3],
                      double tolerance, double tolerance_of_a_weight) {
    double most = tolerance + tolerance_of_a_weight * (fabs(w[0]) + fabs(w[1]) + fabs(w[2]));
    for (size_t k = 0; values && k < stride; k++) {
        double own = values[stride * vertex + k], sum = 0.0, size = fmax(1.0, fabs(own));
        for (int i = 0; i < 3; i++) {
            double v = values[stride * b->index[i] + k];
            sum += w[i] * v;
            size = fmax(size, fabs(v));
        }
        if (!(fabs(sum - own) <= most * size)) return false;
    }
    return true;
}

/* Is a vertex in the plane of the frame? */
static bool is_flat(const face_frame *b, uint32_t vertex) {
    double p[3][3], x[1][3], normal[3], size = 0.0;
    triangle_from_floats(p, b->mesh->positions, b->index);
    vec3_from_floats(x[0], b->mesh->positions + 3 * (size_t)vertex);
    triangle_cross(normal, p[0], p[1], p[2]);
    vec3_normalize(normal);
    for (int k = 0; k < 3; k++)
        size = fmax(fmax(size, fabs(x[0][k])), fmax(fabs(p[0][k]), fmax(fabs(p[1][k]), fabs(p[2][k]))));
    return plane_holds(normal, vec3_dot(normal, p[0]), (const double(*)[3])x, 1, TOLERANCE_OVERLAP * size);
}

/* Is a surface part of the face of a frame? */
static bool continues(const origin *o, const face_frame *b, const surface *s) {
    for (int k = 0; k < surface_corner_count(s); k++) {
        double w[3];
        uint32_t vertex = input_vertex(o->vertices, b->mesh, s->corner[k]);
        if (!weights_of(b, vertex, w) || !is_flat(b, vertex) ||
            !is_affine(b, b->mesh->normals, 3, vertex, w, TOLERANCE_AFFINE_NORMAL, 0.0) ||
            !is_affine(b, b->mesh->attributes, b->mesh->attribute_count, vertex, w, TOLERANCE_AFFINE,
                       ATTRIBUTE_OF_A_WEIGHT))
            return false;
    }
    return true;
}

/* Does an edge run from one vertex to another? */
static bool has_edge(const surface *s, uint32_t from, uint32_t to) {
    int n = surface_corner_count(s);
    for (int k = 0; k < n; k++)
        if (s->corner[k] == from && s->corner[(k + 1) % n] == to) return true;
    return false;
}

static bool joins(const origin *o, const face_frame *b, const surface *x, int k, const surface *y) {
    return y->mesh == x->mesh && has_edge(y, x->corner[(k + 1) % surface_corner_count(x)], x->corner[k]) &&
           vec3_dot(x->normal, y->normal) > 0.0 && continues(o, b, y);
}

static bool same_place(const scene *s, uint32_t v, uint32_t w) {
    return vec3_equal(scene_vertex(s, v), scene_vertex(s, w));
}

/* The next surface after y around the edge from p to q. */
static uint32_t next_around(const scene *s, uint32_t y, uint32_t p, uint32_t q) {
    const surface *g = &s->surfaces[y];
    int n = surface_corner_count(g);
    for (int k = 0; k < n; k++) {
        uint32_t a = g->corner[k], b = g->corner[(k + 1) % n];
        if ((same_place(s, a, p) && same_place(s, b, q)) || (same_place(s, a, q) && same_place(s, b, p)))
            return s->neighbours[4 * (size_t)y + (size_t)k];
    }
    return NO_INDEX;
}

/* What continues surface x across the edge from its corner k, or NO_INDEX; both sides of a sheet are around an edge. */
static uint32_t across(const origin *o, const face_frame *b, const uint32_t *first, uint32_t x, int k) {
    const scene *s = o->scene;
    const surface *g = &s->surfaces[x];
    uint32_t p = g->corner[k], q = g->corner[(k + 1) % surface_corner_count(g)];
    uint32_t y = s->neighbours[4 * (size_t)x + (size_t)k];
    for (int tries = 0; tries < AROUND_MOST && y != NO_INDEX && y != x; tries++, y = next_around(s, y, p, q))
        if (first[y] == NO_INDEX && joins(o, b, g, k, &s->surfaces[y])) return y;
    return NO_INDEX;
}

/* Everything that is one face with surface s. */
static void fill(const origin *o, uint32_t s, uint32_t *first, uint32_t *stack) {
    const surface *from = &o->scene->surfaces[s];
    const source_mesh *m = &o->sources[from->mesh];
    const face_frame b = { m, m->indices + 3 * (size_t)from->triangle[0] };
    uint32_t count = 0;
    stack[count++] = s;
    first[s] = s;
    while (count > 0) {
        uint32_t x = stack[--count];
        for (int k = 0; k < surface_corner_count(&o->scene->surfaces[x]); k++) {
            uint32_t y = across(o, &b, first, x, k);
            if (y == NO_INDEX) continue;
            first[y] = s;
            stack[count++] = y;
        }
    }
}

bool flat_faces_join(const scene *s, const mesh_vertices *vertices, const source_mesh *sources, uint32_t *first) {
    const origin o = { s, vertices, sources };
    uint32_t *stack = block_new(s->memory, (s->surface_count + 1) * sizeof *stack);
    for (size_t i = 0; i < s->surface_count; i++) first[i] = NO_INDEX;
    for (size_t i = 0; stack && i < s->surface_count; i++)
        if (first[i] == NO_INDEX) fill(&o, (uint32_t)i, first, stack);
    block_free(stack);
    return stack;
}
