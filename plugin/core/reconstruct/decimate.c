/* SPDX-License-Identifier: MIT
 * See decimate.h. Vertices that go together (decimate_vertex.next) are known by the first of them, their leader.
 */
#include "decimate.h"

#include "decimate_faces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Shares of the tolerance that one round after the other may spend: what costs little goes first. */
static const double LIMITS[] = { 0.1, 0.3, 1.0 };

/* Of what costs less than this share of what may be spent, the best shape goes first. */
static const double ALIKE = 0.5;

enum { LEADERS_A_JOB = 256 };

/* The best collapse for a leader and what goes with it. */
typedef struct collapse {
    double error, shape; /* error: INFINITY if there is none */
    uint32_t target;     /* a vertex of the leader's ring */
} collapse;

typedef struct decimation {
    decimate_faces faces;
    collapse *collapses; /* of leaders */
    uint32_t *touched;   /* touched[vertex]: the last round in which its triangles changed */
    uint32_t *dirty;     /* leaders whose collapses are not known */
    bool *is_dirty;
    uint32_t dirty_count, round;
    struct candidate *candidates;
} decimation;

typedef struct candidate {
    double error, shape;
    uint32_t leader;
} candidate;

/* ---- collapses ---- */

/* Where a vertex of a border must go so that it follows its leader to a place; DECIMATE_NONE if it cannot. */
static uint32_t follow(const decimate_faces *m, const decimate_ring *ring, uint32_t to, uint32_t from) {
    if (ring->first == DECIMATE_NONE) return DECIMATE_NONE;
    uint32_t a = m->vertices[ring->first].place, b = m->vertices[ring->last].place;
    if (a == to && b == from) return ring->first;
    return b == to && a == from ? ring->last : DECIMATE_NONE;
}

/* A collapse along the border: all that lie in one place go to the same end. */
static bool cost_of_border(const decimate_faces *m, uint32_t leader, uint32_t to, uint32_t from, double limit,
                           decimate_cost *out) {
    uint32_t vertex = leader;
    *out = (decimate_cost){ .error = 0.0, .shape = INFINITY };
    do {
        decimate_ring ring;
        decimate_cost cost;
        if (!decimate_ring_find(m, vertex, &ring)) return false;
        uint32_t target = follow(m, &ring, m->vertices[to].place, m->vertices[from].place);
        if (target == DECIMATE_NONE || !decimate_ring_cost(m, vertex, &ring, target, limit, &cost)) return false;
        out->error = fmax(out->error, cost.error);
        out->shape = fmin(out->shape, cost.shape);
        vertex = m->vertices[vertex].next;
    } while (vertex != leader);
    return true;
}

static void take_better(collapse *best, const decimate_cost *cost, uint32_t target) {
    double error = fmax(cost->error, ALIKE * LIMITS[0]), shape = cost->shape;
    if (error > best->error || (error == best->error && shape <= best->shape)) return;
    *best = (collapse){ error, shape, target };
}

/* A vertex of a ring to go into, by what can be said of it at once: it costs at least what changes where the vertex
 * was. */
typedef struct guess {
    decimate_cost cost;
    uint32_t target;
} guess;

static int compare_guesses(const void *a, const void *b) {
    const guess *x = a, *y = b;
    if (x->cost.error != y->cost.error) return x->cost.error < y->cost.error ? -1 : 1;
    if (x->cost.shape != y->cost.shape) return x->cost.shape > y->cost.shape ? -1 : 1;
    return (x->target > y->target) - (x->target < y->target);
}

static collapse find_collapse_inside(const decimate_faces *m, uint32_t leader, const decimate_ring *ring) {
    collapse best = { .error = INFINITY, .target = DECIMATE_NONE };
    guess all[DECIMATE_RING_MAX];
    decimate_cost cost;
    uint32_t count = 0;
    for (uint32_t i = 0; i < ring->count; i++) {
        if (!decimate_ring_guess(m, leader, ring, ring->after[i], &cost)) continue;
        cost.error = fmax(cost.error, ALIKE * LIMITS[0]);
        all[count++] = (guess){ cost, ring->after[i] };
    }
    qsort(all, count, sizeof *all, compare_guesses);
    for (uint32_t i = 0; i < count && all[i].cost.error < 1.0; i++) {
        double limit = fmin(1.0, best.error);
        /* What remains costs more, or as much for a worse shape. */
        if (all[i].cost.error > limit || (all[i].cost.error == limit && all[i].cost.shape <= best.shape)) break;
        limit = fmin(1.0, limit * (1.0 + 1e-6));
        if (decimate_ring_cost(m, leader, ring, all[i].target, limit, &cost)) take_better(&best, &cost, all[i].target);
    }
    return best;
}

static collapse find_collapse(const decimate_faces *m, uint32_t leader) {
    collapse best = { .error = INFINITY, .target = DECIMATE_NONE };
    decimate_ring ring;
    decimate_cost cost;
    if (!decimate_ring_find(m, leader, &ring)) return best;
    if (m->vertices[leader].kind == DECIMATE_INSIDE) return find_collapse_inside(m, leader, &ring);
    /* Closed, though a border runs through the place: a needle closes it, both of whose sides are edges of neighbours.
     */
    if (ring.first == DECIMATE_NONE) return best;
    if (cost_of_border(m, leader, ring.first, ring.last, 1.0, &cost)) take_better(&best, &cost, ring.first);
    if (cost_of_border(m, leader, ring.last, ring.first, 1.0, &cost)) take_better(&best, &cost, ring.last);
    return best;
}

static const collapse NO_COLLAPSE = { .error = INFINITY, .target = DECIMATE_NONE };

static void find_collapses(void *user, size_t item, unsigned worker) {
    decimation *g = user;
    size_t first = LEADERS_A_JOB * item, end = first + LEADERS_A_JOB;
    (void)worker;
    if (end > g->dirty_count) end = g->dirty_count;
    for (size_t i = first; i < end; i++)
        g->collapses[g->dirty[i]] =
            watcher_over(&g->faces.in->watch) ? NO_COLLAPSE : find_collapse(&g->faces, g->dirty[i]);
}

static void mark_dirty(decimation *g, uint32_t vertex) {
    uint32_t leader = g->faces.vertices[vertex].leader;
    if (g->faces.vertices[leader].kind == DECIMATE_FIXED || g->faces.vertices[leader].gone || g->is_dirty[leader])
        return;
    g->is_dirty[leader] = true;
    g->dirty[g->dirty_count++] = leader;
}

/* ---- rounds ---- */

static void apply_collapse(decimation *g, uint32_t vertex, const decimate_ring *ring, uint32_t target) {
    decimate_ring_collapse(&g->faces, vertex, ring, target);
    for (uint32_t i = 0; i < 2 * ring->count; i++) {
        uint32_t beside = i < ring->count ? ring->after[i] : ring->before[i - ring->count];
        g->touched[beside] = g->round;
        mark_dirty(g, beside);
    }
}

/* False if something around one of those that would go has changed in this round. */
static bool go(decimation *g, uint32_t leader) {
    const decimate_vertex *vertices = g->faces.vertices;
    uint32_t vertex = leader, to = vertices[g->collapses[leader].target].place, from = DECIMATE_NONE;
    decimate_ring ring;
    do {
        if (g->touched[vertex] == g->round) return false;
        vertex = vertices[vertex].next;
    } while (vertex != leader);
    do {
        decimate_ring_find(&g->faces, vertex, &ring);
        if (vertex == leader && ring.first != DECIMATE_NONE)
            from = vertices[g->collapses[leader].target == ring.first ? ring.last : ring.first].place;
        apply_collapse(g, vertex, &ring,
                       vertex == leader ? g->collapses[leader].target : follow(&g->faces, &ring, to, from));
        vertex = vertices[vertex].next;
    } while (vertex != leader);
    return true;
}

static int compare_candidates(const void *a, const void *b) {
    const candidate *x = a, *y = b;
    if (x->error != y->error) return x->error < y->error ? -1 : 1;
    if (x->shape != y->shape) return x->shape > y->shape ? -1 : 1;
    return (x->leader > y->leader) - (x->leader < y->leader);
}

/* Items that are left out would leave candidates as they were, so all are looked at. */
static bool wait(void *user) {
    const watcher *w = &((const decimation *)user)->faces.in->watch;
    if (w->wait) w->wait(w->user);
    return true;
}

static void record(decimation *g, uint32_t leader) {
    decimate_record *r = g->faces.in->record;
    if (!r || r->is_given) return;
    r->pairs[2 * r->count] = leader;
    r->pairs[2 * r->count++ + 1] = g->collapses[leader].target;
}

/* How many went. */
static uint32_t run_round(decimation *g, double limit) {
    uint32_t count = 0, went = 0;
    jobs_run(g->faces.in->jobs, ((size_t)g->dirty_count + LEADERS_A_JOB - 1) / LEADERS_A_JOB, find_collapses, wait, g);
    for (uint32_t i = 0; i < g->dirty_count; i++) g->is_dirty[g->dirty[i]] = false;
    g->dirty_count = 0;
    g->round++;
    for (uint32_t s = 0; s < g->faces.vertex_count; s++) {
        const decimate_vertex *vertex = &g->faces.vertices[s];
        if (vertex->leader != s || vertex->gone || vertex->kind == DECIMATE_FIXED || !(g->collapses[s].error < limit))
            continue;
        g->candidates[count++] = (candidate){ fmax(g->collapses[s].error, ALIKE * limit), g->collapses[s].shape, s };
    }
    qsort(g->candidates, count, sizeof *g->candidates, compare_candidates);
    for (uint32_t i = 0; i < count; i++) {
        if (!go(g, g->candidates[i].leader)) continue;
        record(g, g->candidates[i].leader);
        went++;
    }
    return went;
}

/* ---- once more ---- */

/* Does the way of a record exist, and cost less than the tolerance? */
static bool may_go(const decimate_faces *m, uint32_t leader, uint32_t target) {
    decimate_ring ring;
    decimate_cost cost;
    if (leader >= m->vertex_count || target >= m->vertex_count) return false;
    const decimate_vertex *vertex = &m->vertices[leader];
    if (vertex->leader != leader || vertex->gone || vertex->kind == DECIMATE_FIXED) return false;
    if (!decimate_ring_find(m, leader, &ring)) return false;
    if (vertex->kind == DECIMATE_BORDER) {
        bool is_first = ring.first == target;
        return ring.first != DECIMATE_NONE && (is_first || ring.last == target) &&
               cost_of_border(m, leader, target, is_first ? ring.last : ring.first, 1.0, &cost);
    }
    for (uint32_t i = 0; i < ring.count; i++)
        if (ring.after[i] == target) return decimate_ring_cost(m, leader, &ring, target, 1.0, &cost);
    return false;
}

/* Every collapse is a round of its own. */
static void repeat(decimation *g, const decimate_record *r) {
    for (size_t i = 0; i < r->count && !watcher_over(&g->faces.in->watch); i++) {
        uint32_t leader = r->pairs[2 * i], target = r->pairs[2 * i + 1];
        if (!may_go(&g->faces, leader, target)) continue;
        g->collapses[leader].target = target;
        g->round++;
        go(g, leader);
    }
}

static bool decimation_open(decimation *g, const decimate_input *in, const decimate_triangles *triangles) {
    allocator *memory = jobs_memory(in->jobs);
    if (!decimate_faces_open(in, triangles, &g->faces)) return false;
    size_t count = (size_t)g->faces.vertex_count + 1;
    g->collapses = block_new(memory, count * sizeof *g->collapses);
    g->touched = block_zeroed(memory, count, sizeof *g->touched);
    g->dirty = block_new(memory, count * sizeof *g->dirty);
    g->is_dirty = block_zeroed(memory, count, sizeof *g->is_dirty);
    g->candidates = block_new(memory, count * sizeof *g->candidates);
    decimate_record *r = in->record;
    if (r && !r->is_given) r->count = 0, r->pairs = arena_alloc(r->memory, 2 * count, sizeof *r->pairs);
    return g->collapses && g->touched && g->dirty && g->is_dirty && g->candidates && (!r || r->is_given || r->pairs);
}

static void compact_triangles(const decimate_faces *m, decimate_triangles *out) {
    uint32_t count = 0;
    for (uint32_t t = 0; t < m->triangle_count; t++) {
        if (m->corners[3 * (size_t)t] == DECIMATE_NONE) continue;
        for (size_t k = 0; k < 3; k++)
            out->corners[3 * (size_t)count + k] = m->vertices[m->corners[3 * (size_t)t + k]].vertex;
        out->faces[count++] = m->faces[t];
    }
    out->count = count;
}

bool decimate(const decimate_input *in, decimate_triangles *triangles, decimate_result *out) {
    decimation g = { 0 };
    memset(out, 0, sizeof *out);
    bool ok = decimation_open(&g, in, triangles);
    if (ok) {
        if (in->record && in->record->is_given) repeat(&g, in->record);
        for (uint32_t s = 0; s < g.faces.vertex_count; s++) mark_dirty(&g, s);
        for (size_t i = 0; i < sizeof LIMITS / sizeof *LIMITS; i++)
            while (!watcher_over(&in->watch) && run_round(&g, LIMITS[i]) > 0) {
            }
        decimate_faces_measure(&g.faces, out);
        compact_triangles(&g.faces, triangles);
    }
    decimate_faces_free(&g.faces);
    block_free_all(g.collapses, g.touched, g.dirty, g.is_dirty, g.candidates);
    return ok;
}
