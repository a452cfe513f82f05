/* SPDX-License-Identifier: MIT */
#include "reconstruct/strongest_emitters.h"

#include <stdlib.h>

static int compare(const void *a, const void *b) {
    const strong_emitter *p = a, *q = b;
    if (p->light != q->light) return p->light > q->light ? -1 : 1;
    return (p->patch > q->patch) - (p->patch < q->patch);
}

static double light_of_panes(const scene *s, const mesh *m, const strong_emitter *all, size_t count) {
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        if (s->surfaces[m->patches[all[i].patch].surface].pane) sum += all[i].light;
    return sum;
}

size_t strongest_emitters_choose(const scene *s, const mesh *m, const uint32_t *emitters, const double *radiance,
                                 size_t emitter_count, const double point[3], const double normal[3],
                                 strong_emitter *chosen) {
    size_t count = 0;
    for (size_t i = 0; i < emitter_count; i++) {
        if (surface_height(&s->surfaces[m->patches[emitters[i]].surface], point) <= 0.0) continue;
        chosen[count] = (strong_emitter){ .patch = emitters[i], .share = m->patches[emitters[i]].coverage };
        if (emitter_count > STRONGEST_EMITTERS_MAX) {
            const polygon emitter = mesh_polygon(m, m->patches[emitters[i]].corner);
            const double *L = radiance + 3 * i;
            chosen[count].light =
                m->patches[emitters[i]].coverage * polygon_factor(&emitter, point, normal) * (L[0] + L[1] + L[2]);
            if (!(chosen[count].light > 0.0)) continue;
        }
        count++;
    }
    if (emitter_count <= STRONGEST_EMITTERS_MAX) return count;
    qsort(chosen, count, sizeof *chosen, compare);
    if (count <= STRONGEST_EMITTERS_POLYGONS) return count;
    const double panes = light_of_panes(s, m, chosen, STRONGEST_EMITTERS_POLYGONS);
    const double share = panes > 0.0 ? light_of_panes(s, m, chosen, count) / panes : 1.0;
    for (size_t i = 0; i < STRONGEST_EMITTERS_POLYGONS; i++)
        if (s->surfaces[m->patches[chosen[i].patch].surface].pane) chosen[i].share *= share;
    return STRONGEST_EMITTERS_POLYGONS;
}
