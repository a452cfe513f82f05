/* SPDX-License-Identifier: MIT
 * See leaf_light.h.
 */
#include "adapt/leaf_light.h"

#include "base/block.h"

#include <string.h>

void leaf_light_free(leaf_light *l) {
    block_free(l->irradiance);
    block_free(l->row_sum);
    block_free(l->arrived);
    block_free(l->direct_row_sum);
    memset(l, 0, sizeof *l);
}

bool leaf_light_create(allocator *memory, size_t leaves, bool arrives, leaf_light *out) {
    size_t n = LEAF_SAMPLES_MAX * leaves + 1;
    *out = (leaf_light){ .irradiance = block_zeroed(memory, 3 * n, sizeof *out->irradiance),
                         .row_sum = block_zeroed(memory, n, sizeof *out->row_sum) };
    if (arrives) out->arrived = block_zeroed(memory, 3 * n, sizeof *out->arrived);
    if (arrives) out->direct_row_sum = block_zeroed(memory, n, sizeof *out->direct_row_sum);
    return out->irradiance && out->row_sum && (!arrives || (out->arrived && out->direct_row_sum));
}

void leaf_light_copy(const leaf_light *in, size_t from, size_t count, const leaf_light *out, size_t to) {
    memmove(out->irradiance + 3 * to, in->irradiance + 3 * from, 3 * count * sizeof *out->irradiance);
    memmove(out->row_sum + to, in->row_sum + from, count * sizeof *out->row_sum);
    if (!in->arrived) return;
    memmove(out->arrived + 3 * to, in->arrived + 3 * from, 3 * count * sizeof *out->arrived);
    memmove(out->direct_row_sum + to, in->direct_row_sum + from, count * sizeof *out->direct_row_sum);
}

void leaf_light_take(const mesh *m, const leaf_light *samples, const leaf_light *leaves) {
    for (size_t e = 0; e < m->element_count; e++)
        leaf_light_copy(samples, m->elements[e].first_sample, (size_t)element_corner_count(&m->elements[e]), leaves,
                        LEAF_SAMPLES_MAX * e);
}

void leaf_light_give(const mesh *m, const leaf_light *leaves, const leaf_light *samples) {
    for (size_t e = 0; e < m->element_count; e++)
        leaf_light_copy(leaves, LEAF_SAMPLES_MAX * e, (size_t)element_corner_count(&m->elements[e]), samples,
                        m->elements[e].first_sample);
}

bool leaf_light_follow(allocator *memory, const leaf *leaves, uint32_t count, bool arrives, leaf_light *l) {
    leaf_light next;
    bool ok = leaf_light_create(memory, count, arrives, &next);
    for (size_t i = 0; ok && i < count; i++)
        if (!leaves[i].is_new)
            leaf_light_copy(l, LEAF_SAMPLES_MAX * (size_t)leaves[i].origin, LEAF_SAMPLES_MAX, &next,
                            LEAF_SAMPLES_MAX * i);
    leaf_light_free(l);
    *l = next;
    return ok;
}
