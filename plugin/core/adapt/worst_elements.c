/* SPDX-License-Identifier: MIT */
#include "adapt/worst_elements.h"

#include <stdlib.h>
#include <string.h>

/* What is off by less than this share of the goal is left: splitting it would not make up for what steps leave. */
static const double GOOD_ENOUGH = 0.5;

/* Once split, an element is off by this much less, squared: 16 where radiance is smooth, 2 at the edge of a shadow. */
static const double GAIN_OF_A_SPLIT = 4.0;

/* So many times the goal is far off: what is split beyond `most` is for pictures that would be wrong without, as of 400
 * houses in the sun (12.2 to 8.9 % for twice the time); ten rooms, maps and garages get a thousandth more at most. */
static const double FAR_OFF = 5.0;

typedef struct worst_candidate {
    double error;
    uint32_t leaf;
} worst_candidate;

bool worst_elements_create(allocator *memory, size_t leaves, worst_elements *out) {
    *out = (worst_elements){ .errors = block_new(memory, (leaves + 1) * sizeof *out->errors),
                             .levels = block_new(memory, (leaves + 1) * sizeof *out->levels),
                             .areas = block_new(memory, (leaves + 1) * sizeof *out->areas),
                             .candidates = block_new(memory, (leaves + 1) * sizeof *out->candidates),
                             .marks = block_new(memory, leaves + 1),
                             .count = leaves };
    return out->errors && out->levels && out->areas && out->candidates && out->marks;
}

void worst_elements_free(worst_elements *w) {
    block_free_all(w->errors, w->levels, w->areas, w->candidates, w->marks);
}

/* Large elements that light bends on show as teeth where it ends on a smooth surface, long before they are off by much:
 * there that counts for so much, squared. */
static const double SMOOTH = 16.0;

/* In surroundings that are far larger than what is among them, nothing is looked for further from this than so many of
 * its radii: shadows end there, unless the sun is low. */
static const double BESIDE_RADII = 4.0;

static bool is_beside(const scene *s, const mesh *m, const element *e) {
    const double *at = m->vertices + 3 * (size_t)e->corner[0];
    return !s->has_surroundings || vec3_distance(at, s->things_center) <= BESIDE_RADII * s->things_radius;
}

void worst_elements_weigh(worst_elements *w, const scene *s, const mesh *m, bool by_rows) {
    double all = w->area = w->level = 0.0;
    for (size_t i = 0; i < w->count; i++) {
        all += w->areas[i] = m->elements[i].area;
        w->level += w->levels[i];
        if (!by_rows && m->patches[m->elements[i].patch].is_smooth) w->errors[i] *= SMOOTH;
        if (is_beside(s, m, &m->elements[i]))
            w->area += w->areas[i];
        else
            w->errors[i] = 0.0;
    }
    w->level *= w->area / all;
}

static int compare_candidates(const void *a, const void *b) {
    const worst_candidate *x = a, *y = b;
    if (x->error != y->error) return x->error < y->error ? 1 : -1;
    return (x->leaf > y->leaf) - (x->leaf < y->leaf);
}

/* The worst first, until no more than aim is left. */
static size_t mark_until(worst_elements *w, const leaf *leaves, int levels, double aim, size_t most) {
    double left = 0.0, good = GOOD_ENOUGH * GOOD_ENOUGH * aim / w->area;
    size_t candidates = 0, marked = 0;
    memset(w->marks, 0, w->count);
    for (size_t i = 0; i < w->count; i++) {
        left += w->errors[i];
        if (leaves[i].level < levels && w->errors[i] > good * w->areas[i])
            w->candidates[candidates++] = (worst_candidate){ w->errors[i], (uint32_t)i };
    }
    qsort(w->candidates, candidates, sizeof *w->candidates, compare_candidates);
    for (; marked < candidates && marked < most && left > aim; marked++) {
        w->marks[w->candidates[marked].leaf] = true;
        left -= w->candidates[marked].error * (1.0 - 1.0 / GAIN_OF_A_SPLIT);
    }
    return marked;
}

size_t worst_elements_mark(worst_elements *w, const leaf *leaves, int levels, double goal, size_t most, size_t far) {
    double aim = goal * goal * w->level;
    size_t marked = far > most ? mark_until(w, leaves, levels, FAR_OFF * FAR_OFF * aim, far) : 0;
    return marked > most ? marked : mark_until(w, leaves, levels, aim, most);
}
