/* SPDX-License-Identifier: MIT
 * See vertex_surfaces.h.
 */
#include "scene/vertex_surfaces.h"

#include "base/block.h"

#include <stdlib.h>
#include <string.h>

typedef struct placed {
    const double *position;
    uint32_t corner; /* 4 * surface + k */
} placed;

static int compare(const void *a, const void *b) {
    const placed *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p->position[k] != q->position[k]) return p->position[k] < q->position[k] ? -1 : 1;
    return p->corner < q->corner ? -1 : p->corner > q->corner;
}

static bool same_place(const placed *a, const placed *b) {
    return a->position[0] == b->position[0] && a->position[1] == b->position[1] && a->position[2] == b->position[2];
}

static size_t list_corners(const scene *s, placed *all) {
    size_t count = 0;
    for (size_t i = 0; i < s->surface_count; i++)
        for (int k = 0; k < surface_corner_count(&s->surfaces[i]) && surface_sheet(s, (uint32_t)i) == i; k++)
            all[count++] = (placed){ scene_vertex(s, s->surfaces[i].corner[k]), (uint32_t)(4 * i + (size_t)k) };
    return count;
}

bool vertex_surfaces_create(const scene *s, vertex_surfaces *out) {
    size_t most = 4 * s->surface_count + 1;
    placed *all = block_new(s->memory, most * sizeof *all);
    *out = (vertex_surfaces){ .at = block_new(s->memory, most * sizeof *out->at),
                              .first = block_new(s->memory, (most + 1) * sizeof *out->first),
                              .surface = block_new(s->memory, most * sizeof *out->surface) };
    bool ok = all && out->at && out->first && out->surface;
    if (ok) {
        size_t count = list_corners(s, all);
        uint32_t places = 0;
        qsort(all, count, sizeof *all, compare);
        memset(out->at, 0xff, most * sizeof *out->at);
        for (size_t i = 0; i < count; i++) {
            if (i == 0 || !same_place(&all[i], &all[i - 1])) out->first[places++] = (uint32_t)i;
            out->at[all[i].corner] = places - 1;
            out->surface[i] = all[i].corner / 4;
        }
        out->first[places] = (uint32_t)count;
    }
    block_free(all);
    if (!ok) vertex_surfaces_free(out);
    return ok;
}

void vertex_surfaces_free(vertex_surfaces *c) {
    block_free(c->at);
    block_free(c->first);
    block_free(c->surface);
    memset(c, 0, sizeof *c);
}
