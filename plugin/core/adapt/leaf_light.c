/* SPDX-License-Identifier: MIT */
#include "adapt/leaf_light.h"

#include "geometry/vec3.h"

#include <math.h>
#include <string.h>

void leaf_light_free(leaf_light *l) {
    block_free_all(l->irradiance, l->row_sum, l->arrived, l->direct_row_sum, l->uneven, l->half_difference);
    memset(l, 0, sizeof *l);
}

/* Zeroed, with what `like` has. False when out of memory; to be freed all the same. */
static bool create(allocator *memory, size_t samples, const leaf_light *like, leaf_light *out) {
    size_t n = samples + 1;
    *out = (leaf_light){ .irradiance = block_zeroed(memory, 3 * n, sizeof *out->irradiance),
                         .row_sum = block_zeroed(memory, n, sizeof *out->row_sum) };
    if (like->arrived) out->arrived = block_zeroed(memory, 3 * n, sizeof *out->arrived);
    if (like->arrived) out->direct_row_sum = block_zeroed(memory, n, sizeof *out->direct_row_sum);
    if (like->uneven) out->uneven = block_zeroed(memory, n, sizeof *out->uneven);
    if (like->half_difference) out->half_difference = block_zeroed(memory, 3 * n, sizeof *out->half_difference);
    return out->irradiance && out->row_sum && (!like->arrived || (out->arrived && out->direct_row_sum)) &&
           (!like->uneven || out->uneven) && (!like->half_difference || out->half_difference);
}

void leaf_light_copy(const leaf_light *in, size_t from, size_t count, const leaf_light *out, size_t to) {
    memcpy(out->irradiance + 3 * to, in->irradiance + 3 * from, 3 * count * sizeof *out->irradiance);
    memcpy(out->row_sum + to, in->row_sum + from, count * sizeof *out->row_sum);
    if (in->half_difference)
        memcpy(out->half_difference + 3 * to, in->half_difference + 3 * from, 3 * count * sizeof *out->half_difference);
    if (!in->arrived) return;
    memcpy(out->arrived + 3 * to, in->arrived + 3 * from, 3 * count * sizeof *out->arrived);
    memcpy(out->direct_row_sum + to, in->direct_row_sum + from, count * sizeof *out->direct_row_sum);
    if (in->uneven) memcpy(out->uneven + to, in->uneven + from, count * sizeof *out->uneven);
}

void leaf_light_blend(const leaf_light *in, size_t from, const double w[4], int count, const leaf_light *out,
                      size_t to) {
    double E[3] = { 0, 0, 0 }, arrived[3] = { 0, 0, 0 }, half[3] = { 0, 0, 0 }, row_sum = 0.0, direct_row_sum = 0.0;
    double uneven = 0.0;
    for (size_t i = 0; i < (size_t)count; i++) {
        row_sum += w[i] * in->row_sum[from + i];
        if (in->uneven) uneven += w[i] * (double)in->uneven[from + i];
        if (in->arrived) direct_row_sum += w[i] * (double)in->direct_row_sum[from + i];
        for (size_t c = 0; c < 3; c++) {
            E[c] += w[i] * in->irradiance[3 * (from + i) + c];
            if (in->half_difference) half[c] += w[i] * in->half_difference[3 * (from + i) + c];
            if (in->arrived) arrived[c] += w[i] * in->arrived[3 * (from + i) + c];
        }
    }
    out->row_sum[to] = fmax(row_sum, 0.0);
    for (size_t c = 0; c < 3; c++) out->irradiance[3 * to + c] = fmax(E[c], 0.0);
    if (in->half_difference) vec3_copy(out->half_difference + 3 * to, half);
    if (!in->arrived) return;
    if (in->uneven) out->uneven[to] = (float)uneven;
    out->direct_row_sum[to] = (float)fmax(direct_row_sum, 0.0);
    for (size_t c = 0; c < 3; c++) out->arrived[3 * to + c] = fmax(arrived[c], 0.0);
}

bool leaf_light_follow(allocator *memory, const leaf *leaves, uint32_t count, const leaf_light *before,
                       leaf_light *next) {
    size_t samples = leaves[count - 1].first_sample + (size_t)leaves[count - 1].sample_count;
    bool ok = create(memory, samples, before, next);
    for (size_t i = 0; ok && i < count; i++)
        if (!leaves[i].is_new)
            leaf_light_copy(before, leaves[i].origin, leaves[i].sample_count, next, leaves[i].first_sample);
    return ok;
}
