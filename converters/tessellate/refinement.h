/* SPDX-License-Identifier: MIT
 * Which elements are cut finer, so that neighbours differ by one level and no edge has a T-junction? Every element is
 * the root of a tree; a leaf is cut in the middles of all its edges, a quad into four quads, a triangle into four
 * triangles.
 *
 * Edges are known by where their ends are, whatever their vertices are called: a leaf beside a finer one gets a vertex
 * in the middle of the common edge, also across a crease, a seam of attributes or between two meshes.
 */
#ifndef HEMIBAKE_TESSELLATE_REFINEMENT_H
#define HEMIBAKE_TESSELLATE_REFINEMENT_H

#include "tessellate.h"

typedef struct tessellate_leaf {
    uint32_t corner[4]; /* as of an element */
    uint32_t mid[4];    /* the vertex that hangs in the middle of the edge from corner k, where bit k of cut is set */
    uint32_t base;      /* the element that it is a part of */
    uint32_t origin;    /* where it, or what it was cut from, was among the leaves before the last split */
    float u, v, size; /* corner 0 and the edges' length in coordinates of the base: corner 0 of that is (0,0), corner 1
                         (1,0), the last (0,1). Negative: turned by half a turn, as the middle of a triangle is */
    uint8_t cut, level;
    bool fresh; /* made by the last split */
} tessellate_leaf;

typedef struct refinement refinement;

/* Takes the elements of a tessellation as leaves. The tessellation gets vertices and nodes behind those it has; it and
 * the meshes must outlive the refinement. HEMI_ERROR_MEMORY. */
hemi_result refinement_create(tessellation *t, const hemi_mesh_desc *meshes, refinement **out);
void refinement_free(refinement *r);

/* Leaves of a base, and bases, are in order. Valid until the next split. */
const tessellate_leaf *refinement_leaves(const refinement *r, uint32_t *count);

/* Cuts the leaves that are marked, and those that must be so that neighbours differ by one level. HEMI_ERROR_LIMIT past
 * leaves_max, and nothing has changed then but the marks. */
hemi_result refinement_split(refinement *r, bool *marks, uint32_t leaves_max);

/* Cuts all leaves. No vertex hangs then, so edges are forgotten, and nothing but this may be asked for again. */
hemi_result refinement_split_all(refinement *r, uint32_t leaves_max);

#endif
