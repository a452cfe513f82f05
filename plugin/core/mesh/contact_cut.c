/* SPDX-License-Identifier: MIT
 * See contact_cut.h. First every element of a sheet's front is cut by the lines that run through it; points on its
 * edges are noted under the places of the edge's ends. Then every element, of backs too, is handed out in triangles
 * that have all points on its edges as corners. Elements without any stay as they are.
 */
#include "mesh/contact_cut.h"

#include "geometry/places.h"
#include "geometry/triangle.h"
#include "mesh/contact_nodes.h"
#include "mesh/contact_pieces.h"

#include <string.h>

/* A point on an edge, from the end whose place has the lesser number. */
typedef struct edge_point {
    double t, at[3];
    uint32_t next; /* on the same edge, or NO_INDEX */
} edge_point;

/* How an element was cut. */
typedef struct record {
    piece_point *points;
    piece *all;
    int point_count, count;
} record;

typedef struct cutter {
    const refinement_setup *setup;
    const contact_lines *lines;
    arena memory; /* of records */
    uint32_t *places, *first_patch /* of surfaces */;
    pair_map edges; /* two places: the first point between them */
    edge_point *points;
    size_t point_count, point_capacity;
    const record **records;    /* of elements; NULL: not cut */
    pair_map vertices, nodes;  /* an edge and a point on it: what they are called */
    pair_map contacts;         /* of contact_nodes_part */
    const contact_line **near; /* those near a patch */
    size_t near_count;
    element *elements; /* that there will be */
    size_t element_count, element_capacity;
    const element *cut; /* that is being cut */
} cutter;

static const double *vertex_at(const cutter *c, uint32_t v) {
    return c->setup->vertices->positions + 3 * (size_t)v;
}

static uint32_t sheet_of(const cutter *c, const patch *p) {
    return surface_sheet(c->setup->scene, p->surface);
}

/* ---- lines near something ---- */

typedef struct box {
    double low[3], high[3];
} box;

static box box_of(const cutter *c, const uint32_t corner[4], double share) {
    box b = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
    for (int i = 0; i < 4 && corner[i] != NO_INDEX; i++)
        for (int k = 0; k < 3; k++) {
            b.low[k] = fmin(b.low[k], vertex_at(c, corner[i])[k]);
            b.high[k] = fmax(b.high[k], vertex_at(c, corner[i])[k]);
        }
    double reach = share * vec3_distance(b.low, b.high);
    for (int k = 0; k < 3; k++) b.low[k] -= reach, b.high[k] += reach;
    return b;
}

static bool box_has(const box *b, const contact_line *l) {
    for (int k = 0; k < 3; k++)
        if (fmin(l->from[k], l->to[k]) > b->high[k] || fmax(l->from[k], l->to[k]) < b->low[k]) return false;
    return true;
}

static void find_near(cutter *c, const patch *p) {
    const box around = box_of(c, p->corner, PIECES_SNAP);
    uint32_t sheet = sheet_of(c, p);
    c->near_count = 0;
    for (size_t i = c->lines->first[sheet]; i < c->lines->first[sheet + 1]; i++)
        if (box_has(&around, &c->lines->lines[i])) c->near[c->near_count++] = &c->lines->lines[i];
}

/* ---- points on edges ---- */

/* The places at the ends of the edge from corner k. */
static uint64_t edge_places(const cutter *c, const element *e, int k, uint64_t *high) {
    return pair_order(c->places[e->corner[k]], c->places[e->corner[(k + 1) % element_corner_count(e)]], high);
}

static uint32_t first_on_edge(const cutter *c, const element *e, int k) {
    uint64_t high, low = edge_places(c, e, k, &high);
    return pair_map_get(&c->edges, low, high, NO_INDEX);
}

static uint32_t add_on_edge(cutter *c, const element *e, int k, double at[3]) {
    uint64_t high, low = edge_places(c, e, k, &high);
    uint32_t *first = pair_map_at(&c->edges, low, high, NO_INDEX);
    uint32_t a = e->corner[k], b = e->corner[(k + 1) % element_corner_count(e)];
    if (!first ||
        !block_grow(c->setup->mesh->memory, (void **)&c->points, &c->point_capacity, c->point_count, sizeof *c->points))
        return NO_INDEX;
    const double *from = vertex_at(c, c->places[a] == low ? a : b), *to = vertex_at(c, c->places[a] == low ? b : a);
    double edge[3], offset[3];
    vec3_sub(edge, to, from);
    vec3_sub(offset, at, from);
    edge_point *p = &c->points[c->point_count];
    *p = (edge_point){ .t = vec3_dot(edge, offset) / vec3_dot(edge, edge), .next = *first };
    vec3_add_scaled(p->at, from, p->t, edge);
    vec3_copy(at, p->at);
    return *first = (uint32_t)c->point_count++;
}

static uint32_t point_on_edge(void *user, int k, double at[3], double reach) {
    cutter *c = user;
    uint32_t best = NO_INDEX;
    for (uint32_t i = first_on_edge(c, c->cut, k); i != NO_INDEX; i = c->points[i].next) {
        double distance = vec3_distance(c->points[i].at, at);
        if (distance <= reach) reach = distance, best = i;
    }
    if (best == NO_INDEX) return add_on_edge(c, c->cut, k, at);
    vec3_copy(at, c->points[best].at);
    return best;
}

/* ---- cutting ---- */

static void open_pieces(const cutter *c, const element *e, const patch *p, pieces *out) {
    double corner[4][3];
    int count = element_corner_count(e);
    for (int k = 0; k < count; k++) vec3_copy(corner[k], vertex_at(c, e->corner[k]));
    pieces_open(out, (const double(*)[3])corner, count, c->setup->scene->surfaces[p->surface].normal);
}

static bool keep_record(cutter *c, size_t index, const pieces *from) {
    record *r = arena_alloc(&c->memory, 1, sizeof *r);
    if (!r) return false;
    *r = (record){ .points = arena_alloc(&c->memory, (size_t)from->point_count, sizeof *r->points),
                   .all = arena_alloc(&c->memory, (size_t)from->count, sizeof *r->all),
                   .point_count = from->point_count,
                   .count = from->count };
    if (!r->points || !r->all) return false;
    memcpy(r->points, from->points, (size_t)from->point_count * sizeof *r->points);
    memcpy(r->all, from->all, (size_t)from->count * sizeof *r->all);
    c->records[index] = r;
    return true;
}

static bool cut_element(cutter *c, size_t index, const patch *p) {
    const element *e = &c->setup->mesh->elements[index];
    const box around = box_of(c, e->corner, PIECES_SNAP);
    pieces cut = { .on_edge = point_on_edge, .user = c };
    bool ok = true, is_open = false;
    c->cut = e;
    for (size_t i = 0; ok && i < c->near_count; i++) {
        if (!box_has(&around, c->near[i])) continue;
        if (!is_open) open_pieces(c, e, p, &cut);
        is_open = true;
        ok = pieces_cut(&cut, c->near[i]);
    }
    return ok && (!is_open || cut.count == 1 || keep_record(c, index, &cut));
}

static bool cut_all(cutter *c) {
    const mesh *m = c->setup->mesh;
    for (size_t i = 0; i < m->patch_count; i++) {
        const patch *p = &m->patches[i];
        if (sheet_of(c, p) != p->surface) continue;
        find_near(c, p);
        for (uint32_t e = 0; c->near_count > 0 && e < p->element_count; e++)
            if (!cut_element(c, (size_t)p->first_element + e, p)) return false;
    }
    return true;
}

/* ---- handing out ---- */

/* One element, or its twin on the back of a sheet, whose corners run the other way. */
typedef struct side {
    const element *front, *own;
    uint32_t surface;
    bool is_back;
    uint32_t vertex[PIECE_POINTS_MAX]; /* of points; NO_INDEX: not known yet */
} side;

static uint32_t corner_of(const side *s, int k) {
    int n = element_corner_count(s->front);
    return s->own->corner[s->is_back ? n - 1 - k % n : k % n];
}

static void set_source(cutter *c, const side *s, const uint32_t *others, const double *weights, int count, uint32_t v) {
    const surface *f = &c->setup->scene->surfaces[s->surface];
    mesh_vertices_set_source(c->setup->vertices, &c->setup->sources[f->mesh], f->triangle, others, weights, count, v);
}

static uint32_t edge_vertex(cutter *c, const side *s, int k, uint32_t point) {
    mesh_vertices *v = c->setup->vertices;
    uint32_t a = corner_of(s, k), b = corner_of(s, k + 1);
    uint64_t high, low = pair_order(a, b, &high);
    uint32_t *known = pair_map_at(&c->vertices, low << 32 | high, point, NO_INDEX);
    if (!known || *known != NO_INDEX) return known ? *known : NO_INDEX;
    low = pair_order(v->nodes[a], v->nodes[b], &high);
    uint32_t *node = pair_map_at(&c->nodes, low << 32 | high, point, v->node_count);
    if (!node) return NO_INDEX;
    if (*node == v->node_count) v->node_count++;
    *known = mesh_vertices_add(v, c->points[point].at, *node);
    if (*known == NO_INDEX) return NO_INDEX;
    double t = c->points[point].t, of_b = c->places[a] <= c->places[b] ? t : 1.0 - t;
    set_source(c, s, (uint32_t[]){ a, b }, (double[]){ 1.0 - of_b, of_b }, 2, *known);
    return *known;
}

static uint32_t inner_vertex(cutter *c, const side *s, const double at[3]) {
    mesh_vertices *v = c->setup->vertices;
    uint32_t added = mesh_vertices_add(v, at, v->node_count);
    const uint32_t others[3] = { corner_of(s, 0), corner_of(s, 1), corner_of(s, element_corner_count(s->front) - 1) };
    double w[3] = { 1.0, 0.0, 0.0 };
    if (added == NO_INDEX) return NO_INDEX;
    v->node_count++;
    triangle_weights(w, vertex_at(c, others[0]), vertex_at(c, others[1]), vertex_at(c, others[2]), at);
    set_source(c, s, others, w, 3, added);
    return added;
}

/* NO_INDEX when out of memory. */
static uint32_t vertex_of(cutter *c, side *s, const pieces *p, int point) {
    uint32_t *v = &s->vertex[point];
    const piece_point *x = &p->points[point];
    int k = 0;
    if (*v != NO_INDEX) return *v;
    if (x->on_edge == NO_INDEX) return *v = inner_vertex(c, s, x->at);
    while (!(x->edges & 1 << k)) k++;
    return *v = edge_vertex(c, s, k, x->on_edge);
}

static bool add_element(cutter *c, const uint32_t corner[4]) {
    if (!block_grow(c->setup->mesh->memory, (void **)&c->elements, &c->element_capacity, c->element_count,
                    sizeof *c->elements))
        return false;
    element *e = memset(&c->elements[c->element_count++], 0, sizeof *e);
    memcpy(e->corner, corner, sizeof e->corner);
    return true;
}

/* Notes which edges of a new element lie on contact lines. */
static bool note_contacts(cutter *c, const element *e, double reach) {
    int n = element_corner_count(e);
    for (size_t i = 0; i < c->near_count; i++) {
        const contact_line *l = c->near[i];
        for (int k = 0; k < n; k++) {
            const double *a = vertex_at(c, e->corner[k]), *b = vertex_at(c, e->corner[(k + 1) % n]);
            if (vec3_distance_to_segment(a, l->from, l->to) > reach ||
                vec3_distance_to_segment(b, l->from, l->to) > reach)
                continue;
            const uint32_t *nodes = c->setup->vertices->nodes;
            uint64_t high, low = pair_order(nodes[e->corner[k]], nodes[e->corner[(k + 1) % n]], &high);
            if (!pair_map_at(&c->contacts, low, high, 1)) return false;
        }
    }
    return true;
}

static bool hand_out_piece(cutter *c, side *s, const pieces *p, const piece *one, double reach) {
    uint8_t face[PIECE_POINTS_MAX][4];
    int count = pieces_faces(p, one, face);
    for (int i = 0; i < count; i++) {
        uint32_t corner[4] = { 0, 0, 0, NO_INDEX };
        int corners = face[i][3] == PIECE_NONE ? 3 : 4;
        for (int k = 0; k < corners; k++) {
            uint32_t v = vertex_of(c, s, p, face[i][k]);
            if (v == NO_INDEX) return false;
            corner[s->is_back ? corners - 1 - k : k] = v;
        }
        if (!add_element(c, corner) || !note_contacts(c, &c->elements[c->element_count - 1], reach)) return false;
    }
    return true;
}

/* The pieces of an element with all points on its edges; false if there is nothing but the element. */
static bool find_pieces(cutter *c, size_t front, const patch *p, pieces *out) {
    const element *e = &c->setup->mesh->elements[front];
    const record *r = c->records[front];
    open_pieces(c, e, p, out);
    if (r) {
        memcpy(out->points, r->points, (size_t)r->point_count * sizeof *r->points);
        memcpy(out->all, r->all, (size_t)r->count * sizeof *r->all);
        out->point_count = r->point_count, out->count = r->count;
    }
    for (int k = 0; k < element_corner_count(e); k++)
        for (uint32_t i = first_on_edge(c, e, k); i != NO_INDEX; i = c->points[i].next)
            pieces_point_on_edge(out, k, i, c->points[i].at);
    return out->point_count > out->corner_count;
}

/* An element, whose front is this one. */
static bool hand_out(cutter *c, size_t index, size_t front, const patch *p) {
    const mesh *m = c->setup->mesh;
    pieces cut;
    side s = { &m->elements[front], &m->elements[index], p->surface, index != front, { 0 } };
    const box around = box_of(c, s.front->corner, 0.0);
    double reach = 1.05 * PIECES_SNAP * vec3_distance(around.low, around.high);
    if (!find_pieces(c, front, p, &cut))
        return add_element(c, s.own->corner) && note_contacts(c, &c->elements[c->element_count - 1], reach);
    for (int i = 0; i < cut.point_count; i++) s.vertex[i] = i < cut.corner_count ? corner_of(&s, i) : NO_INDEX;
    for (int i = 0; i < cut.count; i++)
        if (!hand_out_piece(c, &s, &cut, &cut.all[i], reach)) return false;
    return true;
}

/* Element ranges of patches are those of the new elements. */
static bool hand_out_all(cutter *c, patch *out) {
    const mesh *m = c->setup->mesh;
    for (size_t i = 0; i < m->patch_count; i++) {
        const patch *p = &m->patches[i];
        size_t sheet_patch = c->first_patch[sheet_of(c, p)] + i - c->first_patch[p->surface];
        out[i] = *p;
        out[i].first_element = (uint32_t)c->element_count;
        find_near(c, p);
        for (uint32_t e = 0; e < p->element_count; e++)
            if (!hand_out(c, (size_t)p->first_element + e, (size_t)m->patches[sheet_patch].first_element + e, p))
                return false;
        out[i].element_count = (uint32_t)c->element_count - out[i].first_element;
    }
    return true;
}

/* ---- all of it ---- */

static bool open_cutter(cutter *c) {
    const mesh *m = c->setup->mesh;
    const scene *s = c->setup->scene;
    uint32_t place_count;
    size_t most = 0;
    for (size_t i = 0; i < s->surface_count; i++)
        most = most > c->lines->first[i + 1] - c->lines->first[i] ? most : c->lines->first[i + 1] - c->lines->first[i];
    c->memory.memory = c->edges.memory = c->vertices.memory = c->nodes.memory = c->contacts.memory = m->memory;
    c->places = places_new(m->memory, c->setup->vertices->positions, c->setup->vertices->count, &place_count);
    c->first_patch = block_new(m->memory, (s->surface_count + 1) * sizeof *c->first_patch);
    c->records = block_zeroed(m->memory, m->element_count + 1, sizeof *c->records);
    c->near = block_new(m->memory, (most + 1) * sizeof *c->near);
    for (size_t i = m->patch_count; c->first_patch && i-- > 0;) c->first_patch[m->patches[i].surface] = (uint32_t)i;
    return c->places && c->first_patch && c->records && c->near;
}

static void close_cutter(cutter *c) {
    pair_map_free(&c->edges);
    pair_map_free(&c->vertices);
    pair_map_free(&c->nodes);
    pair_map_free(&c->contacts);
    block_free_all(c->places, c->first_patch, c->points, c->records, c->near, c->elements);
    arena_free(&c->memory);
}

/* Vertices may have moved when some were added. */
static void follow(const refinement_setup *setup) {
    setup->scene->vertices = setup->mesh->vertices = setup->vertices->positions;
    setup->scene->vertex_count = setup->mesh->vertex_count = setup->vertices->count;
    setup->mesh->nodes = setup->vertices->nodes;
    setup->mesh->node_count = setup->vertices->node_count;
}

bool contact_cut(const refinement_setup *setup, const contact_lines *lines, uint32_t elements_max) {
    cutter c = { .setup = setup, .lines = lines };
    mesh *m = setup->mesh;
    patch *patches = block_new(m->memory, (m->patch_count + 1) * sizeof *patches);
    bool ok = patches && open_cutter(&c) && cut_all(&c) && hand_out_all(&c, patches);
    if (ok && c.element_count <= elements_max) {
        ok = contact_nodes_part(setup->vertices, c.elements, c.element_count, &c.contacts);
        memcpy(m->patches, patches, m->patch_count * sizeof *patches);
        element *before = m->elements;
        m->elements = c.elements, m->element_count = c.element_count;
        c.elements = before;
    }
    follow(setup);
    block_free(patches);
    close_cutter(&c);
    return ok;
}
