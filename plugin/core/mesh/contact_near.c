/* SPDX-License-Identifier: MIT */
#include "mesh/contact_near.h"

#include "geometry/vec3.h"

#include <string.h>

/* Sets the box; returns its diagonal. */
static double set_box(contact_near *n, const double (*corner)[3], int count, double share) {
    vec3_bounds(corner[0], (size_t)count, n->low, n->high);
    double diagonal = vec3_distance(n->low, n->high);
    for (int k = 0; k < 3; k++) n->low[k] -= share * diagonal, n->high[k] += share * diagonal;
    return diagonal;
}

bool contact_near_has(const contact_near *n, const contact_line *l) {
    for (int k = 0; k < 3; k++)
        if ((l->from[k] > n->high[k] && l->to[k] > n->high[k]) || (l->from[k] < n->low[k] && l->to[k] < n->low[k]))
            return false;
    return true;
}

bool contact_near_open(allocator *memory, const contact_lines *lines, size_t surface_count, contact_near *out) {
    size_t most = 0;
    for (size_t i = 0; i < surface_count; i++)
        most = most > lines->first[i + 1] - lines->first[i] ? most : lines->first[i + 1] - lines->first[i];
    *out = (contact_near){ .patch = block_new(memory, (most + 1) * sizeof *out->patch),
                           .element = block_new(memory, (most + 1) * sizeof *out->element) };
    return out->patch && out->element;
}

void contact_near_close(contact_near *n) {
    block_free_all(n->patch, n->element);
}

void contact_near_patch(contact_near *n, const contact_lines *lines, uint32_t sheet, const double (*corner)[3],
                        int count, double share) {
    set_box(n, corner, count, share);
    n->patch_count = n->element_count = 0;
    for (size_t i = lines->first[sheet]; i < lines->first[sheet + 1]; i++)
        if (contact_near_has(n, &lines->lines[i])) n->patch[n->patch_count++] = &lines->lines[i];
}

double contact_near_element(contact_near *n, const double (*corner)[3], int count, double share) {
    double diagonal = set_box(n, corner, count, share);
    memcpy(n->corner, corner, (size_t)count * sizeof *n->corner);
    n->corner_count = count;
    n->element_count = 0;
    for (size_t i = 0; i < n->patch_count; i++)
        if (contact_near_has(n, n->patch[i])) n->element[n->element_count++] = n->patch[i];
    return diagonal;
}

size_t contact_near_through(const contact_near *n, const double normal[3]) {
    const double(*corner)[3] = (const double(*)[3])n->corner;
    size_t through = 0;
    double low, high;
    for (size_t i = 0; i < n->element_count; i++)
        through += contact_line_clip(n->element[i], corner, n->corner_count, normal, &low, &high);
    return through;
}

bool contact_near_has_edge(const contact_near *n, const double from[3], const double to[3], double gap, double reach) {
    for (size_t i = 0; i < n->element_count; i++) {
        const contact_line *l = n->element[i];
        if (l->gap >= gap) continue; /* light goes on under what hangs there */
        if (vec3_distance_to_segment(from, l->from, l->to) <= reach &&
            vec3_distance_to_segment(to, l->from, l->to) <= reach)
            return true;
    }
    return false;
}
