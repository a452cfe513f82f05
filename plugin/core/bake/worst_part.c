/* SPDX-License-Identifier: MIT */
#include "bake/worst_part.h"

#include "base/block.h"

#include <math.h>

/* The noise of fewer elements says little of what they are off by, and of many meshes one would seem to be bad; and
 * what has less of the area is no place to be in or to look at. */
enum { ELEMENTS_LEAST = 32 };
static const double AREA_LEAST = 1e-4;

typedef struct part {
    double square, level, area;
    size_t elements;
} part;

static uint32_t mesh_of(const scene *s, const mesh *m, size_t e) {
    return s->surfaces[m->patches[m->elements[e].patch].surface].mesh;
}

static void add_element(const mesh *m, size_t e, double square, double level, part *to) {
    to->square += square;
    to->level += level;
    to->area += m->elements[e].area;
    to->elements++;
}

bool worst_part_find(const scene *s, const mesh *m, const double *squares, const double *levels, part_error *out) {
    size_t count = 0;
    part all = { 0 };
    *out = (part_error){ 0 };
    for (size_t e = 0; e < m->element_count; e++)
        if (mesh_of(s, m, e) >= count) count = (size_t)mesh_of(s, m, e) + 1;
    part *parts = block_zeroed(m->memory, count + 1, sizeof *parts);
    for (size_t e = 0; parts && e < m->element_count; e++) {
        add_element(m, e, squares[e], levels[e], &all);
        add_element(m, e, squares[e], levels[e], &parts[mesh_of(s, m, e)]);
    }
    for (size_t i = 0; parts && i < count; i++) {
        const part *p = &parts[i];
        bool is_judged = p->elements >= ELEMENTS_LEAST && p->area >= AREA_LEAST * all.area && p->level > 0.0;
        if (!is_judged || p->square <= out->error * out->error * p->level) continue;
        *out = (part_error){ .mesh = (uint32_t)i,
                             .error = sqrt(p->square / p->level),
                             .light = sqrt(p->level / p->area * (all.area / all.level)),
                             .area = p->area / all.area };
    }
    block_free(parts);
    return parts;
}
