/* SPDX-License-Identifier: MIT
 * See subdivision.h.
 */
#include "solver/subdivision.h"

#include <math.h>

static bool lies_on(const shooters *s, uint32_t index, uint32_t sample) {
    return index < s->mesh->patch_count ? true : s->of_sample[sample] == index;
}

bool subdivision_is_possible(const shooters *s, uint32_t index) {
    const shooter *one = &s->all[index];
    uint32_t elements = s->mesh->patches[one->piece.patch].element_count;
    return shooter_is_whole(one) && shooter_depth(one) < SUBDIVISION_DEPTH && elements >= 4u << 2 * shooter_depth(one);
}

bool subdivision_by_gradient(const shooters *s, uint32_t index, const double *B) {
    const patch *p = &s->mesh->patches[s->all[index].piece.patch];
    double low = INFINITY, high = 0.0, sum = 0.0, area = 0.0;
    for (uint32_t k = 0; k < p->sample_count; k++) {
        if (!lies_on(s, index, p->first_sample + k)) continue;
        double one = B[3 * k] + B[3 * k + 1] + B[3 * k + 2], weight = s->mesh->sample_area[p->first_sample + k];
        low = fmin(low, one);
        high = fmax(high, one);
        sum += weight * one;
        area += weight;
    }
    return area > 0.0 && high - low > SUBDIVISION_GRADIENT * sum / area;
}

bool subdivision_by_factor(const column *c) {
    return c->largest > 1.0;
}
