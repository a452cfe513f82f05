/* SPDX-License-Identifier: MIT
 * Which edges and points of the cage are sharp, which faces are holes, and which face-varying values do its corners
 * have? What the mesh says of its vertices and faces, said of the cage's. */
#include "cage_builder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- holes ----------------------------------------------------------------------------------------------------- */

hemi_result cage_mark_holes(cage_builder *b) {
    const hemi_subdivision_desc *how = b->how;
    b->holes = hemi_allocate_zeroed(b->out->memory, b->mesh_face_count, sizeof *b->holes);
    if (!b->holes) return cage_out_of_memory(b);
    if (how->hole_count && !how->holes)
        return subdivide_fail(HEMI_ERROR_ARGUMENT, b->message, "hole_count is set but holes is NULL");
    for (uint32_t i = 0; i < how->hole_count; i++) {
        if (how->holes[i] >= b->mesh_face_count)
            return subdivide_fail(HEMI_ERROR_DATA, b->message, "hole %lu is face %lu, but there are %lu",
                                  (unsigned long)i, (unsigned long)how->holes[i], (unsigned long)b->mesh_face_count);
        b->holes[how->holes[i]] = true;
    }
    return HEMI_OK;
}

/* Two triangles are only paired if both are holes or neither is. */
static hemi_result add_holes(cage_builder *b) {
    cage *out = b->out;
    if (b->how->hole_count == 0) return HEMI_OK;
    out->holes = hemi_allocate(b->out->memory, b->face_count * sizeof *out->holes);
    if (!out->holes) return cage_out_of_memory(b);
    for (uint32_t f = 0; f < b->face_count; f++) {
        bool counted = out->hole_count && out->holes[out->hole_count - 1] == (int)b->pieces[f];
        bool second = b->partners[f] != SIZE_MAX && b->edges[b->partners[f]].face != f;
        if (b->holes[b->origins[f]] && !counted && !second) out->holes[out->hole_count++] = (int)b->pieces[f];
    }
    return HEMI_OK;
}

/* ---- creases and corners --------------------------------------------------------------------------------------- */

static bool is_sharpness(float s) {
    return s >= 0.0f; /* infinity is as good as 10 */
}

static bool vertex_is_used(const cage_builder *b, uint32_t v) {
    return v < b->mesh->vertex_count && b->welded[v] != UINT32_MAX;
}

/* The edge between two vertices in the sorted list, by halves; it must also be one of the final cage: the diagonal of
 * a quad is none. */
static bool has_edge(const cage_builder *b, uint32_t v, uint32_t w) {
    uint32_t low = v < w ? v : w, high = v < w ? w : v;
    size_t begin = 0, end = b->corner_count;
    while (begin < end) {
        size_t middle = begin + (end - begin) / 2;
        const cage_edge *e = &b->edges[middle];
        if (e->low < low || (e->low == low && e->high < high))
            begin = middle + 1;
        else
            end = middle;
    }
    if (begin == b->corner_count || b->edges[begin].low != low || b->edges[begin].high != high) return false;
    return b->partners[b->edges[begin].face] != begin;
}

static hemi_result add_creases(cage_builder *b) {
    const hemi_subdivision_desc *how = b->how;
    cage *out = b->out;
    if (how->crease_count == 0) return HEMI_OK;
    if (!how->crease_edges || !how->crease_sharpness)
        return subdivide_fail(HEMI_ERROR_ARGUMENT, b->message, "crease_count is set but edges or sharpness is NULL");
    out->creases = hemi_allocate(b->out->memory, 2 * (size_t)how->crease_count * sizeof *out->creases);
    out->crease_sharpness = hemi_allocate(b->out->memory, how->crease_count * sizeof *out->crease_sharpness);
    if (!out->creases || !out->crease_sharpness) return cage_out_of_memory(b);
    for (uint32_t i = 0; i < how->crease_count; i++) {
        const uint32_t *ends = how->crease_edges + 2 * (size_t)i;
        bool valid = vertex_is_used(b, ends[0]) && vertex_is_used(b, ends[1]) &&
                     has_edge(b, b->welded[ends[0]], b->welded[ends[1]]) && is_sharpness(how->crease_sharpness[i]);
        if (!valid)
            return subdivide_fail(
                HEMI_ERROR_DATA, b->message,
                "crease %lu, from vertex %lu to %lu, is no edge of a face, or its sharpness is negative",
                (unsigned long)i, (unsigned long)ends[0], (unsigned long)ends[1]);
        for (size_t k = 0; k < 2; k++) out->creases[2 * (size_t)i + k] = (int)b->welded[ends[k]];
        out->crease_sharpness[i] = fminf(how->crease_sharpness[i], SUBDIVIDE_SHARPNESS_MAX);
    }
    out->crease_count = how->crease_count;
    return HEMI_OK;
}

static hemi_result add_points(cage_builder *b) {
    const hemi_subdivision_desc *how = b->how;
    cage *out = b->out;
    if (how->corner_count == 0) return HEMI_OK;
    if (!how->corner_vertices || !how->corner_sharpness)
        return subdivide_fail(HEMI_ERROR_ARGUMENT, b->message, "corner_count is set but vertices or sharpness is NULL");
    out->points = hemi_allocate(b->out->memory, how->corner_count * sizeof *out->points);
    out->point_sharpness = hemi_allocate(b->out->memory, how->corner_count * sizeof *out->point_sharpness);
    if (!out->points || !out->point_sharpness) return cage_out_of_memory(b);
    for (uint32_t i = 0; i < how->corner_count; i++) {
        uint32_t v = how->corner_vertices[i];
        if (!vertex_is_used(b, v) || !is_sharpness(how->corner_sharpness[i]))
            return subdivide_fail(HEMI_ERROR_DATA, b->message,
                                  "corner %lu, vertex %lu, belongs to no face, or its sharpness is negative",
                                  (unsigned long)i, (unsigned long)v);
        out->points[i] = (int)b->welded[v];
        out->point_sharpness[i] = fminf(how->corner_sharpness[i], SUBDIVIDE_SHARPNESS_MAX);
    }
    out->point_count = how->corner_count;
    return HEMI_OK;
}

/* ---- face-varying values --------------------------------------------------------------------------------------- */

/* A mesh vertex with where it is in the cage and its attributes. */
typedef struct valued_vertex {
    const float *row;
    uint32_t width, welded, vertex;
} valued_vertex;

static int compare_rows(const float *a, const float *b, uint32_t width) {
    for (uint32_t k = 0; k < width; k++)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

static int compare_valued(const void *left, const void *right) {
    const valued_vertex *a = left, *b = right;
    if (a->welded != b->welded) return a->welded < b->welded ? -1 : 1;
    int order = compare_rows(a->row, b->row, a->width);
    return order ? order : a->vertex < b->vertex ? -1 : a->vertex > b->vertex;
}

bool cage_same_values(const cage_builder *b, uint32_t corner, uint32_t other) {
    size_t width = b->mesh->attributes ? b->mesh->attribute_count : 0;
    const float *rows = b->mesh->attributes;
    return width == 0 ||
           compare_rows(rows + width * b->sources[corner], rows + width * b->sources[other], (uint32_t)width) == 0;
}

/* Numbers the different rows at each cage vertex; of_vertex[v]: that of mesh vertex v. */
static void number_values(cage_builder *b, valued_vertex *list, size_t count, uint32_t *of_vertex) {
    cage *out = b->out;
    size_t width = out->value_width;
    qsort(list, count, sizeof *list, compare_valued);
    for (size_t i = 0; i < count; i++) {
        bool known = i > 0 && list[i].welded == list[i - 1].welded &&
                     compare_rows(list[i].row, list[i - 1].row, list[i].width) == 0;
        if (!known) {
            for (size_t k = 0; k < width; k++) out->values[width * out->value_count + k] = list[i].row[k];
            out->value_count++;
        }
        of_vertex[list[i].vertex] = out->value_count - 1;
    }
}

static hemi_result add_values(cage_builder *b, const uint32_t *final_sources) {
    const hemi_mesh_desc *mesh = b->mesh;
    cage *out = b->out;
    if (!mesh->attributes || mesh->attribute_count == 0) return HEMI_OK;
    size_t vertices = mesh->vertex_count, count = 0;
    out->value_width = mesh->attribute_count;
    out->values = hemi_allocate(b->out->memory, vertices * out->value_width * sizeof *out->values);
    out->value_corners = hemi_allocate(b->out->memory, out->corner_count * sizeof *out->value_corners);
    valued_vertex *list = hemi_allocate(b->out->memory, vertices * sizeof *list);
    uint32_t *of_vertex = hemi_allocate(b->out->memory, vertices * sizeof *of_vertex);
    bool ok = out->values && out->value_corners && list && of_vertex;
    for (uint32_t v = 0; ok && v < vertices; v++)
        if (b->welded[v] != UINT32_MAX)
            list[count++] =
                (valued_vertex){ mesh->attributes + (size_t)out->value_width * v, out->value_width, b->welded[v], v };
    if (ok) {
        number_values(b, list, count, of_vertex);
        for (size_t c = 0; c < out->corner_count; c++) out->value_corners[c] = (int)of_vertex[final_sources[c]];
    }
    hemi_deallocate(b->out->memory, list);
    hemi_deallocate(b->out->memory, of_vertex);
    return ok ? HEMI_OK : cage_out_of_memory(b);
}

hemi_result cage_add_features(cage_builder *b, const uint32_t *final_sources) {
    hemi_result result = add_holes(b);
    if (result == HEMI_OK) result = add_creases(b);
    if (result == HEMI_OK) result = add_points(b);
    return result == HEMI_OK ? add_values(b, final_sources) : result;
}
