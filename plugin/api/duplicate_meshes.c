/* SPDX-License-Identifier: MIT */
#include "duplicate_meshes.h"

#include "base/chunk_file.h"

#include <stdlib.h>
#include <string.h>

/* Meshes in the order of their hashes: only those of one hash are compared. */
typedef struct hashed_mesh {
    uint64_t hash;
    uint32_t mesh;
} hashed_mesh;

static hashed_mesh hash_mesh(const hemi_mesh_desc *m, uint32_t index) {
    uint64_t h = chunk_digest(m->transform, sizeof m->transform, m->vertex_count);
    h = chunk_digest(m->positions, 3 * (size_t)m->vertex_count * sizeof *m->positions, h);
    return (hashed_mesh){ chunk_digest(m->indices, 3 * (size_t)m->triangle_count * sizeof *m->indices, h), index };
}

static int compare(const void *a, const void *b) {
    const hashed_mesh *p = a, *q = b;
    if (p->hash != q->hash) return p->hash < q->hash ? -1 : 1;
    return (p->mesh > q->mesh) - (p->mesh < q->mesh);
}

/* Both NULL, or both the same numbers. */
static bool same_numbers(const void *a, const void *b, size_t size) {
    return a && b ? memcmp(a, b, size) == 0 : a == b;
}

static bool coincide(const hemi_scene *in, const hemi_mesh_desc *a, const hemi_mesh_desc *b) {
    size_t vertices = a->vertex_count;
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           a->attribute_count == b->attribute_count && memcmp(a->transform, b->transform, sizeof a->transform) == 0 &&
           in->materials[a->material].double_sided == in->materials[b->material].double_sided &&
           same_numbers(a->indices, b->indices, 3 * (size_t)a->triangle_count * sizeof *a->indices) &&
           same_numbers(a->positions, b->positions, 3 * vertices * sizeof *a->positions) &&
           same_numbers(a->normals, b->normals, 3 * vertices * sizeof *a->normals) &&
           same_numbers(a->attributes, b->attributes, a->attribute_count * vertices * sizeof *a->attributes);
}

static size_t list_meshes(const bake_scene *f, hashed_mesh *out) {
    size_t count = 0;
    for (size_t i = 0; i < f->mesh_count; i++) {
        const hemi_mesh_desc *m = &f->meshes[i];
        f->copy_of[i] = NO_INDEX;
        if (m->triangle_count > 0 && !mesh_is_subdivided(m) && !m->alpha_mask) out[count++] = hash_mesh(m, (uint32_t)i);
    }
    qsort(out, count, sizeof *out, compare);
    return count;
}

bool duplicate_meshes_find(const hemi_scene *in, bake_scene *f) {
    hashed_mesh *all = block_new(f->memory.memory, (f->mesh_count + 1) * sizeof *all);
    f->copy_of = arena_alloc(&f->memory, f->mesh_count + 1, sizeof *f->copy_of);
    bool ok = all && f->copy_of;
    size_t count = ok ? list_meshes(f, all) : 0, end;
    for (size_t first = 0; first < count; first = end) {
        for (end = first + 1; end < count && all[end].hash == all[first].hash; end++) {
        }
        /* Within a run of equal hashes: the first that a mesh coincides with. */
        for (size_t i = first + 1; i < end; i++)
            for (size_t k = first; k < i && f->copy_of[all[i].mesh] == NO_INDEX; k++)
                if (f->copy_of[all[k].mesh] == NO_INDEX &&
                    coincide(in, &f->meshes[all[k].mesh], &f->meshes[all[i].mesh]))
                    f->copy_of[all[i].mesh] = all[k].mesh;
    }
    block_free(all);
    for (size_t i = 0; ok && i < f->mesh_count; i++) {
        if (f->copy_of[i] == NO_INDEX) continue;
        f->meshes[i].triangle_count = 0;
        f->duplicate_count++;
    }
    return ok;
}
