/* SPDX-License-Identifier: MIT
 * Which parallelograms are one larger one? Light knows nothing of how finely a flat wall was cut: a grid of faces over
 * which everything is affine becomes one face, and its cells are remembered (scene/surface_grid.h). Which edges go is
 * said by merge_lines.h.
 */
#include "merge_lines.h"

#include "base/tolerance.h"
#include "base/union_find.h"
#include "geometry/triangle.h"

#include <math.h>

/* Faces are merged that have less than this share of the area of an element, in the mean of what hangs together, if
 * they are so many: of few nothing is to be gained. */
static const double FINE = 1.0;
enum { MANY_FACES = 100 };

/* Where a cell is: its face, and the corner of that which is the grid's first. */
typedef struct cell {
    uint32_t face, corner;
} cell;

typedef struct merger {
    builder *b;
    merge_lines lines;
    uint32_t *grid;        /* a forest of faces that are one grid */
    uint32_t *next, *last; /* of a face: lists of those of its grid */
    cell *cells;           /* of the grid at hand */
    face *merged;          /* of the root of a grid */
    bool *spoilt;          /* of the lowest face of a region: it stays as it is */
} merger;

static const double *position(const merger *m, uint32_t v) {
    return m->b->out->vertices->positions + 3 * (size_t)v;
}

/* ---- grids ---- */

static void find_grids(merger *m) {
    for (uint32_t e = 0; e < 4 * m->b->face_count; e++)
        if (m->lines.across[e] > e && merge_lines_open(&m->lines, e))
            union_find_join(m->grid, e / 4, m->lines.across[e] / 4);
    for (uint32_t f = 0; f < m->b->face_count; f++) {
        uint32_t root = union_find_root(m->grid, f);
        m->next[f] = NO_INDEX;
        if (root != f) m->next[m->last[root]] = f;
        m->last[root] = f;
    }
}

/* The cell that has the first corner of a grid; false: it has not four. *count: of its cells. */
static bool find_corner(const merger *m, uint32_t root, cell *out, uint32_t *count) {
    uint32_t corners = 0;
    *count = 0;
    for (uint32_t f = root; f != NO_INDEX; f = m->next[f], ++*count)
        for (uint32_t k = 0; k < 4; k++) {
            if (merge_lines_open(&m->lines, 4 * f + k) || merge_lines_open(&m->lines, 4 * f + (k + 3) % 4)) continue;
            if (corners++ == 0) *out = (cell){ f, k };
        }
    return corners == 4;
}

/* The next cell of a row, and the first of the next row. */
static bool step(const merger *m, cell *at, bool up) {
    uint32_t e = 4 * at->face + (at->corner + (up ? 2 : 1)) % 4, to = m->lines.across[e];
    if (!merge_lines_open(&m->lines, e)) return false;
    *at = (cell){ to / 4, up ? to % 4 : (to + 1) % 4 };
    return true;
}

/* Lists the cells row by row. False: they are none. */
static bool list_cells(const merger *m, cell first, uint32_t count, uint32_t *columns, uint32_t *rows) {
    uint32_t listed = 0;
    *columns = *rows = 0;
    do {
        cell at = first;
        uint32_t row = listed;
        do {
            if (listed == count) return false;
            m->cells[listed++] = at;
        } while (step(m, &at, false));
        if (*rows == 0) *columns = listed;
        ++*rows;
        if (listed - row != *columns) return false;
    } while (step(m, &first, true));
    return listed == count;
}

static uint32_t corner_at(const merger *m, const cell *at, uint32_t k) {
    return m->b->faces[at->face].corner[(at->corner + k) % 4];
}

/* The vertex of the mesh that a cell's corner is. */
static uint32_t index_at(const merger *m, const cell *at, uint32_t k) {
    const face *f = &m->b->faces[at->face];
    const uint32_t *indices = m->b->mesh->indices;
    k = (at->corner + k) % 4;
    if (k == 2) return indices[3 * (size_t)f->triangle[1] + (size_t)(f->rotation[1] + 1) % 3];
    return indices[3 * (size_t)f->triangle[0] + (size_t)(f->rotation[0] + (k == 3 ? 2 : k)) % 3];
}

/* Are values at a corner of a cell what the grid's corners make of them? in: of three of these, and of that one. */
static bool is_affine(const float *values, uint32_t stride, const uint32_t in[4], double u, double v,
                      double tolerance) {
    for (uint32_t k = 0; values && k < stride; k++) {
        double at[4], size = 1.0;
        for (int i = 0; i < 4; i++) at[i] = values[(size_t)stride * in[i] + k], size = fmax(size, fabs(at[i]));
        if (!(fabs(at[0] + u * (at[1] - at[0]) + v * (at[2] - at[0]) - at[3]) <= tolerance * size)) return false;
    }
    return true;
}

/* Is everything affine at a corner of a cell, which lies at (u, v)? corner: of the grid, those at 0, at u and at v. */
static bool fits(const merger *m, const cell *const corner[3], const cell *at, uint32_t k, double u, double v) {
    const hemi_mesh_desc *d = m->b->mesh;
    const double *o = position(m, corner_at(m, corner[0], 0)), *p = position(m, corner_at(m, corner[1], 1)),
                 *q = position(m, corner_at(m, corner[2], 3)), *x = position(m, corner_at(m, at, k));
    double size = fmax(vec3_distance(o, p), vec3_distance(o, q)), off = 0.0;
    for (int c = 0; c < 3; c++) {
        off = fmax(off, fabs(o[c] + u * (p[c] - o[c]) + v * (q[c] - o[c]) - x[c]));
        size = fmax(size, 0.1 * fabs(x[c]));
    }
    const uint32_t in[4] = { index_at(m, corner[0], 0), index_at(m, corner[1], 1), index_at(m, corner[2], 3),
                             index_at(m, at, k) };
    return off <= TOLERANCE_AFFINE * size && is_affine(d->normals, 3, in, u, v, TOLERANCE_AFFINE_NORMAL) &&
           is_affine(d->attributes, d->attribute_count, in, u, v, TOLERANCE_AFFINE);
}

/* Where columns, or rows, begin. */
static void set_begins(const merger *m, uint32_t count, size_t stride, uint32_t k, double *begins) {
    const double *o = position(m, corner_at(m, &m->cells[0], 0)),
                 *end = position(m, corner_at(m, &m->cells[(count - 1) * stride], k));
    for (uint32_t i = 0; i < count; i++)
        begins[i] = vec3_distance(o, position(m, corner_at(m, &m->cells[i * stride], 0))) / vec3_distance(o, end);
    begins[count] = 1.0;
}

static bool is_flat(const merger *m, const surface_grid *g) {
    size_t columns = g->column_count, rows = g->row_count;
    const cell *const corner[3] = { m->cells, m->cells + columns - 1, m->cells + (rows - 1) * columns };
    for (size_t j = 0; j < rows; j++)
        for (size_t i = 0; i < columns; i++) {
            const cell *at = &m->cells[j * columns + i];
            if (!fits(m, corner, at, 0, g->columns[i], g->rows[j]) ||
                !fits(m, corner, at, 2, g->columns[i + 1], g->rows[j + 1]))
                return false;
        }
    return true;
}

static void set_frame(const merger *m, surface_grid *g) {
    const float *p = m->b->mesh->positions;
    const cell *right = m->cells + g->column_count - 1, *top = m->cells + (size_t)(g->row_count - 1) * g->column_count;
    vec3_from_floats(g->origin, p + 3 * (size_t)index_at(m, m->cells, 0));
    vec3_from_floats(g->across, p + 3 * (size_t)index_at(m, right, 1));
    vec3_from_floats(g->along, p + 3 * (size_t)index_at(m, top, 3));
    vec3_sub(g->across, g->across, g->origin);
    vec3_sub(g->along, g->along, g->origin);
    for (size_t i = 0; i < (size_t)g->column_count * g->row_count; i++)
        for (size_t t = 0; t < 2; t++) g->triangles[2 * i + t] = m->b->faces[m->cells[i].face].triangle[t];
}

/* The face of a grid at m->cells[0], which m->cells are. */
static void replace(merger *m, surface_grid *g) {
    builder *b = m->b;
    uint32_t columns = g->column_count, all = columns * g->row_count;
    const cell *at = m->cells, *right = at + columns - 1, *last = at + all - 1, *top = at + all - columns;
    face whole = b->faces[at->face];
    set_frame(m, g);
    whole.corner[0] = corner_at(m, at, 0), whole.corner[1] = corner_at(m, right, 1);
    whole.corner[2] = corner_at(m, last, 2), whole.corner[3] = corner_at(m, top, 3);
    whole.grid = g;
    g->next = b->out->scene->grids;
    b->out->scene->grids = g;
    m->merged[union_find_root(m->grid, at->face)] = whole;
}

/* Looks at one grid; spoils its region where it is none. False when out of memory. */
static bool look_at(merger *m, uint32_t root) {
    cell first = { root, 0 };
    uint32_t count, columns, rows, region = m->lines.region[root];
    bool *spoilt = &m->spoilt[region];
    if (*spoilt || m->next[root] == NO_INDEX) return true;
    *spoilt = !find_corner(m, root, &first, &count) || !list_cells(m, first, count, &columns, &rows);
    if (*spoilt) return true;
    surface_grid *g = surface_grid_create(m->b->desc->memory, columns, rows);
    if (!g) return false;
    set_begins(m, columns, 1, 1, g->columns);
    set_begins(m, rows, columns, 3, g->rows);
    *spoilt = !is_flat(m, g);
    if (*spoilt)
        surface_grids_free(g);
    else
        replace(m, g);
    return true;
}

/* ---- all of it ---- */

/* What is cut no finer than elements are stays as it is. False when out of memory. */
static bool spoil_coarse(merger *m) {
    const builder *b = m->b;
    double size = b->mesh->element_size > 0.0 ? b->mesh->element_size : b->desc->element_size;
    double *area = block_zeroed(b->desc->memory, b->face_count + (size_t)1, sizeof *area);
    uint32_t *count = block_zeroed(b->desc->memory, b->face_count + (size_t)1, sizeof *count);
    bool ok = area && count;
    for (uint32_t f = 0; ok && f < b->face_count; f++) {
        const uint32_t *c = b->faces[f].corner;
        double half = triangle_area(position(m, c[0]), position(m, c[1]), position(m, c[2]));
        area[m->lines.region[f]] += c[3] == NO_INDEX ? half : 2.0 * half;
        count[m->lines.region[f]]++;
    }
    for (uint32_t f = 0; ok && f < b->face_count; f++)
        m->spoilt[f] = count[f] < MANY_FACES || area[f] > FINE * size * size * count[f];
    block_free_all(area, count);
    return ok;
}

/* Of every grid one face is left, in the place of its first. */
static void take_merged(merger *m) {
    builder *b = m->b;
    uint32_t left = 0;
    for (uint32_t f = 0; f < b->face_count; f++) {
        uint32_t root = union_find_root(m->grid, f);
        bool is_merged = m->next[root] != NO_INDEX && !m->spoilt[m->lines.region[f]];
        if (is_merged && root != f) continue;
        b->faces[left++] = is_merged ? m->merged[f] : b->faces[f];
    }
    b->face_count = left;
}

/* Drops vertices that no face has any more, and their nodes. False when out of memory. */
static bool drop_vertices(const builder *b, uint32_t first, uint32_t first_node) {
    mesh_vertices *v = b->out->vertices;
    uint32_t count = v->count, nodes = v->node_count;
    uint32_t *number = block_new(b->desc->memory, ((size_t)count - first + 1) * sizeof *number),
             *node = block_new(b->desc->memory, ((size_t)nodes - first_node + 1) * sizeof *node);
    if (!number || !node) return block_free_all(number, node), false;
    v->count = first, v->node_count = first_node;
    for (uint32_t i = first; i < count; i++) number[i - first] = NO_INDEX;
    for (uint32_t i = first_node; i < nodes; i++) node[i - first_node] = NO_INDEX;
    for (uint32_t f = 0; f < b->face_count; f++)
        for (int k = 0; k < face_corner_count(&b->faces[f]); k++) number[b->faces[f].corner[k] - first] = 0;
    for (uint32_t i = first; i < count; i++) {
        if (number[i - first] == NO_INDEX) continue;
        uint32_t *own = &node[v->nodes[i] - first_node];
        if (*own == NO_INDEX) *own = v->node_count++;
        v->nodes[v->count] = *own;
        vec3_copy(v->positions + 3 * (size_t)v->count, v->positions + 3 * (size_t)i);
        number[i - first] = v->count++;
    }
    for (uint32_t f = 0; f < b->face_count; f++)
        for (int k = 0; k < face_corner_count(&b->faces[f]); k++)
            b->faces[f].corner[k] = number[b->faces[f].corner[k] - first];
    block_free_all(number, node);
    return true;
}

static bool merge(merger *m) {
    uint32_t count = m->b->face_count;
    bool ok = spoil_coarse(m);
    if (ok) find_grids(m);
    for (uint32_t f = 0; ok && f < count; f++)
        if (m->grid[f] == f) ok = look_at(m, f);
    if (ok) take_merged(m);
    return ok;
}

hemi_result merge_faces(builder *b, uint32_t first_vertex, uint32_t first_node) {
    size_t faces = b->face_count;
    allocator *memory = b->desc->memory;
    if (!b->desc->merges || b->mesh->alpha_mask || faces < MANY_FACES || faces >= NO_INDEX / 4) return HEMI_OK;
    merger m = { .b = b,
                 .grid = block_new(memory, faces * sizeof *m.grid),
                 .next = block_new(memory, faces * sizeof *m.next),
                 .last = block_new(memory, faces * sizeof *m.last),
                 .cells = block_new(memory, faces * sizeof *m.cells),
                 .merged = block_new(memory, faces * sizeof *m.merged),
                 .spoilt = block_zeroed(memory, faces, sizeof *m.spoilt) };
    bool ok = m.grid && m.next && m.last && m.cells && m.merged && m.spoilt &&
              merge_lines_find(b, first_vertex, first_node, &m.lines);
    for (uint32_t f = 0; ok && f < faces; f++) m.grid[f] = f;
    ok = ok && merge(&m) && (b->face_count == faces || drop_vertices(b, first_vertex, first_node));
    merge_lines_free(&m.lines);
    block_free_all(m.grid, m.next, m.last, m.cells, m.merged, m.spoilt);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}
