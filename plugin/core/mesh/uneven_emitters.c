/* SPDX-License-Identifier: MIT
 * Which patches must be split because a picture glows on them? A patch shoots the mean of its elements from all of its
 * area; where a texture makes them emit unevenly, each element becomes a patch of its own. Where rows are kept, of all
 * that a picture glows on, so that another picture finds the same patches.
 */
#include "mesh/mesh.h"

#include <string.h>

/* Emission that differs by less over a patch than this share of its largest is even: what its light misses by then is
 * a tenth of what its shape does. */
static const double EVEN = 0.1;

/* A patch that emits less than this share of all is not worth its elements' hemi-cubes: a thousand such are off by a
 * percent of the light at most. */
static const double POWER_LEAST = 1e-5;

static double patch_power(const mesh *m, const patch *p) {
    double power = 0.0;
    for (uint32_t i = 0; i < p->element_count; i++)
        power += m->elements[p->first_element + i].area * element_emission(&m->elements[p->first_element + i]);
    return power;
}

static bool is_uneven(const mesh *m, const scene *s, const patch *p, double all) {
    if (s->shining) return s->shining[s->surfaces[p->surface].mesh] == SHINING_BY_PICTURE && p->element_count > 1;
    double low = element_emission(&m->elements[p->first_element]), high = low;
    for (uint32_t i = 1; i < p->element_count; i++) {
        double M = element_emission(&m->elements[p->first_element + i]);
        low = M < low ? M : low, high = M > high ? M : high;
    }
    return high - low > EVEN * high && patch_power(m, p) > POWER_LEAST * all;
}

/* The two sides of a sheet must be split alike, whatever roundings say: the first decides. Returns how many patches
 * there will be. */
static size_t mark_uneven(const mesh *m, const scene *s, uint32_t *first_of_surface, bool *uneven) {
    double all = 0.0;
    size_t count = 0;
    for (size_t p = m->patch_count; p-- > 0;) {
        first_of_surface[m->patches[p].surface] = (uint32_t)p;
        all += patch_power(m, &m->patches[p]);
    }
    for (size_t p = 0; p < m->patch_count; p++) {
        uint32_t surface_index = m->patches[p].surface, sheet = surface_sheet(s, surface_index);
        uneven[p] = sheet == surface_index
                        ? is_uneven(m, s, &m->patches[p], all)
                        : uneven[first_of_surface[sheet] + (uint32_t)p - first_of_surface[surface_index]];
        count += uneven[p] ? m->patches[p].element_count : 1;
    }
    return count;
}

static void split_patches(const mesh *m, const bool *uneven, patch *out) {
    for (size_t p = 0; p < m->patch_count; p++) {
        const patch *from = &m->patches[p];
        if (!uneven[p]) {
            *out++ = *from;
            continue;
        }
        for (uint32_t i = 0; i < from->element_count; i++) {
            *out = *from;
            out->first_element = from->first_element + i;
            out->element_count = 1;
            memcpy(out->corner, m->elements[out->first_element].corner, sizeof out->corner);
            out++;
        }
    }
}

bool uneven_emitters_split(mesh *m, const scene *s, arena *memory, bool *any) {
    bool *uneven = block_zeroed(m->memory, m->patch_count + 1, sizeof *uneven);
    uint32_t *first = block_new(m->memory, (s->surface_count + 1) * sizeof *first);
    bool ok = uneven && first;
    size_t count = ok ? mark_uneven(m, s, first, uneven) : 0;
    *any = count > m->patch_count;
    patch *patches = *any ? block_zeroed(m->memory, count, sizeof *patches) : NULL;
    if (patches) {
        split_patches(m, uneven, patches);
        block_free(m->patches);
        m->patches = patches;
        m->patch_count = count;
        ok = mesh_measure_in_scene(m, s, NULL, memory);
        if (ok) mesh_average_materials(m);
    }
    ok = ok && (patches || !*any);
    block_free_all(uneven, first);
    return ok;
}
