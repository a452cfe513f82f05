/* SPDX-License-Identifier: MIT
 * Which elements are split, so that neighbours differ by one level and no edge has a T-junction? Every element of the
 * mesh that was solved with is the root of a tree; a leaf is split in the middles of all its edges, a quad into four
 * quads, a triangle into four triangles. Leaves are elements themselves, and the mesh of leaves shares them.
 *
 * Edges are known by where their ends are, whatever their vertices are called: a leaf beside a finer one gets a hanging
 * vertex in the middle of the common edge, also across a crease, a seam of attributes or between two meshes.
 *
 * The children of a leaf take its place among the leaves: those of a root, and of a patch, stay together, since patches
 * own ranges of elements and sums run in that order. So samples of leaves are numbered anew in each mesh of leaves.
 */
#ifndef HEMIBAKE_CORE_MESH_REFINEMENT_H
#define HEMIBAKE_CORE_MESH_REFINEMENT_H

#include "mesh/mesh.h"
#include "mesh/mesh_vertices.h"

/* What is known of a leaf beside its element. */
typedef struct leaf {
    uint32_t root;         /* the element of the mesh that it is a part of */
    uint32_t first_sample; /* in the mesh of the leaves */
    uint32_t origin;       /* the first sample of it, or of what it was split from, before the last split */
    float u, v, size; /* corner 0 and the edges' length in coordinates of the root: corner 0 of that is (0,0), corner 1
                         (1,0), the last (0,1). Negative: turned by half a turn, as the middle of a triangle is */
    uint8_t level, sample_count;
    bool is_new; /* made by the last split */
} leaf;

typedef struct refinement_setup {
    scene *scene;
    mesh *mesh;                 /* measured */
    mesh_vertices *vertices;    /* of both, which follow when vertices are added */
    const source_mesh *sources; /* of each mesh of the scene */
    jobs *jobs;                 /* NULL: the caller does all of it */
} refinement_setup;

typedef enum refinement_result { REFINEMENT_OK, REFINEMENT_LIMIT, REFINEMENT_NO_MEMORY } refinement_result;

typedef struct refinement refinement;

/* The elements of the mesh are the leaves. NULL when out of memory. */
refinement *refinement_create(const refinement_setup *setup);
void refinement_free(refinement *r);

/* Leaves of a root, and roots, are in order. Valid until the next split. */
const leaf *refinement_leaves(const refinement *r, uint32_t *count);

/* Splits the leaves that are marked, and those that must be so that neighbours differ by one level. REFINEMENT_LIMIT
 * past leaves_max, and nothing has changed then but the marks. */
refinement_result refinement_split(refinement *r, bool *marks, uint32_t leaves_max);

/* Splits all leaves. No vertex hangs then, so edges are forgotten, and nothing but this may be asked for again. */
refinement_result refinement_split_all(refinement *r, uint32_t leaves_max);

/* The mesh of the leaves: patches keep what shoots. Its elements are those of the refinement until the split after the
 * next. False when out of memory. */
bool refinement_mesh(const refinement *r, arena *memory, mesh *out);

/* A mesh of its own of the new leaves from begin to end. False when out of memory. */
bool refinement_mesh_of_new(const refinement *r, uint32_t begin, uint32_t end, arena *memory, mesh *out);

/* Makes the mesh that was refined the mesh of the leaves; nothing but refinement_leaves may be asked for then. False
 * when out of memory. */
bool refinement_finish(refinement *r, arena *memory);

#endif
