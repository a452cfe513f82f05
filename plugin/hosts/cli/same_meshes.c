/* SPDX-License-Identifier: MIT
 * See same_meshes.h. Meshes of the second asset are sorted by how many triangles they have, then by where the first
 * corner lies, so that each of the first is held against few.
 */
#include "same_meshes.h"

#include <hemibake/mesh_transform.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct placed_mesh {
    hemi_mesh_desc desc;
    uint32_t index;
    double x; /* of its first corner */
    bool is_taken;
} placed_mesh;

static void corner_at(const hemi_mesh_desc *m, size_t corner, double at[3]) {
    hemi_transform_point(m->transform, m->positions + 3 * (size_t)m->indices[corner], at);
}

static placed_mesh place(const gltf_asset *asset, uint32_t index) {
    placed_mesh out = { .index = index };
    double at[3] = { 0 };
    gltf_asset_mesh(asset, index, &out.desc);
    if (out.desc.triangle_count > 0) corner_at(&out.desc, 0, at);
    out.x = isfinite(at[0]) ? at[0] : 0.0;
    return out;
}

static int compare_places(const void *a, const void *b) {
    const placed_mesh *p = a, *q = b;
    if (p->desc.triangle_count != q->desc.triangle_count)
        return p->desc.triangle_count < q->desc.triangle_count ? -1 : 1;
    if (p->x != q->x) return p->x < q->x ? -1 : 1;
    return (p->index > q->index) - (p->index < q->index);
}

static bool is_same(const hemi_mesh_desc *a, const hemi_mesh_desc *b, double apart) {
    for (size_t corner = 0; corner < 3 * (size_t)a->triangle_count; corner++) {
        double x[3], y[3];
        corner_at(a, corner, x), corner_at(b, corner, y);
        for (int k = 0; k < 3; k++)
            if (!(fabs(x[k] - y[k]) <= apart)) return false;
    }
    return true;
}

static bool has_name(const hemi_mesh_desc *a, const hemi_mesh_desc *b) {
    return a->name && b->name && strcmp(a->name, b->name) == 0;
}

/* Where in the sorted list what may be this mesh begins. */
static size_t begin_of(const placed_mesh *all, size_t count, const placed_mesh *mesh, double apart) {
    const placed_mesh least = { .desc.triangle_count = mesh->desc.triangle_count, .x = mesh->x - apart };
    size_t low = 0, high = count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (compare_places(&all[middle], &least) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static placed_mesh *find(placed_mesh *all, size_t count, const placed_mesh *mesh, double apart) {
    placed_mesh *found = NULL;
    for (size_t i = begin_of(all, count, mesh, apart); i < count; i++) {
        placed_mesh *one = &all[i];
        if (one->desc.triangle_count != mesh->desc.triangle_count || one->x > mesh->x + apart) break;
        bool is_better = !one->is_taken && (!found || has_name(&one->desc, &mesh->desc));
        if (is_better && is_same(&mesh->desc, &one->desc, apart)) found = one;
        if (found && has_name(&found->desc, &mesh->desc)) break;
    }
    return found;
}

uint32_t *same_meshes_find(const gltf_asset *first, const gltf_asset *second, double apart, same_meshes *out) {
    uint32_t count = gltf_asset_mesh_count(first), others = gltf_asset_mesh_count(second);
    uint32_t *mesh_of = malloc(((size_t)count + 1) * sizeof *mesh_of);
    placed_mesh *all = malloc(((size_t)others + 1) * sizeof *all);
    *out = (same_meshes){ 0 };
    if (!mesh_of || !all) return free(mesh_of), free(all), NULL;
    for (uint32_t i = 0; i < others; i++) all[i] = place(second, i);
    qsort(all, others, sizeof *all, compare_places);
    for (uint32_t i = 0; i < count && !out->has_stranger; i++) {
        const placed_mesh mesh = place(first, i);
        placed_mesh *found = find(all, others, &mesh, apart);
        if (!found) *out = (same_meshes){ true, true, i };
        mesh_of[i] = found ? found->index : 0;
        if (found) found->is_taken = true;
    }
    for (uint32_t i = 0; i < others; i++)
        if (!all[i].is_taken && !out->stranger_is_of_first && (!out->has_stranger || all[i].index < out->stranger))
            *out = (same_meshes){ true, false, all[i].index };
    free(all);
    return mesh_of;
}

bool same_attributes(const hemi_mesh_desc *a, const hemi_mesh_desc *b) {
    size_t width = a->attribute_count;
    if (width != b->attribute_count || !a->attributes != !b->attributes) return false;
    for (size_t corner = 0; a->attributes && corner < 3 * (size_t)a->triangle_count; corner++)
        if (memcmp(a->attributes + width * a->indices[corner], b->attributes + width * b->indices[corner],
                   width * sizeof *a->attributes) != 0)
            return false;
    return true;
}
