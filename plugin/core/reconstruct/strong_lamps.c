/* SPDX-License-Identifier: MIT
 * See strong_lamps.h.
 */
#include "reconstruct/strong_lamps.h"

#include "base/vec3.h"

#include <stdlib.h>

polygon strong_lamp_polygon(const mesh *m, uint32_t patch_index) {
    const patch *p = &m->patches[patch_index];
    polygon lamp = { .count = patch_corner_count(p) };
    for (int k = 0; k < lamp.count; k++) vec3_copy(lamp.corner[k], m->vertices + 3 * (size_t)p->corner[k]);
    return lamp;
}

static int compare(const void *a, const void *b) {
    const strong_lamp *p = a, *q = b;
    if (p->light != q->light) return p->light > q->light ? -1 : 1;
    return (p->patch > q->patch) - (p->patch < q->patch);
}

static double light_of(const mesh *m, uint32_t patch_index, const double L[3], const double point[3],
                       const double normal[3]) {
    polygon lamp = strong_lamp_polygon(m, patch_index);
    return m->patches[patch_index].coverage * polygon_factor(&lamp, point, normal) * (L[0] + L[1] + L[2]);
}

size_t strong_lamps_choose(const scene *s, const mesh *m, const uint32_t *lamps, const double *radiance,
                           size_t lamp_count, const double point[3], const double normal[3], strong_lamp *chosen) {
    size_t count = 0;
    for (size_t i = 0; i < lamp_count; i++) {
        if (surface_height(&s->surfaces[m->patches[lamps[i]].surface], point) <= 0.0) continue;
        chosen[count] = (strong_lamp){ .patch = lamps[i] };
        if (lamp_count > STRONG_LAMPS_MAX) {
            chosen[count].light = light_of(m, lamps[i], radiance + 3 * i, point, normal);
            if (!(chosen[count].light > 0.0)) continue;
        }
        count++;
    }
    if (lamp_count <= STRONG_LAMPS_MAX) return count;
    qsort(chosen, count, sizeof *chosen, compare);
    return count < STRONG_LAMPS_STRONGEST ? count : STRONG_LAMPS_STRONGEST;
}
