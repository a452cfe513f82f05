/* SPDX-License-Identifier: MIT
 * See wedges.h. Half-edges are sorted by the place they start from; each looks for its opposite among those that start
 * where it ends.
 */
#include "wedges.h"

#include "base/union_find.h"
#include "geometry/places.h"
#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <string.h>

/* Normals on the two sides of an edge that differ by more than 20 degrees are a hard edge: an exporter splits normals
 * at 30 degrees and more, and neighbours of a dense smooth surface differ by a few. Hard edges are lines that go on.
 * Where they are so large a share of all edges, or end more often than this, of all their ends, inside of the surface,
 * it is rough and has none at that angle; the next is taken: 40, 60, 90 degrees, none. If as many as that share were
 * hard by chance, none of the five others that meet at an end of one would be with a probability of 0.8^5; half of that
 * is noise among lines, and few lines fade out. */
static const double SMOOTH_COSINES[] = { 0.93969262078590838, 0.76604444311897804, 0.5, 0.0, -2.0 };
enum { SMOOTH_COSINE_COUNT = sizeof SMOOTH_COSINES / sizeof *SMOOTH_COSINES };
static const double LOOSE_ENDS = 0.16, HARD_SHARE = 0.2;

/* Of an edge that more triangles share than this, the others are not looked at. */
enum { EDGE_USES_MAX = 64 };

/* Half-edges in the order of the places they start from: those of place p are list[first[p]] to list[first[p+1]]. */
typedef struct half_edges {
    const uint32_t *place;  /* of a corner */
    uint32_t *first, *list; /* corner 3*t+k starts the half-edge to the next corner of t */
    uint32_t *end;          /* end[i]: the place where list[i] ends */
    uint32_t *opposite;     /* opposite[c]: see opposite(); asked for up to seven times a corner */
} half_edges;

static uint32_t next_corner(uint32_t corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

/* ---- all meshes as one ------------------------------------------------------------------------------------------- */

static uint32_t vertex_of(const wedges *w, uint32_t mesh, uint32_t corner) {
    return w->first_vertex[mesh] + w->desc->meshes[mesh]->indices[corner - 3 * w->first_triangle[mesh]];
}

static void place_vertices(wedges *w) {
    double origin[3] = { 0, 0, 0 };
    hemi_transform_point(w->desc->meshes[0]->transform, w->desc->meshes[0]->positions, origin);
    for (uint32_t i = 0; i < w->desc->mesh_count; i++) {
        const hemi_mesh_desc *m = w->desc->meshes[i];
        for (size_t v = 0; v < m->vertex_count; v++) {
            double p[3];
            hemi_transform_point(m->transform, m->positions + 3 * v, p);
            for (int k = 0; k < 3; k++)
                w->positions[3 * (w->first_vertex[i] + v) + k] = (float)(p[k] - origin[k]) + 0.0f; /* -0 is 0 */
        }
    }
}

static bool find_places(wedges *w) {
    uint32_t *slots = block_new(w->desc->memory, places_slot_count(w->vertex_count) * sizeof *slots);
    bool ok = slots;
    if (ok) w->place_count = places_find_floats(w->positions, w->vertex_count, slots, w->place);
    block_free(slots);
    return ok;
}

/* The cross product of two edges in the mesh's own frame; false for a triangle without area there or without three
 * places. */
static bool set_normal(const hemi_mesh_desc *m, const uint32_t index[3], const uint32_t place[3], float out[3]) {
    double p[3][3], n[3];
    triangle_from_floats(p, m->positions, index);
    triangle_cross(n, p[0], p[1], p[2]);
    for (int k = 0; k < 3; k++) out[k] = (float)n[k];
    bool places = place[0] != place[1] && place[1] != place[2] && place[2] != place[0];
    return places && !triangle_is_degenerate(vec3_length(n), triangle_longest_squared(p[0], p[1], p[2]));
}

/* Normals of triangles; wedge[corner] becomes the corner itself, or WEDGE_NONE. */
static void measure_triangles(wedges *w) {
    for (uint32_t i = 0; i < w->desc->mesh_count; i++) {
        const hemi_mesh_desc *m = w->desc->meshes[i];
        for (uint32_t t = 0; t < m->triangle_count; t++) {
            const uint32_t *index = m->indices + 3 * (size_t)t;
            size_t triangle = (size_t)w->first_triangle[i] + t;
            uint32_t place[3];
            for (int k = 0; k < 3; k++) place[k] = w->place[w->first_vertex[i] + index[k]];
            bool sound = set_normal(m, index, place, w->normals + 3 * triangle);
            for (size_t k = 0; k < 3; k++)
                w->wedge[3 * triangle + k] = sound ? (uint32_t)(3 * triangle + k) : WEDGE_NONE;
            if (!sound) w->check.degenerate_count++;
        }
    }
}

/* ---- half-edges -------------------------------------------------------------------------------------------------- */

/* A stable counting sort of corners by key[corner], or by that of the next corner. */
static void sort_by_place(const uint32_t *key, bool of_next, size_t places, const uint32_t *in, size_t count,
                          uint32_t *first, uint32_t *out) {
    memset(first, 0, (places + 2) * sizeof *first);
    for (size_t i = 0; i < count; i++) first[key[of_next ? next_corner(in[i]) : in[i]] + 2]++;
    for (size_t p = 2; p < places + 2; p++) first[p] += first[p - 1];
    for (size_t i = 0; i < count; i++) out[first[key[of_next ? next_corner(in[i]) : in[i]] + 1]++] = in[i];
}

/* By the place they start from, those by the place they end at, and those by corner. */
static bool sort_half_edges(const wedges *w, const uint32_t *place, half_edges *h) {
    size_t corners = 3 * w->triangle_count, count = 0;
    uint32_t *by_corner = block_new(w->desc->memory, (corners + 1) * sizeof *by_corner);
    h->place = place;
    if (!h->first) h->first = block_new(w->desc->memory, (w->place_count + 2) * sizeof *h->first);
    if (!h->list) h->list = block_new(w->desc->memory, (corners + 1) * sizeof *h->list);
    if (!h->end) h->end = block_new(w->desc->memory, (corners + 1) * sizeof *h->end);
    uint32_t *by_end = block_new(w->desc->memory, (corners + 1) * sizeof *by_end);
    bool ok = by_corner && by_end && h->first && h->list && h->end;
    for (size_t c = 0; ok && c < corners; c++)
        if (w->wedge[c] != WEDGE_NONE) by_corner[count++] = (uint32_t)c;
    if (ok) {
        sort_by_place(place, true, w->place_count, by_corner, count, h->first, by_end);
        sort_by_place(place, false, w->place_count, by_end, count, h->first, h->list);
        for (size_t i = 0; i < count; i++) h->end[i] = place[next_corner(h->list[i])];
    }
    block_free(by_corner);
    block_free(by_end);
    return ok;
}

/* The first of list[low..high) that does not end before a place. */
static uint32_t first_not_before(const half_edges *h, uint32_t low, uint32_t high, uint32_t to) {
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (h->end[middle] < to)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* list[*begin ..] are the half-edges from one place to another; how many there are, at most EDGE_USES_MAX. */
static uint32_t edges_between(const half_edges *h, uint32_t from, uint32_t to, uint32_t *begin) {
    uint32_t end = h->first[from + 1], count = 0;
    *begin = first_not_before(h, h->first[from], end, to);
    while (count < EDGE_USES_MAX && *begin + count < end && h->end[*begin + count] == to) count++;
    return count;
}

/* Is there an earlier triangle of the mesh between these places in this order? */
static bool earlier_between(const wedges *w, const half_edges *h, uint32_t mesh, uint32_t corner, uint32_t a,
                            uint32_t b, uint32_t d) {
    uint32_t begin, count = edges_between(h, a, b, &begin);
    for (uint32_t i = begin; i < begin + count; i++) {
        uint32_t other = h->list[i], last = next_corner(next_corner(other));
        if (other / 3 < corner / 3 && other / 3 >= w->first_triangle[mesh] && h->place[last] == d) return true;
    }
    return false;
}

/* Is there one with the same corners, facing the same way (double-sided: either way)? */
static bool lies_in_earlier(const wedges *w, const half_edges *h, uint32_t mesh, uint32_t triangle) {
    uint32_t c = 3 * triangle, a = h->place[c], b = h->place[c + 1], d = h->place[c + 2];
    return earlier_between(w, h, mesh, c, a, b, d) ||
           (w->desc->double_sided[mesh] && earlier_between(w, h, mesh, c, a, d, b));
}

static bool leave_out_duplicates(wedges *w, half_edges *h) {
    for (uint32_t i = 0; i < w->desc->mesh_count; i++)
        for (uint32_t t = w->first_triangle[i]; t < w->first_triangle[i + 1]; t++) {
            if (w->wedge[3 * (size_t)t] == WEDGE_NONE || !lies_in_earlier(w, h, i, t)) continue;
            for (size_t k = 0; k < 3; k++) w->wedge[3 * (size_t)t + k] = WEDGE_NONE;
            w->check.duplicate_count++;
        }
    return w->check.duplicate_count == 0 || sort_half_edges(w, h->place, h);
}

/* ---- smooth or not ----------------------------------------------------------------------------------------------- */

static const float *corner_normal(const wedges *w, const hemi_mesh_desc *m, uint32_t mesh, uint32_t corner) {
    if (!m->normals) return w->normals + 3 * (size_t)(corner / 3);
    return m->normals + 3 * (size_t)m->indices[corner - 3 * w->first_triangle[mesh]];
}

static bool same_attributes(const wedges *w, const hemi_mesh_desc *m, uint32_t mesh, uint32_t a, uint32_t b) {
    if (!m->texture || !m->attributes) return true;
    size_t n = m->attribute_count, first = 3 * (size_t)w->first_triangle[mesh];
    return memcmp(m->attributes + n * m->indices[a - first], m->attributes + n * m->indices[b - first],
                  n * sizeof(float)) == 0;
}

/* Of the normals of two corners. */
static double cosine(const wedges *w, uint32_t mesh, uint32_t a, uint32_t b) {
    const hemi_mesh_desc *m = w->desc->meshes[mesh];
    const float *n = corner_normal(w, m, mesh, a), *o = corner_normal(w, m, mesh, b);
    double nn = vec3_dot_floats(n, n), oo = vec3_dot_floats(o, o);
    return nn > 0.0 && oo > 0.0 ? vec3_dot_floats(n, o) / sqrt(nn * oo) : 1.0;
}

static bool is_smooth(const wedges *w, uint32_t mesh, double smooth, uint32_t a, uint32_t b) {
    return cosine(w, mesh, a, b) >= smooth && same_attributes(w, w->desc->meshes[mesh], mesh, a, b);
}

/* The corner across the edge that a corner of a mesh begins, if two triangles of the mesh share it; WEDGE_NONE
 * otherwise. */
static uint32_t opposite(const wedges *w, const half_edges *h, uint32_t mesh, uint32_t corner) {
    uint32_t a = h->place[corner], b = h->place[next_corner(corner)], begin, back_begin;
    if (edges_between(h, a, b, &begin) != 1 || edges_between(h, b, a, &back_begin) != 1) return WEDGE_NONE;
    uint32_t other = h->list[back_begin];
    return other >= 3 * w->first_triangle[mesh] && other < 3 * w->first_triangle[mesh + 1] ? other : WEDGE_NONE;
}

static bool find_opposites(const wedges *w, half_edges *h) {
    h->opposite = block_new(w->desc->memory, (3 * w->triangle_count + 1) * sizeof *h->opposite);
    for (uint32_t i = 0; h->opposite && i < w->desc->mesh_count; i++)
        for (uint32_t c = 3 * w->first_triangle[i]; c < 3 * w->first_triangle[i + 1]; c++)
            h->opposite[c] = w->wedge[c] == WEDGE_NONE ? WEDGE_NONE : opposite(w, h, i, c);
    return h->opposite;
}

/* The same of the earlier corner of the two only, so that every edge comes once. */
static uint32_t across(const half_edges *h, uint32_t corner) {
    uint32_t other = h->opposite[corner];
    return other != WEDGE_NONE && other > corner ? other : WEDGE_NONE;
}

/* Where the surface ends, or is no surface, so do its hard edges. */
static void mark_borders(const wedges *w, const half_edges *h, uint32_t mesh, uint8_t *ends) {
    for (uint32_t c = 3 * w->first_triangle[mesh]; c < 3 * w->first_triangle[mesh + 1]; c++)
        if (w->wedge[c] != WEDGE_NONE && h->opposite[c] == WEDGE_NONE)
            ends[h->place[c]] = ends[h->place[next_corner(c)]] = 2;
}

/* ends[place]: hard edges that meet there, scratch, 0 before and after. */
static bool is_rough(const wedges *w, const half_edges *h, uint32_t mesh, double smooth, uint8_t *ends) {
    size_t edges = 0, hard = 0, loose = 0;
    uint32_t first = 3 * w->first_triangle[mesh], last = 3 * w->first_triangle[mesh + 1];
    mark_borders(w, h, mesh, ends);
    for (uint32_t c = first; c < last; c++) {
        uint32_t other = across(h, c);
        if (other == WEDGE_NONE) continue;
        edges++;
        if (cosine(w, mesh, c, next_corner(other)) >= smooth) continue;
        hard++;
        uint8_t *at[2] = { &ends[h->place[c]], &ends[h->place[next_corner(c)]] };
        for (int k = 0; k < 2; k++) *at[k] = *at[k] < 2 ? *at[k] + 1 : 2;
    }
    for (uint32_t c = first; c < last; c++) loose += ends[h->place[c]] == 1, ends[h->place[c]] = 0;
    return (double)loose > LOOSE_ENDS * 2.0 * (double)hard || (double)hard > HARD_SHARE * (double)edges;
}

static double find_smooth_cosine(wedges *w, const half_edges *h, uint32_t mesh, uint8_t *ends) {
    size_t i = 0;
    while (i + 1 < SMOOTH_COSINE_COUNT && is_rough(w, h, mesh, SMOOTH_COSINES[i], ends)) i++;
    if (i > 0) w->is_rough = true;
    return SMOOTH_COSINES[i];
}

static void count_nonmanifold(wedges *w, const half_edges *h, uint32_t corner) {
    uint32_t a = h->place[corner], b = h->place[next_corner(corner)], begin, back_begin;
    uint32_t forth = edges_between(h, a, b, &begin), back = edges_between(h, b, a, &back_begin);
    if (h->list[begin] == corner && (a < b || back == 0) && back + forth > 2) w->check.nonmanifold_count++;
}

/* Joins the corners at the two ends of every edge of two triangles that is smooth there; counts edges of more. */
static void join_over_edges(wedges *w, const half_edges *h, uint8_t *ends) {
    for (uint32_t i = 0; i < w->desc->mesh_count; i++) {
        double smooth = find_smooth_cosine(w, h, i, ends);
        for (uint32_t c = 3 * w->first_triangle[i]; c < 3 * w->first_triangle[i + 1]; c++) {
            if (w->wedge[c] == WEDGE_NONE) continue;
            if (h->opposite[c] == WEDGE_NONE) count_nonmanifold(w, h, c);
            uint32_t other = across(h, c);
            if (other == WEDGE_NONE) continue;
            if (is_smooth(w, i, smooth, c, next_corner(other))) union_find_join(w->wedge, c, next_corner(other));
            if (is_smooth(w, i, smooth, next_corner(c), other)) union_find_join(w->wedge, next_corner(c), other);
        }
    }
}

/* From roots to numbers in the order of corners. */
static bool number_wedges(wedges *w) {
    size_t corners = 3 * w->triangle_count;
    uint32_t *number = block_new(w->desc->memory, (corners + 1) * sizeof *number);
    w->wedge_vertex = block_new(w->desc->memory, (corners + 1) * sizeof *w->wedge_vertex);
    bool ok = number && w->wedge_vertex;
    for (uint32_t i = 0; ok && i < w->desc->mesh_count; i++)
        for (uint32_t c = 3 * w->first_triangle[i]; c < 3 * w->first_triangle[i + 1]; c++) {
            if (w->wedge[c] != c) continue;
            w->wedge_vertex[w->wedge_count] = vertex_of(w, i, c);
            number[c] = w->wedge_count++;
        }
    for (size_t c = 0; ok && c < corners; c++)
        if (w->wedge[c] != WEDGE_NONE) w->wedge[c] = union_find_root(w->wedge, (uint32_t)c);
    for (size_t c = 0; ok && c < corners; c++)
        if (w->wedge[c] != WEDGE_NONE) w->wedge[c] = number[w->wedge[c]];
    block_free(number);
    return ok;
}

static bool join_corners(wedges *w) {
    half_edges h = { 0 };
    uint32_t *place = block_new(w->desc->memory, (3 * w->triangle_count + 1) * sizeof *place);
    for (uint32_t i = 0; place && i < w->desc->mesh_count; i++)
        for (uint32_t c = 3 * w->first_triangle[i]; c < 3 * w->first_triangle[i + 1]; c++)
            place[c] = w->place[vertex_of(w, i, c)];
    uint8_t *ends = block_zeroed(w->desc->memory, w->place_count + 1, sizeof *ends);
    bool ok = place && ends && sort_half_edges(w, place, &h) && leave_out_duplicates(w, &h) && find_opposites(w, &h);
    if (ok) join_over_edges(w, &h, ends);
    block_free(ends);
    block_free_all(h.first, h.list, h.end, h.opposite);
    block_free(place);
    return ok && number_wedges(w);
}

static bool allocate(wedges *w) {
    uint32_t n = w->desc->mesh_count;
    w->first_vertex = block_zeroed(w->desc->memory, n + 1, sizeof *w->first_vertex);
    w->first_triangle = block_zeroed(w->desc->memory, n + 1, sizeof *w->first_triangle);
    if (!w->first_vertex || !w->first_triangle) return false;
    for (uint32_t i = 0; i < n; i++) {
        w->first_vertex[i + 1] = w->first_vertex[i] + w->desc->meshes[i]->vertex_count;
        w->first_triangle[i + 1] = w->first_triangle[i] + w->desc->meshes[i]->triangle_count;
    }
    w->vertex_count = w->first_vertex[n];
    w->triangle_count = w->first_triangle[n];
    w->positions = block_new(w->desc->memory, (3 * w->vertex_count + 1) * sizeof *w->positions);
    w->place = block_new(w->desc->memory, (w->vertex_count + 1) * sizeof *w->place);
    w->normals = block_new(w->desc->memory, (3 * w->triangle_count + 1) * sizeof *w->normals);
    w->wedge = block_new(w->desc->memory, (3 * w->triangle_count + 1) * sizeof *w->wedge);
    return w->positions && w->place && w->normals && w->wedge;
}

hemi_result wedges_find(const simplify_desc *desc, wedges *out) {
    *out = (wedges){ .desc = desc };
    if (!allocate(out)) return HEMI_ERROR_MEMORY;
    place_vertices(out);
    if (!find_places(out)) return HEMI_ERROR_MEMORY;
    measure_triangles(out);
    return join_corners(out) ? HEMI_OK : HEMI_ERROR_MEMORY;
}

void wedges_free(wedges *w) {
    void *all[] = { w->first_vertex, w->first_triangle, w->positions, w->normals, w->place, w->wedge, w->wedge_vertex };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) block_free(all[i]);
    memset(w, 0, sizeof *w);
}
