/* SPDX-License-Identifier: MIT
 * Which of many pieces holds a share of their area, or of what else was summed up over them?
 */
#ifndef HEMIBAKE_CORE_GEOMETRY_AREA_SHARE_H
#define HEMIBAKE_CORE_GEOMETRY_AREA_SHARE_H

#include <stddef.h>

/* The first of count pieces, at least one, whose sum with all before it, sums[i], is above `wanted`; else the last. */
static inline size_t area_share_find(const double *sums, size_t count, double wanted) {
    size_t low = 0, high = count - 1;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (sums[middle] <= wanted)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

#endif
