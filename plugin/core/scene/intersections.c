/* SPDX-License-Identifier: MIT
 * Which surfaces pass through others? Boxes are swept along the axis that the scene is longest on; of those that
 * overlap, edges are tested against surfaces.
 */
#include "scene/scene.h"

#include "base/tolerance.h"

#include <stdlib.h>

static const uint64_t COMPARISONS_MAX = UINT64_C(200000000);

typedef struct box {
    double low[3], high[3];
    uint32_t surface;
} box;

static int compare(const void *a, const void *b) {
    const box *x = a, *y = b;
    if (x->low[0] != y->low[0]) return x->low[0] < y->low[0] ? -1 : 1;
    return (x->surface > y->surface) - (x->surface < y->surface);
}

/* Coordinates are turned so that the longest axis comes first. */
static size_t list_boxes(const scene *s, box *boxes) {
    double low[3], high[3];
    size_t count = 0, first = 0;
    vec3_bounds(s->vertices, s->vertex_count, low, high);
    for (size_t k = 1; k < 3; k++)
        if (high[k] - low[k] > high[first] - low[first]) first = k;
    for (uint32_t i = 0; i < s->surface_count; i++) {
        const surface *f = &s->surfaces[i];
        if (surface_sheet(s, i) != i) continue;
        box *b = &boxes[count++];
        *b =
            (box){ .low = { INFINITY, INFINITY, INFINITY }, .high = { -INFINITY, -INFINITY, -INFINITY }, .surface = i };
        for (int c = 0; c < surface_corner_count(f); c++)
            for (size_t k = 0; k < 3; k++) {
                double x = scene_vertex(s, f->corner[c])[(first + k) % 3];
                b->low[k] = fmin(b->low[k], x);
                b->high[k] = fmax(b->high[k], x);
            }
    }
    return count;
}

/* Is a point of a surface's plane inside it by more than the margin? */
static bool is_well_inside(const scene *s, const surface *f, const double point[3], double margin) {
    int count = surface_corner_count(f);
    for (int i = 0; i < count; i++) {
        const double *a = scene_vertex(s, f->corner[i]), *b = scene_vertex(s, f->corner[(i + 1) % count]);
        double edge[3], offset[3], side[3];
        vec3_sub(edge, b, a);
        vec3_sub(offset, point, a);
        vec3_cross(side, edge, offset);
        if (vec3_dot(side, f->normal) <= margin * vec3_length(edge)) return false;
    }
    return true;
}

/* Does an edge of one pass through the other? */
static bool pierces(const scene *s, const surface *one, const surface *other, double margin) {
    int count = surface_corner_count(one);
    for (int i = 0; i < count; i++) {
        const double *a = scene_vertex(s, one->corner[i]), *b = scene_vertex(s, one->corner[(i + 1) % count]);
        double from = surface_height(other, a), to = surface_height(other, b), point[3], edge[3];
        if (fabs(from) <= margin || fabs(to) <= margin || (from > 0.0) == (to > 0.0)) continue;
        vec3_sub(edge, b, a);
        vec3_add_scaled(point, a, from / (from - to), edge);
        if (is_well_inside(s, other, point, margin)) return true;
    }
    return false;
}

bool intersections_count(const scene *s, uint32_t *count) {
    box *boxes = block_new(s->memory, (s->surface_count + 1) * sizeof *boxes);
    bool *crossed = block_zeroed(s->memory, s->surface_count + 1, sizeof *crossed);
    double margin = TOLERANCE_OVERLAP * s->radius;
    uint64_t comparisons = 0;
    bool ok = boxes && crossed;
    size_t n = ok ? list_boxes(s, boxes) : 0;
    *count = 0;
    if (ok) qsort(boxes, n, sizeof *boxes, compare);
    for (size_t i = 0; i < n && comparisons < COMPARISONS_MAX; i++)
        for (size_t k = i + 1; k < n && boxes[k].low[0] <= boxes[i].high[0]; k++, comparisons++) {
            const box *x = &boxes[i], *y = &boxes[k];
            uint32_t a = x->surface, b = y->surface;
            if ((crossed[a] && crossed[b]) || x->low[1] > y->high[1] || y->low[1] > x->high[1] ||
                x->low[2] > y->high[2] || y->low[2] > x->high[2])
                continue;
            const surface *f = &s->surfaces[a], *g = &s->surfaces[b];
            if (!pierces(s, f, g, margin) && !pierces(s, g, f, margin)) continue;
            crossed[a] = crossed[b] = true;
        }
    for (size_t i = 0; ok && i < s->surface_count; i++) *count += crossed[i];
    block_free_all(boxes, crossed);
    return ok;
}
