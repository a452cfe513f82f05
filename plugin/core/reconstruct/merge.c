/* SPDX-License-Identifier: MIT
 * See merge.h. Spots that go together (merge_spot.next) are known by the first of them, their leader.
 */
#include "merge.h"

#include "merge_faces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Shares of the tolerance that one round after the other may spend: what costs little goes first. */
static const double LIMITS[] = { 0.1, 0.3, 1.0 };

/* Of what costs less than this share of what may be spent, the best shape goes first. */
static const double ALIKE = 0.5;

enum { LEADERS_A_JOB = 256 };

/* The best way for a leader and what goes with it. */
typedef struct way {
    double error, shape; /* error: INFINITY if there is none */
    uint32_t target;     /* a spot of the leader's ring */
} way;

typedef struct merging {
    merge_faces faces;
    way *ways;         /* of leaders */
    uint32_t *touched; /* touched[spot]: the last round in which its triangles changed */
    uint32_t *dirty;   /* leaders whose ways are not known */
    bool *is_dirty;
    uint32_t dirty_count, round;
    struct offer *offers;
} merging;

typedef struct offer {
    double error, shape;
    uint32_t leader;
} offer;

/* ---- ways ----------------------------------------------------------------------------------------------------------
 */

/* Where a spot of a border must go so that it follows its leader to a place; MERGE_NONE if it cannot. */
static uint32_t follow(const merge_faces *m, const merge_ring *ring, uint32_t to, uint32_t from) {
    if (ring->first == MERGE_NONE) return MERGE_NONE;
    uint32_t a = m->spots[ring->first].place, b = m->spots[ring->last].place;
    if (a == to && b == from) return ring->first;
    return b == to && a == from ? ring->last : MERGE_NONE;
}

/* A way along the border: all that lie in one place go to the same end. */
static bool cost_of_border(const merge_faces *m, uint32_t leader, uint32_t to, uint32_t from, double limit,
                           merge_cost *out) {
    uint32_t spot = leader;
    *out = (merge_cost){ .error = 0.0, .shape = INFINITY };
    do {
        merge_ring ring;
        merge_cost cost;
        if (!merge_ring_find(m, spot, &ring)) return false;
        uint32_t target = follow(m, &ring, m->spots[to].place, m->spots[from].place);
        if (target == MERGE_NONE || !merge_ring_cost(m, spot, &ring, target, limit, &cost)) return false;
        out->error = fmax(out->error, cost.error);
        out->shape = fmin(out->shape, cost.shape);
        spot = m->spots[spot].next;
    } while (spot != leader);
    return true;
}

static void take_better(way *best, const merge_cost *cost, uint32_t target) {
    double error = fmax(cost->error, ALIKE * LIMITS[0]), shape = cost->shape;
    if (error > best->error || (error == best->error && shape <= best->shape)) return;
    *best = (way){ error, shape, target };
}

/* A spot of a ring to go into, by what can be said of it at once: it costs at least what changes where the spot was. */
typedef struct guess {
    merge_cost cost;
    uint32_t target;
} guess;

static int compare_guesses(const void *a, const void *b) {
    const guess *x = a, *y = b;
    if (x->cost.error != y->cost.error) return x->cost.error < y->cost.error ? -1 : 1;
    if (x->cost.shape != y->cost.shape) return x->cost.shape > y->cost.shape ? -1 : 1;
    return (x->target > y->target) - (x->target < y->target);
}

static way find_way_inside(const merge_faces *m, uint32_t leader, const merge_ring *ring) {
    way best = { .error = INFINITY, .target = MERGE_NONE };
    guess all[MERGE_RING_MAX];
    merge_cost cost;
    uint32_t count = 0;
    for (uint32_t i = 0; i < ring->count; i++) {
        if (!merge_ring_guess(m, leader, ring, ring->after[i], &cost)) continue;
        cost.error = fmax(cost.error, ALIKE * LIMITS[0]);
        all[count++] = (guess){ cost, ring->after[i] };
    }
    qsort(all, count, sizeof *all, compare_guesses);
    for (uint32_t i = 0; i < count && all[i].cost.error < 1.0; i++) {
        double limit = fmin(1.0, best.error);
        /* What remains costs more, or as much for a worse shape. */
        if (all[i].cost.error > limit || (all[i].cost.error == limit && all[i].cost.shape <= best.shape)) break;
        limit = fmin(1.0, limit * (1.0 + 1e-6));
        if (merge_ring_cost(m, leader, ring, all[i].target, limit, &cost)) take_better(&best, &cost, all[i].target);
    }
    return best;
}

static way find_way(const merge_faces *m, uint32_t leader) {
    way best = { .error = INFINITY, .target = MERGE_NONE };
    merge_ring ring;
    merge_cost cost;
    if (!merge_ring_find(m, leader, &ring)) return best;
    if (m->spots[leader].kind == MERGE_INSIDE) return find_way_inside(m, leader, &ring);
    if (cost_of_border(m, leader, ring.first, ring.last, 1.0, &cost)) take_better(&best, &cost, ring.first);
    if (cost_of_border(m, leader, ring.last, ring.first, 1.0, &cost)) take_better(&best, &cost, ring.last);
    return best;
}

static void find_ways(void *user, size_t item, unsigned worker) {
    merging *g = user;
    size_t first = LEADERS_A_JOB * item, end = first + LEADERS_A_JOB;
    (void)worker;
    if (end > g->dirty_count) end = g->dirty_count;
    for (size_t i = first; i < end; i++) g->ways[g->dirty[i]] = find_way(&g->faces, g->dirty[i]);
}

static void clean(merging *g) {
    jobs_run(g->faces.in->jobs, ((size_t)g->dirty_count + LEADERS_A_JOB - 1) / LEADERS_A_JOB, find_ways, NULL, g);
    for (uint32_t i = 0; i < g->dirty_count; i++) g->is_dirty[g->dirty[i]] = false;
    g->dirty_count = 0;
}

static void soil(merging *g, uint32_t spot) {
    uint32_t leader = g->faces.spots[spot].leader;
    if (g->faces.spots[leader].kind == MERGE_FIXED || g->faces.spots[leader].gone || g->is_dirty[leader]) return;
    g->is_dirty[leader] = true;
    g->dirty[g->dirty_count++] = leader;
}

/* ---- rounds --------------------------------------------------------------------------------------------------------
 */

static void collapse(merging *g, uint32_t spot, const merge_ring *ring, uint32_t target) {
    merge_ring_collapse(&g->faces, spot, ring, target);
    for (uint32_t i = 0; i < 2 * ring->count; i++) {
        uint32_t beside = i < ring->count ? ring->after[i] : ring->before[i - ring->count];
        g->touched[beside] = g->round;
        soil(g, beside);
    }
}

/* False if something around one of those that would go has changed in this round. */
static bool go(merging *g, uint32_t leader) {
    const merge_spot *spots = g->faces.spots;
    uint32_t spot = leader, to = spots[g->ways[leader].target].place, from = MERGE_NONE;
    merge_ring ring;
    do {
        if (g->touched[spot] == g->round) return false;
        spot = spots[spot].next;
    } while (spot != leader);
    do {
        merge_ring_find(&g->faces, spot, &ring);
        if (spot == leader && ring.first != MERGE_NONE)
            from = spots[g->ways[leader].target == ring.first ? ring.last : ring.first].place;
        collapse(g, spot, &ring, spot == leader ? g->ways[leader].target : follow(&g->faces, &ring, to, from));
        spot = spots[spot].next;
    } while (spot != leader);
    return true;
}

static int compare_offers(const void *a, const void *b) {
    const offer *x = a, *y = b;
    if (x->error != y->error) return x->error < y->error ? -1 : 1;
    if (x->shape != y->shape) return x->shape > y->shape ? -1 : 1;
    return (x->leader > y->leader) - (x->leader < y->leader);
}

/* How many went. */
static uint32_t play_round(merging *g, double limit) {
    uint32_t count = 0, went = 0;
    clean(g);
    g->round++;
    for (uint32_t s = 0; s < g->faces.spot_count; s++) {
        const merge_spot *spot = &g->faces.spots[s];
        if (spot->leader != s || spot->gone || spot->kind == MERGE_FIXED || !(g->ways[s].error < limit)) continue;
        g->offers[count++] = (offer){ fmax(g->ways[s].error, ALIKE * limit), g->ways[s].shape, s };
    }
    qsort(g->offers, count, sizeof *g->offers, compare_offers);
    for (uint32_t i = 0; i < count; i++) went += go(g, g->offers[i].leader);
    return went;
}

static bool open_merging(merging *g, const merge_input *in, const merge_triangles *triangles) {
    allocator *memory = jobs_memory(in->jobs);
    if (!merge_faces_open(in, triangles, &g->faces)) return false;
    size_t count = (size_t)g->faces.spot_count + 1;
    g->ways = block_new(memory, count * sizeof *g->ways);
    g->touched = block_zeroed(memory, count, sizeof *g->touched);
    g->dirty = block_new(memory, count * sizeof *g->dirty);
    g->is_dirty = block_zeroed(memory, count, sizeof *g->is_dirty);
    g->offers = block_new(memory, count * sizeof *g->offers);
    return g->ways && g->touched && g->dirty && g->is_dirty && g->offers;
}

static void free_merging(merging *g) {
    merge_faces_free(&g->faces);
    block_free(g->ways);
    block_free(g->touched);
    block_free(g->dirty);
    block_free(g->is_dirty);
    block_free(g->offers);
}

static void hand_back(const merge_faces *m, merge_triangles *out) {
    uint32_t count = 0;
    for (uint32_t t = 0; t < m->triangle_count; t++) {
        if (m->corners[3 * (size_t)t] == MERGE_NONE) continue;
        for (size_t k = 0; k < 3; k++)
            out->corners[3 * (size_t)count + k] = m->spots[m->corners[3 * (size_t)t + k]].vertex;
        out->faces[count++] = m->faces[t];
    }
    out->count = count;
}

bool merge(const merge_input *in, merge_triangles *triangles, merge_result *out) {
    merging g = { 0 };
    memset(out, 0, sizeof *out);
    bool ok = open_merging(&g, in, triangles);
    if (ok) {
        for (uint32_t s = 0; s < g.faces.spot_count; s++) soil(&g, s);
        for (size_t i = 0; i < sizeof LIMITS / sizeof *LIMITS; i++)
            while (play_round(&g, LIMITS[i]) > 0) {
            }
        merge_faces_measure(&g.faces, out);
        hand_back(&g.faces, triangles);
    }
    free_merging(&g);
    return ok;
}
