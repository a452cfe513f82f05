/* SPDX-License-Identifier: MIT */
#include "scene/vertex_surfaces.h"

#include <string.h>

/* Counts the corners at each place, then gives each its place in the list of its own: in the order of surfaces. */
static void list_corners(const scene *s, const uint32_t *place, uint32_t place_count, vertex_surfaces *out) {
    memset(out->at, 0xff, 4 * s->surface_count * sizeof *out->at);
    memset(out->first, 0, ((size_t)place_count + 2) * sizeof *out->first);
    for (uint32_t i = 0; i < s->surface_count; i++)
        for (int k = 0; k < surface_corner_count(&s->surfaces[i]) && surface_sheet(s, i) == i; k++) {
            out->at[4 * (size_t)i + (size_t)k] = place[s->surfaces[i].corner[k]];
            out->first[(size_t)place[s->surfaces[i].corner[k]] + 2]++;
        }
    for (size_t p = 2; p < (size_t)place_count + 2; p++) out->first[p] += out->first[p - 1];
    for (size_t c = 0; c < 4 * s->surface_count; c++)
        if (out->at[c] != NO_INDEX) out->surface[out->first[(size_t)out->at[c] + 1]++] = (uint32_t)(c / 4);
}

bool vertex_surfaces_create(const scene *s, vertex_surfaces *out) {
    uint32_t place_count = 0, *place = scene_find_places(s, &place_count);
    size_t most = 4 * s->surface_count + 1;
    *out = (vertex_surfaces){ .at = block_new(s->memory, most * sizeof *out->at),
                              .first = block_new(s->memory, ((size_t)place_count + 2) * sizeof *out->first),
                              .surface = block_new(s->memory, most * sizeof *out->surface) };
    bool ok = place && out->at && out->first && out->surface;
    if (ok) list_corners(s, place, place_count, out);
    block_free(place);
    if (!ok) vertex_surfaces_free(out);
    return ok;
}

void vertex_surfaces_free(vertex_surfaces *c) {
    block_free_all(c->at, c->first, c->surface);
    memset(c, 0, sizeof *c);
}
