/* SPDX-License-Identifier: MIT */
#include "simplify.h"

#include "meshopt_shim.h"
#include "wedges.h"

#include "base/union_find.h"
#include "geometry/places.h"
#include "geometry/triangle.h"

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <string.h>

double simplify_triangle_count(double area, double edge) {
    return area / (0.25 * sqrt(3.0) * edge * edge);
}

/* ---- collapsing edges -------------------------------------------------------------------------------------------- */

/* Many more: so many times what was asked for, and so many at all. */
static const double MANY_TIMES = 1.5;
enum { MANY = 2000 };

/* Of what keeps its area this share is to be left: a tube that is thinner than the deviation is flat. Where too little
 * is the deviation is halved, so many times. Of all else this share: of 80,000 boxes that are smaller than what a rough
 * mesh may be off by 2,000 were left. */
static const double AREA_LEFT = 0.97, AREA_LEFT_LEAST = 0.5;
enum { HALVINGS = 5 };

/* indices[..count]: all triangles over wedges. */
static size_t list_triangles(const wedges *w, uint32_t *indices) {
    size_t count = 0;
    for (size_t c = 0; c < 3 * w->triangle_count; c++)
        if (w->wedge[c] != WEDGE_NONE) indices[count++] = w->wedge[c];
    return count;
}

/* World area of triangles over wedges. */
static double area_of(const float *positions, const uint32_t *indices, size_t count) {
    double area = 0.0;
    for (size_t i = 0; i + 2 < count; i += 3) {
        double p[3][3];
        for (size_t k = 0; k < 3; k++) vec3_from_floats(p[k], positions + 3 * (size_t)indices[i + k]);
        area += triangle_area(p[0], p[1], p[2]);
    }
    return area;
}

/* Up to a deviation, and where that leaves many further, up to the most. */
static bool collapse_to(const wedges *w, const float *positions, uint32_t *indices, size_t count, size_t wanted,
                        double deviation, double most, size_t *left) {
    size_t many = (size_t)(MANY_TIMES * (double)wanted) > 3 * MANY ? (size_t)(MANY_TIMES * (double)wanted) : 3 * MANY;
    bool ok = meshopt_collapse(positions, w->wedge_count, indices, count, wanted, deviation, left);
    while (ok && *left > many && (deviation *= 2) <= most)
        ok = meshopt_collapse(positions, w->wedge_count, indices, *left, wanted, deviation, left);
    return ok;
}

/* indices[..*left]: the triangles of all proxies over wedges. */
static bool collapse_edges(const wedges *w, uint32_t *indices, size_t *left) {
    float *positions = block_new(w->desc->memory, (3 * (size_t)w->wedge_count + 1) * sizeof *positions);
    if (!positions) return false;
    for (size_t i = 0; i < w->wedge_count; i++)
        memcpy(positions + 3 * i, w->positions + 3 * (size_t)w->wedge_vertex[i], 3 * sizeof *positions);
    const size_t count = list_triangles(w, indices);
    const double area = area_of(positions, indices, count), target = ceil(simplify_triangle_count(area, w->desc->edge));
    const size_t wanted = 3 * target < (double)count ? 3 * (size_t)target : count;
    const double share = w->desc->keeps_area ? AREA_LEFT : AREA_LEFT_LEAST;
    double deviation = w->desc->deviation;
    bool ok = true, is_kept = false;
    for (int i = 0; ok && !is_kept && i <= (w->desc->is_quick ? 0 : HALVINGS); i++, deviation *= 0.5) {
        if (i > 0) list_triangles(w, indices);
        double most = w->is_rough && i == 0 ? w->desc->roughest : deviation;
        ok = collapse_to(w, positions, indices, count, wanted, deviation, most, left);
        is_kept = ok && area_of(positions, indices, *left) >= share * area;
    }
    if (!is_kept) *left = list_triangles(w, indices);
    block_free(positions);
    return ok;
}

/* ---- proxies ----------------------------------------------------------------------------------------------------- */

static void normalize(float n[3]) {
    double length = sqrt(vec3_dot_floats(n, n));
    for (int k = 0; k < 3; k++) n[k] = length > 0.0 ? (float)(n[k] / length) : 0.0f;
}

/* normals[3*i+k] of wedge i: the mean of its triangles by area. */
static float *mean_normals(const wedges *w) {
    float *normals = block_zeroed(w->desc->memory, 3 * (size_t)w->wedge_count + 1, sizeof *normals);
    for (size_t c = 0; normals && c < 3 * w->triangle_count; c++)
        for (size_t k = 0; w->wedge[c] != WEDGE_NONE && k < 3; k++)
            normals[3 * (size_t)w->wedge[c] + k] += w->normals[3 * (c / 3) + k];
    for (size_t i = 0; normals && i < w->wedge_count; i++) normalize(normals + 3 * i);
    return normals;
}

static bool allocate_proxy(allocator *memory, const hemi_mesh_desc *m, simplify_mesh *out) {
    size_t v = out->vertex_count;
    out->positions = block_new(memory, (3 * v + 1) * sizeof *out->positions);
    out->normals = block_new(memory, (3 * v + 1) * sizeof *out->normals);
    out->indices = block_new(memory, (3 * (size_t)out->triangle_count + 1) * sizeof *out->indices);
    bool bare = !m->attributes || m->attribute_count == 0;
    out->attributes = bare ? NULL : block_new(memory, (m->attribute_count * v + 1) * sizeof *out->attributes);
    return out->positions && out->normals && out->indices && (bare || out->attributes);
}

static void set_vertex(const wedges *w, const hemi_mesh_desc *m, uint32_t mesh, const float *normals, uint32_t wedge,
                       simplify_mesh *out, uint32_t v) {
    size_t source = w->wedge_vertex[wedge] - w->first_vertex[mesh], n = m->attribute_count;
    memcpy(out->positions + 3 * (size_t)v, m->positions + 3 * source, 3 * sizeof(float));
    memcpy(out->normals + 3 * (size_t)v, normals + 3 * (size_t)wedge, 3 * sizeof(float));
    if (out->attributes) memcpy(out->attributes + n * v, m->attributes + n * source, n * sizeof(float));
}

/* indices[..left] that belong to a mesh. vertex[i] of wedge i: scratch, WEDGE_NONE where it is none of this mesh's. */
static bool extract_proxy(const wedges *w, uint32_t mesh, const float *normals, const uint32_t *indices, size_t left,
                          uint32_t *vertex, simplify_mesh *out) {
    const hemi_mesh_desc *m = w->desc->meshes[mesh];
    for (size_t i = 0; i < left; i++) {
        uint32_t source = w->wedge_vertex[indices[i]];
        if (source < w->first_vertex[mesh] || source >= w->first_vertex[mesh + 1]) continue;
        if (vertex[indices[i]] == WEDGE_NONE) vertex[indices[i]] = out->vertex_count++;
        out->triangle_count += i % 3 == 0;
    }
    if (!allocate_proxy(w->desc->memory, m, out)) return false;
    size_t at = 0;
    for (size_t i = 0; i < left; i++) {
        uint32_t source = w->wedge_vertex[indices[i]];
        if (source < w->first_vertex[mesh] || source >= w->first_vertex[mesh + 1]) continue;
        out->indices[at++] = vertex[indices[i]];
        set_vertex(w, m, mesh, normals, indices[i], out, vertex[indices[i]]);
    }
    return true;
}

/* ---- dense meshes ------------------------------------------------------------------------------------------------ */

/* out: in, stably sorted by key[..] < keys. first: room for keys + 2. */
static void sort_corners(const uint32_t *key, size_t keys, const uint32_t *in, size_t count, uint32_t *first,
                         uint32_t *out) {
    memset(first, 0, (keys + 2) * sizeof *first);
    for (size_t i = 0; i < count; i++) first[(key[in[i]] < keys ? key[in[i]] : keys - 1) + 2]++;
    for (size_t i = 2; i < keys + 2; i++) first[i] += first[i - 1];
    for (size_t i = 0; i < count; i++) out[first[(key[in[i]] < keys ? key[in[i]] : keys - 1) + 1]++] = in[i];
}

/* Corners by vertex, those of a vertex by wedge, with those of no wedge last. */
static bool sort_dense(allocator *memory, const hemi_mesh_desc *m, const uint32_t *wedge, size_t wedge_count,
                       uint32_t *sorted) {
    size_t corners = 3 * (size_t)m->triangle_count;
    size_t keys = m->vertex_count > wedge_count + 1 ? m->vertex_count : wedge_count + 1;
    uint32_t *by_wedge = block_new(memory, (corners + 1) * sizeof *by_wedge),
             *first = block_new(memory, (keys + 2) * sizeof *first);
    bool ok = by_wedge && first;
    for (size_t c = 0; ok && c < corners; c++) sorted[c] = (uint32_t)c;
    if (ok) {
        sort_corners(wedge, wedge_count + 1, sorted, corners, first, by_wedge);
        sort_corners(m->indices, m->vertex_count, by_wedge, corners, first, sorted);
    }
    block_free(by_wedge);
    block_free(first);
    return ok;
}

/* Vertices in the order of the mesh's own, so that indices keep their locality. */
static bool number_dense(const wedges *w, uint32_t mesh, simplify_mesh *out) {
    const hemi_mesh_desc *m = w->desc->meshes[mesh];
    const uint32_t *wedge = w->wedge + 3 * (size_t)w->first_triangle[mesh];
    size_t corners = 3 * (size_t)m->triangle_count;
    uint32_t *sorted = block_new(w->desc->memory, (corners + 1) * sizeof *sorted);
    out->dense_indices = block_new(w->desc->memory, (corners + 1) * sizeof *out->dense_indices);
    out->dense_source = block_new(w->desc->memory, (corners + 1) * sizeof *out->dense_source);
    bool ok = sorted && out->dense_indices && out->dense_source &&
              sort_dense(w->desc->memory, m, wedge, w->wedge_count, sorted);
    for (size_t i = 0; ok && i < corners; i++) {
        uint32_t c = sorted[i], before = i ? sorted[i - 1] : c;
        bool same = i && m->indices[before] == m->indices[c];
        if (!same || (wedge[c] != wedge[before] && wedge[c] != WEDGE_NONE))
            out->dense_source[out->dense_vertex_count++] = c;
        out->dense_indices[c] = out->dense_vertex_count - 1;
    }
    block_free(sorted);
    return ok;
}

static bool read_dense(const wedges *w, uint32_t mesh, const float *normals, simplify_mesh *out) {
    const uint32_t *wedge = w->wedge + 3 * (size_t)w->first_triangle[mesh];
    if (!number_dense(w, mesh, out)) return false;
    out->dense_normals =
        block_zeroed(w->desc->memory, 3 * (size_t)out->dense_vertex_count + 1, sizeof *out->dense_normals);
    if (!out->dense_normals) return false;
    for (size_t v = 0; v < out->dense_vertex_count; v++) {
        uint32_t own = wedge[out->dense_source[v]];
        if (own == WEDGE_NONE) continue;
        memcpy(out->dense_normals + 3 * v, normals + 3 * (size_t)own, 3 * sizeof(float));
    }
    return true;
}

/* ---- all of it --------------------------------------------------------------------------------------------------- */

static hemi_result simplify(const wedges *w, simplify_mesh *out) {
    size_t corners = 3 * w->triangle_count, left = 0;
    uint32_t *indices = block_new(w->desc->memory, (corners + 1) * sizeof *indices);
    uint32_t *vertex = block_new(w->desc->memory, ((size_t)w->wedge_count + 1) * sizeof *vertex);
    float *normals = mean_normals(w);
    bool ok = indices && vertex && normals && collapse_edges(w, indices, &left);
    for (size_t i = 0; ok && i < w->wedge_count; i++) vertex[i] = WEDGE_NONE;
    for (uint32_t i = 0; ok && i < w->desc->mesh_count; i++)
        ok = extract_proxy(w, i, normals, indices, left, vertex, &out[i]) && read_dense(w, i, normals, &out[i]);
    block_free(indices);
    block_free(vertex);
    block_free(normals);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}

hemi_result simplify_meshes(const simplify_desc *desc, simplify_mesh *out, simplify_check *check) {
    wedges w;
    for (uint32_t i = 0; i < desc->mesh_count; i++) out[i] = (simplify_mesh){ 0 };
    hemi_result result = wedges_find(desc, &w);
    if (result == HEMI_OK) result = simplify(&w, out);
    *check = w.check;
    wedges_free(&w);
    for (uint32_t i = 0; result != HEMI_OK && i < desc->mesh_count; i++) simplify_mesh_free(&out[i]);
    return result;
}

void simplify_mesh_free(simplify_mesh *m) {
    void *all[] = { m->positions,     m->normals,      m->attributes,   m->indices,
                    m->dense_indices, m->dense_source, m->dense_normals };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) block_free(all[i]);
    memset(m, 0, sizeof *m);
}

/* ---- groups ------------------------------------------------------------------------------------------------------ */

/* first[place]: a mesh that has a vertex there. */
static void join_by_places(const hemi_mesh_desc *const *meshes, uint32_t mesh_count, const uint32_t *place,
                           uint32_t *first, uint32_t *group) {
    size_t v = 0;
    for (uint32_t i = 0; i < mesh_count; i++)
        for (size_t end = v + meshes[i]->vertex_count; v < end; v++) {
            if (first[place[v]] == WEDGE_NONE) first[place[v]] = i;
            union_find_join(group, first[place[v]], i);
        }
    for (uint32_t i = 0; i < mesh_count; i++) group[i] = union_find_root(group, i);
}

hemi_result simplify_find_groups(allocator *memory, const hemi_mesh_desc *const *meshes, uint32_t mesh_count,
                                 uint32_t *group) {
    size_t vertices = 0, v = 0;
    for (uint32_t i = 0; i < mesh_count; i++) vertices += meshes[i]->vertex_count, group[i] = i;
    if (mesh_count < 2) return HEMI_OK;
    float *positions = block_new(memory, (3 * vertices + 1) * sizeof *positions);
    uint32_t *place = block_new(memory, (vertices + 1) * sizeof *place),
             *first = block_new(memory, (vertices + 1) * sizeof *first),
             *slots = block_new(memory, places_slot_count(vertices) * sizeof *slots);
    bool ok = positions && place && first && slots;
    for (uint32_t i = 0; ok && i < mesh_count; i++)
        for (size_t n = 0; n < meshes[i]->vertex_count; n++, v++) {
            double p[3];
            hemi_transform_point(meshes[i]->transform, meshes[i]->positions + 3 * n, p);
            for (size_t k = 0; k < 3; k++) positions[3 * v + k] = (float)p[k];
            first[v] = WEDGE_NONE;
        }
    if (ok) places_find_floats(positions, vertices, slots, place);
    if (ok) join_by_places(meshes, mesh_count, place, first, group);
    block_free(positions);
    block_free(place);
    block_free(first);
    block_free(slots);
    return ok ? HEMI_OK : HEMI_ERROR_MEMORY;
}
