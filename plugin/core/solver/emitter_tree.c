/* SPDX-License-Identifier: MIT */
#include "solver/emitter_tree.h"

#include "base/morton.h"
#include "geometry/vec3.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A direction may be off by what a ball is wide; nearer than its radius all are possible. */
static double light_from(const tree_node *n, const double point[3], const double normal[3]) {
    double to[3];
    vec3_sub(to, n->center, point);
    double square = vec3_dot(to, to), distance = sqrt(square);
    if (distance <= n->radius) return n->power / fmax(n->radius * n->radius, 1e-300);
    double off = n->radius / distance;
    double received = fmin(vec3_dot(to, normal) / distance + off, 1.0);
    double emitted = fmin(-vec3_dot(to, n->axis) / distance + n->spread + off, 1.0);
    return received > 0.0 && emitted > 0.0 ? n->power * received * emitted / square : 0.0;
}

static bool is_leaf(size_t first, size_t end) {
    return end - first == 1;
}

const tree_emitter *emitter_tree_sample(const emitter_tree *t, const double point[3], const double normal[3],
                                        double *which, double *probability) {
    size_t first = 0, end = t->count, node = 0;
    *probability = 1.0;
    while (!is_leaf(first, end)) {
        size_t middle = first + (end - first + 1) / 2;
        double left = light_from(&t->nodes[2 * node + 1], point, normal);
        double right = light_from(&t->nodes[2 * node + 2], point, normal);
        if (!(left + right > 0.0)) return NULL;
        double share = left / (left + right);
        if (*which < share) {
            *which /= share, end = middle, node = 2 * node + 1;
            *probability *= share;
        } else {
            *which = fmin((*which - share) / (1.0 - share), 1.0 - 1e-16), first = middle, node = 2 * node + 2;
            *probability *= 1.0 - share;
        }
    }
    return &t->emitters[first];
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
        n->spread = fmax(n->spread, vec3_distance(n->axis, e->normal));
    }
    if (is_leaf(first, end)) return;
    size_t middle = first + (end - first + 1) / 2;
    set_node(t, 2 * node + 1, first, middle);
    set_node(t, 2 * node + 2, middle, end);
}

static tree_emitter emitter_of(const mesh *m, const scene *s, uint32_t patch_index) {
    const patch *p = &m->patches[patch_index];
    tree_emitter e = { .area = p->area, .patch = patch_index };
    vec3_copy(e.center, p->center);
    vec3_copy(e.normal, s->surfaces[p->surface].normal);
    vec3_copy(e.M, p->material.M);
    e.luminance = e.M[0] + e.M[1] + e.M[2];
    for (int k = 0; k < 4 && p->corner[k] != NO_INDEX; k++)
        e.radius = fmax(e.radius, vec3_distance(e.center, m->vertices + 3 * (size_t)p->corner[k]));
    return e;
}

bool emitter_tree_create(const mesh *m, const scene *s, emitter_tree *out) {
    size_t count = 0, nodes = 1;
    for (size_t p = 0; p < m->patch_count; p++) count += material_emits(&m->patches[p].material);
    while (nodes < count) nodes *= 2;
    morton_place *order = block_new(m->memory, (count + 1) * sizeof *order);
    *out = (emitter_tree){ .emitters = block_new(m->memory, (count + 1) * sizeof *out->emitters),
                           .count = count,
                           .nodes = block_new(m->memory, 2 * nodes * sizeof *out->nodes) };
    bool ok = order && out->emitters && out->nodes;
    for (size_t p = 0, i = 0; ok && p < m->patch_count; p++)
        if (material_emits(&m->patches[p].material))
            order[i++] = (morton_place){ morton_code(m->patches[p].center, s->center, s->radius), (uint32_t)p };
    if (ok) morton_sort(order, count);
    for (size_t i = 0; ok && i < count; i++) out->emitters[i] = emitter_of(m, s, order[i].index);
    if (ok && count > 0) set_node(out, 0, 0, count);
    block_free(order);
    return ok;
}

void emitter_tree_free(emitter_tree *t) {
    block_free_all(t->emitters, t->nodes);
    memset(t, 0, sizeof *t);
}
