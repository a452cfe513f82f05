/* SPDX-License-Identifier: MIT
 * See coplanar_overlap.h.
 *
 * Triangles are sorted by the distance of their plane from the origin; those that follow each other closely are a
 * group, cut into strips and swept along them. In scenes without overlaps this is two sorts. Copies of a triangle are
 * swept as one: a file with a hundred copies of all it holds took minutes.
 */
#include "scene/coplanar_overlap.h"

#include "base/tolerance.h"
#include "geometry/plane.h"
#include "geometry/triangle.h"

#include <stdlib.h>
#include <string.h>

typedef struct flat {
    double corner[3][3], low[3], high[3];
    double normal[3], distance; /* of the plane; the normal's sign is that of its product with SIGN */
    uint32_t triangle;
    size_t copies; /* this and those that follow it with the same corners; 0: it is one of these */
} flat;

/* A direction that no modeller's plane contains. */
static const double SIGN[3] = { 1.0, 0.61803398874989485, 0.27550804099948439 };

/* A triangle in one strip of its group. */
typedef struct entry {
    size_t strip;
    double low, high; /* along the strip */
    const flat *flat;
} entry;

typedef struct pair {
    uint32_t later, earlier;
} pair;

typedef struct finder {
    allocator *memory;
    double margin; /* lengths below this are none */
    flat *flats;
    size_t flat_count;
    entry *entries;
    size_t entry_count, entry_capacity;
    pair *pairs;
    size_t pair_count, pair_capacity;
} finder;

/* ---- triangles ---- */

/* False for a triangle without area. */
static bool flat_set(flat *f, const float *positions, const uint32_t *index, uint32_t triangle) {
    triangle_from_floats(f->corner, positions, index);
    for (int k = 0; k < 3; k++) {
        f->low[k] = fmin(f->corner[0][k], fmin(f->corner[1][k], f->corner[2][k]));
        f->high[k] = fmax(f->corner[0][k], fmax(f->corner[1][k], f->corner[2][k]));
    }
    triangle_cross(f->normal, f->corner[0], f->corner[1], f->corner[2]);
    if (!(vec3_normalize(f->normal) > 0.0)) return false;
    double sign = vec3_dot(f->normal, SIGN) < 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 3; k++) f->normal[k] *= sign;
    f->distance = vec3_dot(f->normal, f->corner[0]);
    f->triangle = triangle;
    return true;
}

/* Does a line along an edge of a have all of b on its outer side? */
static bool edge_separates(const flat *a, const flat *b, double margin) {
    for (int i = 0; i < 3; i++) {
        double edge[3], out[3], inner[3], nearest = INFINITY;
        vec3_sub(edge, a->corner[(i + 1) % 3], a->corner[i]);
        vec3_sub(inner, a->corner[(i + 2) % 3], a->corner[i]);
        vec3_cross(out, edge, a->normal);
        if (vec3_normalize(out) == 0.0) continue;
        if (vec3_dot(out, inner) > 0.0) out[0] = -out[0], out[1] = -out[1], out[2] = -out[2];
        for (int k = 0; k < 3; k++) {
            double offset[3];
            vec3_sub(offset, b->corner[k], a->corner[i]);
            nearest = fmin(nearest, vec3_dot(out, offset));
        }
        if (nearest > -margin) return true;
    }
    return false;
}

static bool overlap(const flat *a, const flat *b, double margin) {
    for (int k = 0; k < 3; k++)
        if (a->low[k] > b->high[k] || b->low[k] > a->high[k]) return false;
    return plane_holds(a->normal, a->distance, b->corner, 3, margin) &&
           plane_holds(b->normal, b->distance, a->corner, 3, margin) && !edge_separates(a, b, margin) &&
           !edge_separates(b, a, margin);
}

/* ---- groups ---- */

static int compare_flats(const void *a, const void *b) {
    const flat *x = a, *y = b;
    if (x->distance != y->distance) return x->distance < y->distance ? -1 : 1;
    int corners = memcmp(x->corner, y->corner, sizeof x->corner);
    if (corners != 0) return corners;
    return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

static int compare_entries(const void *a, const void *b) {
    const entry *x = a, *y = b;
    if (x->strip != y->strip) return x->strip < y->strip ? -1 : 1;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    return (x->flat->triangle > y->flat->triangle) - (x->flat->triangle < y->flat->triangle);
}

static int compare_pairs(const void *a, const void *b) {
    const pair *x = a, *y = b;
    if (x->later != y->later) return x->later < y->later ? -1 : 1;
    return (x->earlier > y->earlier) - (x->earlier < y->earlier);
}

static bool add_entry(finder *s, entry e) {
    bool ok = block_grow(s->memory, (void **)&s->entries, &s->entry_capacity, s->entry_count, sizeof e);
    if (ok) s->entries[s->entry_count++] = e;
    return ok;
}

static bool add_pair(finder *s, uint32_t a, uint32_t b) {
    bool ok = block_grow(s->memory, (void **)&s->pairs, &s->pair_capacity, s->pair_count, sizeof *s->pairs);
    if (ok) s->pairs[s->pair_count++] = a > b ? (pair){ a, b } : (pair){ b, a };
    return ok;
}

/* As many strips as the root of the triangles. */
static bool cut_strips(finder *s, const flat *group, size_t count) {
    const double *normal = group[0].normal;
    double low = INFINITY, high = -INFINITY;
    int largest = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) > fabs(normal[largest])) largest = k;
    int along = (largest + 1) % 3, across = (largest + 2) % 3; /* which a group spreads along, whatever its normal */
    for (size_t i = 0; i < count; i++) low = fmin(low, group[i].low[across]), high = fmax(high, group[i].high[across]);
    double strips = floor(sqrt((double)count)), per_length = high > low ? strips / (high - low) : 0.0;
    s->entry_count = 0;
    for (size_t i = 0; i < count; i++) {
        if (group[i].copies == 0) continue;
        size_t first = (size_t)((group[i].low[across] - low) * per_length);
        size_t last = (size_t)((group[i].high[across] - low) * per_length);
        for (size_t strip = first; strip <= last; strip++)
            if (!add_entry(s, (entry){ strip, group[i].low[along], group[i].high[along], &group[i] })) return false;
    }
    return true;
}

/* Each copy overlaps the one before it, which is enough: that one has a higher layer than those before. */
static bool chain_copies(finder *s, flat *group, size_t count) {
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && memcmp(group[i].corner, group[end].corner, sizeof group[i].corner) == 0;
             end++) {
            group[end].copies = 0;
            if (!add_pair(s, group[end].triangle, group[end - 1].triangle)) return false;
        }
        group[i].copies = end - i;
    }
    return true;
}

/* By the same token each copy of one overlaps the last copy of the other before it. */
static bool add_pairs(finder *s, const flat *a, const flat *b) {
    size_t i = 0, k = 0;
    while (i < a->copies || k < b->copies) {
        bool from_a = k == b->copies || (i < a->copies && a[i].triangle < b[k].triangle);
        if (from_a && k > 0 && !add_pair(s, a[i].triangle, b[k - 1].triangle)) return false;
        if (!from_a && i > 0 && !add_pair(s, b[k].triangle, a[i - 1].triangle)) return false;
        if (from_a)
            i++;
        else
            k++;
    }
    return true;
}

static bool sweep_group(finder *s, flat *group, size_t count) {
    if (!chain_copies(s, group, count) || !cut_strips(s, group, count)) return false;
    qsort(s->entries, s->entry_count, sizeof *s->entries, compare_entries);
    for (size_t i = 0; i < s->entry_count; i++) {
        const entry *a = &s->entries[i];
        for (size_t k = i + 1; k < s->entry_count; k++) {
            const entry *b = &s->entries[k];
            if (b->strip != a->strip || b->low > a->high) break;
            if (overlap(a->flat, b->flat, s->margin) && !add_pairs(s, a->flat, b->flat)) return false;
        }
    }
    return true;
}

static bool sweep_all(finder *s) {
    for (size_t first = 0, end; first < s->flat_count; first = end) {
        for (end = first + 1; end < s->flat_count; end++)
            if (s->flats[end].distance - s->flats[end - 1].distance > s->margin) break;
        if (end - first > 1 && !sweep_group(s, s->flats + first, end - first)) return false;
    }
    return true;
}

static void take_triangles(finder *s, const float *positions, const uint32_t *indices, size_t triangle_count) {
    double extent = 0.0;
    for (size_t t = 0; t < triangle_count; t++) {
        flat *f = &s->flats[s->flat_count];
        if (!flat_set(f, positions, indices + 3 * t, (uint32_t)t)) continue;
        for (int k = 0; k < 3; k++) extent = fmax(extent, fmax(fabs(f->low[k]), fabs(f->high[k])));
        s->flat_count++;
    }
    s->margin = TOLERANCE_OVERLAP * extent;
}

bool coplanar_overlap_find_layers(allocator *memory, const float *positions, const uint32_t *indices,
                                  size_t triangle_count, uint8_t *layers) {
    finder s = { .memory = memory, .flats = block_new(memory, (triangle_count + 1) * sizeof *s.flats) };
    bool ok = s.flats != NULL;
    memset(layers, 0, triangle_count);
    if (ok) {
        take_triangles(&s, positions, indices, triangle_count);
        qsort(s.flats, s.flat_count, sizeof *s.flats, compare_flats);
        ok = sweep_all(&s);
    }
    if (ok && s.pair_count > 0) qsort(s.pairs, s.pair_count, sizeof *s.pairs, compare_pairs);
    for (size_t i = 0; ok && i < s.pair_count; i++) {
        int above = layers[s.pairs[i].earlier] + 1;
        uint8_t *layer = &layers[s.pairs[i].later];
        if (above > *layer)
            *layer = (uint8_t)(above < COPLANAR_OVERLAP_LAYERS_MAX ? above : COPLANAR_OVERLAP_LAYERS_MAX - 1);
    }
    block_free_all(s.flats, s.entries, s.pairs);
    return ok;
}
