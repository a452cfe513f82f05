/* SPDX-License-Identifier: MIT
 * What do panes leave of a shooter's light on its way to every sample? Means over a grid of the shooter's points, per
 * band, beside the factors, which are as if panes were not there.
 */
#include "formfactor/column_worker.h"

#include <string.h>

/* Four corners of an outline that has more, evenly spread. */
static polygon four_corners(const polygon *p) {
    polygon out = *p;
    if (p->count <= 4) return out;
    for (int i = 0; i < 4; i++) vec3_copy(out.corner[i], p->corner[i * p->count / 4]);
    out.count = 4;
    return out;
}

static bool tint_run(column_worker *w, const polygon *shape, column *c, column_run *run) {
    const mesh *m = w->setup->mesh;
    const patch *p = &m->patches[run->patch];
    double all = 0.0, sum[3] = { 0, 0, 0 };
    for (uint32_t k = 0; k < p->sample_count; k++) {
        uint32_t s = p->first_sample + k;
        float *tint = c->tints + 3 * ((size_t)run->first + k);
        double T[3] = { 1, 1, 1 }, light = (double)c->factors[run->first + k] * m->sample_area[s];
        const double point[3] = { m->x[s], m->y[s], m->z[s] };
        if (light > 0.0 && !panes_transmit_polygon(w->setup->scene->panes, p->surface, shape, point, &w->crossings, T))
            return false;
        for (int b = 0; b < 3; b++) tint[b] = (float)T[b];
        vec3_add_scaled(sum, sum, light, T);
        all += light;
    }
    for (int b = 0; b < 3 && all > 0.0; b++) run->tint[b] = sum[b] / all;
    return true;
}

void column_tint(column_worker *w, const subpatch *shooter, column *c) {
    const polygon shape = four_corners(&shooter->shape);
    c->tints = block_new(w->setup->mesh->memory, (3 * c->factor_count + 1) * sizeof *c->tints);
    for (size_t i = 0; c->tints && i < c->run_count; i++)
        if (!tint_run(w, &shape, c, &c->runs[i])) w->failed = true;
    if (!c->tints) w->failed = true;
}
