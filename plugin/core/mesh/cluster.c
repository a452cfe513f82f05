/* SPDX-License-Identifier: MIT
 * See cluster.h. Works on surfaces that are one patch each; in every round all pairs of groups that are each other's
 * best are merged.
 */
#include "mesh/cluster.h"

#include "base/splitmix.h"
#include "geometry/polygon.h"
#include "mesh/cluster_outline.h"
#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

/* Surfaces wider than this share of a cluster are left alone: hardly two would go together. */
static const double SMALL = 0.5;

/* An outline whose area is off by more than this factor has lost the shape of what it goes round. */
static const double SHARE_MAX = 1.3;

/* On regular grids costs are alike; a thousandth of chance keeps pairs from waiting for each other in a row. */
static const double CHANCE = 1e-3;

/* Surfaces that are merged, kept at the first of them. */
typedef struct group {
    uint32_t last, size;
    double low[3], high[3], vector[3]; /* of its box, m; vector area, m2 */
    double area, border;               /* m2; length of its outline, m */
    uint32_t edges;                    /* of its outline */
} group;

/* Where two groups meet. */
typedef struct meeting {
    uint32_t a, b; /* the first surfaces of the groups; a < b */
    uint32_t edges;
    double length;
} meeting;

typedef struct finder {
    const scene *scene;
    const mesh *mesh;
    const cluster_desc *desc;
    uint32_t *patch; /* of surfaces that may be in a cluster; NO_INDEX for others */
    uint32_t *mate;  /* scene_find_mates */
    uint32_t *first; /* of surfaces: the first one of their group */
    uint32_t *next;  /* of surfaces: the next one of their group, or NO_INDEX */
    group *groups;
    meeting *meetings;
    uint32_t *best; /* of groups: the one that each goes with best, or NO_INDEX */
    double *cost;   /* of groups: of going with it */
} finder;

/* ---- groups of one ---- */

/* patch[i]: the only patch of surface i, if that may be in a cluster. */
static void choose_surfaces(finder *f) {
    const scene *s = f->scene;
    for (size_t i = 0; i < s->surface_count; i++) f->patch[i] = f->first[i] = NO_INDEX;
    for (uint32_t p = 0; p < f->mesh->patch_count; p++) {
        uint32_t i = f->mesh->patches[p].surface;
        bool only = f->first[i] == NO_INDEX;
        f->first[i] = i;
        f->patch[i] = only ? p : NO_INDEX;
    }
    for (size_t i = 0; i < s->surface_count; i++) {
        const patch *p = f->patch[i] == NO_INDEX ? NULL : &f->mesh->patches[f->patch[i]];
        f->first[i] = (uint32_t)i;
        if (!p) continue;
        bool alone = material_emits(&p->material) && !f->desc->emitters;
        if (alone || s->surfaces[i].holes || p->diameter > SMALL * f->desc->size) f->patch[i] = NO_INDEX;
    }
}

static double edge_length(const scene *s, uint32_t edge) {
    const surface *f = &s->surfaces[edge / 4];
    int k = (int)(edge % 4);
    return vec3_distance(scene_vertex(s, f->corner[k]), scene_vertex(s, f->corner[(k + 1) % surface_corner_count(f)]));
}

static void start_group(finder *f, uint32_t i) {
    const surface *one = &f->scene->surfaces[i];
    group *g = &f->groups[i];
    *g = (group){ .last = i, .size = 1, .area = one->area, .edges = (uint32_t)surface_corner_count(one) };
    f->next[i] = NO_INDEX;
    for (int k = 0; k < 3; k++) {
        g->vector[k] = one->area * one->normal[k];
        g->low[k] = INFINITY, g->high[k] = -INFINITY;
    }
    for (uint32_t c = 0; c < g->edges; c++) {
        const double *at = scene_vertex(f->scene, one->corner[c]);
        for (int k = 0; k < 3; k++) g->low[k] = fmin(g->low[k], at[k]), g->high[k] = fmax(g->high[k], at[k]);
        g->border += edge_length(f->scene, 4 * i + c);
    }
}

/* ---- which go together ---- */

static int compare_meetings(const void *x, const void *y) {
    const meeting *p = x, *q = y;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return (p->b > q->b) - (p->b < q->b);
}

/* Lists the pairs of groups that meet, each once. Returns how many. */
static size_t list_meetings(finder *f) {
    size_t count = 0, merged = 0;
    for (uint32_t edge = 0; edge < 4 * f->scene->surface_count; edge++) {
        uint32_t mate = f->mate[edge];
        if (mate == NO_INDEX || f->patch[edge / 4] == NO_INDEX || f->patch[mate / 4] == NO_INDEX) continue;
        uint32_t a = f->first[edge / 4], b = f->first[mate / 4];
        if (a < b) f->meetings[count++] = (meeting){ a, b, 1, edge_length(f->scene, edge) };
    }
    qsort(f->meetings, count, sizeof *f->meetings, compare_meetings);
    for (size_t i = 0; i < count; i++) {
        meeting *last = merged ? &f->meetings[merged - 1] : NULL;
        if (last && compare_meetings(last, &f->meetings[i]) == 0)
            last->edges++, last->length += f->meetings[i].length;
        else
            f->meetings[merged++] = f->meetings[i];
    }
    return merged;
}

static bool all_face(const finder *f, uint32_t first, const double normal[3], double cosine) {
    for (uint32_t i = first; i != NO_INDEX; i = f->next[i])
        if (vec3_dot(f->scene->surfaces[i].normal, normal) < cosine) return false;
    return true;
}

static group united(const finder *f, const meeting *m) {
    const group *a = &f->groups[m->a], *b = &f->groups[m->b];
    group g = { .last = b->last, .size = a->size + b->size, .area = a->area + b->area };
    for (int k = 0; k < 3; k++) {
        g.low[k] = fmin(a->low[k], b->low[k]), g.high[k] = fmax(a->high[k], b->high[k]);
        g.vector[k] = a->vector[k] + b->vector[k];
    }
    g.border = a->border + b->border - 2.0 * m->length;
    g.edges = a->edges + b->edges - 2 * m->edges;
    return g;
}

/* Of uniting two groups: how far from round their outline is; infinite where they must not. */
static double cost_of(const finder *f, const meeting *m) {
    const surface *a = &f->scene->surfaces[m->a], *b = &f->scene->surfaces[m->b];
    if (a->material != b->material || a->mesh != b->mesh) return INFINITY;
    group g = united(f, m);
    double normal[3], cosine = cos(f->desc->angle);
    vec3_copy(normal, g.vector);
    if (g.edges < 3 || vec3_distance(g.low, g.high) > f->desc->size || vec3_normalize(normal) <= 0.0) return INFINITY;
    if (!all_face(f, m->a, normal, cosine) || !all_face(f, m->b, normal, cosine)) return INFINITY;
    return g.border * g.border / g.area * (1.0 + CHANCE * splitmix_unit(((uint64_t)m->a << 32) + m->b));
}

static void offer_partner(finder *f, uint32_t a, uint32_t b, double cost) {
    if (cost < f->cost[a]) f->cost[a] = cost, f->best[a] = b;
}

/* Returns whether any were united. */
static bool unite_pairs(finder *f) {
    size_t count = list_meetings(f);
    bool any = false;
    for (size_t i = 0; i < f->scene->surface_count; i++) f->best[i] = NO_INDEX, f->cost[i] = INFINITY;
    for (size_t i = 0; i < count; i++) {
        double cost = cost_of(f, &f->meetings[i]);
        offer_partner(f, f->meetings[i].a, f->meetings[i].b, cost);
        offer_partner(f, f->meetings[i].b, f->meetings[i].a, cost);
    }
    for (size_t i = 0; i < count; i++) {
        const meeting *m = &f->meetings[i];
        if (f->best[m->a] != m->b || f->best[m->b] != m->a) continue;
        group g = united(f, m);
        f->next[f->groups[m->a].last] = m->b;
        for (uint32_t k = m->b; k != NO_INDEX; k = f->next[k]) f->first[k] = m->a;
        f->groups[m->a] = g;
        any = true;
    }
    return any;
}

/* ---- clusters ---- */

static bool is_inside(const scene *s, const surface *f, const double point[3]) {
    for (int k = 0; k < surface_corner_count(f); k++) {
        const double *a = scene_vertex(s, f->corner[k]),
                     *b = scene_vertex(s, f->corner[(k + 1) % surface_corner_count(f)]);
        double along[3], to[3], n[3];
        vec3_sub(along, b, a);
        vec3_sub(to, point, a);
        vec3_cross(n, along, to);
        if (vec3_dot(n, f->normal) < 0.0) return false;
    }
    return true;
}

/* On the member nearest to the middle, as near to it as the member's plane gets. */
static void set_eye(const finder *f, uint32_t first, cluster *c) {
    double middle[3] = { 0, 0, 0 }, nearest = INFINITY;
    const patch *chosen = &f->mesh->patches[f->patch[first]]; /* where no distance is a number */
    for (uint32_t i = first; i != NO_INDEX; i = f->next[i]) {
        const patch *p = &f->mesh->patches[f->patch[i]];
        vec3_add_scaled(middle, middle, p->area / c->area, p->center);
    }
    for (uint32_t i = first; i != NO_INDEX; i = f->next[i]) {
        const patch *p = &f->mesh->patches[f->patch[i]];
        double distance = vec3_distance(p->center, middle);
        if (distance < nearest) nearest = distance, chosen = p;
    }
    const surface *on = &f->scene->surfaces[chosen->surface];
    vec3_add_scaled(c->eye, middle, -surface_height(on, middle), on->normal);
    if (!is_inside(f->scene, on, c->eye)) vec3_copy(c->eye, chosen->center);
}

static bool make_cluster(const finder *f, const cluster_edges *edges, uint32_t first, uint32_t *members, cluster *c) {
    const group *g = &f->groups[first];
    uint32_t count = 0;
    *c = (cluster){ .members = members, .member_count = g->size, .area = g->area };
    vec3_copy(c->normal, g->vector);
    double vector_area = vec3_normalize(c->normal), cosine = 1.0;
    for (uint32_t i = first; i != NO_INDEX; i = f->next[i]) {
        cosine = fmin(cosine, vec3_dot(c->normal, f->scene->surfaces[i].normal));
        members[count++] = i;
    }
    c->spread = sqrt(fmax(1.0 - cosine * cosine, 0.0));
    if (!cluster_outline(edges, members, count, g->edges, c)) return false;
    double outline[3];
    polygon_loop_vector_area((polygon_loop){ (const double(*)[3])c->corner, (size_t)c->corner_count }, outline);
    c->share = vector_area / vec3_dot(outline, c->normal);
    if (!(c->share < SHARE_MAX && c->share > 1.0 / SHARE_MAX)) return false;
    for (int i = 0; i < c->corner_count; i++)
        for (int j = 0; j < i; j++) c->diameter = fmax(c->diameter, vec3_distance(c->corner[i], c->corner[j]));
    set_eye(f, first, c);
    return true;
}

static int compare_indices(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* From the groups of more than one that have an outline. */
static bool make_clusters(finder *f, arena *memory, clustering *out) {
    const cluster_edges edges = { f->scene, f->mate, f->first };
    size_t groups = 0, members = 0;
    for (uint32_t i = 0; i < f->scene->surface_count; i++)
        if (f->patch[i] != NO_INDEX && f->first[i] == i && f->groups[i].size > 1)
            groups++, members += f->groups[i].size;
    out->clusters = arena_alloc(memory, groups, sizeof *out->clusters);
    out->members = arena_alloc(memory, members, sizeof *out->members);
    out->of_patch = arena_alloc(memory, f->mesh->patch_count, sizeof *out->of_patch);
    out->of_surface = arena_alloc(memory, f->scene->surface_count, sizeof *out->of_surface);
    if (!out->clusters || !out->members || !out->of_patch || !out->of_surface) return false;
    for (size_t i = 0; i < f->scene->surface_count; i++) out->of_surface[i] = NO_INDEX;
    for (size_t p = 0; p < f->mesh->patch_count; p++) out->of_patch[p] = NO_INDEX;
    uint32_t *next = out->members;
    for (uint32_t i = 0; i < f->scene->surface_count; i++) {
        if (f->patch[i] == NO_INDEX || f->first[i] != i || f->groups[i].size < 2) continue;
        cluster *c = &out->clusters[out->count];
        if (!make_cluster(f, &edges, i, next, c)) continue;
        for (uint32_t k = 0; k < c->member_count; k++) {
            out->of_surface[next[k]] = (uint32_t)out->count;
            next[k] = f->patch[next[k]];
            out->of_patch[next[k]] = (uint32_t)out->count;
        }
        qsort(next, c->member_count, sizeof *next, compare_indices);
        next += c->member_count;
        out->count++;
    }
    return true;
}

static bool allocate(finder *f) {
    size_t n = f->scene->surface_count + 1;
    allocator *memory = f->scene->memory;
    f->patch = block_new(memory, n * sizeof *f->patch);
    f->mate = block_new(memory, 4 * n * sizeof *f->mate);
    f->first = block_new(memory, n * sizeof *f->first);
    f->next = block_new(memory, n * sizeof *f->next);
    f->groups = block_new(memory, n * sizeof *f->groups);
    f->meetings = block_new(memory, 2 * n * sizeof *f->meetings); /* an edge belongs to two */
    f->best = block_new(memory, n * sizeof *f->best);
    f->cost = block_new(memory, n * sizeof *f->cost);
    return f->patch && f->mate && f->first && f->next && f->groups && f->meetings && f->best && f->cost;
}

bool clusters_find(const scene *s, const cluster_desc *desc, arena *memory, mesh *m, clustering *out) {
    finder f = { .scene = s, .mesh = m, .desc = desc };
    memset(out, 0, sizeof *out);
    m->clustering = NULL;
    bool ok = allocate(&f) && scene_find_mates(s, f.mate);
    if (ok) {
        choose_surfaces(&f);
        for (uint32_t i = 0; i < s->surface_count; i++) start_group(&f, i);
        while (unite_pairs(&f)) {
        }
        ok = make_clusters(&f, memory, out);
    }
    if (ok && out->count > 0) m->clustering = out;
    block_free_all(f.patch, f.mate, f.first, f.next, f.groups, f.meetings, f.best, f.cost);
    return ok;
}
