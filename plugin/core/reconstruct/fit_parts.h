/* SPDX-License-Identifier: MIT
 * Which vertex colours depend on each other? Those of elements that share colour nodes, and through these of others: a
 * part. Faces between creases are parts of their own, so a scene has thousands, each of which is fitted by itself.
 */
#ifndef HEMIBAKE_CORE_RECONSTRUCT_FIT_PARTS_H
#define HEMIBAKE_CORE_RECONSTRUCT_FIT_PARTS_H

#include "mesh/triangulation.h"

/* Largest parts come first. Part p has the elements element[first_element[p]] to element[first_element[p+1]-1], which
 * ascend, and the nodes alike. */
typedef struct fit_parts {
    size_t count;
    uint32_t *first_element, *element;
    uint32_t *first_node, *node;
    uint32_t *number; /* number[v]: which node of its part node v is; NO_INDEX: no element has it */
} fit_parts;

/* node: as in vertex_fit_input. False when out of memory; free it either way. */
bool fit_parts_find(const mesh *m, const uint32_t *node, size_t node_count, fit_parts *out);
void fit_parts_free(fit_parts *p);

static inline size_t fit_parts_elements(const fit_parts *p, size_t part) {
    return p->first_element[part + 1] - p->first_element[part];
}

static inline size_t fit_parts_nodes(const fit_parts *p, size_t part) {
    return p->first_node[part + 1] - p->first_node[part];
}

#endif
