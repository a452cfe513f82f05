/* SPDX-License-Identifier: MIT
 * See fit_parts.h.
 */
#include "reconstruct/fit_parts.h"

#include "base/union_find.h"

#include <stdlib.h>
#include <string.h>

typedef struct sized {
    uint32_t root, elements; /* the lowest node of a part, and how many elements it has */
} sized;

/* Largest first; no two have one root. */
static int compare_sizes(const void *a, const void *b) {
    const sized *x = a, *y = b;
    if (x->elements != y->elements) return x->elements > y->elements ? -1 : 1;
    return (x->root > y->root) - (x->root < y->root);
}

static void join_nodes(const mesh *m, const uint32_t *node, size_t node_count, uint32_t *group) {
    for (size_t v = 0; v < node_count; v++) group[v] = (uint32_t)v;
    for (size_t e = 0; e < m->element_count; e++) {
        uint8_t ring[ELEMENT_PLACES];
        int places = element_ring(&m->elements[e], ring);
        const uint32_t *of = node + ELEMENT_PLACES * e;
        for (int i = 1; i < places; i++) union_find_join(group, of[ring[0]], of[ring[i]]);
    }
    for (size_t v = 0; v < node_count; v++) group[v] = union_find_root(group, (uint32_t)v);
}

/* Parts by size; at the end group[v] is the part of node v, NO_INDEX: none. */
static size_t order_parts(const mesh *m, const uint32_t *node, size_t node_count, uint32_t *group, sized *parts,
                          uint32_t *of_root) {
    size_t count = 0;
    memset(of_root, 0, node_count * sizeof *of_root);
    for (size_t e = 0; e < m->element_count; e++) of_root[group[node[ELEMENT_PLACES * e]]]++;
    for (size_t v = 0; v < node_count; v++)
        if (of_root[v] > 0) parts[count++] = (sized){ (uint32_t)v, of_root[v] };
    if (count > 1) qsort(parts, count, sizeof *parts, compare_sizes);
    memset(of_root, 0xff, node_count * sizeof *of_root);
    for (size_t p = 0; p < count; p++) of_root[parts[p].root] = (uint32_t)p;
    for (size_t v = 0; v < node_count; v++) group[v] = of_root[group[v]];
    return count;
}

static void list_elements(const mesh *m, const uint32_t *node, const uint32_t *group, const sized *parts,
                          uint32_t *next, fit_parts *out) {
    out->first_element[0] = 0;
    for (size_t p = 0; p < out->count; p++) {
        next[p] = out->first_element[p];
        out->first_element[p + 1] = out->first_element[p] + parts[p].elements;
    }
    for (size_t e = 0; e < m->element_count; e++) out->element[next[group[node[ELEMENT_PLACES * e]]]++] = (uint32_t)e;
}

/* In the order in which elements come to them, so that neighbours are near each other. */
static void list_nodes(const mesh *m, const uint32_t *node, size_t node_count, fit_parts *out) {
    uint32_t next = 0;
    memset(out->number, 0xff, node_count * sizeof *out->number);
    for (size_t p = 0; p < out->count; p++) {
        out->first_node[p] = next;
        for (uint32_t i = out->first_element[p]; i < out->first_element[p + 1]; i++) {
            uint8_t ring[ELEMENT_PLACES];
            const uint32_t *of = node + ELEMENT_PLACES * (size_t)out->element[i];
            int places = element_ring(&m->elements[out->element[i]], ring);
            for (int k = 0; k < places; k++) {
                uint32_t v = of[ring[k]];
                if (out->number[v] != NO_INDEX) continue;
                out->number[v] = next - out->first_node[p];
                out->node[next++] = v;
            }
        }
    }
    out->first_node[out->count] = next;
}

bool fit_parts_find(const mesh *m, const uint32_t *node, size_t node_count, fit_parts *out) {
    allocator *memory = m->memory;
    uint32_t *group = block_new(memory, (node_count + 1) * sizeof *group),
             *of_root = block_new(memory, (node_count + 1) * sizeof *of_root);
    sized *parts = block_new(memory, (node_count + 1) * sizeof *parts);
    *out = (fit_parts){ .element = block_new(memory, (m->element_count + 1) * sizeof *out->element),
                        .node = block_new(memory, (node_count + 1) * sizeof *out->node),
                        .number = block_new(memory, (node_count + 1) * sizeof *out->number) };
    bool ok = group && of_root && parts && out->element && out->node && out->number;
    if (ok) {
        join_nodes(m, node, node_count, group);
        out->count = order_parts(m, node, node_count, group, parts, of_root);
        out->first_element = block_new(memory, (out->count + 1) * sizeof *out->first_element);
        out->first_node = block_new(memory, (out->count + 1) * sizeof *out->first_node);
        ok = out->first_element && out->first_node;
    }
    if (ok) {
        list_elements(m, node, group, parts, of_root, out);
        list_nodes(m, node, node_count, out);
    }
    block_free_all(group, of_root, parts);
    return ok;
}

void fit_parts_free(fit_parts *p) {
    block_free_all(p->first_element, p->element, p->first_node, p->node, p->number);
    *p = (fit_parts){ 0 };
}
