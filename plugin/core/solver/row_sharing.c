/* SPDX-License-Identifier: MIT
 * See row_sharing.h. Runs go round the processes, so that what is costly in one place is shared too.
 */
#include "solver/row_sharing.h"

#include <string.h>

typedef struct layout {
    const row_sharing *of;
    size_t size;
} layout;

bool row_sharing_open(ranks *r, const mesh *m, const uint32_t *of_element, uint32_t together, row_sharing *out) {
    *out = (row_sharing){ r, m, NULL };
    if (!r) return true;
    out->owner = block_new(m->memory, (m->element_count + 1) * sizeof *out->owner);
    for (uint32_t e = 0; out->owner && e < m->element_count; e++)
        out->owner[e] = (of_element ? of_element[e] : e) / together % r->count;
    return out->owner;
}

void row_sharing_free(row_sharing *s) {
    block_free(s->owner);
    memset(s, 0, sizeof *s);
}

static rank_part part_of_element(const void *user, size_t e) {
    const layout *l = user;
    return (rank_part){ l->of->owner[e], e * l->size, l->size };
}

static rank_part part_of_samples(const void *user, size_t e) {
    const layout *l = user;
    const element *one = &l->of->mesh->elements[e];
    return (rank_part){ l->of->owner[e], one->first_sample * l->size, (uint64_t)element_corner_count(one) * l->size };
}

static bool give(const row_sharing *s, rank_part (*part)(const void *user, size_t i), size_t size, void *all) {
    const layout l = { s, size };
    return !s || !s->owner || ranks_exchange(s->ranks, s->mesh->memory, s->mesh->element_count, part, &l, all);
}

bool row_sharing_give_elements(const row_sharing *s, void *all, size_t size) {
    return give(s, part_of_element, size, all);
}

bool row_sharing_give_samples(const row_sharing *s, void *all, size_t size) {
    return give(s, part_of_samples, size, all);
}
