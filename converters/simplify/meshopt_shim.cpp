/* SPDX-License-Identifier: MIT */
#include "meshopt_shim.h"

#include <meshoptimizer.h>

#include <new>
#include <vector>

static_assert(sizeof(unsigned int) == sizeof(uint32_t), "meshoptimizer's indices are unsigned int");

/* Relative to the extent of what is thinned out; meshoptimizer measures no larger errors. */
static const double largest_error = 1.0;

static const size_t vertex_size = 3 * sizeof(float);

bool meshopt_collapse(const float *positions, size_t vertex_count, uint32_t *indices, size_t index_count,
                      size_t target_index_count, double deviation, size_t *left) {
    try {
        std::vector<unsigned int> from(indices, indices + index_count);
        double scale = meshopt_simplifyScale(positions, vertex_count, vertex_size);
        double error = scale > 0.0 && deviation < largest_error * scale ? deviation / scale : largest_error;
        *left = meshopt_simplify(indices, from.data(), index_count, positions, vertex_count, vertex_size,
                                 target_index_count, float(error), 0, nullptr);
        return true;
    } catch (const std::bad_alloc &) {
        return false;
    }
}
