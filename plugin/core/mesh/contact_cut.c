/* SPDX-License-Identifier: MIT
 * See contact_cut.h. First every element of a sheet's front is cut by the lines that run through it; points on its
 * edges are noted under the places of the edge's ends. Then every element, of backs too, is handed out in triangles
 * that have all points on its edges as corners. Elements without any stay as they are.
 */
#include "mesh/contact_cut.h"

#include "geometry/triangle.h"
#include "mesh/contact_edges.h"
#include "mesh/contact_faces.h"
#include "mesh/contact_kinds.h"
#include "mesh/contact_near.h"
#include "mesh/contact_nodes.h"

#include <string.h>

/* Where patches are cut, elements are cut as exactly as that: a patch is as large as its elements together. */
static const double CHORD_SNAP = 2e-3;

/* An element that more lines run through is in a tangle, as the coil at the back of a refrigerator, whose wires are
 * planes through each other: light that gets there is lost between them, and cut it would be 64 pieces. */
enum { TANGLE = 16 };

/* Fewer are a tangle where the pieces would be so many times as many as elements, and more than these: ten rooms have
 * up to twice as many, and 5,000 blades of grass on a square metre 37 times, which took minutes. */
enum { TIMES_MOST = 4, ELEMENTS_FREE = 20000 };

/* How an element was cut. */
typedef struct record {
    piece_point *points;
    piece *all;
    int point_count, count;
} record;

typedef struct cutter {
    const refinement_setup *setup;
    const contact_lines *lines;
    arena memory;          /* of records */
    uint32_t *first_patch; /* of surfaces */
    contact_edges edges;
    const record **records; /* of elements; NULL: not cut */
    pair_map contacts;      /* of contact_nodes_part */
    contact_near near;
    double least, wide_gap;
    const deadline *latest;
    size_t tangle, added, added_max; /* elements that cuts add so far, and at most */
    contact_faces faces;             /* of the patch */
    uint64_t *in_faces;              /* of elements: a bit of each face of the patch that a piece of it is in */
    patch *patches;                  /* that there will be */
    size_t patch_count, patch_capacity;
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

/* The corners of a patch or an element; returns how many. */
static int corners_at(const cutter *c, const uint32_t vertex[4], double corner[4][3]) {
    int count = 0;
    for (; count < 4 && vertex[count] != NO_INDEX; count++) vec3_copy(corner[count], vertex_at(c, vertex[count]));
    return count;
}

/* The lines near a patch, and the faces that it is cut into; of a back those of the front. */
static void look_at(cutter *c, const patch *p, const patch *front) {
    uint32_t sheet = sheet_of(c, p);
    const surface *own = &c->setup->scene->surfaces[sheet];
    double corner[4][3];
    int count = corners_at(c, front->corner, corner);
    contact_near_patch(&c->near, c->lines, sheet, (const double(*)[3])corner, count, PIECES_SNAP);
    if (scene_is_black(c->setup->scene, own)) c->near.patch_count = 0;
    bool is_whole = scene_emits(c->setup->scene, own); /* what hides a part of an emitter is cut out exactly */
    contact_faces_find((const double(*)[3])corner, count, own->normal, c->near.patch,
                       is_whole ? 0 : c->near.patch_count, c->least, &c->faces);
}

/* The lines near an element; returns the diagonal of its box. */
static double look_at_element(cutter *c, const element *e, double share) {
    double corner[4][3];
    const int count = corners_at(c, e->corner, corner);
    return contact_near_element(&c->near, (const double(*)[3])corner, count, share);
}

/* ---- cutting ---- */

static void open_pieces(const cutter *c, const element *e, const patch *p, pieces *out) {
    double corner[4][3];
    int count = corners_at(c, e->corner, corner);
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

static uint32_t point_on_edge(void *user, int k, double at[3], double reach) {
    cutter *c = user;
    return contact_edges_point(&c->edges, c->cut, k, at, reach);
}

static bool cut_element(cutter *c, size_t index, const patch *p) {
    const element *e = &c->setup->mesh->elements[index];
    pieces cut = { .on_edge = point_on_edge, .user = c };
    bool ok = true, is_open = false;
    c->cut = e;
    look_at_element(c, e, PIECES_SNAP);
    const surface *f = &c->setup->scene->surfaces[p->surface];
    if (c->near.element_count > c->tangle && contact_near_through(&c->near, f->normal) > c->tangle) return true;
    for (size_t i = 0; ok && i < (size_t)c->faces.chord_count + c->near.element_count; i++) {
        bool is_chord = i < (size_t)c->faces.chord_count;
        const contact_line *l = is_chord ? &c->faces.chords[i] : c->near.element[i - (size_t)c->faces.chord_count];
        if (is_chord && !contact_near_has(&c->near, l)) continue;
        if (!is_open) open_pieces(c, e, p, &cut), is_open = true;
        ok = is_chord ? pieces_cut_as(&cut, l, CHORD_SNAP, 0.0) : pieces_cut(&cut, l);
    }
    /* A sheet's back is cut as its front is. */
    if (is_open) c->added += (size_t)(f->twin == NO_INDEX ? 1 : 2) * (size_t)(pieces_face_count(&cut) - 1);
    return ok && (!is_open || cut.count == 1 || keep_record(c, index, &cut));
}

/* All elements of fronts; ends early once more is added than may be, and when there is no more time for it. */
static bool cut_once(cutter *c) {
    const mesh *m = c->setup->mesh;
    for (size_t i = 0; i < m->patch_count && c->added <= c->added_max && !deadline_is_over(c->latest); i++) {
        const patch *p = &m->patches[i];
        if (sheet_of(c, p) != p->surface) continue;
        look_at(c, p, p);
        for (uint32_t e = 0; c->near.patch_count > 0 && e < p->element_count; e++)
            if (!cut_element(c, (size_t)p->first_element + e, p)) return false;
    }
    return true;
}

static bool forget_cuts(cutter *c) {
    contact_edges_close(&c->edges);
    arena_free(&c->memory);
    memset(c->records, 0, c->setup->mesh->element_count * sizeof *c->records);
    c->added = 0;
    return contact_edges_open(c->setup, &c->edges);
}

/* But those in a tangle: where that is too many anew, but those that half as many lines run through. */
static bool cut_all(cutter *c) {
    for (c->tangle = TANGLE; cut_once(c); c->tangle /= 2) {
        if (c->tangle == 0 || c->added <= c->added_max) return true;
        if (!forget_cuts(c)) return false;
    }
    return false;
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
    mesh_vertices_set_source(c->setup->vertices, &c->setup->sources[f->mesh], f, others, weights, count, v);
}

/* The weights of three corners at a point of the element. In a sliver they are not to be told by more than their
 * bounds. */
static void set_weights_inside(const cutter *c, const side *s, const uint32_t corner[3], const double at[3],
                               double w[3]) {
    triangle_weights(w, vertex_at(c, corner[0]), vertex_at(c, corner[1]), vertex_at(c, corner[2]), at);
    w[1] = fmin(fmax(w[1], 0.0), 1.0), w[2] = fmin(fmax(w[2], 0.0), 1.0);
    double sum = element_corner_count(s->front) == 3 ? fmax(w[1] + w[2], 1.0) : 1.0;
    w[1] /= sum, w[2] /= sum, w[0] = 1.0 - w[1] - w[2];
}

static uint32_t inner_vertex(cutter *c, const side *s, const double at[3]) {
    mesh_vertices *v = c->setup->vertices;
    uint32_t added = mesh_vertices_add(v, at, v->node_count);
    const uint32_t others[3] = { corner_of(s, 0), corner_of(s, 1), corner_of(s, element_corner_count(s->front) - 1) };
    double w[3] = { 1.0, 0.0, 0.0 };
    if (added == NO_INDEX) return NO_INDEX;
    v->node_count++;
    set_weights_inside(c, s, others, at, w);
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
    const surface *on = &c->setup->scene->surfaces[s->surface];
    return *v = contact_edges_vertex(&c->edges, on, corner_of(s, k), corner_of(s, k + 1), x->on_edge);
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
    const uint32_t *nodes = c->setup->vertices->nodes;
    for (int k = 0; k < n && c->near.element_count > 0; k++) {
        uint32_t a = e->corner[k], b = e->corner[(k + 1) % n];
        if (!contact_near_has_edge(&c->near, vertex_at(c, a), vertex_at(c, b), c->wide_gap, reach)) continue;
        uint64_t high, low = pair_order(nodes[a], nodes[b], &high);
        if (!pair_map_at(&c->contacts, low, high, 1)) return false;
    }
    return true;
}

static bool distribute_piece(cutter *c, side *s, const pieces *p, const piece *one, double reach) {
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
        for (uint32_t i = contact_edges_first(&c->edges, e, k); i != NO_INDEX; i = c->edges.points[i].next)
            pieces_point_on_edge(out, k, i, c->edges.points[i].at);
    return out->count > 1 || out->point_count > out->corner_count; /* a cut from corner to corner adds no point */
}

/* In which faces of its patch are the pieces of a front? */
static uint64_t faces_of(cutter *c, size_t front, const patch *p) {
    pieces cut;
    if (c->faces.count == 1) return 1;
    find_pieces(c, front, p, &cut);
    return contact_faces_of(&c->faces, &cut);
}

/* What of an element, whose front is this one, is in a face of its patch. */
static bool distribute_faces(cutter *c, size_t index, size_t front, const patch *p, int face) {
    const mesh *m = c->setup->mesh;
    pieces cut;
    side s = { &m->elements[front], &m->elements[index], p->surface, index != front, { 0 } };
    double reach = 1.05 * PIECES_SNAP * look_at_element(c, s.front, 2.0 * PIECES_SNAP), middle[3];
    bool is_cut = find_pieces(c, front, p, &cut), is_whole = c->in_faces[front] == UINT64_C(1) << face;
    for (int i = 0; i < cut.point_count; i++) s.vertex[i] = i < cut.corner_count ? corner_of(&s, i) : NO_INDEX;
    for (int i = 0; i < cut.count; i++) {
        pieces_middle(&cut, &cut.all[i], middle);
        if (!is_whole && contact_faces_holding(&c->faces, middle) != face) continue;
        bool ok = is_cut ? distribute_piece(c, &s, &cut, &cut.all[i], reach)
                         : add_element(c, s.own->corner) && note_contacts(c, &c->elements[c->element_count - 1], reach);
        if (!ok) return false;
    }
    return true;
}

/* The patch that is a face of another, without elements so far. */
static patch *add_patch(cutter *c, const patch *from, bool is_back, int face) {
    if (!block_grow(c->setup->mesh->memory, (void **)&c->patches, &c->patch_capacity, c->patch_count,
                    sizeof *c->patches))
        return NULL;
    patch *p = &c->patches[c->patch_count++];
    *p = *from;
    p->first_element = (uint32_t)c->element_count;
    if (c->faces.count == 1) return p;
    const uint8_t *points = c->faces.face[face];
    int n = points[3] == PIECE_NONE ? 3 : 4, corners = c->faces.cut.corner_count;
    p->corner[3] = NO_INDEX;
    for (int k = 0; k < n; k++) {
        uint32_t *to = &p->corner[is_back ? n - 1 - k : k];
        if (points[k] < corners)
            *to = from->corner[is_back ? corners - 1 - points[k] : points[k]];
        else
            *to = mesh_vertices_place(c->setup->vertices, from->corner[0], c->faces.cut.points[points[k]].at);
        if (*to == NO_INDEX) return NULL;
    }
    return p;
}

static bool distribute_pieces(cutter *c) {
    const mesh *m = c->setup->mesh;
    for (size_t i = 0; i < m->patch_count; i++) {
        const patch *p = &m->patches[i];
        const patch *front = &m->patches[c->first_patch[sheet_of(c, p)] + i - c->first_patch[p->surface]];
        look_at(c, p, front);
        uint64_t *in_faces = c->in_faces + front->first_element;
        for (uint32_t e = 0; e < p->element_count; e++) in_faces[e] = faces_of(c, (size_t)front->first_element + e, p);
        for (int face = 0; face < c->faces.count; face++) {
            if (!add_patch(c, p, p != front, face)) return false;
            for (uint32_t e = 0; e < p->element_count; e++)
                if (in_faces[e] >> face & 1 &&
                    !distribute_faces(c, (size_t)p->first_element + e, (size_t)front->first_element + e, p, face))
                    return false;
            patch *made = &c->patches[c->patch_count - 1];
            made->element_count = (uint32_t)c->element_count - made->first_element;
            if (made->element_count == 0) c->patch_count--;
        }
    }
    return true;
}

/* ---- all of it ---- */

static bool open_cutter(cutter *c, size_t elements_max) {
    const mesh *m = c->setup->mesh;
    const scene *s = c->setup->scene;
    c->memory.memory = c->contacts.memory = m->memory;
    c->first_patch = block_new(m->memory, (s->surface_count + 1) * sizeof *c->first_patch);
    c->records = block_zeroed(m->memory, m->element_count + 1, sizeof *c->records);
    c->in_faces = block_new(m->memory, (m->element_count + 1) * sizeof *c->in_faces);
    for (size_t i = m->patch_count; c->first_patch && i-- > 0;) c->first_patch[m->patches[i].surface] = (uint32_t)i;
    size_t most = TIMES_MOST * m->element_count;
    if (most < ELEMENTS_FREE) most = ELEMENTS_FREE;
    if (most > elements_max) most = elements_max;
    c->added_max = most > m->element_count ? most - m->element_count : 0;
    return contact_edges_open(c->setup, &c->edges) && c->first_patch && c->records && c->in_faces &&
           contact_near_open(m->memory, c->lines, s->surface_count, &c->near);
}

static void close_cutter(cutter *c) {
    contact_edges_close(&c->edges);
    pair_map_free(&c->contacts);
    contact_near_close(&c->near);
    block_free_all(c->first_patch, c->records, c->in_faces, c->elements, c->patches);
    arena_free(&c->memory);
}

/* Vertices may have moved when some were added. */
static void follow(const refinement_setup *setup) {
    setup->scene->vertices = setup->mesh->vertices = setup->vertices->positions;
    setup->scene->vertex_count = setup->mesh->vertex_count = setup->vertices->count;
    setup->mesh->nodes = setup->vertices->nodes;
    setup->mesh->node_count = setup->vertices->node_count;
}

bool contact_cut(const refinement_setup *setup, const contact_lines *lines, double least, double wide_gap,
                 uint32_t elements_max, const deadline *latest) {
    cutter c = { .setup = setup, .lines = lines, .least = least, .wide_gap = wide_gap, .latest = latest };
    mesh *m = setup->mesh;
    bool ok = open_cutter(&c, elements_max) && cut_all(&c) && distribute_pieces(&c);
    if (ok && c.element_count <= elements_max) {
        ok = contact_nodes_part(setup->vertices, c.elements, c.element_count, &c.contacts);
        element *elements = m->elements;
        patch *patches = m->patches;
        m->elements = c.elements, m->element_count = c.element_count;
        m->patches = c.patches, m->patch_count = c.patch_count;
        c.elements = elements, c.patches = patches;
    }
    follow(setup);
    if (ok) contact_kinds_set(setup->scene, lines, m, setup->jobs);
    close_cutter(&c);
    return ok;
}
