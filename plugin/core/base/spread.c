/* SPDX-License-Identifier: MIT */
#include "base/spread.h"

static const double GOLDEN = 0.61803398874989485;

size_t spread_stride(size_t count) {
    for (size_t stride = (size_t)(GOLDEN * (double)count);; stride++) {
        size_t a = stride, b = count;
        while (b > 0) {
            size_t rest = a % b;
            a = b, b = rest;
        }
        if (a <= 1 || stride <= 1) return stride > 0 ? stride : 1;
    }
}
