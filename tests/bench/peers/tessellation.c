/* SPDX-License-Identifier: MIT */
#include "tessellation.h"

#include "base/splitmix.h"
#include "geometry/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far a vertex is seen from inside of its triangle, of the way to the middle: on an edge, half the rays would begin
 * behind the wall that meets it there. */
static const double INSIDE = 0.02;

/* Normals whose components differ by less are one. */
static const double SAME_NORMAL = 1e-3;

typedef struct place {
    double position[3], normal[3], weights[3];
} place;

/* What vertices must agree in to be one. */
typedef struct vertex_key {
    float position[3];
    int32_t normal[3];
    uint32_t mesh;
} vertex_key;

typedef struct builder {
    const traced_scene *scene;
    tessellation *out;
    double edge_squared;
    vertex_key *keys;            /* of the vertices */
    uint32_t *slots;             /* a hash table of vertices, 0: empty, else one more than its number */
    size_t slot_count, key_room; /* a power of two */
    uint32_t triangle;
    bool back;
} builder;

/* ---- vertices ---------------------------------------------------------------------------------------------------- */

static uint64_t hash(const vertex_key *k) {
    uint32_t words[7];
    uint64_t h = 0;
    memcpy(words, k, sizeof words);
    for (int i = 0; i < 7; i++) h = splitmix(h ^ words[i]);
    return h;
}

static bool grow_slots(builder *b) {
    if (2 * b->out->vertex_count < b->slot_count) return true;
    size_t count = b->slot_count ? 2 * b->slot_count : 4096;
    uint32_t *slots = calloc(count, sizeof *slots);
    if (!slots) return false;
    for (size_t v = 0; v < b->out->vertex_count; v++) {
        size_t at = hash(&b->keys[v]) & (count - 1);
        while (slots[at]) at = (at + 1) & (count - 1);
        slots[at] = (uint32_t)v + 1;
    }
    free(b->slots);
    b->slots = slots;
    b->slot_count = count;
    return true;
}

static bool grow_vertices(builder *b) {
    tessellation *t = b->out;
    if (t->vertex_count < t->vertex_room) return true;
    size_t room = t->vertex_room ? 2 * t->vertex_room : 4096;
    float *positions = realloc(t->positions, 3 * room * sizeof *positions);
    if (positions) t->positions = positions;
    uint32_t *first = realloc(t->first, room * sizeof *first);
    if (first) t->first = first;
    vertex_key *keys = realloc(b->keys, room * sizeof *keys);
    if (keys) b->keys = keys;
    if (positions && first && keys) t->vertex_room = room;
    return positions && first && keys;
}

static bool find_vertex(builder *b, const place *p, uint32_t *out) {
    vertex_key key = { .mesh = 2 * b->scene->triangles[b->triangle].mesh + b->back };
    for (int k = 0; k < 3; k++) {
        key.position[k] = (float)p->position[k];
        key.normal[k] = (int32_t)lround(p->normal[k] / SAME_NORMAL);
    }
    if (!grow_slots(b) || !grow_vertices(b)) return false;
    size_t at = hash(&key) & (b->slot_count - 1);
    for (; b->slots[at]; at = (at + 1) & (b->slot_count - 1))
        if (memcmp(&b->keys[b->slots[at] - 1], &key, sizeof key) == 0) {
            *out = b->slots[at] - 1;
            return true;
        }
    size_t v = b->out->vertex_count++;
    b->slots[at] = (uint32_t)v + 1;
    b->keys[v] = key;
    b->out->first[v] = UINT32_MAX;
    memcpy(b->out->positions + 3 * v, key.position, sizeof key.position);
    *out = (uint32_t)v;
    return true;
}

/* ---- triangles --------------------------------------------------------------------------------------------------- */

static bool grow_triangles(tessellation *t) {
    if (t->triangle_count < t->triangle_room) return true;
    size_t room = t->triangle_room ? 2 * t->triangle_room : 4096;
    if (room > UINT32_MAX / 6) return false;
    uint32_t *indices = realloc(t->indices, 3 * room * sizeof *indices);
    if (indices) t->indices = indices;
    tessellation_corner *corners = realloc(t->corners, 3 * room * sizeof *corners);
    if (corners) t->corners = corners;
    if (indices && corners) t->triangle_room = room;
    return indices && corners;
}

static bool add_leaf(builder *b, const place *const corner[3]) {
    tessellation *t = b->out;
    if (!grow_triangles(t)) return false;
    for (size_t k = 0; k < 3; k++) {
        size_t c = 3 * t->triangle_count + (b->back ? 2 - k : k);
        uint32_t v;
        if (!find_vertex(b, corner[k], &v)) return false;
        t->indices[c] = v;
        t->corners[c] = (tessellation_corner){ .triangle = b->triangle, .next = t->first[v], .back = b->back };
        t->first[v] = (uint32_t)c;
        for (int i = 0; i < 3; i++) {
            double middle = (corner[0]->weights[i] + corner[1]->weights[i] + corner[2]->weights[i]) / 3;
            t->corners[c].weights[i] = (float)((1 - INSIDE) * corner[k]->weights[i] + INSIDE * middle);
        }
    }
    t->triangle_count++;
    return true;
}

static place middle_of(const place *a, const place *b) {
    place m;
    vec3_mid(m.position, a->position, b->position);
    vec3_mid(m.weights, a->weights, b->weights);
    vec3_mid(m.normal, a->normal, b->normal);
    vec3_normalize(m.normal);
    return m;
}

static bool halve(builder *b, const place *p, const place *q, const place *r) {
    const place *corner[3] = { p, q, r };
    int longest = 0;
    double most = -1;
    for (int k = 0; k < 3; k++) {
        double length = vec3_distance_squared(corner[k]->position, corner[(k + 1) % 3]->position);
        if (length > most) {
            most = length;
            longest = k;
        }
    }
    if (most <= b->edge_squared) return add_leaf(b, corner);
    const place *from = corner[longest], *to = corner[(longest + 1) % 3], *apex = corner[(longest + 2) % 3];
    place middle = middle_of(from, to);
    return halve(b, from, &middle, apex) && halve(b, &middle, to, apex);
}

static void set_corner(const traced_scene *s, const traced_triangle *t, int k, place *out) {
    const hemi_mesh_desc *mesh = &s->meshes[t->mesh];
    *out = (place){ .weights = { k == 0, k == 1, k == 2 } };
    vec3_copy(out->position, t->corner[k]);
    vec3_copy(out->normal, t->normal);
    if (mesh->normals) vec3_from_floats(out->normal, mesh->normals + 3 * (size_t)t->vertex[k]);
}

bool tessellation_create(const traced_scene *s, double edge, tessellation *out) {
    builder b = { .scene = s, .out = out, .edge_squared = edge * edge };
    bool ok = true;
    memset(out, 0, sizeof *out);
    for (uint32_t t = 0; ok && t < s->triangle_count; t++) {
        place corner[3];
        for (int k = 0; k < 3; k++) set_corner(s, &s->triangles[t], k, &corner[k]);
        b.triangle = t;
        for (int side = 0; ok && side <= traced_scene_double_sided(s, t); side++) {
            b.back = side;
            ok = halve(&b, &corner[0], &corner[1], &corner[2]);
        }
    }
    free(b.keys);
    free(b.slots);
    return ok;
}

void tessellation_destroy(tessellation *t) {
    free(t->positions);
    free(t->indices);
    free(t->corners);
    free(t->first);
    memset(t, 0, sizeof *t);
}

void tessellation_point(const traced_scene *s, const tessellation_corner *corner, traced_point *out) {
    const traced_triangle *t = &s->triangles[corner->triangle];
    out->triangle = corner->triangle;
    for (int k = 0; k < 3; k++) {
        out->weights[k] = (double)corner->weights[k];
        out->normal[k] = corner->back ? -t->normal[k] : t->normal[k];
        out->position[k] = 0;
        for (int i = 0; i < 3; i++) out->position[k] += (double)corner->weights[i] * t->corner[i][k];
    }
    traced_scene_set_shading(s, out);
}
