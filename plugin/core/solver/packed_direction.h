/* SPDX-License-Identifier: MIT
 * How is a direction kept in 32 bits? As a point of the unfolded octahedron, 16 bits each way.
 */
#ifndef HEMIBAKE_CORE_SOLVER_PACKED_DIRECTION_H
#define HEMIBAKE_CORE_SOLVER_PACKED_DIRECTION_H

#include "geometry/vec3.h"

#include <math.h>
#include <stdint.h>

static inline uint32_t packed_direction(const double d[3]) {
    double sum = fabs(d[0]) + fabs(d[1]) + fabs(d[2]), u = d[0] / sum, v = d[1] / sum;
    if (d[2] < 0.0) {
        double folded = (1.0 - fabs(v)) * (u < 0.0 ? -1.0 : 1.0);
        v = (1.0 - fabs(u)) * (v < 0.0 ? -1.0 : 1.0);
        u = folded;
    }
    return (uint32_t)floor(0.5 + 32767.5 * (u + 1.0)) << 16 | (uint32_t)floor(0.5 + 32767.5 * (v + 1.0));
}

static inline void packed_direction_open(uint32_t packed, double d[3]) {
    double u = (packed >> 16) / 32767.5 - 1.0, v = (packed & 0xffff) / 32767.5 - 1.0;
    d[0] = u, d[1] = v, d[2] = 1.0 - fabs(u) - fabs(v);
    if (d[2] < 0.0) {
        d[0] = (1.0 - fabs(v)) * (u < 0.0 ? -1.0 : 1.0);
        d[1] = (1.0 - fabs(u)) * (v < 0.0 ? -1.0 : 1.0);
    }
    vec3_normalize(d);
}

#endif
