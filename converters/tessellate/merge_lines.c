/* SPDX-License-Identifier: MIT
 * See merge_lines.h.
 */
#include "merge_lines.h"

#include "base/union_find.h"

#include <string.h>

/* Cells that hardly turn at each line make a curve: this is for a line, the whole grid is looked at after that. */
static const double TOLERANCE_LINE = 1e-4;

static const double *position(const merge_lines *m, uint32_t v) {
    return m->b->out->vertices->positions + 3 * (size_t)v;
}

/* ---- what is around what ---- */

static void find_around(merge_lines *m) {
    const builder *b = m->b;
    for (uint32_t f = 0; f < b->face_count; f++)
        for (int k = 0; k < face_corner_count(&b->faces[f]); k++)
            m->first[b->faces[f].corner[k] - m->first_vertex + 2]++;
    for (uint32_t v = 2; v < m->vertex_count + 2; v++) m->first[v] += m->first[v - 1];
    for (uint32_t f = 0; f < b->face_count; f++)
        for (int k = 0; k < face_corner_count(&b->faces[f]); k++)
            m->around[m->first[b->faces[f].corner[k] - m->first_vertex + 1]++] = f;
}

static uint32_t count_around(const merge_lines *m, uint32_t v) {
    return m->first[v - m->first_vertex + 1] - m->first[v - m->first_vertex];
}

/* The edge of another face that runs from q to p; NO_INDEX if there is none or several, or another from p to q. */
static uint32_t find_across(const merge_lines *m, uint32_t f, uint32_t p, uint32_t q) {
    uint32_t found = NO_INDEX, first = m->first[p - m->first_vertex], end = m->first[p - m->first_vertex + 1];
    for (uint32_t i = first; i < end; i++) {
        uint32_t g = m->around[i];
        int n = face_corner_count(&m->b->faces[g]);
        for (int k = 0; g != f && k < n; k++) {
            uint32_t from = m->b->faces[g].corner[k], to = m->b->faces[g].corner[(k + 1) % n];
            bool is_same = from == p && to == q;
            if (!is_same && !(from == q && to == p)) continue;
            if (is_same || found != NO_INDEX) return NO_INDEX;
            found = 4 * g + (uint32_t)k;
        }
    }
    return found;
}

static void find_neighbours(merge_lines *m) {
    for (uint32_t f = 0; f < m->b->face_count; f++) {
        const face *own = &m->b->faces[f];
        int n = face_corner_count(own);
        for (int k = 0; k < 4; k++) {
            size_t e = 4 * (size_t)f + (size_t)k;
            m->across[e] = k < n ? find_across(m, f, own->corner[k], own->corner[(k + 1) % n]) : NO_INDEX;
            m->line[e] = (uint32_t)e;
            if (m->across[e] != NO_INDEX) union_find_join(m->region, f, m->across[e] / 4);
        }
    }
}

/* ---- lines ---- */

/* Do the faces on both sides of an edge make a parallelogram? */
static bool joins(const merge_lines *m, uint32_t e) {
    const face *f = &m->b->faces[e / 4], *g = &m->b->faces[m->across[e] / 4];
    double before[3], after[3], off[3];
    if (face_corner_count(f) != 4 || face_corner_count(g) != 4) return false;
    uint32_t p = f->corner[e % 4];
    vec3_sub(before, position(m, p), position(m, f->corner[(e + 3) % 4]));
    vec3_sub(after, position(m, g->corner[(m->across[e] + 2) % 4]), position(m, p));
    vec3_cross(off, before, after);
    return vec3_length(off) <= TOLERANCE_LINE * vec3_dot(before, after);
}

/* The edge on which that from corner k of a face goes on past the corner, if four faces meet there; NO_INDEX: else. */
static uint32_t edge_beyond(const merge_lines *m, uint32_t e) {
    uint32_t f = e / 4, back = m->across[4 * f + (e + 3) % 4];
    if (back == NO_INDEX || face_corner_count(&m->b->faces[back / 4]) != 4) return NO_INDEX;
    return 4 * (back / 4) + (back + 3) % 4;
}

/* What a line does at one end of an edge, the corner that it runs from. False: it stays. */
static bool goes_on(merge_lines *m, uint32_t e, const uint32_t *sharing, uint32_t first_node) {
    const face *f = &m->b->faces[e / 4];
    uint32_t p = f->corner[e % 4], count = count_around(m, p), beyond;
    if (sharing[m->b->out->vertices->nodes[p] - first_node] > 1) return false;
    if (count == 2) return true;
    if (count != 4) return false;
    beyond = edge_beyond(m, e);
    if (beyond == NO_INDEX || m->across[beyond] == NO_INDEX) return false;
    uint32_t other = m->across[beyond], from = m->across[e];
    /* The fourth face must be the one beyond the face on the other side. */
    uint32_t side = m->across[4 * (from / 4) + (from + 1) % 4];
    if (side == NO_INDEX || side / 4 != other / 4) return false;
    union_find_join(m->line, e < from ? e : from, beyond < other ? beyond : other);
    return true;
}

/* sharing[n]: how many vertices have the node n past the first of the mesh. */
static void find_lines(merge_lines *m, const uint32_t *sharing, uint32_t first_node) {
    size_t edges = 4 * (size_t)m->b->face_count;
    for (uint32_t e = 0; e < edges; e++) {
        uint32_t other = m->across[e];
        if (other == NO_INDEX || e > other) continue;
        bool goes = joins(m, e) && goes_on(m, e, sharing, first_node);
        m->stays[e] = !(goes && goes_on(m, other, sharing, first_node));
    }
    for (uint32_t e = 0; e < edges; e++) {
        m->line[e] = union_find_root(m->line, e);
        if (m->stays[e]) m->stays[m->line[e]] = true;
    }
}

bool merge_lines_open(const merge_lines *m, uint32_t e) {
    uint32_t other = m->across[e];
    if (other == NO_INDEX) return false;
    return !m->stays[m->line[e < other ? e : other]];
}

/* ---- all of it ---- */

bool merge_lines_find(builder *b, uint32_t first_vertex, uint32_t first_node, merge_lines *m) {
    size_t faces = b->face_count, corners = 4 * faces, vertices = b->out->vertices->count - first_vertex;
    size_t nodes = b->out->vertices->node_count - first_node;
    allocator *memory = b->desc->memory;
    *m = (merge_lines){ .b = b,
                        .first_vertex = first_vertex,
                        .vertex_count = (uint32_t)vertices,
                        .first = block_zeroed(memory, vertices + 3, sizeof *m->first),
                        .around = block_new(memory, (corners + 1) * sizeof *m->around),
                        .across = block_new(memory, (corners + 1) * sizeof *m->across),
                        .line = block_new(memory, (corners + 1) * sizeof *m->line),
                        .stays = block_zeroed(memory, corners + 1, sizeof *m->stays),
                        .region = block_new(memory, (faces + 1) * sizeof *m->region) };
    uint32_t *sharing = block_zeroed(memory, nodes + 1, sizeof *sharing);
    bool ok = m->first && m->around && m->across && m->line && m->stays && m->region && sharing;
    for (uint32_t f = 0; ok && f < faces; f++) m->region[f] = f;
    for (size_t i = 0; ok && i < vertices; i++) sharing[b->out->vertices->nodes[first_vertex + i] - first_node]++;
    if (ok) {
        find_around(m);
        find_neighbours(m);
        find_lines(m, sharing, first_node);
        for (uint32_t f = 0; f < faces; f++) m->region[f] = union_find_root(m->region, f);
    }
    block_free(sharing);
    return ok;
}

void merge_lines_free(merge_lines *m) {
    block_free_all(m->first, m->around, m->across, m->line, m->stays, m->region);
    memset(m, 0, sizeof *m);
}
