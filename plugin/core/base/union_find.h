/* SPDX-License-Identifier: MIT
 * Which things belong together? A forest in which each names another of its group, and the root itself [Tarjan75].
 */
#ifndef HEMIBAKE_CORE_BASE_UNION_FIND_H
#define HEMIBAKE_CORE_BASE_UNION_FIND_H

#include <stdint.h>

/* The root of a thing's group; halves the way to it. At first group[i] is i. */
static inline uint32_t union_find_root(uint32_t *group, uint32_t i) {
    while (group[i] != i) i = group[i] = group[group[i]];
    return i;
}

/* The lower root stays, so that the result does not depend on the order. */
static inline void union_find_join(uint32_t *group, uint32_t a, uint32_t b) {
    a = union_find_root(group, a), b = union_find_root(group, b);
    group[a > b ? a : b] = a > b ? b : a;
}

#endif
