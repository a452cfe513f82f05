/* SPDX-License-Identifier: MIT */
#include "mesh/element_parts.h"

#include "scene/scene.h"

void element_parts(const uint32_t corner[4], const uint32_t middle[4], uint32_t center, bool is_back,
                   element_part out[ELEMENT_PARTS]) {
    static const int FORTH[ELEMENT_PARTS] = { 0, 1, 2, 3 };
    static const int BACK[2][ELEMENT_PARTS] = { { 2, 1, 0, 3 }, { 3, 2, 1, 0 } };
    const uint32_t *c = corner, *m = middle;
    bool is_quad = c[3] != NO_INDEX;
    const int *order = is_back ? BACK[is_quad] : FORTH;
    const element_part triangles[ELEMENT_PARTS] = { { { c[0], m[0], m[2], NO_INDEX }, 0.0, 0.0, 0.5 },
                                                    { { m[0], c[1], m[1], NO_INDEX }, 0.5, 0.0, 0.5 },
                                                    { { m[2], m[1], c[2], NO_INDEX }, 0.0, 0.5, 0.5 },
                                                    { { m[1], m[2], m[0], NO_INDEX }, 0.5, 0.5, -0.5 } };
    const element_part quads[ELEMENT_PARTS] = { { { c[0], m[0], center, m[3] }, 0.0, 0.0, 0.5 },
                                                { { m[0], c[1], m[1], center }, 0.5, 0.0, 0.5 },
                                                { { center, m[1], c[2], m[2] }, 0.5, 0.5, 0.5 },
                                                { { m[3], center, m[2], c[3] }, 0.0, 0.5, 0.5 } };
    for (int i = 0; i < ELEMENT_PARTS; i++) out[order[i]] = is_quad ? quads[i] : triangles[i];
}
