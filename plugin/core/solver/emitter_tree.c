/* SPDX-License-Identifier: MIT */
#include "solver/emitter_tree.h"

#include "base/morton.h"
#include "base/tolerance.h"
#include "geometry/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is wider than this share of its distance is looked at in parts. */
static const double WIDE = 0.35;

/* A direction may be off by what a ball is wide; nearer than its radius all are possible. to: its centre, from the
 * point, at that distance. */
static double light_from(const tree_node *n, const double to[3], double distance, const double normal[3]) {
    double square = distance * distance;
    if (distance > n->reach + n->radius) return 0.0;
    if (distance <= n->radius) return n->power / fmax(n->radius * n->radius, 1e-300);
    double received = vec3_dot(to, normal) + n->radius,
           emitted = n->spread * distance - vec3_dot(to, n->axis) + n->radius;
    if (!(received > 0.0 && emitted > 0.0)) return 0.0;
    if (received > distance) received = distance;
    if (emitted > distance) emitted = distance;
    return n->power * received * emitted / (square * square);
}

static bool is_leaf(size_t first, size_t end) {
    return end - first == 1;
}

/* What is near, for its size, is not as bright as its middle says: of a tube that begins beside the point a ray in a
 * thousand would bring a thousand times as much. */
static double light_from_near(const emitter_cut *c, const tree_emitter *e) {
    const polygon shape = mesh_polygon(c->tree->mesh, c->tree->mesh->patches[e->patch].corner);
    polygon above;
    double factor = 0.0;
    polygon_clip(&above, &shape, c->normal, vec3_dot(c->normal, c->point));
    polygon_factor_batch(&above, c->normal, &c->point[0], &c->point[1], &c->point[2], 1, &factor);
    return PI * fmax(factor, 0.0) * e->luminance;
}

static emitter_part part_of_tree(const emitter_cut *c, size_t node, size_t first, size_t end) {
    const tree_node *n = &c->tree->nodes[node];
    double to[3];
    vec3_sub(to, n->center, c->point);
    double distance = vec3_length(to);
    emitter_part p = { node, first, end, .light = light_from(n, to, distance, c->normal) };
    if (!(n->radius > WIDE * distance && p.light > 0.0)) return p;
    if (!is_leaf(first, end))
        p.wide = n->radius / fmax(distance, 1e-300);
    else if (c->tree->mesh)
        p.light = light_from_near(c, &c->tree->emitters[first]);
    return p;
}

static emitter_part half_of(const emitter_cut *c, const emitter_part *p, bool is_left) {
    size_t middle = p->first + (p->end - p->first + 1) / 2;
    return is_left ? part_of_tree(c, 2 * p->node + 1, p->first, middle)
                   : part_of_tree(c, 2 * p->node + 2, middle, p->end);
}

/* Puts a part into a heap of them, the widest first; wide[i] <= wide[(i-1)/2]. */
static void push_part(emitter_part *heap, int count, const emitter_part *part) {
    int i = count;
    for (int above = (i - 1) / 2; i > 0 && heap[above].wide < part->wide; i = above, above = (i - 1) / 2)
        heap[i] = heap[above];
    heap[i] = *part;
}

/* The same in the place of the first. */
static void replace_first(emitter_part *heap, int count, const emitter_part *part) {
    int i = 0;
    for (int below = 1; below < count; i = below, below = 2 * i + 1) {
        if (below + 1 < count && heap[below + 1].wide > heap[below].wide) below++;
        if (heap[below].wide <= part->wide) break;
        heap[i] = heap[below];
    }
    heap[i] = *part;
}

void emitter_tree_cut(const emitter_tree *t, const double point[3], const double normal[3], emitter_cut *out) {
    out->tree = t, out->count = 1;
    vec3_copy(out->point, point), vec3_copy(out->normal, normal);
    out->parts[0] = part_of_tree(out, 0, 0, t->count);
    while (out->count < EMITTER_CUT_MOST && out->parts[0].wide > 0.0) {
        const emitter_part whole = out->parts[0];
        const emitter_part left = half_of(out, &whole, true), right = half_of(out, &whole, false);
        replace_first(out->parts, out->count, &left);
        push_part(out->parts, out->count++, &right);
    }
    double all = 0.0;
    for (int i = 0; i < out->count; i++) out->until[i] = all += out->parts[i].light;
}

/* The part whose sum is the first beyond a number. */
static int part_of(const emitter_cut *c, double at) {
    int low = 0, high = c->count - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (at < c->until[middle])
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

const tree_emitter *emitter_cut_sample(const emitter_cut *c, double *which, double *probability) {
    double all = c->until[c->count - 1], at = *which * all;
    if (!(all > 0.0)) return NULL;
    int i = part_of(c, at);
    emitter_part p = c->parts[i];
    if (!(p.light > 0.0)) return NULL;
    *which = fmin(fmax((at - c->until[i]) / p.light + 1.0, 0.0), 1.0 - 1e-16);
    *probability = p.light / all;
    while (!is_leaf(p.first, p.end)) {
        const emitter_part left = half_of(c, &p, true), right = half_of(c, &p, false);
        if (!(left.light + right.light > 0.0)) return NULL;
        double share = left.light / (left.light + right.light);
        bool is_left = *which < share;
        *which = is_left ? *which / share : fmin((*which - share) / (1.0 - share), 1.0 - 1e-16);
        *probability *= is_left ? share : 1.0 - share;
        p = is_left ? left : right;
    }
    return &c->tree->emitters[p.first];
}

/* ---- how it is made ---- */

static void set_node(emitter_tree *t, size_t node, size_t first, size_t end) {
    tree_node *n = &t->nodes[node];
    *n = (tree_node){ .power = 0.0 };
    for (size_t i = first; i < end; i++) {
        const tree_emitter *e = &t->emitters[i];
        double power = e->area * e->luminance;
        n->power += power;
        vec3_add_scaled(n->center, n->center, power, e->center);
        vec3_add_scaled(n->axis, n->axis, power, e->normal);
    }
    for (int k = 0; k < 3; k++) n->center[k] /= n->power;
    if (!(vec3_length(n->axis) > 1e-3 * n->power)) n->axis[0] = n->power;
    vec3_normalize(n->axis);
    for (size_t i = first; i < end; i++) {
        const tree_emitter *e = &t->emitters[i];
        n->radius = fmax(n->radius, vec3_distance(n->center, e->center) + e->radius);
        n->spread = fmax(n->spread, vec3_distance(n->axis, e->normal) + e->spread);
        n->reach = fmax(n->reach, e->reach);
    }
    if (is_leaf(first, end)) return;
    size_t middle = first + (end - first + 1) / 2;
    set_node(t, 2 * node + 1, first, middle);
    set_node(t, 2 * node + 2, middle, end);
}

static tree_emitter emitter_of(const mesh *m, const scene *s, uint32_t patch_index) {
    const patch *p = &m->patches[patch_index];
    tree_emitter e = { .area = p->area, .patch = patch_index, .reach = INFINITY };
    vec3_copy(e.center, p->center);
    vec3_copy(e.normal, s->surfaces[p->surface].normal);
    vec3_copy(e.M, p->material.M);
    e.luminance = e.M[0] + e.M[1] + e.M[2];
    for (int k = 0; k < 4 && p->corner[k] != NO_INDEX; k++)
        e.radius = fmax(e.radius, vec3_distance(e.center, m->vertices + 3 * (size_t)p->corner[k]));
    return e;
}

/* What emits all round does so by a chord of 2 from any axis. */
static tree_emitter emitter_of_light(const punctual *light, const scene *s, uint32_t index) {
    bool is_spot = light->kind == PUNCTUAL_SPOT;
    tree_emitter e = { .area = 1.0,
                       .normal = { 0, 0, 1 },
                       .radius = TOLERANCE_EYE_LIFT * s->radius,
                       .spread = is_spot ? 1.0 - light->cos_outer : 2.0,
                       .reach = light->range > 0.0 ? light->range : INFINITY,
                       .patch = index };
    vec3_copy(e.center, light->position);
    if (is_spot) vec3_copy(e.normal, light->direction);
    vec3_copy(e.M, light->intensity);
    e.luminance = e.M[0] + e.M[1] + e.M[2];
    return e;
}

/* Puts the emitters, in any order, in that of a curve, and builds the nodes over them. False when out of memory. */
static bool build(allocator *memory, const scene *s, size_t count, emitter_tree *t) {
    size_t nodes = 1;
    while (nodes < count) nodes *= 2;
    morton_place *order = block_new(memory, (count + 1) * sizeof *order);
    tree_emitter *sorted = block_new(memory, (count + 1) * sizeof *sorted);
    t->nodes = block_new(memory, 2 * nodes * sizeof *t->nodes);
    bool ok = order && sorted && t->nodes;
    for (size_t i = 0; ok && i < count; i++)
        order[i] = (morton_place){ morton_code(t->emitters[i].center, s->center, s->radius), (uint32_t)i };
    if (ok) morton_sort(order, count);
    for (size_t i = 0; ok && i < count; i++) sorted[i] = t->emitters[order[i].index];
    block_free_all(order, t->emitters);
    t->emitters = sorted, t->count = count;
    if (ok && count > 0) set_node(t, 0, 0, count);
    return ok;
}

bool emitter_tree_create(const mesh *m, const scene *s, emitter_tree *out) {
    size_t most = 0, count = 0;
    for (size_t p = 0; p < m->patch_count; p++) most += material_emits(&m->patches[p].material);
    *out = (emitter_tree){ .emitters = block_new(m->memory, (most + 1) * sizeof *out->emitters), .mesh = m };
    for (size_t p = 0; out->emitters && p < m->patch_count; p++)
        if (material_emits(&m->patches[p].material)) out->emitters[count++] = emitter_of(m, s, (uint32_t)p);
    return out->emitters && build(m->memory, s, count, out);
}

bool emitter_tree_of_lights(const punctual *all, size_t all_count, const scene *s, emitter_tree *out) {
    size_t count = 0;
    *out = (emitter_tree){ .emitters = block_new(s->memory, (all_count + 1) * sizeof *out->emitters) };
    for (size_t i = 0; out->emitters && i < all_count; i++) {
        if (all[i].kind == PUNCTUAL_DIRECTIONAL || vec3_is_zero(all[i].intensity)) continue;
        out->emitters[count++] = emitter_of_light(&all[i], s, (uint32_t)i);
    }
    return out->emitters && build(s->memory, s, count, out);
}

void emitter_tree_free(emitter_tree *t) {
    block_free_all(t->emitters, t->nodes);
    memset(t, 0, sizeof *t);
}
